"""Times of day in a plan are moments that come, not texts to be compared.

Whoever understands a sentence compares what the clock shows with a time: "until six" is until it
shows 06:00 or more. Said in the evening, that is so at once, as "06:00" is less than "20:00"; and
nothing is less than "00:00". So what only waits for a time waits for the moment when it comes next
(`wait_until`), and what is done until a time ends when it has come since the beginning.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final, TypeVar

import msgspec

from grammar import plan as p
from grammar.traversal import nodes, rebuilt

SHOWN: Final = p.Ask("clock", field="time")
BEGIN: Final = "begin"
_Loop = p.While | p.RepeatUntil | p.Forever

Part = TypeVar("Part", bound=p.Node)


def by_the_clock(plan: p.Plan, whiles: bool = False) -> p.Plan:
    """The plan with the moments that its times mean. What depends on how late it is ("if it is
    after six") stays as it is; so does what is done while it is before a time ("as long as it is
    before noon"), but for `whiles`: of who writes "until noon" like that."""
    if SHOWN not in nodes(plan.steps):
        return plan
    return msgspec.structs.replace(plan, steps=_Reading(plan, whiles).steps(plan.steps))


def outside_of(first: str, last: str) -> p.Condition:
    """Whether it is not between two times of day, which may have midnight between them."""
    early = p.Compare(SHOWN, "<", p.Text(first))
    late = p.Compare(SHOWN, ">=", p.Text(last))
    return p.Either((early, late)) if first < last else p.Both((early, late))


class _Reading:
    def __init__(self, plan: p.Plan, whiles: bool) -> None:
        self.whiles = whiles
        self.names = {
            getattr(each, field)
            for each in nodes(plan.steps)
            for field in ("name", "save_as", "variable", "problem")
            if hasattr(each, field)
        }

    def steps(self, steps: Iterable[p.Step]) -> tuple[p.Step, ...]:
        return tuple(each for step in steps for each in self.step(step))

    def step(self, step: p.Step) -> tuple[p.Step, ...]:
        if (time := awaited_time(step)) is not None:
            return (p.Call("wait_until", {"time": time}),)
        if isinstance(step, _Loop):
            return self.loop(step)
        return (self.inside(step),)

    def inside(self, step: Part) -> Part:
        """The step with what is in it read so; conditions and values are not steps."""
        fields = {
            name: self.steps(value)
            for name in ("steps", "then", "otherwise")
            if (value := getattr(step, name, None)) is not None
        }
        return msgspec.structs.replace(step, **fields)

    def loop(self, loop: _Loop) -> tuple[p.Step, ...]:
        """A loop that ends at a time, with the moment of its beginning before it."""
        begin = self.new_name()
        since = p.Recall(begin)
        steps = tuple(_leaving(each, since) for each in loop.steps)
        changed: _Loop = msgspec.structs.replace(loop, steps=steps)
        if isinstance(changed, p.RepeatUntil) or (self.whiles and isinstance(changed, p.While)):
            ended = _until(changed.condition, since)
            changed = msgspec.structs.replace(changed, condition=ended)
        if changed == loop:
            return (self.inside(loop),)
        self.names.add(begin)
        return (p.Remember(begin, p.Ask("clock")), self.inside(changed))

    def new_name(self) -> str:
        number, name = 1, BEGIN
        while name in self.names:
            number, name = number + 1, f"{BEGIN}{number + 1}"
        return name


def awaited_time(step: p.Step) -> p.Value | None:
    """The time of day that a step waits for, doing nothing else."""
    match step:
        case p.While(
            condition=p.Compare(left=left, operator="<" | "!=", right=p.Text() as time),
            steps=(p.Call(method="wait"),) | (),
        ) if left == SHOWN:
            return time
        case _:
            return None


def _leaving(step: p.Step, since: p.Recall) -> p.Step:
    """What leaves the loop at a time, when that has come."""
    match step:
        case p.If(condition=condition, then=(p.End(),)):
            return msgspec.structs.replace(step, condition=_until(condition, since))
        case _:
            return step


def _until(condition: p.Condition, since: p.Recall) -> p.Condition:
    match condition:
        case p.Compare(left=left, operator=">=" | "==", right=p.Text() as time) if left == SHOWN:
            return p.Holds(p.HasCome(time, since))
        case p.Compare(left=left, operator="<", right=p.Text() as time) if left == SHOWN:
            return p.Not(p.Holds(p.HasCome(time, since)))
        case p.Both() | p.Either() | p.Not():
            return rebuilt(condition, lambda each: _until(each, since))
        case _:
            return condition
