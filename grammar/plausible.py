"""Whether a plan makes sense as a whole: a sentence whose words were all read may still have been
put together wrongly, and then the robot would put down what it never took, or ask everybody twice.
Such a plan is no understanding, however well each part of it was read; it is refused.

What is looked for are mistakes of reading that no speaker means, not plans that may fail: whether a
thing will be there is for the dry run to find out.
"""

from __future__ import annotations

from enum import Enum
from typing import Final

from grammar.plan import (
    Ask,
    Call,
    Collect,
    ForEach,
    Forever,
    If,
    Increase,
    Plan,
    Recall,
    Remember,
    Repeat,
    RepeatUntil,
    Step,
    Text,
    Try,
    While,
)
from grammar.tidy import nodes

LETTING_GO: Final = frozenset({"put", "give"})
FINDING_OUT: Final = frozenset({"ask", "sees", "count", "people", "objects", "describe"})
"""Methods that tell the robot something."""


class Doubt(Enum):
    """What makes no sense in a plan; the value is the name of the phrase that says so."""

    EMPTY_HANDED = "empty_handed"
    TWICE = "found_out_twice"


def implausible(plan: Plan) -> Doubt | None:
    """What makes no sense in a plan, if anything does."""
    if _lets_go_of_nothing(plan):
        return Doubt.EMPTY_HANDED
    if _finds_out_twice(plan):
        return Doubt.TWICE
    return None


# --- hands ---------------------------------------------------------------------------------------


class Hand(Enum):
    """What a robot has in its hand at some point of a plan."""

    UNKNOWN = "perhaps something, from before"
    FULL = "something"
    EMPTY = "nothing"


class _Nothing(Exception):
    """Something is let go of that nobody took."""


def _lets_go_of_nothing(plan: Plan) -> bool:
    """Whether something is put or given that was surely never taken."""
    try:
        _after(plan.steps, Hand.UNKNOWN)
    except _Nothing:
        return True
    return False


def _after(steps: tuple[Step, ...], hand: Hand) -> Hand:
    for step in steps:
        match step:
            case Call(method="grab"):
                hand = Hand.FULL
            case Call(method=method, arguments=arguments) if method in LETTING_GO:
                thing = arguments.get("thing")
                # Nobody can have been given in advance what an answer will be.
                known = isinstance(thing, Text) or hand is Hand.FULL
                if hand is Hand.EMPTY or not known:
                    raise _Nothing
                hand = Hand.EMPTY
            case If():
                hand = _either(_after(step.then, hand), _after(step.otherwise, hand))
            case Try():
                hand = _either(_after(step.steps, hand), _after(step.otherwise, hand))
            case Repeat() | ForEach() | While() | RepeatUntil() | Forever():
                once = _after(step.steps, hand)
                hand = _either(hand, _after(step.steps, once))
            case _:
                pass
    return hand


def _either(one: Hand, other: Hand) -> Hand:
    """What may be in the hand where two ways meet: only what is so on both is known."""
    return one if one is other else Hand.UNKNOWN


# --- finding out ---------------------------------------------------------------------------------


def _finds_out_twice(plan: Plan) -> bool:
    """Whether two rounds in a row go over the same places or people and find out the same."""
    return any(_repeats(each) for each in _rows(plan.steps))


def _rows(steps: tuple[Step, ...]) -> list[tuple[Step, ...]]:
    """The steps and all rows of steps inside them."""
    found = [steps]
    for step in steps:
        for name in ("steps", "then", "otherwise"):
            inner: tuple[Step, ...] = getattr(step, name, ())
            if inner:
                found += _rows(inner)
    return found


def _repeats(steps: tuple[Step, ...]) -> bool:
    done: list[tuple[object, frozenset[str]]] = []
    for step in steps:
        if isinstance(step, ForEach):
            asked = _questions(step)
            if asked and any(items == step.items and asked & before for items, before in done):
                return True
            done.append((step.items, asked))
        elif _changes_something(step):
            done.clear()
    return False


def _questions(step: ForEach) -> frozenset[str]:
    """What a round finds out, each named in one way whatever the round calls its place."""
    return frozenset(
        repr(
            (
                node.method,
                [(name, value) for name, value in node.arguments.items() if name != "person"],
            )
        ).replace(repr(Recall(step.variable)), "it")
        for node in nodes(step.steps)
        if isinstance(node, Call | Ask) and node.method in FINDING_OUT
    )


def _changes_something(step: Step) -> bool:
    """Whether it may be different after a step: time has passed, or something was moved."""
    if isinstance(step, Remember | Collect | Increase):
        return False
    return any(
        isinstance(node, Call | Ask) and node.method in {"wait", "wait_for", "put", "give", "guide"}
        for node in nodes(step)
    )


__all__ = ["Doubt", "implausible"]
