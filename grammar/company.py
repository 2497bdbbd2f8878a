"""With whom of several a step is done: one guest after the other is led, and in a round over the
people at a place, "them" is whose turn it is."""

from __future__ import annotations

from typing import Any, Final

import msgspec

from grammar.discourse import ANYONE
from grammar.plan import Ask, Call, ForEach, Node, Plan, Recall, Repeat, Step, Text, Value
from grammar.tidy import BODIES, nodes

SPOKEN: Final = frozenset({"say", "ask", "gesture", "emotion", "show"})
"""What is done with somebody where they are."""


def in_company(plan: Plan) -> Plan:
    """The plan with everybody led who was waited for, and with whoever's turn it is."""
    return msgspec.structs.replace(plan, steps=_in_company(plan.steps))


def _in_company(steps: tuple[Step, ...]) -> tuple[Step, ...]:
    result: list[Step] = []
    for step in _each_led(steps):
        inner = {name: _in_company(body) for name in BODIES if (body := getattr(step, name, ()))}
        step = msgspec.structs.replace(step, **inner) if inner else step
        if isinstance(step, ForEach) and step.items == Ask("people") and not _meets(step):
            step = _put(step, Text(ANYONE), Recall(step.variable))
        result.append(step)
    return tuple(result)


def _each_led(steps: tuple[Step, ...]) -> list[Step]:
    """ "Wait for three guests, say good morning and take them to the lounge": nobody leads three at
    once, so that each is greeted and led before the next one is waited for."""
    result: list[Step] = []
    rest = list(steps)
    while rest:
        step = rest.pop(0)
        match step:
            case Repeat(steps=(Call(method="wait_for", arguments={"thing": who}),)):
                taken = _with_them(rest, who)
                step = msgspec.structs.replace(step, steps=(*step.steps, *rest[:taken]))
                del rest[:taken]
            case _:
                pass
        result.append(step)
    return result


def _with_them(steps: list[Step], who: Value) -> int:
    """How many steps are done with those who were waited for, up to the last that leads them."""
    led = 0
    for at, step in enumerate(steps):
        if isinstance(step, Call) and step.method == "guide" and step.arguments["person"] == who:
            led = at + 1
        elif not isinstance(step, Call) or step.method not in SPOKEN:
            break
    return led


def _meets(loop: ForEach) -> bool:
    """Whether somebody else may be met within a round."""
    return any(isinstance(each, Call | Ask) and each.method == "wait_for" for each in nodes(loop))


def _put(node: Any, old: Value, new: Value) -> Any:
    """A plan with one value for another in the calls to a robot that has to do with people."""
    if isinstance(node, tuple):
        return tuple(_put(each, old, new) for each in node)
    if not isinstance(node, Node):
        return node
    if isinstance(node, Call) and node.method in ("guide", "give", "ask", "find", "follow"):
        given = {name: new if value == old else value for name, value in node.arguments.items()}
        return msgspec.structs.replace(node, arguments=given)
    inner = {name: _put(getattr(node, name), old, new) for name in BODIES if hasattr(node, name)}
    return msgspec.structs.replace(node, **inner) if inner else node
