"""The text of a deck as cards that can be changed: a copy with other cells, another step, another place of the grid.

A copy is a deck of its own: values of --set stand in it, files are named by whole paths, included files that define no
units are in it.
"""

import math
import re
from pathlib import Path

from .files import SgmpFileError, existing

TOKEN = re.compile(r'(?:"[^"]*"|[^\s"!#])+')
NAME = re.compile(r"[A-Za-z_]\w*")
FUNCTIONS = {
    name: getattr(math, name)
    for name in (
        "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "exp", "log", "log10", "sqrt",
    )
}
FUNCTIONS.update(pi=math.pi, abs=abs, min=min, max=max)
MOST = 110                                              # letters of a line of a copy


def statements(text):
    """Cards as lists of words; comments gone, continued lines joined."""
    words = []
    for line in text.splitlines():
        found = TOKEN.findall(re.sub(r'^((?:"[^"]*"|[^"!#])*)[!#].*', r"\1", line))
        continued = bool(found) and found[-1] == "&"
        words += found[:-1] if continued else found
        if words and not continued:
            yield words
            words = []
    if words:
        yield words


def bare(text):
    """A value without its quotes."""
    return text[1:-1] if len(text) > 1 and text[0] == text[-1] == '"' else text


class Card:
    """A card: its keyword, the words behind it, keys with values."""

    def __init__(self, words):
        self.keyword, self.words = words[0].lower(), list(words[1:])

    def place(self, key):
        """Number of the word that gives a key; None where none does."""
        return next((k for k, word in enumerate(self.words) if word.lower().startswith(f"{key}=")), None)

    def get(self, key):
        """Value of a key as written, without quotes; None where it is not given."""
        place = self.place(key)
        return None if place is None else bare(self.words[place].partition("=")[2])

    def set(self, key, value):
        """Gives a key a value, as the last word if it had none."""
        word = f'{key}="{value}"' if re.search(r"[\s!#]", str(value)) else f"{key}={value}"
        if self.place(key) is None:
            self.words.append(word)
        else:
            self.words[self.place(key)] = word

    def drop(self, *keys):
        """Takes keys away."""
        self.words = [word for word in self.words if word.partition("=")[0].lower() not in keys]

    def text(self):
        """The card, on as many lines as it needs."""
        lines = [self.keyword]
        for word in self.words:
            if len(lines[-1]) + len(word) > MOST and lines[-1].strip():
                lines[-1] += " &"
                lines.append(" ")
            lines[-1] += f" {word}"
        return "\n".join(lines)


class Deck:
    """The cards of a deck, and its parameters with the values of --set."""

    def __init__(self, path, settings=()):
        self.path = existing(path)
        if self.path.suffix == ".mpm":
            raise SgmpFileError(f"{path}: a deck of MPM3D; make one of sgmp first: sgmp import {path}")
        self.cards = list(self.read(self.path))
        self.parameters = {}
        for card in self.all("parameter"):
            name, _, value = "".join(card.words).partition("=")
            self.parameters[name] = value
            card.words = [name]
        for setting in settings:
            name, _, value = setting.partition("=")
            if name not in self.parameters:
                raise ValueError(
                    f"--set {setting}: the deck has no parameter '{name}'; there are: {', '.join(self.parameters)}"
                )
            self.parameters[name] = value

    def read(self, path):
        """Cards of a file; included files that stand beside it and define no units are read in their place."""
        for words in statements(path.read_text(errors="replace")):
            card = Card(words)
            beside = path.parent / bare(card.words[0]) if card.keyword == "include" and card.words else None
            if beside is not None and beside.is_file():
                if not any(inner[0].lower() == "units" for inner in statements(beside.read_text(errors="replace"))):
                    yield from self.read(beside)
                    continue
                card.words[0] = f'"{beside.resolve()}"'
            file = card.get("file")
            if file and (path.parent / file).is_file():
                card.words[card.place("file")] = f'file="{(path.parent / file).resolve()}"'
            yield card

    def all(self, keyword):
        """Cards of a keyword."""
        return [card for card in self.cards if card.keyword == keyword]

    def one(self, keyword):
        """The card of a keyword, made if there is none."""
        found = self.all(keyword)
        if not found:
            self.cards.append(Card([keyword]))
        return found[0] if found else self.cards[-1]

    def text(self):
        """The deck."""
        lines = [
            f"parameter {card.words[0]} = {self.parameters[card.words[0]]}"
            if card.keyword == "parameter"
            else card.text()
            for card in self.cards
        ]
        return "\n".join(lines) + "\n"

    # ------------------------------------------------------------ values

    def word(self, text):
        """A text with the parameters that it names by $ put in."""
        return re.sub(r"\$(\w+)", lambda found: bare(self.parameters.get(found[1], found[0])), bare(text))

    def number(self, text):
        """Value of a formula of parameters; None where it is none, as one of x or t."""
        return evaluate(self.word(text), self.parameters, 0)

    def root(self, text, fixed=()):
        """The parameter to change in order to change a value: the last of those that only pass it on. None: change the
        value itself."""
        name = bare(text).lstrip("$")
        if name not in self.parameters or name in fixed:
            return None
        return self.root(self.parameters[name], fixed) or name

    def scale(self, card, key, factor, fixed=(), done=None):
        """Multiplies the value of a key, by its parameter if it is one (once: `done` collects their names)."""
        root = self.root(card.get(key), fixed)
        if root is None:
            card.set(key, f'"({card.get(key)})*{factor!r}"')
        elif done is None or root not in done:
            self.parameters[root] = f'"({bare(self.parameters[root])})*{factor!r}"'
        if root is not None and done is not None:
            done.add(root)


def evaluate(text, parameters, depth):
    """Value of a formula of parameters and numbers, None for any other."""
    if depth > 50 or not re.fullmatch(r"[\w.+\-*/^(), ]+", text):
        return None
    values = dict(FUNCTIONS)
    for name in set(NAME.findall(re.sub(r"(?<![A-Za-z_])[\d.]+[eEdD][+-]?\d+", "0", text))):
        if name in parameters:
            values[name] = evaluate(re.sub(r"\$(\w+)", r"(\1)", bare(parameters[name])), parameters, depth + 1)
        if values.get(name) is None:
            return None
    try:  # only numbers, operators, the names above
        return float(
            eval(re.sub(r"(?<=[\d.])[dD](?=[+-]?\d)", "e", text).replace("^", "**"), {"__builtins__": {}}, values)
        )  # noqa: S307
    except (ArithmeticError, SyntaxError, TypeError, ValueError):
        return None

