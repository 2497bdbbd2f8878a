"""Going through a plan, and making another of it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any, TypeVar

from grammar import plan as p


def nodes(part: Any) -> Iterator[p.Node]:
    """All nodes in a part of a plan, itself included."""
    if isinstance(part, p.Node):
        yield part
        for name in part.__struct_fields__:
            yield from nodes(getattr(part, name))
    elif isinstance(part, tuple | list):
        for each in part:
            yield from nodes(each)
    elif isinstance(part, dict):
        for each in part.values():
            yield from nodes(each)


Part = TypeVar("Part", bound=p.Plan | p.Node)


def rebuilt(part: Part, change: Callable[[Any], Any]) -> Part:
    """The part with each node in it, but not those within these, put through `change`."""

    def changed(each: Any) -> Any:
        match each:
            case p.Node():
                return change(each)
            case tuple():
                return tuple(map(changed, each))
            case dict():
                return {key: changed(value) for key, value in each.items()}
            case _:
                return each

    return type(part)(**{name: changed(getattr(part, name)) for name in part.__struct_fields__})


def walk(steps: Iterable[p.Step]) -> Iterator[p.Step]:
    """Every step, those inside others included, in the order they are written."""
    for step in steps:
        yield step
        match step:
            case p.If():
                yield from walk(step.then)
                yield from walk(step.otherwise)
            case p.Try():
                yield from walk(step.steps)
                yield from walk(step.otherwise)
            case p.Repeat() | p.ForEach() | p.While() | p.RepeatUntil() | p.Forever():
                yield from walk(step.steps)
            case _:
                pass
