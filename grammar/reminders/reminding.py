"""Reminders to people: "remind Alice to drink at ten and at four".

Who is reminded is asked afterwards whether it is done (or understood, of what is no deed), once
more if nobody answers. The answer is kept under a name by which it is known everywhere (`ANSWER`).
Reminders among other errands ("and remind her to call me") are messages as any other.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import msgspec

from grammar.chart import Node
from grammar.discourse import ANYONE, Discourse
from grammar.meanings.persons import is_me
from grammar.meanings.registry import meaning
from grammar.meanings.requests import request
from grammar.plan import (
    Ask,
    Call,
    Compare,
    End,
    ForEach,
    Holds,
    If,
    Items,
    Not,
    Number,
    Plan,
    Recall,
    Remember,
    Repeat,
    Step,
    Text,
    Try,
    Value,
)
from grammar.reminders.reminded import Of, Reminded
from grammar.requests import Request
from grammar.traversal import nodes

ANSWER: Final = "reminder_done"
"""The variable with the answer: by it a program that reminds somebody is known."""
TRIES: Final = 2
_HERE: Final = Ask("people")
_ON_THE_WAY: Final = frozenset({"find", "goto", "wait", "wait_until", "location", "say", "people"})
"""What a program does that only reminds somebody."""


@meaning("schedule_reminder")
def schedule_reminder(d: Discourse, node: Node) -> Request:
    """What is to be said, without the times, wherever they stand among the words."""
    part = node.parts["part"]
    asked = request(d, node, "schedule")
    said = " ".join(
        words
        for first, last in ((node.start, part.start), (part.end, node.end))
        if first < last and (words := d.words(first, last).strip(" ,"))
    )
    return replace(asked, sentence=said, when=d.build(part))


def reminding(plan: Plan, d: Discourse) -> Plan:
    """The plan with the question what came of it, if it does nothing but remind somebody."""
    reminded: Reminded | None = d.answers.reminded
    if reminded is None or is_me(reminded.person):
        return plan
    made = [each for each in nodes(plan.steps) if isinstance(each, Call | Ask)]
    said = [each for each in made if each.method == "say" and not _is_failure(each, plan)]
    if len(said) != 1 or any(each.method not in _ON_THE_WAY for each in made):
        return plan
    (saying,) = said
    person = reminded.person
    whom = person.value if person is not None and person.known and person.group is None else None
    several = person is not None and (person.plural or person.text == ANYONE)
    everybody = any(isinstance(each, ForEach) and each.items == _HERE for each in nodes(plan.steps))
    if (several or everybody) and reminded.of != "deed":
        return plan  # of lunch, or of what is so, people who are there are only told
    asking = _Asking(d, saying, reminded.of, several)
    return msgspec.structs.replace(plan, steps=asking.inside(plan.steps, whom))


def _is_failure(said: Call | Ask, plan: Plan) -> bool:
    """Whether it is only said where somebody was not found."""
    return any(
        said in each.otherwise
        for each in nodes(plan.steps)
        if isinstance(each, If) and isinstance(each.condition, Holds)
    )


class _Asking:
    """Puts the question behind what is said."""

    def __init__(self, d: Discourse, saying: Call | Ask, of: Of, several: bool) -> None:
        self.d = d
        self.saying = saying
        self.of = of
        self.several = several

    def inside(self, steps: tuple[Step, ...], person: Value | None) -> tuple[Step, ...]:
        """The steps with the question, to that person or to whoever was found before."""
        done: list[Step] = []
        for step in steps:
            if step == self.saying:
                done += self.asked(step, person)
                continue
            match step:
                case If(condition=Holds(value=Ask(method="find", arguments=given))):
                    found = given["thing"]
                    named = isinstance(found, Recall) or found == person
                    then = self.inside(step.then, found if named else None)
                    step = msgspec.structs.replace(step, then=then)
                case ForEach(items=items, variable=name):
                    each = Recall(name) if items == _HERE else person
                    step = msgspec.structs.replace(step, steps=self.inside(step.steps, each))
                case _:
                    pass
            done.append(step)
        return tuple(done)

    def asked(self, saying: Step, person: Value | None) -> tuple[Step, ...]:
        if person is None and self.several:  # everybody who is there
            name = self.d.variable("person")
            return (saying, ForEach(name, Ask("people"), self.talk(Recall(name), ())))
        return self.talk(person, (saying,))

    def talk(self, person: Value | None, said: tuple[Step, ...]) -> tuple[Step, ...]:
        d = self.d
        yes, no = Text(d.language.phrase("yes")), Text(d.language.phrase("no"))
        question: dict[str, Value] = {
            "question": d.sentence(f"reminder_of_{self.of}"),
            "options": Items((yes, no)),
        }
        if person is not None:
            question["person"] = person
        unanswered = Compare(Recall(ANSWER), "==", Text(""))
        ask = Try((Call("ask", question, ANSWER),), (Remember(ANSWER, Text("")),))
        trying = Repeat(Number(TRIES), (*said, ask, If(Not(unanswered), (End(),))))
        if self.of == "fact":  # understood or not, there is nothing to thank for
            return (trying,)
        told = d.say("reminder_not_done")
        otherwise = If(Compare(Recall(ANSWER), "==", no), (told,))
        thanked = If(Compare(Recall(ANSWER), "==", yes), (d.say("thanks"),), (otherwise,))
        return (trying, thanked)
