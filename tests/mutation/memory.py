"""What earlier rounds of mutate.py have found: which test noticed which fault, and how tests went without one."""
import collections
import hashlib
import json
import pathlib
import threading


def digest(paths):
    """What tells the contents of some files from others."""
    sums = hashlib.sha1()
    for path in map(pathlib.Path, paths):
        if path.is_file():
            sums.update(path.name.encode() + b"\0" + path.read_bytes())
    return sums.hexdigest()[:12]


class Memory:
    """A file of outcomes; those of other sources count only for what a test promises."""

    def __init__(self, path, sources):
        self.path, self.sources = pathlib.Path(path), sources
        self.lock = threading.Lock()
        kept = json.loads(self.path.read_text(encoding="utf-8")) if self.path.exists() else {}
        self.first = kept.get("first", {})      # test -> state, seconds, reaches, runs
        self.outcomes = kept.get("outcomes", {})  # fault -> test -> [state, noticed]
        self.unfit = kept.get("unfit", {})      # fault -> the sources that it is no Fortran in
        self.tally = collections.defaultdict(lambda: [0, 0])
        for fault, tests in self.outcomes.items():
            for test, (_, noticed) in tests.items():
                self.count(fault.split("|")[0], test, noticed)

    def count(self, file, test, noticed):
        """Adds an outcome to those of a file and of its area."""
        for place in (file, file.split("/")[1]):
            self.tally[test, place][0] += noticed
            self.tally[test, place][1] += 1

    def write(self):
        """Writes the file anew."""
        part = self.path.with_suffix(".part")
        part.write_text(
            json.dumps({"first": self.first, "outcomes": self.outcomes, "unfit": self.unfit}), encoding="utf-8"
        )
        part.rename(self.path)

    def fits(self, mutant):
        """Whether a fault is Fortran, as far as is known."""
        return self.unfit.get(key(mutant)) != self.sources

    def keep_unfit(self, mutants):
        """Keeps which faults are no Fortran."""
        self.unfit.update({key(mutant): self.sources for mutant in mutants})
        self.write()

    def first_round(self, test, program):
        """How a test went without a fault, None if that is not known of this program."""
        known = self.first.get(test.name)
        return known if known and known["state"] == program + test.state else None

    def keep_first_round(self, test, program, known):
        """Keeps how a test went without a fault."""
        with self.lock:
            self.first[test.name] = {**known, "state": program + test.state}
            self.write()

    def outcome(self, mutant, test):
        """Whether a test has noticed a fault, None if it has not been tried."""
        state, noticed = self.outcomes.get(key(mutant), {}).get(test.name, (None, None))
        return noticed if state == self.sources + test.state else None

    def keep(self, mutant, test, noticed):
        """Keeps whether a test notices a fault."""
        with self.lock:
            self.outcomes.setdefault(key(mutant), {})[test.name] = [self.sources + test.state, noticed]
            self.count(mutant.file, test.name, noticed)
            self.write()

    def promise(self, test, mutant):
        """Chance that a test notices a fault, by what it has noticed in the same file and area; tests of units, and
        those that come by few faults, are the likelier."""
        chance = 0.3 if test.kind == "unit" else 0.15
        for place, weight in ((mutant.folder, 4), (mutant.file, 2)):
            noticed, tried = self.tally.get((test.name, place), (0, 0))
            chance = (noticed + weight*chance)/(tried + weight)
        return chance/(1 + len(test.reaches))**0.25


def key(mutant):
    """The name of a fault."""
    return f"{mutant.file}|{mutant.line}|{mutant.was}|{mutant.now}"
