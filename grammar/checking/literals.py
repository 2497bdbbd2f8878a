"""The literals of a plan, each with what it is for."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final

from grammar.inference import form_for
from grammar.plan import (
    Ask,
    Call,
    Compare,
    ForEach,
    Items,
    Node,
    Number,
    Plan,
    Repeat,
    Sentence,
    Text,
    Weekday,
)
from grammar.roles import FREE, role
from robot_api.methods import METHODS

COMPARED: Final = "compared"
"""The role of what is only compared with something, or stands in a list."""
COUNTED: Final = "counted"
"""The role of a number of times."""


@dataclass(frozen=True)
class Literal:
    value: str | float
    role: str
    """What it is for: a field of `grammar.roles`, or `FREE`,
    `OPTIONS`, `COMPARED`, `COUNTED`."""
    method: str = ""
    """The robot method that it is given to, if it is."""

    @property
    def text(self) -> str:
        return self.value if isinstance(self.value, str) else f"{self.value:g}"


def literals(plan: Plan) -> Iterator[Literal]:
    """All of them, in the order in which they are written."""
    yield from _in(plan.steps, COMPARED, "")


def _in(part: Any, what: str, method: str) -> Iterator[Literal]:
    match part:
        case Text(value=value):
            yield Literal(value, what, method)
        case Number(value=value):
            yield Literal(float(value), what, method)
        case Sentence(parts=parts):
            yield from _in(parts, FREE, method)
        case Weekday():
            return
        case Call() | Ask():
            yield from _arguments(part)
        case Repeat(times=times, steps=steps):
            yield from _in(times, COUNTED, method)
            yield from _in(steps, COMPARED, "")
        case ForEach(items=items, steps=steps):
            yield from _in(items, COMPARED, "")
            yield from _in(steps, COMPARED, "")
        case Compare(left=left, right=right):
            yield from _in((left, right), COMPARED, method)
        case Items(items=items):
            yield from _in(items, what, method)
        case tuple() | list():
            for each in part:
                yield from _in(each, what, method)
        case dict():
            for each in part.values():
                yield from _in(each, what, method)
        case Node():
            for name in part.__struct_fields__:
                yield from _in(getattr(part, name), what, method)
        case _:
            return


def _arguments(call: Call | Ask) -> Iterator[Literal]:
    method = METHODS.get(call.method)
    if method is None:
        return
    parameters = {each.name: each for each in form_for(method, call.arguments) or ()}
    for name, value in call.arguments.items():
        known = parameters.get(name)
        what = role(method, known) if known is not None else FREE
        yield from _in(value, what, call.method)
