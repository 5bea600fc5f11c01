"""Small faults of Fortran sources: where they can be, and a copy of a source that has them all, each behind a switch.

Faults are put into executable statements: assignments, calls, conditions, bounds of loops. Declarations, tables of
`case`, `where`, input and output of Fortran stay as they are, and so do texts.
"""
import collections
import dataclasses
import re

TOKEN = re.compile(
    r"""'[^']*'|"[^"]*"|\.[a-zA-Z]+\.|(?:\d+\.\d*|\.\d+)(?:[eEdD][+-]?\d+)?(?:_\w+)?|\d+[eEdD][+-]?\d+(?:_\w+)?
                       |\d+(?:_\w+)?|[A-Za-z]\w*|\*\*|//|/=|==|<=|>=|=>|\s+|.""",
    re.VERBOSE,
)
BOUND = {"<": "<=", "<=": "<", ">": ">=", ">=": ">"}           # of whole numbers
DIRECTION = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}       # of others, for which a bound's own value seldom matters
OTHER_OPERATOR = {"+": "-", "-": "+", "*": "/", "/": "*", "==": "/=", "/=": "==",
                  ".and.": ".or.", ".or.": ".and.", ".true.": ".false.", ".false.": ".true.", ".not.": "",
                  ".eqv.": ".neqv.", ".neqv.": ".eqv."}
OTHER_FUNCTION = {"min": "max", "max": "min", "minval": "maxval", "maxval": "minval", "any": "all", "all": "any",
                  "floor": "ceiling", "sin": "cos", "cos": "sin"}
NO_ASSIGNMENT = re.compile(
    r"""(use|implicit|private|public|type|class|end|contains|interface|module|submodule|procedure|function
    |subroutine|pure|elemental|impure|recursive|integer|real|logical|character|complex|select|case|where
    |elsewhere|forall|allocate|deallocate|write|read|print|open|close|inquire|rewind|flush|format|data|include
    |associate|block|else|nullify|stop|error|import|generic|final|enum|enumerator|abstract|program|critical
    |continue)\b
    (?!\s*(\(.*?\))?\s*(%[\w%() ,:]*)?=(?![=>]))""",
    re.VERBOSE | re.IGNORECASE,
)
MODULE = re.compile(r"^\s*module\s+(?!procedure\b|subroutine\b|function\b)(?:DIM\(\s*\w+\s*\)|\w+)\s*$", re.IGNORECASE)
CALL = re.compile(r"call\s+[\w%]+\s*(\(|$)", re.IGNORECASE)
LOOP = re.compile(r"((?:\w+\s*:\s*)?do\s+)(\w+\s*=\s*)(.*)$", re.IGNORECASE)
LEAVE = re.compile(r"(return|cycle|exit)\b", re.IGNORECASE)


@dataclasses.dataclass
class Statement:
    """A statement in one line, and the lines that it came from."""
    first: int
    last: int
    text: str


@dataclasses.dataclass
class Mutant:
    """One fault: where it is, and what stands there instead."""
    file: str
    line: int
    part: str       # 'statement', 'condition' or 'loop'
    was: str        # that part
    now: str
    what: str       # the change in a few words
    number: int = 0

    @property
    def folder(self):
        """The area that it belongs to."""
        parts = self.file.split("/")
        return parts[1] if len(parts) > 2 else ""


# ------------------------------------------------------------------------------------------------ reading sources
def code_of(line):
    """The line without its comment."""
    quote = None
    for position, char in enumerate(line):
        if quote:
            quote = None if char == quote else quote
        elif char in "'\"":
            quote = char
        elif char == "!":
            return line[:position].rstrip()
    return line.rstrip()


def statements(lines):
    """All statements with code, joined where they go on over several lines."""
    first, text = None, ""
    for number, line in enumerate(lines):
        code = code_of(line).strip()
        if not code or code.startswith("#"):
            continue
        if first is None:
            first = number
        goes_on = code.endswith("&")
        text += code.rstrip("&").lstrip("&") if goes_on or text else code
        if not goes_on:
            yield Statement(first, number, text.strip())
            first, text = None, ""


def closing(text, start):
    """Position of the bracket that closes the one at `start`."""
    depth, quote = 0, None
    for position in range(start, len(text)):
        char = text[position]
        if quote:
            quote = None if char == quote else quote
        elif char in "'\"":
            quote = char
        elif char in "([":
            depth += 1
        elif char in ")]":
            depth -= 1
            if depth == 0:
                return position
    return -1


def split_condition(text):
    """(head, condition, tail) of if, else if and do while; None for other statements."""
    match = re.match(r"((?:\w+\s*:\s*)?(?:else\s*if|if|do\s+while)\s*)\(", text, re.IGNORECASE)
    if not match:
        return None
    end = closing(text, match.end() - 1)
    return text[:match.end()], text[match.end():end], text[end:]


def is_assignment(text):
    """Whether a statement sets a variable (no pointer, no declaration)."""
    if "::" in text or NO_ASSIGNMENT.match(text):
        return False
    depth = 0
    for token in TOKEN.findall(text):
        depth += (token in "([") - (token in ")]")
        if depth == 0 and token in ("=", "=>"):
            return token == "="
    return False


# ------------------------------------------------------------------------------------------------ what can be wrong
def other_number(token):
    """A number a little off."""
    value, _, kind = token.partition("_")
    if re.fullmatch(r"\d+", value):
        return str(int(value) + 1) + (f"_{kind}" if kind else "")
    suffix = f"_{kind}" if kind else ""
    if float(value.lower().replace("d", "e")) == 0.0:
        return f"1.0{suffix}"
    return f"(1.5{suffix}*{token})"


def real_names(source):
    """Names that a source declares as real numbers."""
    names = set()
    for match in re.finditer(r"^\s*real\(\w+\).*?::(.*)$", source, re.MULTILINE | re.IGNORECASE):
        names |= set(re.findall(r"[A-Za-z]\w*", re.sub(r"\(.*?\)|=.*", "", code_of(match.group(1)))))
    return {name.lower() for name in names}


def is_real(tokens, place, reals):
    """Whether the comparison at `place` is one of real numbers, as far as the terms beside it tell."""
    def names(parts):
        for part in parts:
            if part.lower() in (".and.", ".or.", ".not."):
                return
            yield part.lower()
    beside = [*names(tokens[place + 1:]), *names(reversed(tokens[:place]))]
    return any(token in reals or re.match(r"\d+\.\d*", token) for token in beside)


def in_ranges(tokens):
    """Places of tokens in subscripts that hold a colon of their own, as sections of arrays do."""
    open_subscripts, inside, colons = [], collections.defaultdict(list), set()
    for place, token in enumerate(tokens):
        if token in (")", "]") and open_subscripts:
            open_subscripts.pop()
        if token == "," and open_subscripts:
            open_subscripts[-1] = place
        if open_subscripts:
            inside[open_subscripts[-1]].append(place)
            if token == ":":
                colons.add(open_subscripts[-1])
        if token in ("(", "["):
            open_subscripts.append(place)
    return {place for subscript in colons for place in inside[subscript]}


def changes(text, reals, inside_only=False, ranges=True):
    """(new text, what) for all tokens; inside_only: nothing outside of brackets; ranges: bounds of sections, too."""
    tokens = TOKEN.findall(text)
    depth = 0
    kept = set() if ranges else in_ranges(tokens)
    for place, token in enumerate(tokens):
        depth += (token in "([") - (token in ")]")
        if inside_only and depth == 0 or place in kept:
            continue
        low = token.lower()
        new = None
        if low in OTHER_OPERATOR:
            if token == "*" and "".join(tokens[:place]).rstrip()[-1:] in ("(", ","):
                continue
            new = OTHER_OPERATOR[low]
        elif low in BOUND:
            new = (DIRECTION if is_real(tokens, place, reals) else BOUND)[low]
        elif re.match(r"\.?\d", token):
            if "".join(tokens[:place]).endswith(("huge(", "tiny(", "epsilon(")):  # its kind alone matters
                continue
            new = other_number(token)
        elif (
            low in OTHER_FUNCTION
            and "".join(tokens[place + 1 :]).lstrip().startswith("(")
            and tokens[place - 1 : place] != ["%"]
        ):
            new = OTHER_FUNCTION[low]
        if new is not None:
            yield "".join([*tokens[:place], new, *tokens[place + 1:]]), f"{token} -> {new or 'nothing'}"
    yield from swaps(text)


def swaps(text):
    """Neighbouring arguments or subscripts, both plain names, in the other order; not in texts."""
    for match in re.finditer(r"(?<=[(,])(\s*)([A-Za-z][\w%]*)(\s*,\s*)([A-Za-z][\w%]*)(?=\s*[,)])", text):
        quotes = text[:match.start()]
        if quotes.count("'") % 2 or quotes.count('"') % 2:
            continue
        if match.group(2).lower() != match.group(4).lower():
            new = match.group(1) + match.group(4) + match.group(3) + match.group(2)
            yield text[:match.start()] + new + text[match.end():], f"{match.group(2)}, {match.group(4)} swapped"


def mutants_of_statement(file, statement, reals):
    """All faults that a statement can have."""
    line, text = statement.first + 1, statement.text
    condition = split_condition(text)
    if condition:
        _, was, tail = condition
        for now, what in changes(was, reals):
            yield Mutant(file, line, "condition", was, now, what)
        inner = tail[1:].strip()
        if LEAVE.match(inner):
            yield Mutant(file, line, "condition", was, ".false.", f"no {inner}")
        elif inner and inner.lower() != "then":
            yield from plain_mutants(file, line, inner, reals)
        return
    loop = LOOP.match(text)
    if loop:
        for now, what in changes(loop.group(3), reals):
            yield Mutant(file, line, "loop", loop.group(3), now, what)
        return
    yield from plain_mutants(file, line, text, reals)


def plain_mutants(file, line, text, reals):
    """Faults of an assignment or a call."""
    if CALL.match(text):
        for now, what in changes(text, reals, inside_only=True):
            yield Mutant(file, line, "statement", text, now, what)
        yield Mutant(file, line, "statement", text, "continue", "not called")
    elif is_assignment(text):
        equals = next(m.start() for m in re.finditer(r"=(?![=>])", text) if brackets_closed(text[:m.start()]))
        left, right = text[:equals + 1], text[equals + 1:]
        # Sections that do not fit each other are no Fortran; what a compiler makes of them is its own affair.
        scalar = ":" not in left
        for now, what in changes(left, reals, inside_only=True, ranges=scalar):
            yield Mutant(file, line, "statement", text, now + right, what)
        for now, what in changes(right, reals, ranges=scalar):
            yield Mutant(file, line, "statement", text, left + now, what)


def brackets_closed(text):
    """Whether every bracket that is opened is closed."""
    tokens = TOKEN.findall(text)
    return sum((token in "([") - (token in ")]") for token in tokens) == 0


def candidates(file, source):
    """All faults of a source."""
    in_where = False
    reals = real_names(source)
    for statement in statements(source.split("\n")):
        low = statement.text.lower()
        if re.match(r"where\s*\(", low) and closing(low, low.index("(")) == len(low) - 1:
            in_where = True
        elif re.match(r"end\s*where\b", low):
            in_where = False
        elif not in_where and ";" not in low:
            yield from mutants_of_statement(file, statement, reals)


def by_hand(file, source, was, now, what):
    """The fault that a text in one statement makes, written by hand."""
    found = [s for s in statements(source.split("\n")) if was in s.text]
    if len(found) != 1:
        raise ValueError(f"{file}: {len(found)} statements with: {was}")
    line, text = found[0].first + 1, found[0].text
    part, condition, loop = "statement", split_condition(text), LOOP.match(text)
    if condition and was in condition[1]:
        part, text = "condition", condition[1]
    elif condition:
        text = condition[2][1:].strip()
    elif loop:
        # The bounds alone; the name of the counter stays.
        part, text = "loop", loop.group(3)
        was, now = (side.removeprefix(loop.group(2)) for side in (was, now))
    return Mutant(file, line, part, text, text.replace(was, now, 1), what)


# ------------------------------------------------------------------------------------------------ all in one source
def choice(mutants, was):
    """Text of a plain statement that is one of several."""
    if not mutants:
        return was
    lines = []
    for mutant in mutants:
        lines += [f"{'else ' if lines else ''}if (mutant_on({mutant.number})) then", mutant.now]
    return "\n".join([*lines, "else", was, "end if"])


def either(mutants, was, impure):
    """Text of a condition that is one of several. Where that does no harm the faulty one is worked out as well, to see
    whether it makes a difference."""
    both = [m for m in mutants if comparable(m, impure)]
    for mutant in both:
        was = f"mutant_either({mutant.number}, {mutant.now}, {was})"
    mutants = [m for m in mutants if m not in both]
    terms = [f"(mutant_on({mutant.number}) .and. ({mutant.now}))" for mutant in mutants]
    none = " .or. ".join(f"mutant_on({mutant.number})" for mutant in mutants)
    return " .or. ".join([*terms, f"(.not. ({none}) .and. ({was}))"]) if mutants else was


def comparable(mutant, impure):
    """Whether a faulty condition can be worked out beside the right one: no side effects, no array beyond its
    bounds."""
    if mutant.now == ".false.":
        return True
    if any(name.lower() in impure for name in re.findall(r"(\w+)\s*\(", mutant.was)):
        return False
    changed = mutant.what.split(" -> ")[0]
    return changed in (*BOUND, "==", "/=", ".not.") or changed[0].isdigit() and "(" not in mutant.was


def impure_functions(sources):
    """Names of functions that may have side effects, and of the bindings to them."""
    names, bindings = set(), {}
    for source in sources:
        for line in source.lower().split("\n"):
            code = code_of(line)
            found = re.match(r"\s*((?:[\w(),= ]+\s)?)function\s+(\w+)", code)
            if found and not re.search(r"\b(pure|elemental|end)\b", found.group(1)):
                names.add(found.group(2))
            for new, old in re.findall(r"(\w+)\s*=>\s*(\w+)", code):
                bindings.setdefault(old, set()).add(new)
    return names | {new for old in names for new in bindings.get(old, ())}


def bounds(mutants, was):
    """Text of a loop's bounds that are one of several."""
    parts = split_arguments(was)
    for mutant in mutants:
        other = split_arguments(mutant.now)
        parts = [part if new == old else f"merge({new}, {part}, mutant_on({mutant.number}))"
                 for part, old, new in zip(parts, split_arguments(was), other)]
    return ", ".join(parts)


def split_arguments(text):
    """The parts between commas outside of brackets."""
    parts, depth = [""], 0
    for token in TOKEN.findall(text):
        depth += (token in "([") - (token in ")]")
        if token == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += token
    return [part.strip() for part in parts]


def rewritten(statement, mutants, impure):
    """A statement with its mutants behind switches."""
    text = statement.text
    condition = split_condition(text)
    if condition:
        head, was, tail = condition
        faults = [m for m in mutants if m.part == "condition"]
        inner = [m for m in mutants if m.part == "statement"]
        action = tail[1:].strip()
        if re.match(r"then\b", action, re.IGNORECASE) or not re.match(r"if\b", text, re.IGNORECASE):
            return head + either(faults, was, impure) + tail
        if not faults:
            return f"{head}{was}) then\n{choice(inner, action)}\nend if"
        # A compiler may work out both sides of .and.: a faulty condition that must not be gets an if of its own.
        alone = [m for m in faults if not comparable(m, impure)]
        both = either([m for m in faults if m not in alone], was, impure)
        branches = [
            f"if (mutant_on({m.number})) then\nif ({m.now}) then\n{choice(inner, action)}\nend if\nelse " for m in alone
        ]
        end = "\nend if" if alone else ""
        return "".join([*branches, "\n" if alone else "", f"if ({both}) then\n{choice(inner, action)}\nend if{end}"])
    loop = LOOP.match(text)
    if loop:
        return loop.group(1) + loop.group(2) + bounds(mutants, loop.group(3))
    return choice(mutants, text)


def with_switches(source, mutants, impure):
    """(text of the source with its mutants, line of it -> mutants there)"""
    by_line = {}
    for mutant in mutants:
        by_line.setdefault(mutant.line, []).append(mutant)
    lines = source.split("\n")
    replaced = {
        s.first: (s.last, rewritten(s, by_line[s.first + 1], impure))
        for s in statements(lines)
        if s.first + 1 in by_line
    }
    out, owners, number = [], {}, 0
    while number < len(lines):
        if number in replaced:
            last, text = replaced[number]
            for piece in text.split("\n"):
                out.append(piece)
                owners[len(out)] = by_line[number + 1]
            number = last + 1
            continue
        out.append(lines[number])
        if MODULE.match(code_of(lines[number])):
            out.append("use sgmp_mutant, only: mutant_either, mutant_on")
        number += 1
    return "\n".join(out), owners
