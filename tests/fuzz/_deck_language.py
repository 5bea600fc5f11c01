"""The language of decks as its reference tells it, read without the program's own reader: cards and keys from
`sgmp help --markdown`, statements by the rules at its head."""
import re
import subprocess

NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$")


class Key:
    """A row of the reference."""

    def __init__(self, name, slot, kind, default, range_, applies):
        self.name, self.slot, self.kind, self.default, self.applies = name, slot, kind, default, applies
        self.range = range_

    def allows(self, number):
        """Whether a number lies in the key's range."""
        if not self.range:
            return True
        low, high = self.range[1:-1].split(",")
        low, high = float(low), float(high)
        return (number > low or self.range[0] == "[" and number >= low) and (
            number < high or self.range[-1] == "]" and number <= high
        )


def reference(sgmp):
    """Cards by name, each a list of keys."""
    text = subprocess.run([sgmp, "help", "--markdown"], stdout=subprocess.PIPE, check=True).stdout.decode()
    cards, card = {}, None
    for line in text.splitlines():
        if line.startswith("## "):
            card = cards.setdefault(line[3:].strip(), [])
        cells = [cell.strip() for cell in line.strip().strip("|").split(" | ")] if line.startswith("| `") else []
        if card is not None and cells:
            cells = [cell.strip(" |") for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
            name, kind, _, default, range_, applies = cells[:6]
            found = re.match(r"`([^`]+)`(?: \(word (\d+)\))?", name)
            card.append(
                Key(found.group(1), int(found.group(2) or 0), kind, default, range_.strip("`"), applies.split())
            )
    return cards


def tokens(line):
    """Words, quoted texts and equals signs of a line up to a comment: (kind, text), and whether it goes on in the
    next."""
    found, place, goes_on = [], 0, False
    while place < len(line):
        letter = line[place]
        if letter in " \t":
            place += 1
        elif letter in "!#":
            break
        elif letter == "&":
            goes_on, place = True, place + 1
        elif letter in "\"'":
            end = line.find(letter, place + 1)
            end = len(line) if end < 0 else end
            found.append(("quoted", line[place + 1:end]))
            place = end + 1
        elif letter == "=":
            found.append(("equals", "="))
            place += 1
        else:
            depth, first = 0, place
            while place < len(line):
                letter = line[place]
                depth += (letter == "(") - (letter == ")")
                if letter in "\"'#!" or depth <= 0 and letter in " \t=&":
                    break
                place += 1
            found.append(("word", line[first:place]))
    return found, goes_on


def statements(text):
    """The statements of a deck."""
    current, pending = [], False
    for line in text.split("\n"):
        found, goes_on = tokens(line.rstrip("\r"))
        current += found
        pending = goes_on or (pending and not found)
        if not pending:
            if current:
                yield current
            current = []
    if current:
        yield current


def objections(text, cards):
    """What an accepted deck must not have: cards and keys that do not exist or do not apply, plain numbers out of
    range."""
    for words in statements(text):
        name = words[0][1].lower()
        if name in ("parameter", "include"):
            continue
        if name not in cards:
            yield f"there is no card {name!r}"
            continue
        keys = {key.name: key for key in cards[name]}
        given, place, slot = {}, 1, 0
        while place < len(words):
            if place + 2 < len(words) and words[place + 1][0] == "equals":
                key, value = words[place][1].lower(), words[place + 2][1]
                if key not in keys:
                    yield f"card {name} has no key {key!r}"
                given[key] = value
                place += 3
            else:
                slot += 1
                key = next((k for k in cards[name] if k.slot == slot), None)
                if key is not None:
                    given[key.name] = words[place][1]
                place += 1
        yield from about_values(name, keys, given)


def about_values(name, keys, given):
    """Keys that mean nothing beside the others, numbers out of range."""
    chosen = {value.lower() for value in given.values()}
    for key, value in given.items():
        if key not in keys:
            continue
        if keys[key].applies and not any("$" in v for v in given.values()) and not chosen & set(keys[key].applies):
            yield f"key {key!r} of card {name} is not for {sorted(chosen)}"
        if keys[key].kind in ("number", "whole number") and NUMBER.match(value) and not keys[key].allows(float(value)):
            yield f"{key}={value} of card {name} is out of range {keys[key].range}"
