"""One line of the dialect, read letter by letter, as far as it is written.

A reader stands at a place of the line. Where the line ends too early it raises `Unfinished`, with
what could come next if that is one of a few; where no program goes on like this it raises `Dead`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Final

LONGEST_TEXT: Final = 300
"""Characters that are said or shown at once."""
LONGEST_NAME: Final = 16
"""Of what a program remembers: a model that has lost its way would go on and on."""
_WORD: Final = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


class Dead(Exception):
    """No program goes on like this."""


class Unfinished(Exception):
    """The line ends too early; `completions` are all that could follow, if they are few."""

    def __init__(self, completions: Iterable[str] = ()) -> None:
        super().__init__()
        self.completions = tuple(completions)


def is_plain(letter: str) -> bool:
    """Whether a letter may stand in a text as it is."""
    return letter != "\\" and (letter.isprintable() or letter in "\u00a0\u202f")


class Letters:
    """Reads a line from a place on."""

    def __init__(self, line: str, at: int) -> None:
        self.line = line
        self.at = at
        self.quote = '"'

    @property
    def rest(self) -> str:
        return self.line[self.at :]

    def choose(self, options: Sequence[str]) -> str:
        """One of these texts."""
        rest = self.rest
        found = max((each for each in options if rest.startswith(each)), key=len, default=None)
        if found is not None:
            self.at += len(found)
            return found
        begun = [each[len(rest) :] for each in options if each.startswith(rest)]
        if begun:
            raise Unfinished(begun)
        raise Dead

    def expect(self, text: str) -> None:
        self.choose((text,))

    def maybe(self, *options: str) -> str:
        """One of these texts if it stands here, else ""; they may also follow what does not."""
        rest = self.rest
        if any(each.startswith(rest) for each in options):
            if rest in options:
                self.at += len(rest)
                return rest
            raise Unfinished
        found = next((each for each in options if rest.startswith(each)), "")
        self.at += len(found)
        return found

    def next(self) -> str:
        """The letter that stands here."""
        if self.at >= len(self.line):
            raise Unfinished
        return self.line[self.at]

    def word(self, known: Iterable[str] | None = None) -> str:
        """A name; one of those that are `known`, if that is said."""
        self.next()
        match = _WORD.match(self.line, self.at)
        if match is None:
            raise Dead
        word = match.group()
        if len(word) > LONGEST_NAME:
            raise Dead
        if match.end() == len(self.line):
            if known is None:
                raise Unfinished
            begun = [each[len(word) :] for each in known if each.startswith(word)]
            if not begun:
                raise Dead
            raise Unfinished(begun if all(begun) else ())
        if known is not None and word not in known:
            raise Dead
        self.at = match.end()
        return word

    def text(self, longest: int = LONGEST_TEXT) -> str:
        """Words in quotation marks."""
        self.expect(self.quote)
        start = self.at
        while (letter := self.next()) != self.quote:
            if letter in '"{}' or not is_plain(letter) or self.at - start >= longest:
                raise Dead
            self.at += 1
        self.at += 1
        return self.line[start : self.at - 1]

    def quoted_words(self, sentence: str) -> None:
        """Some words of a sentence, in quotation marks."""
        self.expect(self.quote)
        rest, _, behind = self.rest.partition(self.quote)
        said = re.escape(rest)
        ends = len(rest) < len(self.rest)
        if rest[:1] == " " or not re.search(rf"\b{said}" + r"\b" * ends, sentence):
            raise Dead
        if not ends:
            raise Unfinished
        self.at = len(self.line) - len(behind)

    def literal(self, known: Sequence[str]) -> str:
        """One of these in quotation marks, of those that can stand in them."""
        quotes = {'"', self.quote}
        plain = [each for each in known if all(map(is_plain, each)) and not quotes & {*each}]
        chosen = self.choose([f"{self.quote}{each}{self.quote}" for each in plain])
        return chosen[1:-1]

    def starts(self, text: str) -> bool:
        """Whether this stands here; as long as it may, what is said is unfinished."""
        rest = self.rest
        if len(rest) < len(text) and text.startswith(rest):
            raise Unfinished
        return rest.startswith(text)
