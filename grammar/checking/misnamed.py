"""What is looked for by a name that is nearly one of the world's: "where is bobb?", "find ward dd".

A word of which nothing is known may be a thing that nobody listed, and is looked for as one. It is
rather a slip if it stands without an article and differs by a letter from somebody's name, or if it
numbers a kind of place beyond those that there are. Who means the thing says "the".
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from grammar.checking.evidence import evidence_of
from grammar.lexicon import Lexicon, nearest, series_of
from grammar.plan import Ask, Call, Plan, Text
from grammar.planning.turn import Turn
from grammar.refusals import SEEN
from grammar.tidy import nodes

SHORTEST: Final = 3
"""Letters of a name that may be misspelt."""
LONGEST_NUMBER: Final = 2
"""Letters that may be what a place is numbered by: "ward dd"."""


@dataclass(frozen=True)
class Misnamed:
    phrase: str
    """What is said of it: a key of the language's phrases, with a gap `name`."""
    words: str
    """As they were said."""
    start: int
    end: int
    """The tokens."""
    near: tuple[str, ...]
    """Names that may be meant, as the world spells them."""


def misnamed(turn: Turn, plan: Plan) -> Misnamed | None:
    """The first such name in a plan."""
    listed = {each.name for each in (*turn.lexicon.objects, *turn.lexicon.people)}
    for step in nodes(plan.steps):
        if not isinstance(step, Call | Ask) or step.method not in SEEN:
            continue
        thing = step.arguments.get("thing")
        if not isinstance(thing, Text) or thing.value in listed:
            continue
        found = _at(turn, turn.language.tokens_of(thing.value))
        if found is None:
            continue
        start, end = found
        words = turn.reader.words(start, end)
        if end - start == 1:
            people = _people(turn, start)
            if people:
                return Misnamed("unknown_person", words, start, end, people)
        elif _numbers_a_place(words, turn.lexicon):
            near = nearest(words, turn.lexicon.places)
            return Misnamed("unknown_place", words, start, end, near)
    return None


def _at(turn: Turn, words: tuple[str, ...]) -> tuple[int, int] | None:
    """The tokens at which these words were said."""
    norms = tuple(token.norm for token in turn.tokens)
    ends = range(len(words), len(norms) + 1) if words else ()
    return next(
        ((end - len(words), end) for end in ends if norms[end - len(words) : end] == words), None
    )


def _people(turn: Turn, at: int) -> tuple[str, ...]:
    """Whose name differs by a letter from the word there, if that is no noun."""
    from rapidfuzz.distance import OSA

    word, speech = turn.tokens[at].norm, turn.language.speech
    nouns = {*speech.get("articles", ()), *speech.get("definite", ())}
    if len(word) < SHORTEST or (at and turn.tokens[at - 1].norm in nouns):
        return ()
    if evidence_of(turn.language).knows(word):
        return ()
    near = (
        each.name
        for each in turn.lexicon.people
        for name in (each.name, *each.aliases)
        for part in (name.lower(), *name.lower().split())
        if len(part) >= SHORTEST and part[0] == word[0] and OSA.distance(part, word) == 1
    )
    return tuple(dict.fromkeys(near))


def _numbers_a_place(words: str, lexicon: Lexicon) -> bool:
    """Whether these words are of a series of places, with a number or a letter that none has."""
    *_, last = words.split()
    series = series_of(words)
    if series is None and len(last) <= LONGEST_NUMBER:
        series = words.lower().removesuffix(last.lower()).strip()
    known = {series_of(text) for each in lexicon.places for text in (each.name, *each.aliases)}
    return series is not None and series in (known - {None}) | lexicon.place_kinds.keys()
