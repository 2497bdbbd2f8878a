"""Asking until so many have answered, or said so: whoever is asked last is then "that person"."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import msgspec

from grammar.chart import Node
from grammar.discourse import ANYONE, Discourse, Steps, Thing
from grammar.errors import NotUnderstood
from grammar.meanings.answered import of_those_asked
from grammar.meanings.answers import Wanted
from grammar.meanings.polls import counted
from grammar.meanings.registry import meaning
from grammar.meanings.surveys import (
    Survey,
    asked_before,
    asked_so_far,
    asked_without_end,
    in_loop,
    is_in,
    note,
    noting,
    polled_before,
)
from grammar.plan import (
    Call,
    Compare,
    Condition,
    End,
    ForEach,
    Forever,
    If,
    Increase,
    Items,
    Number,
    Recall,
    Remember,
    RepeatUntil,
    Step,
    Text,
)
from grammar.tidy import BODIES, LOOPS, nodes


@meaning("answers_reached")
def answers_reached(d: Discourse, node: Node) -> Condition:
    """ "until three of them say yes": the loop around counts the answers."""
    if not d.answers.surveys:
        raise NotUnderstood(d.language.phrase("no_question"))
    if not d.loops.in_loop and asked_so_far(
        d
    ):  # "if one of them says no": all have answered by now
        return reached(d, node)
    return counting_to(d, node)


def counting_to(d: Discourse, node: Node) -> Compare:
    """Whether so many have answered by now, as the loop around is to count."""
    answer = d.get(node, "answer")
    name = d.variable("answers" if answer is None else f"said_{answer}")
    d.answers = replace(
        d.answers, counting=(d.answers.surveys[-1], None if answer is None else str(answer), name)
    )
    return Compare(Recall(name), ">=", Number(int(d.get(node, "count"))))


def reached(d: Discourse, node: Node) -> Condition:
    """Whether so many of those who were asked have given an answer."""
    surveys = polled_before(d)
    said = d.get(node, "answer")
    wanted = None if said is None else Wanted((str(said),))
    d.answers = replace(d.answers, said=wanted)
    number = int(d.get(node, "count"))
    if wanted is not None and number == 1 and asked_without_end(d, surveys[-1]):
        return wanted.given(surveys[-1])
    if wanted is not None and number == 1 and not in_loop(d, surveys[-1].call):
        return of_those_asked(d, surveys, wanted, "some")
    return Compare(counted(d, surveys, wanted), ">=", Number(number))


def until_answered(d: Discourse, condition: Condition, body: Steps) -> Steps:
    """A loop that goes on until a condition holds; if that is how many have answered, each round is
    with the next person, and those who are known by name are asked once."""
    if d.answers.counting is None:
        return [RepeatUntil(condition, tuple(body))]
    survey, answer, name = d.answers.counting
    d.answers = replace(d.answers, counting=None)
    count: Step = Increase(name)
    if answer is not None:
        count = If(survey.said(answer), (count,))
    zero = Remember(name, Number(0))
    loop = next(
        (each for each in body if isinstance(each, ForEach) and is_in(each, survey.call)), None
    )
    if loop is not None and isinstance(loop.items, Items):
        return [zero, *noting(body, survey.call, [count, If(condition, (End(),))])]
    if loop is not None and loop.steps == (survey.call,):  # of those who come, one after the other
        body = [other for each in body for other in ((survey.call,) if each is loop else (each,))]
    steps = list(noting(body, survey.call, [count]))
    waits = any(isinstance(step, Call) and step.method == "wait_for" for step in steps)
    nameless = survey.who is None or loop is not None
    if any(step is survey.call for step in steps) and nameless and not waits:
        who = d.scene.person.value if d.scene.person is not None else Text("person")
        at = next(at for at, step in enumerate(steps) if step is survey.call)
        arguments = {key: each for key, each in survey.call.arguments.items() if key != "person"}
        asking = msgspec.structs.replace(survey.call, arguments=arguments)
        steps[at : at + 1] = [Call("wait_for", {"thing": who}), asking]
    if condition == Compare(Recall(name), ">=", Number(1)):
        the_last_one(d)
    return [zero, RepeatUntil(condition, tuple(steps))]


def the_last_one(d: Discourse) -> None:
    """Whoever stands before the robot when somebody has said so is who is spoken of next: "ask
    people until one agrees, then take them to Clara's office"."""
    person = d.scene.person or Thing(Text(ANYONE), person=True)
    one = replace(person, place=None, group=None, count=None, every=False, plural=False)
    d.scene = d.scene.speaking_of_person(replace(one, here=True, coming=False))
    d.scene = replace(d.scene, with_person=one.value)


@meaning("stop_asking")
def stop_asking(d: Discourse, node: Node) -> Steps:
    """ "as soon as one says yes, stop asking": leaves the loops that ask."""
    stopped_when(d, node)
    return []


def stops_asking(d: Discourse, node: Node) -> bool:
    """Whether something is said to be done as soon as so many have answered, while others are still
    to be asked."""
    reached = _reached(node) is not None and bool(asked_so_far(d)) and not d.loops.in_loop
    return reached and in_loop(d, d.answers.surveys[-1].call)


def as_soon_as_answered(d: Discourse, node: Node) -> Steps:
    """ "as soon as one says yes, take them to Clara": nobody else is asked then."""
    survey, condition = stopped_when(d, node)
    endless = not any(isinstance(each, ForEach) and is_in(each, survey.call) for each in d.done)
    one = condition.right == Number(1)
    if one and not endless and isinstance(survey.who, Recall) and survey.where is None:
        who = d.variable("who")
        note(d, survey.call, [Remember(who, survey.who)], [Remember(who, Text(""))])
        d.scene = d.scene.speaking_of_person(Thing(Recall(who), known=True, person=True, here=True))
        d.scene = replace(d.scene, with_person=Recall(who))
    then: Steps = d.build(node.parts["then"])
    return then if endless else [If(condition, tuple(then))]


def _reached(node: Node) -> Node | None:
    """The part of a condition that says how many have answered; None if it is on something else."""
    part = node.parts.get("condition")
    while isinstance(part, Node) and part.means != "answers_reached":
        if len(part.parts) != 1:
            return None
        (part,) = part.parts.values()
    return part if isinstance(part, Node) else None


def stopped_when(d: Discourse, node: Node) -> tuple[Survey, Compare]:
    """Leave the loops that ask as soon as so many have answered: of those without end, that is
    their end."""
    asked_before(d)
    part = _reached(node)
    assert part is not None
    condition = counting_to(d, part)
    counting = survey, answer, name = d.answers.counting
    d.answers = replace(d.answers, counting=None)
    if not in_loop(d, survey.call):
        raise NotUnderstood(d.language.phrase("no_question"))
    at = next((at for at, each in enumerate(d.done) if isinstance(each, Forever)), None)
    endless = d.done[at] if at is not None else None
    if isinstance(endless, Forever) and at is not None and is_in(endless, survey.call):
        d.answers = replace(d.answers, counting=counting)
        d.done[at : at + 1] = until_answered(d, condition, list(endless.steps))
        return survey, condition
    count: Step = Increase(name)
    if answer is not None:
        count = If(survey.said(answer), (count,))
        d.answers = replace(
            d.answers, said=Wanted((answer,)), polled_for="who"
        )  # "... and tell me"
    leave = If(condition, (End(),))
    noted = noting(_left_when(d.done, survey.call, leave), survey.call, [count, leave])
    d.done[:] = [Remember(name, Number(0)), *noted]
    return survey, condition


def _left_when(step: Any, call: Call, leave: Step) -> Any:
    """Steps whose loops around the one that a call is in are left, too."""
    if isinstance(step, tuple | list):
        return tuple(_left_when(each, call, leave) for each in step)
    inner = {
        name: _left_when(body, call, leave) for name in BODIES if (body := getattr(step, name, ()))
    }
    loops = isinstance(step, LOOPS) and any(
        isinstance(each, LOOPS) and is_in(each, call) for each in nodes(step.steps)
    )
    if loops:
        inner["steps"] = (*inner["steps"], leave)
    return msgspec.structs.replace(step, **inner) if inner else step
