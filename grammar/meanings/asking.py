"""Putting a question to people: to one, who may have to be found first, to each of several, to
whoever comes.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import msgspec

from grammar.discourse import ANYONE, Discourse, Steps, Thing
from grammar.meanings.absences import answer_variable
from grammar.meanings.finding import (
    found,
    go,
    if_found,
    if_met,
    is_here,
    meet,
    particular,
    visits_only,
    waited_for,
    where_sent,
)
from grammar.meanings.persons import is_me
from grammar.meanings.surveys import Survey
from grammar.plan import (
    Ask,
    Call,
    ForEach,
    Holds,
    If,
    Items,
    Number,
    Recall,
    Repeat,
    Text,
    Value,
)


@dataclass(frozen=True)
class Audience:
    """Who is asked."""

    person: Thing | None
    way: Steps
    """How to get to them."""
    several: bool = False
    """Whether they are a group that was named or counted."""
    everybody: bool = False
    """Whether they are all who are there."""

    @property
    def many(self) -> bool:
        return self.several or self.everybody


def audience(d: Discourse, person: Thing | None) -> Audience:
    """Those who are asked, and the way to them."""
    if person is None:
        return Audience(None, [])
    person = where_sent(d, person)
    if person.group is not None or person.count is not None:
        way = go(d, person.place) if person.place is not None else []
        d.scene = replace(d.scene, person=replace(person, here=True))
        return Audience(person, way, several=True)
    if person.plural and (person.text == ANYONE or person.every):  # "ask each of them"
        way = go(d, person.place) if person.place is not None else []
        return Audience(person, way, everybody=True)
    if is_me(person):
        return Audience(person, [])
    way = []
    sought = particular(person) and not is_here(d, person)
    if person.known or person.first or person.place is not None or sought:
        way = meet(d, person)
        if sought and not way and d.scene.with_person != person.value:  # "ask the nurse"
            d.scene = replace(d.scene, with_person=person.value)
            way = [found(d, person)]
    d.scene = replace(d.scene, person=person if not person.first else d.scene.person)
    return Audience(person, way)


def put(
    d: Discourse,
    whom: Audience,
    call: Call,
    options: tuple[str, ...],
    nouns: frozenset[str] = frozenset(),
) -> Steps:
    """The question, put to those who are asked; `call` says nothing of them yet."""
    person, steps = whom.person, whom.way
    if person is not None and person.known:
        call = _to(call, person.value)
    if person is not None and person.count is not None:
        asking = asked(d, call, options, None, nouns)
        waited_for(d, person.value)
        waiting = Call("wait_for", {"thing": person.value})
        return [*steps, Repeat(Number(person.count), (waiting, asking))]
    if whom.many:
        return [*steps, *_to_each(d, person, call, options, nouns)]
    known = person.value if person is not None and person.known else None
    if person is None and isinstance(d.scene.with_person, Recall):  # whose turn it is in a round
        known = d.scene.with_person
        call = _to(call, known)
    elif (
        person is None
        and isinstance(d.scene.with_person, Text)
        and d.scene.with_person.value in d.people.named
    ):
        known = d.scene.with_person  # whoever was spoken to before
    who_else = (
        d.scene.place
        if d.loops.in_loop and isinstance(d.scene.place, Recall) and d.scene.place == d.scene.at
        else None
    )
    asking = asked(d, call, options, known or who_else, nouns)
    if known is None and who_else is not None and not is_me(person) and d.scene.with_person is None:
        # A round comes to places where nobody is.
        anyone = Text(ANYONE) if person is None else person.value
        return [*steps, If(Holds(Ask("sees", {"thing": anyone})), (asking,))]
    if person is not None and not steps:
        return if_met(d, person, [asking])
    return [*steps, asking]


def _to_each(
    d: Discourse,
    person: Thing | None,
    call: Call,
    options: tuple[str, ...],
    nouns: frozenset[str],
) -> Steps:
    """The question, put to one after the other: those named are looked for."""
    group = person.group if person is not None else None
    if isinstance(group, Items):
        visits_only(d, group)
    who = Recall(d.variable("person"))
    asking = asked(d, _to(call, who), options, who, nouns)
    if group is None or isinstance(group, Ask):
        return [ForEach(who.name, group or Ask("people"), (asking,))]
    d.scene = d.scene.wandered()
    return [ForEach(who.name, group, tuple(if_found(d, who, [asking])))]


def _to(call: Call, who: Value) -> Call:
    return msgspec.structs.replace(call, arguments={**call.arguments, "person": who})


def asked(
    d: Discourse,
    call: Call,
    options: tuple[str, ...],
    who: Value | None,
    nouns: frozenset[str] = frozenset(),
) -> Call:
    """Remember a question, so that its answers can be reported."""
    round_at = d.scene.place if d.loops.in_loop and isinstance(d.scene.place, Recall) else None
    d.answers = replace(d.answers, request=None)
    survey = Survey(call, options, who, round_at, nouns)
    d.answers = replace(d.answers, surveys=(*d.answers.surveys, survey))
    return call


def remember_answer(d: Discourse, options: tuple[str, ...], name: str) -> str:
    """Give the answer a variable; a choice of places is also where "there" is."""
    places = {each for place in d.lexicon.places for each in (place.name, d.called(place.name))}
    if options and all(option in places for option in options):
        variable = answer_variable(d, options) or d.variable("place")
        d.scene = replace(d.scene, place=Recall(variable))
    else:
        variable = answer_variable(d, options) or d.variable(name)
    d.answers = replace(d.answers, last=variable, options=options)
    d.reports = replace(d.reports, last=None, news=None, checked=None)
    d.answers = replace(d.answers, polled_for=None, said=None)
    return variable
