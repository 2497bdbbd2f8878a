"""What kind of value everything in a plan is, so far as the method table tells.

Programs need it in a few spots only: texts are compared in lower case, what was heard has to be
made a number before it can be counted with, a list is spoken with commas.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, Final, assert_never

from grammar import plan as p
from robot_api.methods import METHODS, Method, Parameter

_FIELDS: Final = {
    ("location", "x"): "float",
    ("location", "y"): "float",
    ("location", "theta"): "float",
    ("location", "place"): "str",
    ("clock", "time"): "str",
    ("clock", "weekday"): "str",
    ("clock", "date"): "str",
}


def form_for(method: Method, arguments: Mapping[str, Any]) -> tuple[Parameter, ...] | None:
    """The form of the method that takes these arguments, or None."""
    for form in method.forms:
        known = {parameter.name for parameter in form}
        required = {parameter.name for parameter in form if parameter.required}
        if required <= arguments.keys() and (method.extra or arguments.keys() <= known):
            return form
    return None


class Types:
    """The kinds of a plan's values: "str", "int", "float", "bool", "list[str]", "Location",
    "Clock", "None", or "Any" where nobody knows."""

    def __init__(self, plan: p.Plan) -> None:
        self.names: dict[str, str] = {}
        """Every name the plan gives, in order, with the kind of its value."""
        for step in walk(plan.steps):
            match step:
                case p.Call(save_as=str() as name):
                    self._learn(name, self.of(p.Ask(step.method)))
                case p.Remember():
                    self._learn(step.name, self.of(step.value))
                case p.ForEach():
                    kind = self.of(step.items)
                    item = kind.removeprefix("list[").removesuffix("]")
                    self._learn(step.variable, item if kind.startswith("list[") else "Any")
                case p.Increase():
                    self._learn(step.name, "int")
                case p.Collect():
                    # The list was made empty; this is the first that is known of its items.
                    self.names[step.name] = f"list[{self.of(step.value)}]"
                case _:
                    pass

    def _learn(self, name: str, kind: str) -> None:
        known = self.names.setdefault(name, kind)
        if known != kind:
            self.names[name] = "float" if {known, kind} == {"int", "float"} else "Any"

    def of(self, value: p.Value) -> str:
        match value:
            case p.Text() | p.Sentence() | p.Weekday():
                return "str"
            case p.Number():
                return "int" if float(value.value).is_integer() else "float"
            case p.Truth():
                return "bool"
            case p.Recall():
                return self.names.get(value.name, "Any")
            case p.Items():
                kinds = {self.of(item) for item in value.items}
                return f"list[{kinds.pop()}]" if len(kinds) == 1 else "list[Any]"
            case p.Ask(field=str() as field):
                return _FIELDS.get((value.method, field), "Any")
            case p.Ask():
                method = METHODS.get(value.method)
                return method.returns.annotation if method else "Any"
            case p.Length() | p.Share() | p.Elapsed():
                return "int"
            case p.Figure():
                return "float" if value.how == "average" else "int"
            case p.Choice():
                kind = self.of(value.among)
                known = kind.startswith("list[")
                return kind.removeprefix("list[").removesuffix("]") if known else "Any"
            case _:
                assert_never(value)


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


Steps = tuple[p.Step, ...]


# --- time ----------------------------------------------------------------------------------------


def _slow(name: str) -> bool:
    """Whether the method keeps the robot busy for a moment, so that a loop of it does not spin."""
    method = METHODS.get(name)
    if method is None:
        return False
    return method.moves or name in ("say", "wait", "wait_for") or "TimedOut" in method.errors


def takes_time(part: Steps | p.Condition | p.Value) -> bool:
    """Whether it is certain that the robot is busy for a moment when this is done once, as the
    body of a loop or its condition. Leaving that loop is as good."""
    match part:
        case tuple():
            return _steps_take_time(part, may_leave=True)
        case p.Holds():
            return takes_time(part.value)
        case p.Compare():
            return takes_time(part.left) or takes_time(part.right)
        case p.Not():
            return takes_time(part.condition)
        case p.Both() | p.Either():
            # Only the first is looked at in any case.
            return bool(part.conditions) and takes_time(part.conditions[0])
        case p.Ask():
            return _slow(part.method) or any(map(takes_time, part.arguments.values()))
        case p.Sentence():
            return any(map(takes_time, part.parts))
        case p.Items():
            return any(map(takes_time, part.items))
        case p.Length():
            return takes_time(part.of)
        case p.Share():
            return takes_time(part.part) or takes_time(part.whole)
        case p.Figure():
            return takes_time(part.of)
        case p.Choice():
            return takes_time(part.among)
        case p.Elapsed():
            return takes_time(part.since)
        case _:
            return False


def _steps_take_time(steps: Steps, may_leave: bool) -> bool:
    """The same for steps; `may_leave`: whether an `End` among them leaves the loop asked about,
    and not one within it."""
    for step in steps:
        if isinstance(step, p.End):
            return may_leave
        if _step_takes_time(step, may_leave):
            return True
        if not may_leave and may_end(step):
            return False
    return False


def _step_takes_time(step: p.Step, may_leave: bool) -> bool:
    match step:
        case p.Call():
            return takes_time(p.Ask(step.method, step.arguments))
        case p.Remember() | p.Collect():
            return takes_time(step.value)
        case p.If():
            return takes_time(step.condition) or (
                _steps_take_time(step.then, may_leave)
                and _steps_take_time(step.otherwise, may_leave)
            )
        case p.Try():
            # What fails may fail at once.
            return _steps_take_time(step.steps, may_leave) and _steps_take_time(
                step.otherwise, may_leave
            )
        case p.Repeat(times=p.Number(value=times)):
            return times >= 1 and _steps_take_time(step.steps, may_leave=False)
        case p.While():
            return takes_time(step.condition)
        case p.RepeatUntil() | p.Forever():
            # A pause is written into them where nothing else takes time.
            return _steps_take_time(step.steps, may_leave=False) or not any(
                map(may_end, step.steps)
            )
        case _:
            return False


def may_end(step: p.Step) -> bool:
    """Whether the step can leave the loop that it is in."""
    match step:
        case p.End():
            return True
        case p.If():
            return any(map(may_end, (*step.then, *step.otherwise)))
        case p.Try():
            return any(map(may_end, (*step.steps, *step.otherwise)))
        case _:
            return False
