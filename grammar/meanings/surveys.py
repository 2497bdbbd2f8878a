"""Asking several people and reporting: who said yes, how many of each, what share, what they said.

The asking comes first in a sentence and the report last, so the report goes back into the steps
that were made for the asking: it puts behind each question a step that notes the answer, and
before everything the empty list or the zero that it is noted in.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import msgspec

from grammar.chart import Node
from grammar.discourse import Discourse, NotUnderstood, Steps, Thing
from grammar.meanings.finding import speak_to
from grammar.meanings.nouns import is_me
from grammar.meanings.registry import meaning
from grammar.plan import (
    Ask,
    Call,
    Collect,
    Compare,
    Condition,
    If,
    Increase,
    Items,
    Length,
    Number,
    Recall,
    Remember,
    Sentence,
    Share,
    Step,
    Text,
    Value,
)
from grammar.tidy import BODIES, nodes


@dataclass(frozen=True)
class Survey:
    """A question that was asked, of one or of several."""

    call: Call
    options: tuple[str, ...]
    who: Value | None
    """Who was asked, or where; None if it is not known who they are."""

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


def note(d: Discourse, call: Step, notes: Steps, before: Steps) -> None:
    """Put notes behind a call among the steps so far, and what they need before them all."""
    d.done[:] = [*before, *noting(d.done, call, notes)]


def moved(steps: Any) -> bool:
    """Whether some steps leave the place where the command was given."""
    return any(
        isinstance(each, Call | Ask) and each.method in ("goto", "find", "guide", "follow")
        for each in nodes(tuple(steps))
    )


def go_back(d: Discourse) -> Steps:
    """Back to who gave the command, unless the robot is there."""
    start = Call("goto", {"place": Recall("start")})
    if not moved(d.done) or d.done[-1] == start:
        return []
    d.start()
    d.went(Recall("start"))
    return [start]


def asked_before(d: Discourse) -> list[Survey]:
    surveys: list[Survey] = d.surveys
    calls = [each for each in nodes(tuple(d.done)) if isinstance(each, Call)]
    found = [each for each in surveys if any(each.call is call for call in calls)]
    if not found:
        raise NotUnderstood(d.language.phrase("no_question"))
    return found


@meaning("survey_report")
def survey_report(d: Discourse, node: Node) -> Steps:
    """ "tell me who said yes", "report how many of each", "tell Alice what they said"."""
    surveys = asked_before(d)
    person: Thing | None = d.get(node, "whom")
    kind = str(node.production.fixed["kind"])
    option = d.get(node, "answer") or d.language.phrase("yes")
    told = {"who": _who, "many": _many, "each": _each, "share": _share, "answers": _answers}[kind](
        d, surveys, str(option)
    )
    going = go_back(d) if person is None or is_me(person) else []
    return [*going, *speak_to(d, person, told)]


def _who(d: Discourse, surveys: list[Survey], option: str) -> Steps:
    name = d.variable(f"said_{option}")
    for survey in surveys:
        if survey.who is None:
            raise NotUnderstood(d.language.phrase("who_unknown"))
        note(d, survey.call, [If(survey.said(option), (Collect(name, survey.who),))], [])
    note(d, Call("", {}), [], [Remember(name, Items(()))])
    nobody = d.say("nobody_said", answer=option)
    some = d.say("who_said", answer=option, names=Recall(name))
    return [If(Compare(Length(Recall(name)), "==", Number(0)), (nobody,), (some,))]


def _counted(d: Discourse, surveys: list[Survey], option: str | None) -> Recall:
    """A variable that counts how often this was answered, or how often anybody was asked."""
    name = d.variable("asked" if option is None else f"said_{option}")
    for survey in surveys:
        count: Step = Increase(name)
        if option is not None:
            count = If(survey.said(option), (count,))
        note(d, survey.call, [count], [])
    note(d, Call("", {}), [], [Remember(name, Number(0))])
    return Recall(name)


def _many(d: Discourse, surveys: list[Survey], option: str) -> Steps:
    said, asked = _counted(d, surveys, option), _counted(d, surveys, None)
    return [d.say("how_many_said", number=said, asked=asked, answer=option)]


def _each(d: Discourse, surveys: list[Survey], option: str) -> Steps:
    options = surveys[-1].options
    if not options:
        return _answers(d, surveys, option)
    parts: list[Value] = []
    for each in options:
        parts += [Text(f"{', ' if parts else ''}{each}: "), _counted(d, surveys, each)]
    return [d.say("answers_were", answers=Sentence(tuple(parts)))]


def _share(d: Discourse, surveys: list[Survey], option: str) -> Steps:
    said, asked = _counted(d, surveys, option), _counted(d, surveys, None)
    return [d.say("share_said", share=Share(said, asked), answer=option)]


def _answers(d: Discourse, surveys: list[Survey], option: str) -> Steps:
    if len(surveys) == 1 and not in_loop(d, surveys[0].call):
        return [Call("say", {"text": Recall(str(surveys[0].call.save_as))})]
    name = d.variable("answers")
    for survey in surveys:
        answer = Recall(str(survey.call.save_as))
        line = answer if survey.who is None else Sentence((survey.who, Text(": "), answer))
        note(d, survey.call, [Collect(name, line)], [])
    note(d, Call("", {}), [], [Remember(name, Items(()))])
    return [d.say("answers_were", answers=Recall(name))]


def all_answers(d: Discourse) -> Steps:
    """What everybody said who was asked."""
    return _answers(d, asked_before(d), "")


def in_loop(d: Discourse, call: Call) -> bool:
    """Whether it is done more than once."""
    return not any(
        each is call or (isinstance(each, If) and any(inner is call for inner in each.then))
        for each in d.done
    )


@meaning("option_words")
def option_words(d: Discourse, node: Node) -> str:
    return str(d.get(node, "text"))


# --- until so many have answered


@meaning("answers_reached")
def answers_reached(d: Discourse, node: Node) -> Condition:
    """ "until three of them say yes": the loop around counts the answers."""
    if not d.surveys:
        raise NotUnderstood(d.language.phrase("no_question"))
    answer = d.get(node, "answer")
    name = d.variable("answers" if answer is None else f"said_{answer}")
    d.counting = (d.surveys[-1], None if answer is None else str(answer), name)
    return Compare(Recall(name), ">=", Number(int(d.get(node, "count"))))


def counting(d: Discourse, body: Steps) -> tuple[Steps, Steps]:
    """What stands before a loop that goes on until so many have answered, and its steps: each round
    with the next person."""
    if d.counting is None:
        return [], body
    survey, answer, name = d.counting
    d.counting = None
    count: Step = Increase(name)
    if answer is not None:
        count = If(survey.said(answer), (count,))
    steps = list(noting(body, survey.call, [count]))
    if any(step is survey.call for step in steps) and survey.who is None:
        who = d.person.value if d.person is not None else Text("person")
        at = next(at for at, step in enumerate(steps) if step is survey.call)
        steps.insert(at, Call("wait_for", {"thing": who}))
    return [Remember(name, Number(0))], steps
