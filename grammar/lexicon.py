"""What the world and the robot know by name, for the language to recognise.

The application makes a `Lexicon` from a world and a robot's capabilities; the grammar knows nothing
of either. Names keep the world's own spelling: that is what programs contain, whatever alias a
person used.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from typing import Final

from grammar.languages import registry
from robot_api.methods import SUGGESTED_EMOTIONS, SUGGESTED_GESTURES

LIKE_ENOUGH: Final = 55
"""Percent that two names have to be alike for one to be offered in the place of the other."""


@dataclass(frozen=True)
class Name:
    """Something that goes by a name."""

    name: str
    """As the world spells it; what a program contains."""
    kind: str | None = None
    """What it is: "office", "nurse", "tool". Of a place, the last word of its name if left out."""
    aliases: tuple[str, ...] = ()
    """Other names, in the language spoken."""
    attributes: tuple[str, ...] = ()
    """What a person may say of it: "red", "sitting"."""
    inside: str | None = None
    """The place that a piece of furniture stands in; of a place, what it is a part of: a floor."""


@dataclass(frozen=True)
class Question:
    """A predefined question and its answer."""

    question: str
    answer: str
    aliases: tuple[str, ...] = ()


@dataclass(frozen=True)
class Routine:
    """Something to do that goes by a name."""

    name: str
    """ "evening round"."""
    sentence: str
    """What to do, as it was said; empty where a program says it."""
    program: str = ""
    reviewed: bool = True
    """Whether somebody has looked at what it does; else it cannot be used."""


@dataclass(frozen=True)
class Lexicon:
    """Everything that has a name. All parts may be empty."""

    places: tuple[Name, ...] = ()
    people: tuple[Name, ...] = ()
    objects: tuple[Name, ...] = ()
    furniture: tuple[Name, ...] = ()
    contacts: tuple[str, ...] = ()
    contact_aliases: tuple[Name, ...] = ()
    """Contacts that go by other names too."""
    gestures: tuple[str, ...] = SUGGESTED_GESTURES
    emotions: tuple[str, ...] = SUGGESTED_EMOTIONS
    joints: tuple[str, ...] = ()
    skills: tuple[str, ...] = ()
    """The robot's own extra skills, for `do`."""
    languages: tuple[str, ...] = field(default_factory=registry.codes)
    questions: tuple[Question, ...] = ()
    routines: tuple[Routine, ...] = ()
    """Commands that people gave a name."""
    robot_name: str = ""
    """What people may call it: "hey Cruzr"."""
    _kinds: dict[str, tuple[Name, ...]] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    _series: frozenset[str] = field(default=frozenset(), init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        for place in self.places:
            kind = kind_of(place)
            if kind:
                self._kinds[kind] = (*self._kinds.get(kind, ()), place)
        names = {name.lower() for place in self.places for name in (place.name, *place.aliases)}
        series: dict[str, tuple[Name, ...]] = {}
        for place in self.places:
            for name in {series_of(each) for each in (place.name, *place.aliases)}:
                if name and name not in names and name not in self._kinds:
                    series[name] = (*series.get(name, ()), place)
        self._kinds.update(series)
        object.__setattr__(self, "_series", frozenset(series))

    def __hash__(self) -> int:
        """Of all its names, counted once: whatever is known of a lexicon is looked up by it."""
        return self._hash

    def __getstate__(self) -> dict[str, object]:
        """Without the hash: another process counts otherwise."""
        return {name: value for name, value in vars(self).items() if name != "_hash"}

    @functools.cached_property
    def _hash(self) -> int:
        return hash((self.places, self.people, self.objects, self.furniture, self.routines))

    @property
    def place_kinds(self) -> dict[str, tuple[Name, ...]]:
        """The places of each kind, and of each series: "conference room" 1, 2 and 3."""
        return self._kinds

    def is_series(self, kind: str) -> bool:
        """Whether a kind is only what numbered names have in common, which no robot knows of."""
        return kind in self._series


def kind_of(place: Name) -> str | None:
    """The kind of a place: the one it states, or the last word of its name."""
    if place.kind:
        return place.kind.lower()
    words = place.name.lower().split()
    return words[-1] if len(words) > 1 and not words[-1].isdigit() else None


def series_of(name: str) -> str | None:
    """What a numbered name counts: "conference room" of "Conference room 2b"."""
    *words, last = name.lower().split() or [""]
    numbered = last[:1].isdigit() or len(last) == 1
    return " ".join(words) if words and numbered else None


def nearest(words: str, names: tuple[Name, ...]) -> tuple[str, ...]:
    """The names most like some words, the best first."""
    from rapidfuzz import fuzz, process

    choices = {text: name.name for name in names for text in (name.name, *name.aliases)}
    if _is_numbered(words):  # no room without a number is like "room 3"
        choices = {text: name for text, name in choices.items() if _is_numbered(text)}
    found = process.extract(
        words.lower(), list(choices), scorer=fuzz.ratio, limit=6, score_cutoff=LIKE_ENOUGH
    )
    return tuple(dict.fromkeys(choices[text] for text, _, _ in found))[:3]


def _is_numbered(name: str) -> bool:
    return any(letter.isdigit() for letter in name)


EMPTY: Final = Lexicon()
