"""Visitors: sent somewhere, or led to somebody of whom only they can tell who it is.

"Ask who they want to see and take them to that person's office": the question then offers the names
of those who have an office, and the answer is a part of the name of the place.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import msgspec

from grammar.chart import Leaf, Node
from grammar.discourse import Discourse, Steps, Thing, Where
from grammar.errors import NotUnderstood
from grammar.meanings.alternatives import itself
from grammar.meanings.finding import meet, named, speak_to
from grammar.meanings.hosts import SOMEBODY, place_of_named
from grammar.meanings.leading import lead
from grammar.meanings.people import followed, led
from grammar.meanings.persons import is_me, person_pronoun
from grammar.meanings.questions import ask
from grammar.meanings.references import survey_named
from grammar.meanings.registry import meaning
from grammar.meanings.reports import found_out
from grammar.meanings.sights import names_here
from grammar.meanings.speaking import sentence_form
from grammar.meanings.waiting import moment
from grammar.naming import place_called
from grammar.plan import Call, Recall, Repeat, Text, Value
from grammar.tidy import nodes

LED_AWAY: Final = frozenset({"guide", "guide_where_wanted", "guide_nowhere", "send_person"})
SPOKEN_TO: Final = frozenset({"ask", "ask_to", "say_that"})
"""Commands that are about one visitor after the other."""


@meaning("send_person")
def send_person(d: Discourse, node: Node) -> Steps:
    """ "send her to the reception": tell her to go there."""
    person: Thing = d.get(node, "person_ref")
    if "to" in node.parts:
        host: Thing = d.get(node, "to")
        d.scene = replace(d.scene, person=person)
        return speak_to(d, person, [d.say("please_go", place=named(d, host))])
    spot: Where = d.get(node, "spot")
    if spot.place is None:
        raise NotUnderstood(d.language.phrase("where_is_there"), gap=(node.start, node.end))
    called: Value | str = spot.place
    if isinstance(spot.place, Text):
        called = place_called(spot.place.value, d.lexicon, d.language)
    return speak_to(d, person, [d.say("please_go", place=called)])


@meaning("tour")
def tour(d: Discourse, node: Node) -> Steps:
    """ "show the visitor the library, then the lounge": to one after the other."""
    person = led(d, node)
    steps = meet(d, person)
    with_me = node.production.fixed.get("along") and is_me(d.get(node, "person_ref"))
    go_on = followed if with_me else lead
    return [*steps, *(go_on(d, person, place) for place in d.get(node, "stops"))]


@meaning("tour_told")
def tour_told(d: Discourse, node: Node) -> Steps:
    """ "give them a tour: in the lab tell them ..., then go on to the library and say ..."."""
    person = led(d, node)

    def make() -> None:
        d.done.extend(meet(d, person))
        stops: Leaf | Node | None = node.parts["stops"]
        while isinstance(stops, Node):
            stop = stops.parts["first"]
            assert isinstance(stop, Node)
            d.done.append(lead(d, person, d.get(stop, "place")))
            if "steps" in stop.parts:
                d.done.extend(d.build(stop.parts["steps"]))
            stops = stops.parts.get("rest")

    return d.sequence(make)


@meaning("tour_goes_on")
def tour_goes_on(d: Discourse, node: Node) -> Steps:
    """ "finish at the reception": with whoever was led before."""
    spot: Where = d.get(node, "spot")
    guest = next(
        (
            each.arguments["person"]
            for each in reversed([*nodes(tuple(d.done))])
            if isinstance(each, Call) and each.method == "guide"
        ),
        None,
    )
    if guest is None or spot.place is None:
        words = d.words(node.start, node.end)
        raise NotUnderstood(
            d.language.phrase("not_understood", part=words), gap=(node.start, node.end)
        )
    wish = node.parts.get("wish")  # "with a goodbye"
    said = [] if wish is None else [sentence_form(d.words(wish.start, wish.end))]
    leading = lead(d, Thing(guest, person=True, here=True), spot.place)
    return [leading, *(Call("say", {"text": Text(each)}) for each in said)]


def with_each_asked(d: Discourse, clause: Node) -> Steps | None:
    """ "Ask the next three visitors where they want to go and take them there": each of them in the
    round in which they are asked, or greeted."""
    loop = d.done[-1] if d.done else None
    command = itself(clause)
    part = command.parts.get("person_ref")
    about_one = command.means in LED_AWAY | SPOKEN_TO
    if not isinstance(loop, Repeat) or not about_one or not isinstance(part, Node):
        return None
    of_them = part.means in ("person_pronoun", "person_group_them")
    asked = d.answers.surveys and any(
        each is d.answers.surveys[-1].call for each in nodes(loop.steps)
    )
    if not of_them or d.scene.person is None:
        return None
    met = d.scene.person.count is not None and len(loop.steps) > 1
    if not met and not (asked and command.means in LED_AWAY):
        return None
    d.done.pop()
    outer, d.done = d.done, list(loop.steps)
    inside = d.loops.in_loop
    d.loops = replace(d.loops, in_loop=True)
    d.bind(part, replace(d.scene.person, count=None, plural=False, place=None, here=True))
    steps = d.build(clause)
    body = (*d.done, *steps)
    d.done = outer
    d.loops = replace(d.loops, in_loop=inside)
    d.scene = d.scene.wandered()
    return [msgspec.structs.replace(loop, steps=body)]


@meaning("to_the_next")
def to_the_next(d: Discourse, node: Node) -> Steps:
    """ "go on to the next one": what a round does in any case."""
    if not d.loops.in_loop:
        words = d.words(node.start, node.end)
        raise NotUnderstood(
            d.language.phrase("not_understood", part=words), gap=(node.start, node.end)
        )
    return []


@meaning("guard")
def guard(d: Discourse, node: Node) -> Steps:
    """ "keep watch": to stay, for what is to be done whenever somebody comes."""
    d.people = replace(d.people, on_duty="guard")
    return moment(d, node)


@meaning("find_name")
def find_name(d: Discourse, node: Node) -> Steps:
    """ "find out their name": a visitor is asked; of others it is told who is seen."""
    if d.people.visitor is not None:
        return ask(d, node)
    found = names_here(d, node)
    return found if isinstance(found, list) else found_out(d, found, None, back=True)


@meaning("place_of_answer")
def place_of_answer(d: Discourse, node: Node) -> Value:
    """ "that person's office", of whoever was named in an answer."""
    part = node.parts.get("noun")
    if part is not None:
        survey = survey_named(d, part.start, part.end)
    else:
        survey = next(
            (
                each
                for each in reversed(d.answers.surveys)
                if SOMEBODY in each.nouns or each.options
            ),
            None,
        )
    place = None if survey is None else place_of_named(d, survey, d.get(node, "kind"))
    if place is None:
        words = d.words(node.start, node.end)
        raise NotUnderstood(
            d.language.phrase("not_understood", part=words), gap=(node.start, node.end)
        )
    if part is not None:
        d.resolve(range(part.start, part.end))
    d.scene = replace(d.scene, place=place)
    return place


@meaning("person_of_answer")
def person_of_answer(d: Discourse, node: Node) -> Thing:
    """ "that person", "whoever they want to see": at the place of theirs, if an answer tells who it
    is; else whoever was spoken of."""
    survey = next((each for each in reversed(d.answers.surveys) if SOMEBODY in each.nouns), None)
    place = None if survey is None else place_of_named(d, survey)
    if survey is None or place is None:
        return person_pronoun(d, node)
    who = Recall(str(survey.call.save_as))
    person = Thing(who, place=place, known=True, person=True)
    d.scene = d.scene.speaking_of_person(person)
    return person
