"""Asking several people and reporting: who said yes, how many of each, what share, what they said.

The asking comes first in a sentence and the report last, so the report goes back into the steps
that were made for the asking: it puts behind each question a step that notes the answer, and
before everything the empty list or the zero that it is noted in.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import msgspec

from grammar.discourse import Discourse, Steps, Thing
from grammar.errors import NotUnderstood
from grammar.plan import (
    Ask,
    Call,
    Compare,
    Condition,
    ForEach,
    Forever,
    If,
    Recall,
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


def exchanged(steps: Iterable[Step], old: Step | None, new: Steps) -> Steps:
    """Steps with others in the place of one of them, or of one inside them."""
    return [
        other for each in steps for other in (new if each is old else (replacing(each, old, new),))
    ]


def replacing(step: Any, old: Step | None, new: Steps) -> Any:
    """A step with others in the place of one inside it."""
    inner = {
        name: tuple(exchanged(body, old, new))
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
    first = d.done if d.loops.in_loop else (*d.around, d.done)[1 if d.around else 0]
    first[:0] = steps


def moved(steps: Any) -> bool:
    """Whether some steps leave the place where the command was given."""
    return any(
        isinstance(each, Call | Ask) and each.method in ("goto", "find", "guide", "follow")
        for each in nodes(tuple(steps))
    )


def asked_so_far(d: Discourse) -> list[Survey]:
    """The questions among the steps so far, here and around."""
    surveys: tuple[Survey, ...] = d.answers.surveys
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
    return [each for each in d.answers.surveys if any(each.call is call for call in calls)]


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
    surveys: tuple[Survey, ...] = d.answers.surveys
    last = surveys[-1] if surveys else None
    if last is None or d.answers.last is None or d.answers.last != last.call.save_as:
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
        and is_in(each, last.call)
        for each in nodes(tuple(d.done))
    )


def asked_yet(d: Discourse) -> bool:
    """Whether anybody was asked anything so far."""
    return bool(asked_so_far(d))


def of_one_question(surveys: Sequence[Survey]) -> list[Survey]:
    """Those that asked the same as the last one; also what was asked of others in other words."""
    last = surveys[-1]
    again = {each.who for each in surveys if _alike(each, last)}
    return [
        each
        for each in surveys
        if _alike(each, last) or (isinstance(each.who, Text) and each.who not in again)
    ]


def polled_before(d: Discourse) -> list[Survey]:
    """Those of several who were asked the same; who was asked only because of what they had said is
    none of them: "if all say no, ask Clara; if somebody says yes, ..."."""
    surveys = asked_before(d)
    surely = [
        each
        for step in d.done
        if not isinstance(step, If) or any(isinstance(ask, Ask) for ask in nodes(step.condition))
        for each in surveys
        if is_in(step, each.call)
    ]
    several = any(in_loop(d, each.call) for each in surely)
    return of_one_question(surely if several else surveys)


def _alike(one: Survey, other: Survey) -> bool:
    return one.call.arguments["question"] == other.call.arguments["question"]


def in_loop(d: Discourse, call: Call) -> bool:
    """Whether it is done more than once."""
    steps = (*d.around, d.done)
    loops = [each for done in steps for each in nodes(tuple(done)) if isinstance(each, LOOPS)]
    return any(each is call for loop in loops for each in nodes(loop))


def asked_without_end(d: Discourse, survey: Survey) -> bool:
    """Whether a question is put to one after the other for ever: "if one says no" is then about
    whoever was asked just now."""
    return any(isinstance(each, Forever) and is_in(each, survey.call) for each in d.done)


# --- what is done with the answer of each


def each_asked(d: Discourse) -> Thing | None:
    """Whoever is asked in a loop, for what is done with the answer: "ask Alice and Bob what they
    want to drink and bring it to them"."""
    survey: Survey | None = d.answers.surveys[-1] if d.answers.surveys else None
    if survey is None or not isinstance(survey.who, Recall) or not in_loop(d, survey.call):
        return None
    people = any(
        isinstance(each, ForEach)
        and each.variable == survey.who.name
        and d.scene.place != survey.who
        for each in nodes(tuple(d.done))
    )
    return Thing(survey.who, known=True, person=True) if people else None


def uses_answer(d: Discourse, steps: Steps) -> bool:
    """Whether some steps need the last answer."""
    return d.answers.last is not None and mentions(steps, Recall(d.answers.last))


def is_in(step: Step, inner: Step) -> bool:
    """Whether a step is another one or has it in it."""
    return any(each is inner for each in nodes(step))
