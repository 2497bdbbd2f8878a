"""What the model is told: the task, the robot's functions, examples, and the sentence with what it
speaks of. All but the last is the same for every world, so that it has to be read only once.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from grammar.lexicon import Lexicon
from grammar.planning.mentions import Mention, written
from grammar.planning.model.vocabulary import Vocabulary
from grammar.understand import Reader

ANYBODY: Final = "person"
_NAMES: Final = frozenset({"place", "person", "contact"})
_PAUSES: Final = ("1", "2", "5", "10", "30", "60")
"""Seconds to wait between two looks, which nobody says."""
_DEFAULTS: Final = {
    "metres": ("0.5", "1"),
    "degrees": ("45", "90", "180", "360"),
    "percents": ("20", "30", "50", "70", "80", "100"),
}
"""Numbers for what is asked for without one: "wait a moment", "turn left", "a bit louder"."""
_SIGNED: Final = frozenset({"metres", "degrees", "numbers"})
_SORTS: Final = {
    "places": "place",
    "kinds": "kind",
    "people": "person",
    "things": "thing",
    "furniture": "furniture",
    "contacts": "contact",
    "gestures": "gesture",
    "emotions": "emotion",
    "joints": "joint",
    "skills": "skill",
    "languages": "language",
    "times": "time",
    "urls": "url",
    "selectors": "selector",
}


def vocabulary(reader: Reader, found: Sequence[Mention]) -> Vocabulary:
    """What a program for this sentence may name."""
    lexicon = reader.lexicon
    own = {
        field: tuple(dict.fromkeys(each.value for each in found if each.sort == sort))
        for field, sort in _SORTS.items()
    }
    own["places"] += tuple(_owned(lexicon, own["people"]))
    own["people"] = tuple(dict.fromkeys((*own["people"], ANYBODY)))
    own["gestures"] = tuple(dict.fromkeys((*own["gestures"], *lexicon.gestures)))
    own["emotions"] = tuple(dict.fromkeys((*own["emotions"], *lexicon.emotions)))
    own["joints"], own["skills"] = lexicon.joints, lexicon.skills
    own["languages"] = own["languages"] or lexicon.languages
    numbers = {
        field: tuple(_numbers(field, [each.value for each in found if each.sort == sort]))
        for field, sort in (
            *(("seconds", "seconds"), ("metres", "metres"), ("degrees", "degrees")),
            ("percents", "percent"),
        )
    }
    spans = [float(each.value) / 60 for each in found if each.sort == "seconds"]
    numbers["minutes"] = tuple(dict.fromkeys(written(minutes) for minutes in spans))
    plain = [each.value for each in found if each.sort in ("number", "times")]
    return Vocabulary(
        **own,
        **numbers,
        numbers=tuple(_numbers("numbers", plain)),
        phrases=tuple(_phrases(reader, found)),
    )


def _owned(lexicon: Lexicon, people: Sequence[str]) -> Iterator[str]:
    """The places that are called after people."""
    for place in lexicon.places:
        called = " ".join((place.name, *place.aliases)).lower()
        if any(person.lower() in called for person in people if person != ANYBODY):
            yield place.name


def _numbers(field: str, said: Sequence[str]) -> Iterator[str]:
    numbers = tuple(dict.fromkeys(said)) or _DEFAULTS.get(field, ())
    yield from numbers
    if field == "seconds":
        yield from (each for each in _PAUSES if each not in numbers)
    if field in _SIGNED:
        yield from (f"-{each}" for each in numbers if each != "0" and each[0] != "-")


def _phrases(reader: Reader, found: Sequence[Mention]) -> Iterator[str]:
    """Words of the sentence, as they were said, that may stand for something in a list."""
    seen: set[str] = set()
    spans = [(each.start, each.end) for each in found if each.sort in ("thing", "person", "time")]
    spans += [(at, at + 1) for at in range(len(reader.tokens))]
    for start, end in spans:
        while start < end and reader.tokens[start].norm in reader.language.closed:
            start += 1
        words = reader.words(start, end)
        if words and words not in seen and reader.tokens[start].kind != "mark":
            seen.add(words)
            yield words


def hints(reader: Reader, found: Sequence[Mention]) -> str:
    """What the sentence speaks of, by the names that programs know it by."""
    found = _shortest(found)
    named = [each for each in found if each.sort in _NAMES and each.value != ANYBODY]
    inside = {
        (each.start, each.end)
        for each in found
        for other in named
        if other.start <= each.start
        and each.end <= other.end
        and (other.start, other.end) != (each.start, each.end)
    }
    told: dict[str, None] = {}
    taken: set[int] = set()
    order = {sort: place for place, sort in enumerate(("place", "person", "kind", "contact"))}
    likeliest = sorted(
        found,
        key=lambda each: (
            each.sort not in order,
            each.cost > 0.5,
            order.get(each.sort, 9),
            each.start - each.end,
        ),
    )
    for each in likeliest:
        span = {*range(each.start, each.end)}
        words = reader.words(each.start, each.end)
        new = each.value.lower() != words.lower()
        if each.sort not in order and not (each.sort in ("thing", "furniture") and new):
            continue
        if each.value == ANYBODY or span & taken or (each.start, each.end) in inside:
            continue
        if each.sort == "person" and not _is_name(reader.lexicon, each.value) and not new:
            continue
        taken |= span
        sort = "kind of place" if each.sort == "kind" else each.sort
        told[f'{words}: {sort} "{each.value}"' if new else f"{words}: {sort}"] = None
    return "; ".join(told)


def _shortest(found: Sequence[Mention]) -> list[Mention]:
    """Of mentions of the same in more and fewer words, those with the fewest."""
    return [
        each
        for each in found
        if not any(
            (other.sort, other.value) == (each.sort, each.value)
            and each.start <= other.start
            and other.end <= each.end
            and other != each
            and (other.start, other.end) != (each.start, each.end)
            for other in found
        )
    ]


def _is_name(lexicon: Lexicon, person: str) -> bool:
    return any(each.name == person for each in lexicon.people)
