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
            case p.Text() | p.Sentence():
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
            case p.Length() | p.Share():
                return "int"
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


# --- time ----------------------------------------------------------------------------------------


def _slow(name: str) -> bool:
    """Whether the method keeps the robot busy for a moment, so that a loop of it does not spin."""
    method = METHODS.get(name)
    if method is None:
        return False
    return method.moves or name in ("say", "wait", "wait_for") or "TimedOut" in method.errors


def takes_time(part: tuple[p.Step, ...] | p.Step | p.Condition | p.Value) -> bool:
    """Whether it is certain that the robot is busy for a moment when this is done once."""
    match part:
        case tuple():
            return any(takes_time(each) for each in part)
        case p.Call() | p.Ask():
            return _slow(part.method) or any(takes_time(each) for each in part.arguments.values())
        case p.Remember() | p.Collect() | p.Holds():
            return takes_time(part.value)
        case p.If():
            return takes_time(part.condition) or (
                takes_time(part.then) and takes_time(part.otherwise)
            )
        case p.Try():
            return takes_time(part.steps) and takes_time(part.otherwise)
        case p.Repeat(times=p.Number(value=times)):
            return times >= 1 and takes_time(part.steps)
        case p.While():
            return takes_time(part.condition)
        case p.RepeatUntil() | p.Forever() | p.End():
            return True
        case p.Compare():
            return takes_time(part.left) or takes_time(part.right)
        case p.Not():
            return takes_time(part.condition)
        case p.Both() | p.Either():
            # Only the first is looked at in any case.
            return bool(part.conditions) and takes_time(part.conditions[0])
        case p.Sentence():
            return any(takes_time(each) for each in part.parts)
        case p.Items():
            return any(takes_time(each) for each in part.items)
        case p.Length() | p.Share() | p.Choice():
            inner = (part.part, part.whole) if isinstance(part, p.Share) else ()
            single = (
                ()
                if isinstance(part, p.Share)
                else (part.of if isinstance(part, p.Length) else part.among,)
            )
            return any(takes_time(each) for each in (*inner, *single))
        case _:
            return False
