"""What people say out of courtesy: "hello, how are you?" is answered, and nothing is done.

Whatever is an order stays one: a sentence counts only where all of it is courtesy. Slips of the
keyboard are allowed where nothing else was understood.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any, Final

from grammar.language import load_language
from grammar.lexicon import Lexicon
from grammar.tokens import tokenise
from nl2robot.texts import texts_in

ALIKE: Final = 0.79
"""How alike a sentence must be to a courtesy for a slip: of five letters one may be wrong."""
LONGEST: Final = 12
"""Words; nobody is more courteous."""
SHORTEST: Final = 5
"""Letters in which a slip may be made."""

Words = tuple[str, ...]


@dataclass(frozen=True)
class _Courtesies:
    """Those of one language."""

    ways: dict[Words, str]
    """What may be said, with its kind."""
    address: frozenset[Words]
    kinds: dict[str, dict[str, Any]]
    offer: str
    nameless: str

    def parts(self, words: Words) -> list[str] | None:
        """The kinds that words are of, one after the other; None if some are of none."""
        if not words:
            return []
        for length in range(len(words), 0, -1):
            first = words[:length]
            kind = self.ways.get(first)
            if kind is None and first not in self.address:
                continue
            rest = self.parts(words[length:])
            if rest is not None:
                return rest if kind is None else [kind, *rest]
        return None


def courtesy(text: str, lexicon: Lexicon, language: str, *, with_slips: bool = False) -> str | None:
    """The answer to a courtesy; None for anything else. Where the world has an answer of its own
    ("who are you?"), it is that one. `with_slips`: the words may be misspelt."""
    known = _courtesies(language)
    words = _words(text, language)
    own = _predefined(lexicon, language).get(words)
    if own is not None:
        return own or None if words in known.ways else None
    if len(words) > LONGEST:
        return None
    if lexicon.robot_name:
        name = _words(lexicon.robot_name, language)
        known = _Courtesies(
            known.ways, known.address | {name}, known.kinds, known.offer, known.nameless
        )
    kinds = known.parts(words)
    if not kinds and with_slips:
        kinds = _likely(words, known)
    if not kinds:
        return None
    answers = [
        known.kinds[kind]["answer"].format(name=lexicon.robot_name or known.nameless)
        for kind in dict.fromkeys(kinds)
    ]
    offers = all(known.kinds[kind].get("offers") for kind in kinds)
    return " ".join(dict.fromkeys([*answers, *([known.offer] if offers else [])]))


def _likely(words: Words, known: _Courtesies) -> list[str] | None:
    """The kind of a courtesy that is spelled much like this, and begins like it."""
    from rapidfuzz import process
    from rapidfuzz.distance import OSA

    while words:
        said = " ".join(words)
        ways = {
            " ".join(way): kind
            for way, kind in known.ways.items()
            if len(way) == len(words) and way[0][0] == said[0]
        }
        found = process.extractOne(
            said, list(ways), scorer=OSA.normalized_similarity, score_cutoff=ALIKE
        )
        if found and len(found[0]) >= SHORTEST:
            return [ways[found[0]]]
        if words[-1:] not in known.address:
            return None
        words = words[:-1]
    return None


@functools.cache
def _courtesies(language: str) -> _Courtesies:
    data = texts_in(language, "courtesies")
    ways = {
        _words(way, language): kind
        for kind, about in data["kinds"].items()
        for way in about["ways"]
    }
    address = frozenset(_words(way, language) for way in data["address"])
    return _Courtesies(ways, address, data["kinds"], data["offer"], data["nameless"])


def _predefined(lexicon: Lexicon, language: str) -> dict[Words, str]:
    """The questions that the world has answers for."""
    return {
        _words(way, language): question.answer
        for question in lexicon.questions
        for way in (question.question, *question.aliases)
    }


def _words(text: str, language: str) -> Words:
    spelling = load_language(language).spelling
    return tuple(token.norm for token in tokenise(text, spelling) if token.kind != "mark")
