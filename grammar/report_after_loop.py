"""What people have said in a round is told when all have been asked: "ask everybody in the lobby
whether they have seen my dog. If someone has, ask them where and come back and tell me".

Told at once, it would leave those behind who are still to be asked.
"""

from __future__ import annotations

from msgspec.structs import replace

from grammar.discourse import Discourse
from grammar.meanings.first_match import is_said
from grammar.meanings.news import BACK
from grammar.plan import (
    Ask,
    Call,
    Collect,
    Compare,
    ForEach,
    Holds,
    If,
    Items,
    Length,
    Number,
    Plan,
    Recall,
    Remember,
    Sentence,
    Step,
    Text,
    Value,
)
from grammar.tidy import mentions, nodes


def told_when_all_are_asked(plan: Plan, d: Discourse) -> Plan:
    """The plan with what is told in a round over the people at a place behind that round."""
    steps: list[Step] = []
    for step in plan.steps:
        steps += _told_behind(step, d) if isinstance(step, ForEach) else [step]
    return replace(plan, steps=tuple(steps))


def _told_behind(loop: ForEach, d: Discourse) -> list[Step]:
    """A round without the errand that it would break off for, and that errand behind it."""
    if not any(isinstance(each, Call) and each.method == "ask" for each in nodes(loop)):
        return [loop]
    errand = _errand_of(loop)
    if errand is None:
        return [loop]
    told, found = _said_on(errand), d.variable("answers")
    if not told or not all(isinstance(each, Recall | Sentence) for each in told):
        return [loop]
    kept = _with_notes(loop, errand, found, told)
    said = d.say("answers_were", answers=Recall(found))
    behind = _saying_instead(errand, said)
    some = Compare(Length(Recall(found)), ">", Number(0))
    if errand[0] == BACK:
        return [Remember(found, Items(())), kept, BACK, If(some, tuple(behind[1:]))]
    return [Remember(found, Items(())), kept, If(some, tuple(behind))]


def _errand_of(step: Step) -> tuple[Step, ...] | None:
    """What a round ends with, if that is to go and tell somebody what was said in it."""
    steps: tuple[Step, ...] = step.steps if isinstance(step, ForEach) else ()
    if isinstance(step, If) and step.otherwise in ((), (BACK,)):
        steps = step.then
    for at, each in enumerate(steps):
        if each == BACK and all(is_said(later) for later in steps[at + 1 :]):
            return steps[at:]
    last = steps[-1] if steps else None
    if isinstance(last, If) and _is_search(last) and all(map(is_said, last.then)):
        return (last,)
    return _errand_of(last) if isinstance(last, ForEach | If) else None


def _is_search(step: If) -> bool:
    """Whether somebody is looked for by name, and no one of those who are asked."""
    condition = step.condition
    return (
        isinstance(condition, Holds)
        and isinstance(condition.value, Ask)
        and condition.value.method == "find"
        and isinstance(condition.value.arguments.get("thing"), Text)
    )


def _said_on(errand: tuple[Step, ...]) -> list[Value]:
    (first,) = errand[:1]
    said = first.then if isinstance(first, If) else errand[1:]
    return [each.arguments["text"] for each in said if isinstance(each, Call)]


def _saying_instead(errand: tuple[Step, ...], said: Step) -> list[Step]:
    (first,) = errand[:1]
    return [replace(first, then=(said,))] if isinstance(first, If) else [BACK, said]


def _with_notes(
    step: ForEach | If, errand: tuple[Step, ...], found: str, told: list[Value], who: str = ""
) -> ForEach | If:
    """A round with notes of what was said, and by whom, in the place of an errand."""
    if isinstance(step, ForEach):
        who = step.variable
    body = step.steps if isinstance(step, ForEach) else step.then
    if body[len(body) - len(errand) :] == errand:
        notes = [Collect(found, _line(who, each)) for each in told]
        body = (*body[: len(body) - len(errand)], *notes)
    else:
        last = body[-1]
        assert isinstance(last, ForEach | If)
        body = (*body[:-1], _with_notes(last, errand, found, told, who))
    if isinstance(step, ForEach):
        return replace(step, steps=body)
    return replace(step, then=body, otherwise=())


def _line(who: str, said: Value) -> Value:
    if mentions(said, Recall(who)):
        return said
    parts = said.parts if isinstance(said, Sentence) else (said,)
    return Sentence((Recall(who), Text(": "), *parts))
