"""Whether a plan makes sense as a whole: a sentence whose words were all read may still have been
put together wrongly, and then the robot would put down what it never took, or ask everybody twice.
Such a plan is no understanding, however well each part of it was read; it is refused.

What is looked for are mistakes of reading that no speaker means, not plans that may fail: whether a
thing will be there is for the dry run to find out.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Final

from grammar.plan import (
    Ask,
    Call,
    Choice,
    Collect,
    ForEach,
    Forever,
    If,
    Increase,
    Items,
    Plan,
    Remember,
    Repeat,
    RepeatUntil,
    SetItem,
    Step,
    Text,
    Try,
    Value,
    While,
)
from grammar.tidy import nodes

LETTING_GO: Final = frozenset({"put", "give"})
FINDING_OUT: Final = frozenset({"ask", "sees", "find", "count", "people", "objects", "describe"})
"""Methods that tell the robot something."""
WHERE_AND_WHOM: Final = frozenset({"person", "place"})
"""Parameters of these that the round itself fills in."""
EVERYWHERE: Final = Ask("places")
PRESENT: Final = Ask("people")


class Doubt(Enum):
    """What makes no sense in a plan; the value is the name of the phrase that says so."""

    EMPTY_HANDED = "empty_handed"
    FULL_HANDED = "taken_twice"
    TWICE = "found_out_twice"


def implausible(plan: Plan) -> Doubt | None:
    """What makes no sense in a plan, if anything does."""
    return _handled(plan) or (Doubt.TWICE if _finds_out_twice(plan) else None)


# --- hands ---------------------------------------------------------------------------------------


class _Senseless(Exception):
    def __init__(self, doubt: Doubt) -> None:
        super().__init__(doubt.value)
        self.doubt = doubt


@dataclass(frozen=True)
class Hand:
    """What a robot has in its hand at some point of a plan."""

    known: bool
    """Whether that can be told: at first it may hold what somebody has given it."""
    thing: Value | None = None
    """What it has taken last, if it still has it."""


def _handled(plan: Plan) -> Doubt | None:
    """Whether something is put or given that was surely never taken, or taken when it surely is in
    the hand already."""
    try:
        _after(plan.steps, Hand(known=False))
    except _Senseless as senseless:
        return senseless.doubt
    return None


def _after(steps: tuple[Step, ...], hand: Hand) -> Hand:
    for step in steps:
        match step:
            case Call(method="grab", arguments=arguments):
                thing = arguments.get("thing")
                if isinstance(thing, Text) and thing == hand.thing:
                    raise _Senseless(Doubt.FULL_HANDED)
                hand = Hand(known=True, thing=thing)
            case Call(method=method, arguments=arguments) if method in LETTING_GO:
                # Nobody can have been given in advance what an answer will be.
                given = not hand.known and isinstance(arguments.get("thing"), Text)
                if hand.thing is None and not given:
                    raise _Senseless(Doubt.EMPTY_HANDED)
                hand = Hand(known=True)
            case If():
                hand = _either(_after(step.then, hand), _after(step.otherwise, hand))
            case Try():
                hand = _either(_after(step.steps, hand), _after(step.otherwise, hand))
            case Repeat() | ForEach() | While() | RepeatUntil() | Forever():
                once = _after(step.steps, hand)
                if once.thing is not None:  # in the next round another such thing may be taken
                    once = Hand(known=True, thing=Choice(Items((once.thing,))))
                hand = _either(hand, _after(step.steps, once))
            case _:
                pass
    return hand


def _either(one: Hand, other: Hand) -> Hand:
    """What may be in the hand where two ways meet: only what is so on both is known."""
    if one == other:
        return one
    if one.thing is not None and other.thing is not None:
        return Hand(known=True, thing=Choice(Items((one.thing, other.thing))))
    return Hand(known=False)


# --- finding out ---------------------------------------------------------------------------------


def _finds_out_twice(plan: Plan) -> bool:
    """Whether two rounds in a row go over the same places or people, or the second one over all
    places there are, and find out the same."""
    return any(_repeats(each) for each in rows(plan.steps))


def rows(steps: tuple[Step, ...]) -> list[tuple[Step, ...]]:
    """The steps and all rows of steps inside them."""
    found = [steps]
    for step in steps:
        for name in ("steps", "then", "otherwise"):
            inner: tuple[Step, ...] = getattr(step, name, ())
            if inner:
                found += rows(inner)
    return found


def _repeats(steps: tuple[Step, ...]) -> bool:
    done: list[tuple[object, frozenset[str]]] = []
    here: Value | None = None
    for step in steps:
        if isinstance(step, Call) and step.method == "goto":
            here = step.arguments.get("place")
        if isinstance(step, ForEach):
            asked = _questions(step)
            # whoever is in the lobby is not whoever is in the kitchen
            among = (step.items, here) if step.items == PRESENT else step.items
            if any(asked & before and among in (those, EVERYWHERE) for those, before in done):
                return True
            done.append((among, asked))
        elif _changes_something(step):
            done.clear()
    return False


def _questions(step: ForEach) -> frozenset[str]:
    """What a round finds out, whatever it calls its place: to look for a cup and to see whether
    there is one is the same."""
    found: set[str] = set()
    for node in nodes(step.steps):
        if isinstance(node, Call | Ask) and node.method in FINDING_OUT:
            asked = [item for item in node.arguments.items() if item[0] not in WHERE_AND_WHOM]
            method = "sees" if node.method == "find" else node.method
            found.add(repr((method, asked)))
    return frozenset(found)


def _changes_something(step: Step) -> bool:
    """Whether it may be different after a step: time has passed, or something was moved."""
    if isinstance(step, Remember | Collect | Increase | SetItem):
        return False
    return any(
        isinstance(node, Call | Ask) and node.method in {"wait", "wait_for", "put", "give", "guide"}
        for node in nodes(step)
    )


__all__ = ["Doubt", "implausible", "rows"]
