"""What a name in a program may stand for, as far as that decides what may follow it."""

from __future__ import annotations

import enum
from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import Final

from robot_api.methods import METHODS


class Kind(enum.Enum):
    TEXT = "text"
    PLACE = "place"
    PERSON = "person"
    NUMBER = "number"
    TRUTH = "truth"
    LOCATION = "location"
    LIST = "list"
    RECORD = "record"
    NOTHING = "nothing"


@dataclass(frozen=True)
class Type:
    kind: Kind
    options: tuple[str, ...] = ()
    """Of a text that can only be one of a few: the answers that a question offers."""
    of: Type | None = None
    """Of a list, its items; of a record, its values, its keys being texts; None while it is
    empty."""
    keys: Type | None = None
    """Of a record."""
    written: frozenset[str] = frozenset()
    """Of a text, all that it may be because the program says so; not what is heard or found."""
    made: bool = False
    """Whether the program may have put the text together."""

    @property
    def is_text(self) -> bool:
        return self.kind in (Kind.TEXT, Kind.PLACE, Kind.PERSON)

    def named(self, known: Collection[str]) -> bool:
        """Whether it is none but these, as far as the program has a say in it."""
        return not self.made and self.written <= {*known}

    def joined(self, other: Type) -> Type | None:
        """What is either of them; None if that makes no sense."""
        if self == other:
            return self
        if self.is_text and other.is_text:
            return replace(TEXT, written=self.written | other.written, made=self.made or other.made)
        if self.kind is other.kind and self.kind in (Kind.LIST, Kind.RECORD):
            of = self.of or other.of
            if self.of and other.of:
                of = self.of.joined(other.of)
            keys = self.keys or other.keys
            if self.keys and other.keys:
                keys = self.keys.joined(other.keys)
            return replace(self, of=of, keys=keys)
        if self.kind is other.kind:
            return Type(self.kind)
        travels = {Kind.LOCATION, Kind.PLACE, Kind.TEXT}
        if not {self.kind, other.kind} <= travels:
            return None
        return replace(LOCATION, written=self.written | other.written, made=self.made or other.made)


TEXT: Final = Type(Kind.TEXT)
PLACE: Final = Type(Kind.PLACE)
PERSON: Final = Type(Kind.PERSON)
NUMBER: Final = Type(Kind.NUMBER)
TRUTH: Final = Type(Kind.TRUTH)
LOCATION: Final = Type(Kind.LOCATION)
NOTHING: Final = Type(Kind.NOTHING)

_RESULTS: Final = {
    "str": TEXT,
    "bool": TRUTH,
    "int": NUMBER,
    "float": NUMBER,
    "Location": LOCATION,
    "None": NOTHING,
    "list[str]": Type(Kind.LIST, of=TEXT),
}
_LISTS: Final = {"places": PLACE, "people": PERSON}


def result_of(method: str) -> Type:
    """What a robot method returns."""
    if method in _LISTS:
        return Type(Kind.LIST, of=_LISTS[method])
    return _RESULTS.get(METHODS[method].returns.annotation, TEXT)
