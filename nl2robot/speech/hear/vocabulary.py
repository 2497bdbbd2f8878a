"""Words as they are spoken, and words that a speech model can never hear."""

from __future__ import annotations

import re
import string
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from nl2robot.speech.hear.recogniser import Recogniser

_NUMBER = re.compile(r"\d+(?:\.\d+)?")


def spell_numbers(text: str, language: str) -> str:
    """The text with its numerals as words: "ward 3b" -> "ward three b"."""
    if not _NUMBER.search(text):
        return text
    spelled = _NUMBER.sub(lambda number: f" {number_words(number[0], language)} ", text)
    return " ".join(spelled.split())


def number_words(number: str, language: str) -> str:
    """A numeral as spoken, one blank between words: "21" -> "twenty one"."""
    value = float(number) if "." in number else int(number)
    return str(_spelling(language).format_number(value).text).replace("-", " ").lower()


@cache
def _spelling(language: str) -> Any:
    from unicode_rbnf import RbnfEngine

    return RbnfEngine.for_language(language)


@dataclass(frozen=True)
class Missing:
    """A word of the world that the speech model can never hear."""

    word: str
    alike: str | None  # known words that sound much the same, where there are some

    @property
    def message(self) -> str:
        such = f", such as “{self.alike}”" if self.alike else ""
        return (
            f"The speech model does not know the word “{self.word}” and will never hear it. "
            f"In the world file, give what it names an alias that sounds alike{such}."
        )


def missing_words(recogniser: Recogniser, phrases: Iterable[str]) -> list[Missing]:
    """The words of these names that cannot be heard, sorted, each with a way round."""
    return [
        Missing(word, _alike(recogniser, word.lower().replace("-", "")))
        for word in recogniser.unknown_words(phrases)
    ]


def _alike(recogniser: Recogniser, word: str) -> str | None:
    """Two known words that make up this one, or one that differs by a letter."""
    if not word.isalpha():
        return None
    for cut in range(len(word) - 3, 2, -1):
        if recogniser.knows(word[:cut]) and recogniser.knows(word[cut:]):
            return f"{word[:cut]} {word[cut:]}"
    # In a short word one letter makes another word altogether.
    variants = _one_letter_away(word) if len(word) >= 6 else ()
    return next(filter(recogniser.knows, variants), None)


def _one_letter_away(word: str) -> Iterator[str]:
    """ "orthopaedics" -> "orthopedics", "organise" -> "organize", and many that are no words."""
    places = range(1, len(word))  # the first letter is always heard
    for i in places:
        yield word[:i] + word[i + 1 :]
    for i in places:
        for letter in string.ascii_lowercase:
            yield word[:i] + letter + word[i + 1 :]
