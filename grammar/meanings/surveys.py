"""Asking several people and reporting: who said yes, how many of each, what share, what they said.

The asking comes first in a sentence and the report last, so the report goes back into the steps
that were made for the asking: it puts behind each question a step that notes the answer, and
before everything the empty list or the zero that it is noted in.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import msgspec

from grammar.chart import Node
from grammar.discourse import Discourse, Steps, Thing
from grammar.doubts import NotUnderstood
from grammar.meanings.registry import meaning
from grammar.plan import (
    Ask,
    Call,
    Compare,
    Condition,
    End,
    ForEach,
    If,
    Increase,
    Items,
    Number,
    Recall,
    Remember,
    RepeatUntil,
    Step,
    Text,
    Value,
)
from grammar.tidy import BODIES, LOOPS, mentions, nodes


@dataclass(frozen=True)
class Survey:
    """A question that was asked, of one or of several."""

    call: Call
    options: tuple[str, ...]
    who: Value | None
    """Who was asked, or where; None if it is not known who they are."""
    where: Value | None = None
    """The place, where a round goes from one to the next."""
    nouns: frozenset[str] = frozenset()
    """What its answer may be called: "time", "colour"."""

    def said(self, option: str) -> Condition:
        """Whether the answer is this."""
        assert self.call.save_as is not None
        answer = Recall(self.call.save_as)
        for each in self.options:
            if each.lower() == option.lower():
                return Compare(answer, "==", Text(each))
        return Compare(Text(option), "in", answer)


def noting(step: Any, call: Step, notes: Steps) -> Any:
    """A step, or steps, with some more put behind this call, wherever it stands in there."""
    if isinstance(step, tuple | list):
        result: Steps = []
        for each in step:
            result.append(noting(each, call, notes))
            if each is call:
                result += notes
        return tuple(result)
    bodies = {name: body for name in BODIES if (body := getattr(step, name, ()))}
    inner = {name: noting(body, call, notes) for name, body in bodies.items()}
    return step if inner == bodies else msgspec.structs.replace(step, **inner)


def replacing(step: Any, old: Step | None, new: Steps) -> Any:
    """A step with others in the place of one inside it."""
    inner = {
        name: tuple(
            other
            for each in body
            for other in (new if each is old else (replacing(each, old, new),))
        )
        for name in BODIES
        if (body := getattr(step, name, ()))
    }
    return msgspec.structs.replace(step, **inner) if inner else step


def note(d: Discourse, call: Step, notes: Steps, before: Steps) -> None:
    """Put notes behind a call among the steps so far, and what they need before them all."""
    for steps in (*d.around, d.done):
        steps[:] = noting(steps, call, notes)
    before_all(d, before)


def before_all(d: Discourse, steps: Steps) -> None:
    """Put steps before all that was done; in a loop, before all that is done in a round."""
    first = d.done if d.in_loop else (*d.around, d.done)[1 if d.around else 0]
    first[:0] = steps


def moved(steps: Any) -> bool:
    """Whether some steps leave the place where the command was given."""
    return any(
        isinstance(each, Call | Ask) and each.method in ("goto", "find", "guide", "follow")
        for each in nodes(tuple(steps))
    )


def asked_so_far(d: Discourse) -> list[Survey]:
    """The questions among the steps so far, here and around."""
    surveys: list[Survey] = d.surveys
    done = (*d.around, d.done)
    calls = [each for steps in done for each in nodes(steps) if isinstance(each, Call)]
    found = [each for each in surveys if any(each.call is call for call in calls)]
    return [*found, *_asked_again(d, found)]


def _asked_again(d: Discourse, surveys: list[Survey]) -> list[Survey]:
    """What was asked of others in the same words, into the same variable: "do the same with
    Alice". Who is asked only where somebody else was not found is none of them."""
    known = {id(each.call) for each in surveys}
    by_variable = {each.call.save_as: each for each in surveys}
    return [
        replace(by_variable[step.save_as], call=step, who=step.arguments.get("person"))
        for step in _in_any_case(d.done)
        if isinstance(step, Call)
        and step.method == "ask"
        and step.save_as in by_variable
        and id(step) not in known
    ]


def asked_before(d: Discourse) -> list[Survey]:
    found = asked_so_far(d)
    if not found:
        raise NotUnderstood(d.language.phrase("no_question"))
    return found


def in_line(d: Discourse) -> list[Survey]:
    """The questions that were asked in any case to come here, and in no other branch."""
    calls = [each for steps in (*d.around, d.done) for each in _in_any_case(steps)]
    return [each for each in d.surveys if any(each.call is call for call in calls)]


def _in_any_case(steps: Iterable[Step]) -> Iterator[Step]:
    """Steps that are done, if those who are looked for are found."""
    for step in steps:
        searching = isinstance(step, If) and "find" in {
            each.method for each in nodes(step.condition) if isinstance(each, Ask)
        }
        if isinstance(step, If):
            yield from _in_any_case(step.then if searching else ())
        else:
            yield step


def several_asked(d: Discourse) -> bool:
    """Whether "the answer" is that of several: of who was asked the same, or of who was asked only
    because of what somebody else had answered."""
    surveys: list[Survey] = d.surveys
    last = surveys[-1] if surveys else None
    if last is None or d.answer is None or d.answer != last.call.save_as:
        return False
    others = [each for each in asked_so_far(d) if each.who not in (None, last.who)]
    if any(each.call.save_as == last.call.save_as for each in others):
        return False  # only one of them is asked
    question = last.call.arguments["question"]
    if any(each.call.arguments["question"] == question for each in others):
        return True
    answers = [Recall(each.call.save_as) for each in others if each.call.save_as]
    return any(
        isinstance(each, If)
        and any(mentions(each.condition, answer) for answer in answers)
        and _is_in(each, last.call)
        for each in nodes(tuple(d.done))
    )


def asked_yet(d: Discourse) -> bool:
    """Whether anybody was asked anything so far."""
    return bool(asked_so_far(d))


def of_one_question(surveys: list[Survey]) -> list[Survey]:
    """Those that asked the same as the last one; also what was asked of others in other words."""
    last = surveys[-1]
    again = {each.who for each in surveys if _alike(each, last)}
    return [
        each
        for each in surveys
        if _alike(each, last) or (isinstance(each.who, Text) and each.who not in again)
    ]


def _alike(one: Survey, other: Survey) -> bool:
    return one.call.arguments["question"] == other.call.arguments["question"]


def in_loop(d: Discourse, call: Call) -> bool:
    """Whether it is done more than once."""
    loops = [each for each in nodes(tuple(d.done)) if isinstance(each, LOOPS)]
    return any(each is call for loop in loops for each in nodes(loop))


# --- what is done with the answer of each


def each_asked(d: Discourse) -> Thing | None:
    """Whoever is asked in a loop, for what is done with the answer: "ask Alice and Bob what they
    want to drink and bring it to them"."""
    survey: Survey | None = d.surveys[-1] if d.surveys else None
    if survey is None or not isinstance(survey.who, Recall) or not in_loop(d, survey.call):
        return None
    people = any(
        isinstance(each, ForEach) and each.variable == survey.who.name and d.place != survey.who
        for each in nodes(tuple(d.done))
    )
    return Thing(survey.who, known=True, person=True) if people else None


def uses_answer(d: Discourse, steps: Steps) -> bool:
    """Whether some steps need the last answer."""
    return d.answer is not None and mentions(steps, Recall(d.answer))


# --- until so many have answered


@meaning("answers_reached")
def answers_reached(d: Discourse, node: Node) -> Condition:
    """ "until three of them say yes": the loop around counts the answers."""
    if not d.surveys:
        raise NotUnderstood(d.language.phrase("no_question"))
    if not d.in_loop and asked_so_far(d):  # "if one of them says no": all have answered by now
        return reached(d, node)
    return counting_to(d, node)


def counting_to(d: Discourse, node: Node) -> Condition:
    """Whether so many have answered by now, as the loop around is to count."""
    answer = d.get(node, "answer")
    name = d.variable("answers" if answer is None else f"said_{answer}")
    d.counting = (d.surveys[-1], None if answer is None else str(answer), name)
    return Compare(Recall(name), ">=", Number(int(d.get(node, "count"))))


def reached(d: Discourse, node: Node) -> Condition:
    """Whether so many of those who were asked have given an answer."""
    from grammar.meanings.answered import of_those_asked
    from grammar.meanings.answers import Wanted
    from grammar.meanings.polls import counted

    surveys = asked_before(d)
    said = d.get(node, "answer")

    wanted = None if said is None else Wanted((str(said),))
    number = int(d.get(node, "count"))
    if wanted is not None and number == 1 and not in_loop(d, surveys[-1].call):
        return of_those_asked(d, surveys, wanted, "some")
    return Compare(counted(d, surveys, wanted), ">=", Number(number))


def until_answered(d: Discourse, condition: Condition, body: Steps) -> Steps:
    """A loop that goes on until a condition holds; if that is how many have answered, each round is
    with the next person, and those who are known by name are asked once."""
    if d.counting is None:
        return [RepeatUntil(condition, tuple(body))]
    survey, answer, name = d.counting
    d.counting = None
    count: Step = Increase(name)
    if answer is not None:
        count = If(survey.said(answer), (count,))
    zero = Remember(name, Number(0))
    loop = next(
        (each for each in body if isinstance(each, ForEach) and _is_in(each, survey.call)), None
    )
    if loop is not None and isinstance(loop.items, Items):
        return [zero, *noting(body, survey.call, [count, If(condition, (End(),))])]
    if loop is not None and loop.steps == (survey.call,):  # of those who come, one after the other
        body = [other for each in body for other in ((survey.call,) if each is loop else (each,))]
    steps = list(noting(body, survey.call, [count]))
    waits = any(isinstance(step, Call) and step.method == "wait_for" for step in steps)
    nameless = survey.who is None or loop is not None
    if any(step is survey.call for step in steps) and nameless and not waits:
        who = d.person.value if d.person is not None else Text("person")
        at = next(at for at, step in enumerate(steps) if step is survey.call)
        arguments = {key: each for key, each in survey.call.arguments.items() if key != "person"}
        asking = msgspec.structs.replace(survey.call, arguments=arguments)
        steps[at : at + 1] = [Call("wait_for", {"thing": who}), asking]
    return [zero, RepeatUntil(condition, tuple(steps))]


@meaning("stop_asking")
def stop_asking(d: Discourse, node: Node) -> Steps:
    """ "as soon as one says yes, stop asking": leaves the loops that ask."""
    asked_before(d)
    part = node.parts["condition"]
    while isinstance(part, Node) and part.means != "answers_reached":
        (part,) = part.parts.values()
    assert isinstance(part, Node)
    condition = counting_to(d, part)
    survey, answer, name = d.counting
    d.counting = None
    if not in_loop(d, survey.call):
        raise NotUnderstood(d.language.phrase("no_question"))
    count: Step = Increase(name)
    if answer is not None:
        count = If(survey.said(answer), (count,))
    leave = If(condition, (End(),))
    d.done[:] = [
        Remember(name, Number(0)),
        *noting(_left_when(d.done, survey.call, leave), survey.call, [count, leave]),
    ]
    return []


def _left_when(step: Any, call: Call, leave: Step) -> Any:
    """Steps whose loops around the one that a call is in are left, too."""
    if isinstance(step, tuple | list):
        return tuple(_left_when(each, call, leave) for each in step)
    inner = {
        name: _left_when(body, call, leave) for name in BODIES if (body := getattr(step, name, ()))
    }
    loops = isinstance(step, LOOPS) and any(
        isinstance(each, LOOPS) and _is_in(each, call) for each in nodes(step.steps)
    )
    if loops:
        inner["steps"] = (*inner["steps"], leave)
    return msgspec.structs.replace(step, **inner) if inner else step


def _is_in(step: Step, inner: Step) -> bool:
    return any(each is inner for each in nodes(step))
