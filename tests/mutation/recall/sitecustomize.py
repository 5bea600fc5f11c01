"""Runs of the program that do not come by the fault that is switched on are recalled, not repeated.

mutate.py puts this folder into PYTHONPATH. A run is known by its command line, the files that this names, and how often
it has been seen before in the same script; what it printed and which files of the scratch folder it changed are kept,
with the faults that it came by. Nothing is recalled that could depend on a run that did come by the fault.
"""
import collections
import hashlib
import os
import pathlib
import pickle
import re
import resource
import shutil
import subprocess
import tempfile

PROGRAM = os.environ.get("SGMP_MUTANT_PROGRAM", "")
RECORDS = pathlib.Path(os.environ.get("SGMP_MUTANT_RECORDS", "."))
FAULT = int(os.environ.get("SGMP_MUTANT", "0"))
LARGEST = 200_000_000   # bytes of files that a record may have
RESTARTS = ("--restart", "restart")
SCRATCH = pathlib.Path.cwd()
TEMPORARY = re.compile(re.escape(tempfile.gettempdir()) + r"/tmp\w+")  # another in every run of a script
seen = collections.Counter()
doubtful = set()        # folders that runs with the fault, or interrupted ones, have written to
real_run, RealPopen = subprocess.run, subprocess.Popen


def files():
    """The files of the scratch folder: path -> what shows a change."""
    found = {}
    for folder, _, names in os.walk(SCRATCH):
        for name in names:
            try:
                state = os.lstat(os.path.join(folder, name))
            except FileNotFoundError:
                continue
            found[os.path.join(folder, name)] = (state.st_mtime_ns, state.st_size, state.st_ino)
    return found


def contents(words):
    """The bytes of the files that a command line names."""
    return b"\0".join(pathlib.Path(word).read_bytes() for word in words if word != PROGRAM and os.path.isfile(word))


def output_folder(words):
    """Where a command line writes to."""
    return {words[place + 1] for place, word in enumerate(words[:-1]) if word == "--output"}


def depends(words, text):
    """Whether a run may read what is doubtful."""
    if doubtful and any(word in RESTARTS for word in words):
        return True
    return any(folder in word for folder in doubtful for word in words) or any(
        folder.encode() in text for folder in doubtful
    )


def cpu_seconds():
    """What the processes that this one has waited for have used."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def key_of(words, text, settings):
    """The name of a run's record."""
    environment = settings.get("env") or os.environ
    told = sorted(
        (name, value)
        for name, value in environment.items()
        if name.startswith(("SGMP_", "OMP_", "OMPI_")) and not name.startswith(("SGMP_MUTANT", "SGMP_TEST_FIRST"))
    )
    how = sorted((name, repr(value)) for name, value in settings.items() if name not in ("env", "timeout", "check"))
    same = hashlib.sha1(TEMPORARY.sub("", repr((words, told, how))).encode() + text).hexdigest()
    seen[same] += 1
    return f"{same}_{seen[same]}"


def record_of(folder):
    """What is kept of a run."""
    try:
        with open(folder / "record", "rb") as file:
            return pickle.load(file)
    except FileNotFoundError:
        return None


def note(seconds, reaches):
    """Tells mutate.py what the runs of a script take and which faults they come by."""
    if FAULT == 0:
        with open(RECORDS / "runs", "a", encoding="ascii") as file:
            file.write(f"{seconds} {' '.join(map(str, sorted(reaches)))}\n")


def put_back(record, folder, check, words):
    """What a run printed; its files are put back."""
    for path in record["removed"]:
        pathlib.Path(path).unlink(missing_ok=True)
    for number, path in enumerate(record["changed"]):
        os.makedirs(os.path.dirname(path), exist_ok=True)
        pathlib.Path(path).unlink(missing_ok=True)
        shutil.copyfile(folder / str(number), path, follow_symlinks=False)
    done = subprocess.CompletedProcess(words, record["code"], record["stdout"], record["stderr"])
    if check:
        done.check_returncode()
    return done


def keep(folder, done, before, after, reaches, seconds):
    """Keeps what a run did."""
    changed = [path for path, state in after.items() if before.get(path) != state]
    if sum(after[path][1] for path in changed) > LARGEST:
        return
    part = folder.with_suffix(".part")
    shutil.rmtree(part, ignore_errors=True)
    part.mkdir(parents=True)
    for number, path in enumerate(changed):
        shutil.copyfile(path, part / str(number), follow_symlinks=False)
    with open(part / "record", "wb") as file:
        pickle.dump(
            {
                "code": done.returncode,
                "stdout": done.stdout,
                "stderr": done.stderr,
                "seconds": seconds,
                "reaches": reaches,
                "changed": changed,
                "removed": [path for path in before if path not in after],
            },
            file,
        )
    part.rename(folder)


def run(*positional, check=False, **settings):
    """Stands in for subprocess.run."""
    words = positional[0] if positional else settings.get("args")
    if not isinstance(words, list) or PROGRAM not in words or {"preexec_fn", "input", "stdin"} & settings.keys():
        return real_run(*positional, check=check, **settings)
    text = contents(words)
    key = key_of(words, text, settings)
    folder, trace = RECORDS / key, RECORDS / f"{key}.{os.getpid()}.trace"
    may = not depends(words, text)
    record = record_of(folder)
    if may and record and FAULT not in record["reaches"]:
        note(record["seconds"], record["reaches"])
        return put_back(record, folder, check, words)
    if record: # a run that does not end has a fault
        limit = int(3*record["seconds"]) + 3
        settings["preexec_fn"] = lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 2))
    RECORDS.mkdir(parents=True, exist_ok=True)
    before, cpu = files(), cpu_seconds()
    settings["env"] = {**(settings.get("env") or os.environ), "SGMP_MUTANT_TRACE": str(trace)}
    subprocess.Popen = RealPopen
    try:
        done = real_run(*positional, **settings)
    finally:
        subprocess.Popen = Popen
        reaches = frozenset(n for n, byte in enumerate(trace.read_bytes()) if byte) if trace.exists() else frozenset()
        trace.unlink(missing_ok=True)
    after = files()
    seconds = cpu_seconds() - cpu
    note(seconds, reaches)
    if FAULT in reaches or not may:
        doubtful.update(
            output_folder(words), (os.path.dirname(path) for path, state in after.items() if before.get(path) != state)
        )
    elif not folder.exists():
        keep(folder, done, before, after, reaches, seconds)
    if check:
        done.check_returncode()
    return done


class Popen(RealPopen):
    """What is started and left to itself may be interrupted."""

    def __init__(self, args, *positional, **settings):
        if isinstance(args, list) and PROGRAM in args:
            doubtful.update(output_folder(args) or [str(SCRATCH)])
        super().__init__(args, *positional, **settings)


if PROGRAM:
    subprocess.run, subprocess.Popen = run, Popen
