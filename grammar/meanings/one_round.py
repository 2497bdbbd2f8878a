"""The steps for one of several, as the body of a loop."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from grammar.discourse import (
    START,
    Discourse,
    Steps,
)
from grammar.meanings.guards import guard_finds
from grammar.plan import (
    Ask,
    Call,
    Recall,
    Value,
)
from grammar.tidy import nodes

Make = Callable[[], Steps]
"""Makes the steps of a command, for whatever its noun phrases are bound to by then."""


One = Callable[[Any], Steps]


def round_of_steps(d: Discourse, make: Make) -> Steps:
    """The steps of one round of a loop."""
    d.scene = replace(d.scene, with_person=None, holding=None)
    outer = d.loops.in_loop
    d.loops = replace(d.loops, in_loop=True)
    steps = d.sequence(lambda: d.done.extend(make()))
    d.loops = replace(d.loops, in_loop=outer)
    return guard_finds(d, steps)


def leaves(steps: Steps, place: Value | None) -> bool:
    """Whether some steps end elsewhere than where they begin."""
    last: Value | None = place or Recall(START)
    for each in nodes(tuple(steps)):
        if isinstance(each, Call) and each.method in ("goto", "guide"):
            last = each.arguments.get("place")
        elif isinstance(each, Call | Ask) and each.method in ("find", "follow"):
            last = each.arguments.get("place") or each.arguments.get("to")
    return last != (place or Recall(START))
