"""Kinds of values, written as the method table writes them: "str", "int", "float", "bool",
"list[str]", "dict[str, int]", "Location", "Clock", "None"; "Any" where nobody knows.

An empty list is a "list[Never]": what is put into it later says of what it is.
"""

from __future__ import annotations

import functools
from collections.abc import Iterable
from typing import Any, Final

from robot_api.methods import CLOCK, LOCATION

NEVER: Final = "Never"
PROBLEM: Final = "Exception"
"""The kind of what tells why the robot failed."""


def _kind_of(schema: dict[str, Any]) -> str:
    return "float" if schema.get("type") == "number" else "str"


FIELDS: Final = {
    kind.annotation: {name: _kind_of(part) for name, part in kind.schema["properties"].items()}
    for kind in (LOCATION, CLOCK)
}
"""The parts that a value of such a kind has, with their kinds."""


def is_number(kind: str) -> bool:
    return kind in ("int", "float")


def is_list(kind: str) -> bool:
    return kind.startswith("list[")


def is_record(kind: str) -> bool:
    return kind.startswith("dict[")


def record(keys: str, values: str) -> str:
    """The kind of a record of such keys and values."""
    return f"dict[{keys}, {values}]"


def item_of(kind: str) -> str:
    """What a loop over such a value gives: the items of a list, the keys of a record."""
    if is_list(kind):
        return _known(kind.removeprefix("list[").removesuffix("]"))
    return _known(_key_and_value(kind)[0]) if is_record(kind) else "Any"


def value_of(kind: str) -> str:
    """What such a value has under a position or a key."""
    return _known(_key_and_value(kind)[1]) if is_record(kind) else item_of(kind)


def _key_and_value(kind: str) -> tuple[str, str]:
    key, _, value = kind.removeprefix("dict[").removesuffix("]").partition(", ")
    return key, value


def _known(kind: str) -> str:
    return "Any" if kind == NEVER else kind


def joined(kinds: Iterable[str]) -> str:
    """The kind of what may be of any of these."""
    return functools.reduce(_join, kinds, NEVER)


def _join(one: str, other: str) -> str:
    if one == other or other == NEVER:
        return one
    if one == NEVER:
        return other
    if is_number(one) and is_number(other):
        return "float"
    if is_list(one) and is_list(other):
        return f"list[{_join(one[5:-1], other[5:-1])}]"
    if is_record(one) and is_record(other):
        keys, values = map(_join, _key_and_value(one), _key_and_value(other))
        return record(keys, values)
    return "Any"
