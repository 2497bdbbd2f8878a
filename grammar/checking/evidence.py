"""Which words of a language speak for which deeds, as far as that was counted.

The counts are data (`counted/<language>.msgpack`), made by
`nl2robot.training.planner.evidence`. For a robot method that is newer than they are, the words of
its rules speak.
"""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Final

import msgspec

from grammar.language import Language
from grammar.tokens import without_accents
from robot_api.methods import METHODS

FOLDER: Final = Path(__file__).parent / "counted"
LETTERS: Final = 6
"""Of a word by which its forms count as one."""
CERTAIN: Final = 0.95
OFTEN: Final = 10.0
"""A word that was said so often, and nearly always with the same deed, asks for it."""
LICENCE: Final = 0.3
"""How often a word at least stands with a deed that it asks for by itself."""
KNOWN: Final = 6.0
"""A word that was said less often may speak for anything."""
CHANCE: Final = 2.0
"""Sentences in which a word might have been said without its deed."""
LIKELIER: Final = 1.5
"""By how much a deed is likelier with a word that speaks for it than without."""


class Evidence(msgspec.Struct, frozen=True):
    total: float
    """Sentences, by their weight; so all counts."""
    done: dict[str, float]
    """How often each deed was done."""
    said: dict[str, float]
    """How often each word was said."""
    together: dict[str, dict[str, float]]
    """How often each deed was done where a word was said."""
    reported: list[str]
    """Words in which the robot reports."""
    ruled: dict[str, frozenset[str]] = {}
    """For each robot method of which nothing was counted, the words of its rules."""

    def share(self, word: str, deed: str) -> float:
        """How often, of the times that a word was said, something was done; less for a word that
        was seldom said, which may be chance."""
        word = stem(word)
        return self.together.get(word, {}).get(deed, 0.0) / (self.said.get(word, 0.0) + CHANCE)

    def speaks_for(self, word: str, deed: str) -> bool:
        if deed in self.ruled:
            return stem(word) in self.ruled[deed]
        usual = self.done.get(deed, 0.0) / self.total
        return self.share(word, deed) > max(0.15, min(0.9, LIKELIER * usual))

    def licenses(self, word: str, deed: str) -> bool:
        """Whether a word is enough for a deed that nobody wants unasked."""
        if deed in self.ruled:
            return self.speaks_for(word, deed)
        usual = self.done.get(deed, 0.0) / self.total
        return self.share(word, deed) > max(LICENCE, min(0.8, 3 * usual))

    def knows(self, word: str) -> bool:
        """Whether enough was said with a word to tell what it speaks for."""
        return self.said.get(stem(word), 0.0) >= KNOWN

    def asked_for(self, word: str) -> list[str]:
        """The deeds that a word asks for wherever it stands."""
        word = stem(word)
        if self.said.get(word, 0.0) < OFTEN:
            return []
        return [deed for deed in self.together[word] if self.share(word, deed) >= CERTAIN]


def stem(word: str) -> str:
    return without_accents(word.lower())[:LETTERS]


@functools.cache
def evidence_of(language: Language) -> Evidence:
    """What was counted in a language; nothing, where nobody has counted yet."""
    path = FOLDER / f"{language.code}.msgpack"
    counted = Evidence(1.0, {}, {}, {}, [])
    if path.exists():
        counted = msgspec.msgpack.decode(path.read_bytes(), type=Evidence)
    newer = METHODS.keys() - counted.done.keys()
    ruled = {method: frozenset(map(stem, language.words_for(method))) for method in newer}
    return msgspec.structs.replace(counted, ruled=ruled)
