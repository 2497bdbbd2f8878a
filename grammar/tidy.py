"""Small tidying of a finished plan."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import msgspec

from grammar.plan import Call, Node, Plan, Recall, Remember, Step


def without_unused(plan: Plan) -> Plan:
    """The plan without names for results, and without kept values, that nothing uses."""
    used = {value.name for value in nodes(plan.steps) if isinstance(value, Recall)}
    return msgspec.structs.replace(plan, steps=_forget(plan.steps, used))


def nodes(value: Any) -> Iterator[Node]:
    """All nodes in a part of a plan, itself included."""
    if isinstance(value, Node):
        yield value
        for name in value.__struct_fields__:
            yield from nodes(getattr(value, name))
    elif isinstance(value, tuple | list):
        for each in value:
            yield from nodes(each)
    elif isinstance(value, dict):
        for each in value.values():
            yield from nodes(each)


def _forget(steps: tuple[Step, ...], used: set[str]) -> tuple[Step, ...]:
    return tuple(
        _forget_in(step, used)
        for step in steps
        if not (isinstance(step, Remember) and step.name not in used)
    )


def _forget_in(step: Step, used: set[str]) -> Step:
    if isinstance(step, Call):
        if step.save_as is not None and step.save_as not in used:
            return msgspec.structs.replace(step, save_as=None)
        return step
    inner = {
        name: _forget(value, used)
        for name in ("steps", "then", "otherwise")
        if (value := getattr(step, name, None))
    }
    return msgspec.structs.replace(step, **inner) if inner else step
