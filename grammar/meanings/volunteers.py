"""Somebody of whom only they themselves can tell that they are it: "somebody who speaks French".

They are asked one after the other until one says yes, with whom the rest is done. Where nobody
does, that is said.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import msgspec

from grammar.chart import Node
from grammar.discourse import ANYONE, START, Discourse, Steps, Thing
from grammar.meanings.asking import asked, remember_answer
from grammar.meanings.descriptions import described
from grammar.meanings.finding import go
from grammar.meanings.options import options_of
from grammar.meanings.persons import by_furniture, known_by_name
from grammar.meanings.places import kind_places, only_taken_apart
from grammar.meanings.registry import meaning
from grammar.meanings.surveys import moved
from grammar.plan import (
    Ask,
    Call,
    Compare,
    Condition,
    End,
    ForEach,
    Holds,
    If,
    Items,
    Not,
    Recall,
    Remember,
    Text,
    Value,
)
from grammar.tidy import mentions


@dataclass(frozen=True)
class Willing:
    """Somebody who is to be found by asking."""

    person: Thing
    """Of whom it may be anyone."""
    question: str
    options: tuple[str, ...]
    places: Value | None = None
    """Where to ask, if in several places."""


@meaning("person_willing")
def person_willing(d: Discourse, node: Node) -> Willing:
    only_taken_apart(d, node)
    return willing(d, node)


def willing(d: Discourse, node: Node) -> Willing:
    kind = str(d.get(node, "kind_of_person", ANYONE))
    person = replace(by_furniture(d, described(d, kind, node)), person=True)
    question = node.parts["question"]
    assert isinstance(question, Node)
    text: str = d.build(question)
    options = options_of(d, question) or (d.language.phrase("yes"), d.language.phrase("no"))
    # "go through the offices and find somebody who ..."
    places = kind_places(d, d.get(node, "kinds")) if "kinds" in node.parts else None
    return Willing(person, text, options, places)


def over_willing(d: Discourse, node: Node, wanted: Willing, one: Callable[[Any], Steps]) -> Steps:
    """A command about whoever says yes: "bring somebody who speaks French to the reception"."""
    search, found = search_for(d, wanted)
    agreed = Thing(found, known=True, person=True, here=True)
    d.scene = replace(d.scene.speaking_of_person(agreed), with_person=found)
    body = [step for step in one(agreed) if not looks_for(step, found)]
    d.scene = d.scene.speaking_of_person(
        replace(d.scene.person or agreed, value=found, known=True, here=True)
    )
    d.scene = replace(d.scene, with_person=found)
    return [*search, If(_nobody(found), (d.say("nobody_agreed"),), tuple(body))]


def search_for(d: Discourse, wanted: Willing) -> tuple[Steps, Recall]:
    """The steps that ask one after the other, and the name of who has said yes, or nothing."""
    found = Recall(d.variable("found_person"))
    person = wanted.person
    answer = remember_answer(d, wanted.options, "answer")
    arguments: dict[str, Value] = {
        "question": Text(wanted.question),
        "options": Items(tuple(map(Text, wanted.options))),
    }
    who = Recall(d.variable("person"))
    call = Call("ask", {**arguments, "person": who}, save_as=answer)
    asking = asked(d, call, wanted.options, who)
    yes = Compare(Recall(answer), "==", Text(d.language.phrase("yes")))
    agreed = If(yes, (Remember(found.name, who), End()))
    nothing = Remember(found.name, Text(""))
    by_name = known_by_name(d, person, person.text)
    d.scene = replace(d.scene, at=d.scene.at if wanted.places is None else None)
    if by_name and wanted.places is None:
        there = Holds(Ask("find", {"thing": who}))
        return [nothing, ForEach(who.name, Items(by_name), (If(there, (asking, agreed)),))], found
    everybody = ForEach(who.name, Ask("people"), (asking, agreed))
    here = person.place or d.scene.at
    if wanted.places is None and here is not None:
        return [*go(d, here), nothing, everybody], found
    place = Recall(d.variable("place"))
    going = Call("goto", {"place": place})
    leave = If(Not(_nobody(found)), (End(),))
    round_of = ForEach(place.name, wanted.places or Ask("places"), (going, everybody, leave))
    d.scene = replace(d.scene, at=None)
    return [nothing, round_of], found


def looks_for(step: object, who: Recall) -> bool:
    """Whether a step does nothing but look for somebody, who is here."""
    return isinstance(step, Call) and step.method == "find" and step.arguments["thing"] == who


def _nobody(found: Recall) -> Condition:
    return Compare(found, "==", Text(""))


def just_found(d: Discourse) -> tuple[Condition, Thing] | None:
    """Whether somebody has said yes in the search that the step before is; what it says if not is
    taken out of the steps, for that is told otherwise."""
    found = found_by(d.done[-1]) if d.done else None
    if found is None or d.done[-1].otherwise:  # type: ignore[union-attr]
        return None
    d.done.pop()
    return Not(_nobody(found)), Thing(found, known=True, person=True)


def guard_found(done: Steps) -> Steps:
    """Steps with whoever has said yes are done if somebody has: they go where that is known, with
    all that stands between."""
    for at, step in enumerate(done):
        found = found_by(step)
        if found is None:
            continue
        last = max((n for n in range(at + 1, len(done)) if mentions(done[n], found)), default=at)
        while last + 1 < len(done) and not moved([done[last + 1]]):
            last += 1  # "and tell her that ...": said to who is here
        assert isinstance(step, If)
        inner = (*step.otherwise, *done[at + 1 : last + 1])
        rest = guard_found(done[last + 1 :])
        home = Recall(START)
        back = [Call("goto", {"place": home})] if mentions(inner, home) else []
        both = msgspec.structs.replace(step, then=(*back, *step.then), otherwise=inner)
        return [*done[:at], both, *rest]
    return done


def found_by(step: object) -> Recall | None:
    """Whom a step has found who has said yes."""
    if not isinstance(step, If) or not isinstance(step.condition, Compare):
        return None
    left, right = step.condition.left, step.condition.right
    is_it = isinstance(left, Recall) and left.name.startswith("found_person") and right == Text("")
    return left if is_it and isinstance(left, Recall) else None
