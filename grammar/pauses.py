"""Pauses in loops that would otherwise ask the robot something as fast as the computer can.

A plan says nothing of them: `with_pauses` puts them where a program needs them, `without_pauses`
takes the same ones out again.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import zip_longest
from typing import Any, Final, TypeVar

import msgspec

from grammar import plan as p
from grammar.traversal import rebuilt
from robot_api.methods import METHODS

PAUSE: Final = p.Call("wait", {"seconds": p.Number(1)})

Steps = tuple[p.Step, ...]
Loop = p.While | p.RepeatUntil | p.Forever
"""Loops without a number of rounds."""


# --- time ----------------------------------------------------------------------------------------


def takes_time(part: Steps | p.Condition | p.Value) -> bool:
    """Whether it is certain that the robot is busy for a moment when this is done once, as the
    body of a loop or its condition. Leaving that loop is as good."""
    match part:
        case tuple():
            return _steps_take_time(part, own=True)
        case p.Both() | p.Either():
            # Only the first is looked at in any case.
            return bool(part.conditions) and takes_time(part.conditions[0])
        case p.Ask() if _slow(part.method):
            return True
        case _:
            return any(takes_time(each) for each in _inside(part))


def _inside(value: p.Value | p.Condition) -> list[p.Value | p.Condition]:
    """The values that a value is made of."""
    found: list[p.Value | p.Condition] = []

    def note(each: p.Value) -> p.Value:
        found.append(each)
        return each

    rebuilt(value, note)
    return found


def _slow(name: str) -> bool:
    """Whether the method keeps the robot busy for a moment, so that a loop of it does not spin."""
    method = METHODS.get(name)
    if method is None:
        return False
    return (
        method.moves
        or name in ("say", "wait", "wait_until", "wait_for")
        or "TimedOut" in method.errors
    )


def _steps_take_time(steps: Steps, own: bool) -> bool:
    """The same for steps; `own`: whether an `End` or `Continue` among them is one of the loop asked
    about, and not of one within it."""
    for step in steps:
        if isinstance(step, p.End | p.Continue):
            return own
        if _step_takes_time(step, own):
            return True
        if not own and may_leave_round(step):
            return False
    return False


def _step_takes_time(step: p.Step, own: bool) -> bool:
    match step:
        case p.Call():
            return takes_time(p.Ask(step.method, step.arguments))
        case p.Remember() | p.Collect():
            return takes_time(step.value)
        case p.If():
            return takes_time(step.condition) or (
                _steps_take_time(step.then, own) and _steps_take_time(step.otherwise, own)
            )
        case p.Try():
            # What fails may fail at once.
            return _steps_take_time(step.steps, own) and _steps_take_time(step.otherwise, own)
        case p.Repeat(times=p.Number(value=times)):
            return times >= 1 and _steps_take_time(step.steps, own=False)
        case p.While():
            return takes_time(step.condition)
        case p.RepeatUntil() | p.Forever():
            # A pause is written into them where nothing else takes time.
            return _steps_take_time(step.steps, own=False) or not any(
                map(may_leave_round, step.steps)
            )
        case _:
            return False


def may_end(step: p.Step) -> bool:
    """Whether the step can leave the loop that it is in."""
    return _may_meet(step, (p.End,))


def may_leave_round(step: p.Step) -> bool:
    """Whether the step can leave the round, or the loop, that it is in."""
    return _may_meet(step, (p.End, p.Continue))


def _may_meet(step: p.Step, what: tuple[type[p.Node], ...]) -> bool:
    match step:
        case p.If():
            return any(_may_meet(each, what) for each in (*step.then, *step.otherwise))
        case p.Try():
            return any(_may_meet(each, what) for each in (*step.steps, *step.otherwise))
        case _:
            return isinstance(step, what)


# --- pauses --------------------------------------------------------------------------------------

Part = TypeVar("Part", bound=p.Plan | p.Node)


def with_pauses(part: Part) -> Part:
    """A plan with a pause in each loop that would spin: at the end of a round, and before a round
    is cut short."""
    paused: Part = _paused_loop(part) if isinstance(part, Loop) else part
    inside: Part = rebuilt(paused, with_pauses)
    return inside


def without_pauses(part: Part) -> Part:
    """The plan without the pauses that `with_pauses` puts into it."""
    inside = rebuilt(part, without_pauses)
    unpaused: Part = _unpaused_loop(inside) if isinstance(inside, Loop) else inside
    return unpaused


def _paused_loop(loop: Loop) -> Any:
    steps = tuple(_paused(loop.steps, _begins_slowly(loop)))
    if not (_ends_slowly(loop) or takes_time(loop.steps)):
        steps = (*steps, PAUSE)
    return msgspec.structs.replace(loop, steps=steps)


def _unpaused_loop(loop: Loop) -> Any:
    steps = tuple(_unpaused(loop.steps, _begins_slowly(loop)))
    rest = steps[:-1]
    needless = steps[-1:] == (PAUSE,) and not (_ends_slowly(loop) or takes_time(rest))
    # Where a loop is left before the pause, the pause is no part of the last round.
    if needless and not (isinstance(loop, p.Forever) and _leaves_at_end(rest)):
        steps = rest
    return msgspec.structs.replace(loop, steps=steps)


def _begins_slowly(loop: Loop) -> bool:
    return isinstance(loop, p.While) and takes_time(loop.condition)


def _ends_slowly(loop: Loop) -> bool:
    """Whether what is found out after a round takes time."""
    return not isinstance(loop, p.Forever) and takes_time(loop.condition)


def _leaves_at_end(steps: Steps) -> bool:
    match steps[-1:]:
        case (p.If(then=(p.End(),), otherwise=()),):
            return True
        case _:
            return False


def _paused(steps: Steps, took: bool) -> Iterator[p.Step]:
    """The steps of a round with a pause before each way to cut it short; `took`: whether time has
    passed in it already."""
    for step in steps:
        if isinstance(step, p.Continue) and not took:
            yield PAUSE
        yield _in_branches(step, took, _paused)
        took = took or _step_takes_time(step, own=True)


def _unpaused(steps: Steps, took: bool) -> Iterator[p.Step]:
    for step, following in zip_longest(steps, steps[1:]):
        if step == PAUSE and isinstance(following, p.Continue) and not took:
            continue
        yield _in_branches(step, took, _unpaused)
        took = took or _step_takes_time(step, own=True)


def _in_branches(
    step: p.Step, took: bool, change: Callable[[Steps, bool], Iterator[p.Step]]
) -> p.Step:
    match step:
        case p.If(condition=condition, then=then, otherwise=otherwise):
            took = took or takes_time(condition)
            then, otherwise = tuple(change(then, took)), tuple(change(otherwise, took))
            return msgspec.structs.replace(step, then=then, otherwise=otherwise)
        case p.Try(steps=steps, otherwise=otherwise):
            steps, otherwise = tuple(change(steps, took)), tuple(change(otherwise, took))
            return msgspec.structs.replace(step, steps=steps, otherwise=otherwise)
        case _:
            return step
