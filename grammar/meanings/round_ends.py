"""The end of what goes on, at the place where something is so: "go from ward to ward and stop as
soon as you see Bob", "look in every office for the book until you find it".

A round of places has an end of its own, and a search ends with what it finds. Neither is done again
and again, and nobody waits at the first place for what may be at the next.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, TypeGuard

from msgspec.structs import replace as structs_replace

from grammar.discourse import Discourse, Steps, Thing
from grammar.meanings.finding import not_found
from grammar.plan import (
    Ask,
    Call,
    Condition,
    End,
    ForEach,
    Holds,
    If,
    Not,
    Recall,
    Step,
    Text,
    Value,
)
from grammar.tidy import nodes

STOP: Final = Call("stop")


def ended_there(d: Discourse, looking: Steps, condition: Condition) -> Steps | None:
    """The steps that end the round around them, the round before them, or the search before them,
    where something is so; None if nothing of the kind goes on."""
    if d.loops.in_loop:
        return [*looking, _ending(condition)]
    lookout = d.round.lookout
    if lookout is not None and is_sight(condition):
        lookout.until_found(d)
        return []
    last = d.done[-1] if d.done else None
    if last is not None and seeks(last, condition):
        return []
    sought = _sought(condition)
    if sought is not None and "place" in sought[0].arguments and len(sought) > 1:
        return [If(Not(condition), (not_found(d, _spoken_of(d, sought[0].arguments["thing"])),))]
    if last is not None and goes_round(last):
        d.done.pop()
        return round_until(last, looking, condition)
    return None


def round_until(loop: ForEach, looking: Sequence[Step], condition: Condition) -> Steps:
    """A round that ends at the first place where something is so."""
    return [structs_replace(loop, steps=(*loop.steps, *looking, _ending(condition)))]


def _ending(condition: Condition) -> If:
    """The end of a round; what is to be found is looked for at each place of it."""
    match condition:
        case Holds(value=Ask(method="find", arguments={"thing": thing, **more})) if not more:
            condition = Holds(Ask("sees", {"thing": thing}))
    return If(condition, (End(),))


def goes_round(step: Step) -> TypeGuard[ForEach]:
    """Whether a step goes from place to place."""
    if not isinstance(step, ForEach):
        return False
    return Call("goto", {"place": Recall(step.variable)}) in step.steps


def is_sight(condition: Condition) -> bool:
    """Whether it is that something is seen or found where the robot is."""
    match condition:
        case Holds(value=Ask(method="sees" | "find", arguments={"thing": Text(), **more})):
            return not more
        case _:
            return False


def seeks(step: Step, condition: Condition) -> bool:
    """Whether a step looks at several places for what is to be found."""
    sought = _sought(condition)
    if sought is None:
        return False
    thing = sought[0].arguments["thing"]
    return any(
        each.method == "find" and each.arguments.get("thing") == thing and "place" in each.arguments
        for each in nodes(step)
        if isinstance(each, Call | Ask)
    )


def _sought(condition: Condition) -> list[Ask] | None:
    """The looks by which one thing is found, if a condition is nothing else."""
    asked = [each for each in nodes(condition) if isinstance(each, Ask)]
    things = [each.arguments.get("thing") for each in asked]
    if not asked or None in things or any(each != things[0] for each in things):
        return None
    return asked if all(each.method in ("find", "sees") for each in asked) else None


def _spoken_of(d: Discourse, value: Value) -> Thing:
    known = (d.scene.thing, d.scene.person)
    return next((each for each in known if each is not None and each.value == value), Thing(value))
