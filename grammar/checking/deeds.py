"""What a plan does, in a few words: its robot methods, and whether it decides, goes round,
counts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from grammar.plan import (
    Ask,
    Call,
    Collect,
    Compare,
    ForEach,
    Forever,
    Holds,
    If,
    Increase,
    Not,
    Number,
    Plan,
    Repeat,
    RepeatUntil,
    Step,
    Text,
    Try,
    While,
)
from grammar.tidy import nodes

DECIDES: Final = "decides"
OTHERWISE: Final = "otherwise"
ROUND: Final = "round"
REPEATS: Final = "repeats"
UNTIL: Final = "until"
COUNTS: Final = "counts"
COLLECTS: Final = "collects"
COMPARES: Final = "compares numbers"
NEGATES: Final = "negates"


def said_anyhow(plan: Plan) -> Iterator[str]:
    """What is said or shown whatever the robot finds out, but for whether it finds somebody."""
    yield from _said(plan.steps)


def _said(steps: Sequence[Step]) -> Iterator[str]:
    for step in steps:
        match step:
            case Call(method="say" | "show", arguments={"text": text}):
                yield from (node.value for node in nodes(text) if isinstance(node, Text))
            case If(condition=Holds(value=Ask(method="find")), then=then):
                yield from _said(then)
            case Repeat() | ForEach() | Forever():
                yield from _said(step.steps)
            case _:
                continue


def deeds(plan: Plan) -> frozenset[str]:
    """The deeds of a plan: names of robot methods, and those above."""
    found: set[str] = set()
    for node in nodes(plan.steps):
        match node:
            case Call() | Ask():
                found.add(node.method)
            case If(otherwise=otherwise):
                found |= {DECIDES, OTHERWISE} if otherwise else {DECIDES}
            case Try():
                found |= {DECIDES, OTHERWISE}
            case ForEach():
                found.add(ROUND)
            case Repeat():
                found.add(REPEATS)
            case While() | RepeatUntil() | Forever():
                found |= {UNTIL, REPEATS}
            case Increase():
                found.add(COUNTS)
            case Collect():
                found.add(COLLECTS)
            case Not():
                found.add(NEGATES)
            case Compare(operator=operator, left=left, right=right):
                if operator == "!=":
                    found.add(NEGATES)
                if isinstance(left, Number) or isinstance(right, Number):
                    found.add(COMPARES)
            case _:
                pass
    return frozenset(found)
