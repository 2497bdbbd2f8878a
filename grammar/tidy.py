"""Tidying of a finished plan: names that nothing uses, steps that hang on what may not happen."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Final

import msgspec

from grammar.discourse import START
from grammar.plan import (
    Ask,
    Call,
    Collect,
    ForEach,
    Forever,
    Holds,
    If,
    Increase,
    Items,
    Node,
    Not,
    Number,
    Plan,
    Recall,
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
from grammar.traversal import nodes as nodes
from robot_api.methods import METHODS

BODIES: Final = ("steps", "then", "otherwise")
"""Parts of a step that are steps themselves."""


LOOPS: Final = (Repeat, ForEach, While, RepeatUntil, Forever)


class Unbound(Exception):
    """A step uses a name that nothing before it gives; `name` is the name."""

    def __init__(self, name: str) -> None:
        super().__init__(f"nothing gives {name!r}")
        self.name = name


def scoped(plan: Plan) -> Plan:
    """The plan with every step where all that it refers to is known: what needs the answer of
    somebody who may not be found, or of a loop that may have no round, is moved in there, with all
    that stands between. Raises `Unbound` if a name is given nowhere."""
    return msgspec.structs.replace(plan, steps=_scoped(plan.steps, frozenset()))


def _scoped(steps: tuple[Step, ...], known: frozenset[str]) -> tuple[Step, ...]:
    done: list[Step] = []
    bound = [known]
    for step in steps:
        if done and isinstance(done[-1], Forever):
            # What follows a loop without end would never be done: it belongs to each round.
            done[-1] = in_each_round(done[-1], step)
            continue
        done.append(step)
        while (missing := _missing(done[-1], bound[-1])) is not None:
            giver = max(
                (at for at, each in enumerate(done[:-1]) if missing in gives(each)), default=None
            )
            if giver is None:
                raise Unbound(missing)
            done[giver:] = [_taking_in(done[giver], missing, tuple(done[giver + 1 :]))]
            del bound[giver + 1 :]
        bound.append(bound[-1] | _surely(done[-1]))
    result: list[Step] = []
    for step, before in zip(done, bound, strict=False):
        inside = before | (loop_names(step) if isinstance(step, ForEach) else set())
        inner = {name: _scoped(body, inside) for name in BODIES if (body := _body(step, name))}
        result.append(msgspec.structs.replace(step, **inner) if inner else step)
    return tuple(result)


def _missing(step: Step, known: frozenset[str]) -> str | None:
    """A name that a step uses before it or anything inside it could have given it."""
    given = known | gives(step)
    own = [value for value in _heads(step) if isinstance(value, Recall)]
    inner = [value for value in nodes(step) if isinstance(value, Recall)]
    for value in own:
        if value.name not in known and not isinstance(step, RepeatUntil):
            return value.name
    for value in inner:
        if value.name not in given:
            return value.name
    return None


def _heads(step: Step) -> Iterator[Node]:
    """All values in a step itself, not in the steps inside it."""
    for name in step.__struct_fields__:
        if name not in BODIES:
            yield from nodes(getattr(step, name))


def _body(step: Step, name: str) -> tuple[Step, ...]:
    body: tuple[Step, ...] = getattr(step, name, ())
    return body


def gives(step: Step) -> frozenset[str]:
    """The names that a step or a step inside it gives."""
    found: set[str] = set()
    for each in nodes(step):
        if isinstance(each, Call) and each.save_as:
            found.add(each.save_as)
        elif isinstance(each, Remember):
            found.add(each.name)
        elif isinstance(each, ForEach):
            found |= loop_names(each)
        elif isinstance(each, Try) and each.problem:
            found.add(each.problem)
    return frozenset(found)


def loop_names(loop: ForEach) -> set[str]:
    """The names that what a loop goes over has inside it."""
    return {loop.variable} | ({loop.value} if loop.value else set())


def _surely(step: Step) -> frozenset[str]:
    """The names that are given after a step, whatever happens."""
    match step:
        case Call(save_as=str(name)) | Remember(name=name):
            return frozenset({name})
        case If():
            return _all_of(step.then) & _all_of(step.otherwise)
        case Repeat(times=Number(value=times)) if times >= 1:
            return _all_of(step.steps)
        case RepeatUntil() | Forever():
            return _all_of(step.steps)
        case Try():
            return _all_of(step.steps) & _all_of(step.otherwise)
        case _:
            return frozenset()


def _all_of(steps: tuple[Step, ...]) -> frozenset[str]:
    return frozenset().union(*(_surely(step) for step in steps))


def _taking_in(step: Step, name: str, more: tuple[Step, ...]) -> Step:
    """A step with others put at the end of the steps inside it that give a name."""
    match step:
        case If() if name not in _all_given(step.then):
            return msgspec.structs.replace(step, otherwise=(*step.otherwise, *more))
        case If() if name in _all_given(step.otherwise):  # either of two may have been asked
            both = {side: (*getattr(step, side), *more) for side in ("then", "otherwise")}
            return msgspec.structs.replace(step, **both)
        case If():
            back = tuple(each for each in more if _goes_back(each))[:1]
            otherwise = (*back, *step.otherwise) if step.otherwise else back
            return msgspec.structs.replace(step, then=(*step.then, *more), otherwise=otherwise)
        case Repeat() | ForEach() | While() | RepeatUntil() | Forever() | Try():
            return msgspec.structs.replace(step, steps=(*step.steps, *more))
        case _:
            raise Unbound(name)


def _all_given(steps: tuple[Step, ...]) -> frozenset[str]:
    return frozenset().union(*(gives(step) for step in steps))


def _goes_back(step: Step) -> bool:
    """Whether it goes to a remembered place: news of a failure are told there, too."""
    return isinstance(step, Call) and step == Call("goto", {"place": Recall(START)})


def charging_last(plan: Plan) -> Plan:
    """The plan with charging behind a round that ends with it: "visit every ward and then go back
    to your charger" is one way to the charger."""
    return msgspec.structs.replace(plan, steps=_charging_last(plan.steps))


def _charging_last(steps: tuple[Step, ...]) -> tuple[Step, ...]:
    result: list[Step] = []
    for step in steps:
        inner = {name: _charging_last(body) for name in BODIES if (body := _body(step, name))}
        step = msgspec.structs.replace(step, **inner) if inner else step
        result.append(step)
        if isinstance(step, ForEach) and len(step.steps) > 1 and step.steps[-1] == Call("dock"):
            result[-1] = msgspec.structs.replace(step, steps=step.steps[:-1])
            result.append(Call("dock"))
    return tuple(result)


def returning(plan: Plan) -> Plan:
    """The plan with a way back at the end of each round that begins with waiting for somebody and
    leads away: the next one is waited for where the first was."""
    steps = _returning(plan.steps, Recall(START))
    first = Remember(START, Ask("location"))
    if mentions(steps, Recall(START)) and first not in steps:
        steps = (first, *steps)
    return msgspec.structs.replace(plan, steps=steps)


def _returning(steps: tuple[Step, ...], here: Value) -> tuple[Step, ...]:
    result: list[Step] = []
    for step in steps:
        inner = {name: _returning(body, here) for name in BODIES if (body := _body(step, name))}
        step = msgspec.structs.replace(step, **inner) if inner else step
        if isinstance(step, ForEach) and step.items == Ask("people"):
            step = msgspec.structs.replace(step, steps=_coming_back(step.steps, here))
        elif isinstance(step, LOOPS) and _leaves(step.steps):
            back = Call("goto", {"place": here})
            only = step.steps[0]
            if isinstance(only, If) and len(step.steps) == 1 and not only.otherwise:
                steps_back = (msgspec.structs.replace(only, then=(*only.then, back)),)
                step = msgspec.structs.replace(step, steps=steps_back)
            else:
                step = msgspec.structs.replace(step, steps=(*step.steps, back))
        if isinstance(step, Call) and step.method == "goto" and "place" in step.arguments:
            if result[-1:] == [step]:
                continue  # "go to the hall, and when you see Bob there, ..."
            here = step.arguments["place"]
        result.append(step)
    return tuple(result)


def _coming_back(steps: tuple[Step, ...], here: Value) -> tuple[Step, ...]:
    """A round with one of those who are at a place, with a way back to the next of them where it
    leads away: "ask everybody in the lobby ..., and take those who say yes to the lecture hall"."""
    first, last = (steps[0], steps[-1]) if steps else (None, None)
    if isinstance(first, Call) and first.method == "goto":
        return steps
    if isinstance(last, If):
        inner = {name: _coming_back(body, here) for name in BODIES if (body := _body(last, name))}
        return (*steps[:-1], msgspec.structs.replace(last, **inner))
    leads_away = isinstance(last, Call) and last.method in ("guide", "follow")
    return (*steps, Call("goto", {"place": here})) if leads_away else steps


def _leaves(steps: tuple[Step, ...]) -> bool:
    """Whether a round waits for somebody first, and ends somewhere else."""
    waits = bool(steps) and any(
        isinstance(each, Call | Ask) and each.method == "wait_for" for each in _first(steps[0])
    )
    away = {"goto", "guide", "find", "follow", "dock"}
    called = [each for each in nodes(steps) if isinstance(each, Call | Ask) and each.method in away]
    last = steps[-1] if steps else None
    comes_back = isinstance(last, Call) and last.method in ("goto", "dock")
    return bool(waits and called and not comes_back)


def _first(step: Step) -> Iterator[Node]:
    """What is done first in a step."""
    yield from nodes(step.condition) if isinstance(step, If) else (step,)


def is_one_of_each(plan: Plan) -> bool:
    """Whether no call is given a whole list, such as all the labs, where it takes one thing."""
    for node in nodes(plan.steps):
        if isinstance(node, Call | Ask):
            single = [value for name, value in node.arguments.items() if name != "options"]
            if any(map(_is_list, single)):
                return False
        if isinstance(node, Items) and any(map(_is_list, node.items)):
            return False
    return True


def _is_list(value: Value) -> bool:
    if isinstance(value, Items):  # "in the lobby or in the lounge", which nothing looked through
        return True
    if not isinstance(value, Ask) or value.method not in METHODS:
        return False
    return METHODS[value.method].returns.schema.get("type") == "array"


def without_unused(plan: Plan) -> Plan:
    """The plan without names for results, without kept and counted values, that nothing uses."""
    while True:
        used = {value.name for value in nodes(plan.steps) if isinstance(value, Recall)}
        less = msgspec.structs.replace(plan, steps=_forget(plan.steps, used))
        if less == plan:
            return plan
        plan = less


def replaced(part: Any, old: Value, new: Value) -> Any:
    """A part of a plan with one value put in the place of another, in texts too."""
    if part == old:
        return new
    if isinstance(part, tuple):
        return tuple(replaced(each, old, new) for each in part)
    if isinstance(part, dict):
        return {key: replaced(value, old, new) for key, value in part.items()}
    if isinstance(part, Text) and isinstance(old, Text) and isinstance(new, Text):
        return Text(part.value.replace(old.value, new.value))
    if isinstance(part, msgspec.Struct):
        fields = {name: replaced(getattr(part, name), old, new) for name in part.__struct_fields__}
        return msgspec.structs.replace(part, **fields)
    return part


def in_each_round(loop: Forever, step: Step) -> Forever:
    """A loop without end with one more step: before its pause, and said to somebody who is looked
    for only if they are found: "every two hours look for Bob and ask him how he is"."""
    body = list(loop.steps)
    ending = body[-1:] if isinstance(body[-1], Call) and body[-1].method == "wait" else []
    body = body[: len(body) - len(ending)]
    spoken = isinstance(step, Call) and step.method in ("say", "ask")
    match body[-1:]:
        case [If(Not(Holds(Ask("find")) as found), missing, ())] if spoken:
            body[-1] = If(found, (step,), missing)
        case _:
            body.append(step)
    return Forever((*body, *ending))


def mentions(steps: Any, value: Node) -> bool:
    """Whether some steps use a value, such as a variable."""
    return any(node == value for node in nodes(steps))


def _forget(steps: tuple[Step, ...], used: set[str]) -> tuple[Step, ...]:
    kept = (
        _forget_in(step, used)
        for step in steps
        if not (isinstance(step, Remember | Collect | Increase | SetItem) and step.name not in used)
    )
    return _going_once(tuple(step for step in kept if step is not None))


def _going_once(steps: tuple[Step, ...]) -> tuple[Step, ...]:
    """Nobody drives to where they have just gone, and have only spoken since."""
    result: list[Step] = []
    here: Step | None = None
    for step in steps:
        going = isinstance(step, Call) and step.method == "goto"
        if going and step == here:
            continue
        calls = (each for each in nodes(step) if isinstance(each, Call | Ask))
        if going or any(each.method != "say" for each in calls):
            here = step if going else None
        result.append(step)
    return tuple(result)


def _forget_in(step: Step, used: set[str]) -> Step | None:
    """The step without what nothing uses; None for a condition that nothing hangs on any more."""
    if isinstance(step, Call):
        if step.save_as is not None and step.save_as not in used:
            return msgspec.structs.replace(step, save_as=None)
        return step
    inner = {name: _forget(value, used) for name in BODIES if (value := getattr(step, name, None))}
    if isinstance(step, If) and inner and not any(inner.values()):
        return None
    return msgspec.structs.replace(step, **inner) if inner else step
