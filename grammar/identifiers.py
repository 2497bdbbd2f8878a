"""Names in programs: what people call things, as Python identifiers."""

from __future__ import annotations

import builtins
import keyword
import re
import unicodedata
from collections.abc import Iterator
from typing import Any, Final, TypeVar

import msgspec

from grammar import plan as p
from grammar.helpers import HELPERS
from grammar.inference import Types
from grammar.traversal import nodes, rebuilt

_TAKEN: Final = frozenset(
    {
        *keyword.kwlist,
        *keyword.softkwlist,
        *dir(builtins),
        "robot",
        "random",
        "re",
        "math",
        *HELPERS,
    }
)

LONGEST: Final = 30


def identifier(text: str) -> str:
    """The text as an identifier in plain letters: "Größe der Übung" becomes `grosse_der_ubung`."""
    plain = unicodedata.normalize("NFKD", text.replace("ß", "ss"))
    plain = plain.encode("ascii", "ignore").decode().lower()
    word = re.sub(r"[^a-z0-9]+", "_", plain)[:LONGEST].strip("_")
    if not word:
        return "value"
    if word[0].isdigit():
        word = f"value_{word}"
    return f"{word}_" if word in _TAKEN else word


class Identifiers:
    """Gives every name of a plan its own identifier, the same whenever it is asked for."""

    def __init__(self) -> None:
        self._given: dict[str, str] = {}
        self._used: set[str] = set()

    def of(self, name: str) -> str:
        if name not in self._given:
            self._given[name] = self.fresh(name)
        return self._given[name]

    def fresh(self, wish: str) -> str:
        """An identifier like the wish that nothing else has."""
        chosen = self.spare(wish)
        self._used.add(chosen)
        return chosen

    def spare(self, wish: str) -> str:
        """The same without taking it: for a variable whose life is one expression."""
        base = chosen = identifier(wish)
        number = 2
        while chosen in self._used:
            chosen = f"{base.rstrip('_')}_{number}"
            number += 1
        return chosen


# --- names in plans ------------------------------------------------------------------------------

_NAMES: Final[dict[type[Any], tuple[str, ...]]] = {
    p.Recall: ("name",),
    p.Call: ("save_as",),
    p.Remember: ("name",),
    p.Collect: ("name",),
    p.Increase: ("name",),
    p.SetItem: ("name",),
    p.ForEach: ("variable", "value"),
    p.Try: ("problem",),
}
"""The fields of a plan's nodes that hold a name of its own."""


def names_in(node: p.Node) -> dict[str, str]:
    """The names of the plan's own that stand in a node itself, by the fields that hold them."""
    held = {name: getattr(node, name) for name in _NAMES.get(type(node), ())}
    return {name: value for name, value in held.items() if value is not None}


def all_names(plan: p.Plan) -> Iterator[str]:
    """Every name of a plan: what is given one before what is only spoken of."""
    yield from Types(plan).names
    for node in nodes(plan.steps):
        yield from names_in(node).values()


def speaks_of(part: Any, name: str) -> bool:
    """Whether a part of a plan uses a name, but for loops in which it means something else."""
    match part:
        case p.ForEach(variable=variable) if variable == name:
            return speaks_of(part.items, name)
        case p.Node():
            inside = (getattr(part, field) for field in part.__struct_fields__)
            return name in names_in(part).values() or any(speaks_of(each, name) for each in inside)
        case tuple():
            return any(speaks_of(each, name) for each in part)
        case dict():
            return speaks_of(tuple(part.values()), name)
        case _:
            return False


Part = TypeVar("Part", bound=p.Plan | p.Node)


def with_identifiers(plan: p.Plan) -> p.Plan:
    """The plan with an identifier for each of its names."""
    names = Identifiers()
    for name in all_names(plan):
        names.of(name)

    def renamed(part: Part) -> Part:
        part = rebuilt(part, renamed)
        if isinstance(part, p.Plan):
            return part
        new = {field: names.of(name) for field, name in names_in(part).items()}
        return msgspec.structs.replace(part, **new) if new else part

    return renamed(plan)
