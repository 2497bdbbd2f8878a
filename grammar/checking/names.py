"""Names that a plan uses before it gives them, and calls that lead nowhere."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import Final

from grammar.plan import Call, ForEach, ListOf, Plan, Recall, Remember, Try
from grammar.plausible import rows
from grammar.tidy import nodes
from robot_api.methods import METHODS, NOTHING

ONLY_FINDS_OUT: Final = frozenset(
    name for name, method in METHODS.items() if method.returns is not NOTHING
) - {"ask", "answer", "find", "wait_for", "do"}
"""Methods that are of no use if nothing is made of what they tell."""


_GIVERS: Final = (
    (Call, "save_as"),
    (Remember, "name"),
    (ForEach, "variable"),
    (ForEach, "value"),
    (ListOf, "variable"),
    (Try, "problem"),
)
"""What gives a name, and the field in which it stands."""


def unbound(plan: Plan) -> Iterator[str]:
    """Names that are used and never given."""
    given = {
        getattr(node, giver)
        for node in nodes(plan.steps)
        for kind, giver in _GIVERS
        if isinstance(node, kind)
    }
    seen: set[str] = set()
    for node in nodes(plan.steps):
        if type(node) is Recall and node.name not in given and node.name not in seen:
            seen.add(node.name)
            yield node.name


def idle_names(plan: Plan) -> Iterator[str]:
    """Names that are given to what nobody uses."""
    used = {node.name for node in nodes(plan.steps) if type(node) is Recall}
    for node in nodes(plan.steps):
        if isinstance(node, Remember) and node.name not in used:
            yield node.name


def misplaced(plan: Plan) -> Iterator[str]:
    """Calls that find something out and lose it again."""
    for node in nodes(plan.steps):
        if isinstance(node, Call) and node.method in ONLY_FINDS_OUT and node.save_as is None:
            yield node.method


def gone_twice(plan: Plan) -> Iterator[str]:
    """Calls that go where the robot has just gone."""
    for steps in rows(plan.steps):
        for before, step in itertools.pairwise(steps):
            if isinstance(step, Call) and step.method == "goto" and step == before:
                yield step.method
