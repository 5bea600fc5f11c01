#!/usr/bin/env python3
"""Wraps paragraphs and list items of Markdown pages that have a line of more than 120 letters; leaves all others as
they are.

    python3 scripts/dev/wrap.py README.md doc/*.md          # in place; prints the pages that it changed
    python3 scripts/dev/wrap.py --check README.md doc/*.md  # prints lines that are too long; exit code 1 if there are
    some

Tables and headings are left alone, and so are rows of tables when lines are counted: a row cannot be wrapped. In blocks
of code a comment that makes a line too long goes above it. Code within a line is not broken, for commands in it are
tested (tests/regression/documents.py).
"""
import argparse
import pathlib
import re
import sys

WIDTH = 120
ITEM = re.compile(r"^(\s*)((?:[*+-]|\d+\.)\s+)(.*)$")
FIXED = re.compile(r"^\s*(\||#|>|<|\[\w+\]: |```|!\[|:?-{3,})")
OPENS = re.compile(r"^[>|]|^([*+#=-]+|\d+[.)])$")  # what a line may not begin with, or it would mean something else
COMMENTED = re.compile(r"^( {4,})(\S.*?)\s+([#!]) (.*)$")
HOLD = "\0"


def words_of(text):
    """Words, code and the text that must stay with the word before it kept whole."""
    text = re.sub(r"(`+)(.+?)\1", lambda span: span.group(0).replace(" ", HOLD), text)
    words = []
    for word in text.split():
        if words and (word in ("…", "–", "—") or re.fullmatch(r"([*+#>=|-]+|\d+[.)])", word)):
            words[-1] += HOLD + word
        else:
            words.append(word)
    return words


def filled(text, first, later):
    """Lines of a paragraph: the first begins with `first`, the others with `later`."""
    lines, line = [], first
    begins = True
    for word in words_of(text):
        glue = "" if begins else " "
        if not begins and len(line) + 1 + len(word) > WIDTH and not OPENS.match(word):
            lines.append(line)
            line, glue = later, ""
        line += glue + word
        begins = False
    return [each.replace(HOLD, " ").rstrip() for each in [*lines, line]]


def blocks_of(lines):
    """Groups of lines: (kind, lines); kind is text, or other for what is not wrapped."""
    block, code, fence = [], False, False
    for number, line in enumerate(lines):
        blank_before = number == 0 or not lines[number - 1].strip()
        if line.lstrip().startswith("```"):
            fence = not fence
        if not line.strip():
            if block:
                yield "text", block
                block = []
            yield "other", [line]
            continue
        code = line.startswith("    ") and not ITEM.match(line) and (code or blank_before)
        if code or fence or FIXED.match(line):
            if block:
                yield "text", block
                block = []
            yield "other", [line]
            continue
        if ITEM.match(line) and block:
            yield "text", block
            block = []
        block.append(line)
    if block:
        yield "text", block


def comment_above(line):
    """A line of code whose comment makes it too long: the comment, and then the code."""
    found = COMMENTED.match(line)
    if len(line) <= WIDTH or not found:
        return [line]
    indent, code, sign, comment = found.groups()
    return filled(comment, f"{indent}{sign} ", f"{indent}{sign} ") + [indent + code]


def wrapped(text):
    """The page with no paragraph that has too long a line."""
    result = []
    for kind, lines in blocks_of(text.split("\n")):
        if kind == "other":
            result += [each for line in lines for each in comment_above(line)]
            continue
        if max(map(len, lines)) <= WIDTH:
            result += lines
            continue
        item = ITEM.match(lines[0])
        indent = re.match(r"\s*", lines[0]).group(0)
        first = item.group(1) + item.group(2) if item else indent
        later = " " * len(first)
        begin = item.group(3) if item else lines[0].strip()
        result += filled(" ".join([begin, *(line.strip() for line in lines[1:])]), first, later)
    return "\n".join(result)


def too_long(text):
    """Numbers of lines that are too long; rows of tables do not count, nor a line that is one word."""
    return [number for number, line in enumerate(text.split("\n"), 1)
            if len(line) > WIDTH and not line.lstrip().startswith("|") and len(line.split()) > 1]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pages", nargs="+", type=pathlib.Path)
    parser.add_argument("--check", action="store_true", help="change nothing")
    options = parser.parse_args()
    bad = 0
    for page in options.pages:
        text = page.read_text(encoding="utf-8")
        if options.check:
            for number in too_long(text):
                print(f"{page}:{number}: more than {WIDTH} letters")
                bad += 1
        elif wrapped(text) != text:
            page.write_text(wrapped(text), encoding="utf-8")
            print(page)
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
