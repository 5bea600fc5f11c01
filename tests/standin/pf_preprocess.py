#!/usr/bin/env python3
"""Turns a unit test in pFUnit's language (.pf) into Fortran (.F90) for the stand-in framework of this folder.

usage: pf_preprocess.py INPUT.pf OUTPUT.F90

Only the directives listed in tests/README.md are known; everything else is rejected as FILE:LINE: message with exit
code 1, so that a file that passes here also builds with the real pFUnit 4.14.
"""
import os
import re
import sys

# Number of positional arguments of each assertion: (least, most).
ASSERTIONS = {
    "fail": (1, 1), "true": (1, 1), "false": (1, 1), "equal": (2, 2), "notequal": (2, 2), "lessthan": (2, 2),
    "lessthanorequal": (2, 2), "greaterthan": (2, 2), "greaterthanorequal": (2, 2), "relativelyequal": (2, 2),
    "sameshape": (2, 2), "any": (1, 1), "all": (1, 1), "none": (1, 1), "notall": (1, 1), "isnan": (1, 1),
    "isfinite": (1, 1), "exceptionraised": (0, 1),
}
WITH_TOLERANCE = {"equal", "relativelyequal"}
WITHOUT_MESSAGE = {"fail", "exceptionraised"}
FORBIDDEN_NAMES = set("run test is every near stub initialize finalize disable t suite".split())
LINE_LIMIT = 132


class Rejected(Exception):
    def __init__(self, line, message):
        super().__init__(message)
        self.line = line


class Test:
    def __init__(self, line, npes):
        self.line, self.npes = line, npes
        self.name, self.disabled = None, False


def split_arguments(text):
    """Splits at top-level commas; None if a bracket or a quote is left open."""
    parts, depth, quote, current = [], 0, None, ""
    for char in text:
        if quote:
            quote = None if char == quote else quote
        elif char in "'\"":
            quote = char
        elif char in "([":
            depth += 1
        elif char in ")]":
            depth -= 1
            if depth < 0:
                return None
        elif char == "," and depth == 0:
            parts.append(current.strip())
            current = ""
            continue
        current += char
    if quote or depth:
        return None
    if current.strip() or parts:
        parts.append(current.strip())
    return parts


def without_comment(line):
    quote = None
    for i, char in enumerate(line):
        if quote:
            quote = None if char == quote else quote
        elif char in "'\"":
            quote = char
        elif char == "!":
            return line[:i]
    return line


class Preprocessor:
    def __init__(self, path):
        self.path = path
        self.base = os.path.splitext(os.path.basename(path))[0]
        self.output = []
        self.module = None
        self.is_mpi = None          # use pfunit / use funit, once seen
        self.tests = []
        self.hooks = {}             # 'before' / 'after' -> (line, name)
        self.pending = None         # ('test', Test) or ('before'|'after', line): the next subroutine belongs to it
        self.procedure = None       # (name, arguments) of the module procedure that we are in
        self.contains = False
        self.typedef = False

    def run(self):
        with open(self.path, encoding="utf-8") as file:
            lines = file.read().split("\n")
        if lines and lines[-1] == "":
            lines.pop()
        self.output.append(f'#line 1 "{self.path}"')
        for number, line in enumerate(lines, 1):
            self.line(number, line)
        last = len(lines)
        if self.pending:
            raise Rejected(last, "the file ends where a subroutine should follow a directive")
        if self.module is None:
            raise Rejected(last, "no module")
        if self.is_mpi is None:
            raise Rejected(last, "neither `use funit` nor `use pfunit`")
        if not self.tests:
            raise Rejected(last, "no @test")
        if self.is_mpi and len(self.hooks) == 1:
            raise Rejected(next(iter(self.hooks.values()))[0],
                           "with npes, @before and @after come both or not at all")
        self.suite()
        return "\n".join(self.output) + "\n"

    # ------------------------------------------------------------------------------------------------ one line
    def line(self, number, line):
        code = without_comment(line).strip()
        if code.startswith("@"):
            self.directive(number, line)
            return
        if re.search(r"\banyexceptions\s*\(\s*[^\s)]", code, re.IGNORECASE):
            raise Rejected(number, "anyExceptions takes no communicator")
        if code:
            self.statement(number, code, line)
        self.output.append(line)

    def statement(self, number, code, line):
        lower = code.lower()
        match = re.match(r"module\s+(\w+)(.*)$", lower)
        if match and not re.match(r"module\s+(procedure|subroutine|function)\b", lower):
            if self.module is not None:
                raise Rejected(number, "one module per file")
            if not re.match(r"\s*module\s+\w+\s*$", line, re.IGNORECASE):
                raise Rejected(number, "nothing may follow the module's name on its line")
            if match.group(1) != self.base.lower():
                raise Rejected(number, f"the module must be called {self.base}, as its file")
            self.module = match.group(1)
            return
        match = re.match(r"use\s*(?:::)?\s*(p?funit)\b(.*)$", lower)
        if match:
            if match.group(2).strip():
                raise Rejected(number, "`use funit` and `use pfunit` take no only: or renaming")
            if self.is_mpi is not None and self.procedure is None:
                raise Rejected(number, "use either funit or pfunit, once")
            if self.is_mpi is None:
                self.is_mpi = match.group(1) == "pfunit"
            return
        if self.procedure is None and not self.contains and re.match(r"private\b(?!.*::)", lower) and not self.typedef:
            raise Rejected(number, "a test module is public")
        if re.match(r"contains\b", lower) and self.procedure is None and not self.typedef:
            self.contains = True
            return
        if re.match(r"type\b(?!\s*\()", lower):
            self.typedef = True
        if re.match(r"end\s*type\b", lower):
            self.typedef = False
        if not self.contains and "::" in code and not lower.startswith("use"):
            for name in re.findall(r"(?:^|,)\s*(\w+)", re.sub(r"\(.*?\)", "", lower.split("::", 1)[1])):
                self.check_name(number, name)
        self.procedure_statement(number, code, lower)

    def procedure_statement(self, number, code, lower):
        if self.procedure is not None:
            if re.match(rf"end\s*(subroutine|function)\s*{self.procedure[0]}\s*$", lower):
                self.procedure = None
            return
        match = re.match(r"(?:[\w\s()*=,]*?\b)?(subroutine|function)\s+(\w+)\s*(\(([\w\s,]*)\))?", lower)
        if self.pending and not re.match(r"subroutine\s+\w+\s*(\([\w\s,]*\))?\s*$", lower):
            raise Rejected(
                number, "a plain `subroutine name` or `subroutine name(this)`, on one line, must follow a directive"
            )
        if not match or lower.startswith("end") or not self.contains:
            return
        name = match.group(2)
        arguments = [a.strip() for a in (match.group(4) or "").split(",") if a.strip()]
        self.check_name(number, name)
        self.procedure = (name, arguments)
        if self.pending:
            self.attach(number, name, arguments)

    def attach(self, number, name, arguments):
        kind, item = self.pending
        self.pending = None
        wanted = ["this"] if self.is_mpi else []
        if arguments != wanted:
            raise Rejected(number, f"this subroutine must have "
                           f"{'the argument this, of class(MpiTestMethod)' if wanted else 'no argument'}")
        if kind == "test":
            if any(t.name == name for t in self.tests):
                raise Rejected(number, f"a second test called {name}")
            item.name = name
            self.tests.append(item)
        else:
            self.hooks[kind] = (item, name)

    def check_name(self, number, name):
        if name.lower() in FORBIDDEN_NAMES:
            raise Rejected(number, f"the module-level name {name} clashes with pFUnit's own")

    # ---------------------------------------------------------------------------------------------- directives
    def directive(self, number, line):
        if "&" in without_comment(line) and without_comment(line).rstrip().endswith("&"):
            raise Rejected(number, "a directive is one line, without &")
        if without_comment(line) != line:
            raise Rejected(number, "no comment may follow a directive on its line")
        text = line.strip()
        match = re.match(r"@(\w+)\s*(\((.*)\))?$", text)
        if not match:
            raise Rejected(number, f"malformed directive: {text}")
        name, has_list, arguments = match.group(1).lower(), match.group(2) is not None, match.group(3) or ""
        if name.startswith("assert") or name.startswith("mpiassert"):
            self.assertion(number, match.group(1), has_list, arguments)
            return
        if self.procedure is not None:
            raise Rejected(number, f"@{name} inside of a procedure")
        if name == "test":
            self.test(number, has_list, arguments)
        elif name in ("before", "after"):
            self.hook(number, name, has_list)
        elif name == "disable":
            if has_list or not self.pending or self.pending[0] != "test":
                raise Rejected(number, "@disable stands alone between @test and its subroutine")
            self.pending[1].disabled = True
        else:
            raise Rejected(number, f"unknown directive @{match.group(1)}")
        self.output.append(line.replace("@", "!@", 1))

    def need_use(self, number):
        if self.is_mpi is None:
            raise Rejected(number, "`use funit` or `use pfunit` must come before the first directive")

    def test(self, number, has_list, arguments):
        self.need_use(number)
        if self.pending:
            raise Rejected(number, "two directives for one subroutine")
        npes = None
        if has_list:
            match = re.match(r"\s*npes\s*=\s*\[([\d,\s]+)\]\s*$", arguments)
            if not match:
                raise Rejected(number, "the only known option of @test is npes=[…]")
            try:
                npes = [int(n) for n in match.group(1).split(",")]
            except ValueError:
                raise Rejected(number, "npes is a list of positive integers")
            if min(npes) < 1:
                raise Rejected(number, "npes is a list of positive integers")
        if self.is_mpi and npes is None:
            raise Rejected(number, "a test under `use pfunit` needs npes=[…]")
        if not self.is_mpi and npes is not None:
            raise Rejected(number, "npes needs `use pfunit`")
        self.pending = ("test", Test(number, npes))

    def hook(self, number, name, has_list):
        self.need_use(number)
        if has_list:
            raise Rejected(number, f"@{name} takes no arguments")
        if self.pending:
            raise Rejected(number, "two directives for one subroutine")
        if name in self.hooks:
            raise Rejected(number, f"a second @{name}")
        self.pending = (name, number)

    def assertion(self, number, name, has_list, arguments):
        is_collective = name.lower().startswith("mpi")
        variant = name[len("mpiassert"):] if is_collective else name[len("assert"):]
        key = variant.lower()
        if key not in ASSERTIONS:
            raise Rejected(number, f"unknown assertion @{name}")
        if not has_list:
            raise Rejected(number, f"@{name} needs a list of arguments")
        if self.procedure is None:
            raise Rejected(number, f"@{name} outside of a procedure")
        if is_collective and (not self.is_mpi or "this" not in self.procedure[1]):
            raise Rejected(number, f"@{name} needs `use pfunit` and the test's argument this")
        self.check_arguments(number, name, key, arguments)
        call = f"  call assert{variant}({arguments}{', ' if arguments.strip() else ''}&"
        if len(call) > LINE_LIMIT:
            raise Rejected(number, f"expands to {len(call)} columns, more than {LINE_LIMIT}")
        self.output += [f'#line {number} "{self.path}"', call,
                        " & location=SourceLocation( &", f" & '{os.path.basename(self.path)}', &", f" & {number}) )"]
        if not is_collective: # pFUnit 4.14 goes on behind @mpiAssert…, on all processes
            self.output.append("  if (anyExceptions()) return")
        self.output.append(f'#line {number + 1} "{self.path}"')

    def check_arguments(self, number, name, key, arguments):
        parts = split_arguments(arguments)
        if parts is None:
            raise Rejected(number, "unbalanced brackets or quotes")
        if any(part == "" for part in parts):
            raise Rejected(number, "an empty argument")
        allowed = set() if key in WITHOUT_MESSAGE else {"message"}
        if key in WITH_TOLERANCE:
            allowed.add("tolerance")
        positional, seen = 0, set()
        for part in parts:
            match = re.match(r"(\w+)\s*=(?!=)", part)
            if not match:
                if seen:
                    raise Rejected(number, "a positional argument after a named one")
                positional += 1
            elif match.group(1).lower() not in allowed or match.group(1).lower() in seen:
                raise Rejected(number, f"@{name} does not take {match.group(1)}= here")
            else:
                seen.add(match.group(1).lower())
        least, most = ASSERTIONS[key]
        if not least <= positional <= most:
            raise Rejected(
                number,
                f"@{name} takes {most} unnamed argument{'s' if most != 1 else ''}, not {positional}; "
                "name message= and tolerance=",
            )

    # --------------------------------------------------------------------------------------------------- suite
    def suite(self):
        """Appends the external subroutine <module>_suite that the driver calls."""
        names = [t.name for t in self.tests] + [name for _, name in self.hooks.values()]
        before, after = (self.hooks.get(k, (0, None))[1] for k in ("before", "after"))
        out = self.output
        out += ["", f"subroutine {self.module}_suite()"]
        out += [
            "  use funit_runner, only: test_begin, test_end, test_disabled",
            "  use funit_core, only: anyExceptions",
        ]
        if self.is_mpi:
            out += ["  use pfunit_runner, only: MpiTestMethod, mpi_test_begin, mpi_test_end"]
        # An alias for each, because a local name may not be the same as that of this subroutine.
        out += [f"  use {self.module}, only: p{i}_ => {name}" for i, name in enumerate(names)]
        out += ["  implicit none"]
        alias = {name: f"p{i}_" for i, name in enumerate(names)}
        if self.is_mpi:
            out += ["  type(MpiTestMethod) :: this_", "  logical :: takes_part"]
        for test in self.tests:
            label = f"'{self.module}_suite.{test.name}'"
            if test.disabled:
                out.append(f"  call test_disabled({label})")
                continue
            for npes in test.npes or [None]:
                argument = "(this_)" if self.is_mpi else "()"
                body = [f"call {alias[test.name]}{argument}"]
                if before:
                    body = [f"call {alias[before]}{argument}", "if (.not. anyExceptions()) then", *body, "end if"]
                if after:
                    body.append(f"call {alias[after]}{argument}")
                if self.is_mpi:
                    out.append(f"  call mpi_test_begin(this_, {label}, {npes}, takes_part)")
                    out += [
                        "  if (takes_part) then", *("    " + b for b in body), "  end if", "  call mpi_test_end(this_)",
                    ]
                else:
                    out += [f"  call test_begin({label})", *("  " + b for b in body), "  call test_end()"]
        out.append(f"end subroutine {self.module}_suite")


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    source, target = sys.argv[1:]
    try:
        text = Preprocessor(source).run()
    except Rejected as rejected:
        print(f"{source}:{rejected.line}: {rejected}", file=sys.stderr)
        return 1
    with open(target, "w", encoding="utf-8") as file:
        file.write(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
