"""What somebody is to sign or to read: it is shown to them, and stays in the robot's hand."""

from __future__ import annotations

from dataclasses import replace

from grammar.chart import Node
from grammar.discourse import Discourse, Steps, Thing
from grammar.errors import NotUnderstood
from grammar.meanings.carrying import pick_up
from grammar.meanings.deliveries import kept_in_hand
from grammar.meanings.finding import meet
from grammar.meanings.nouns import thing_it
from grammar.meanings.registry import meaning
from grammar.meanings.remarks import aside
from grammar.plan import Call, Value


@meaning("get_signed")
def get_signed(d: Discourse, node: Node) -> Steps:
    """ "have Clara sign the form", "take it to Clara and get it signed"."""
    thing: Thing = d.get(node, "thing") or thing_it(d, node)
    taken_there = kept_in_hand(d, asking=False) if thing.pronoun else None
    person: Thing | None = d.get(node, "person_ref") or d.scene.person
    if person is None:
        raise NotUnderstood(d.language.phrase("signed_by"))
    steps = pick_up(d, thing)
    if taken_there is None or person.value != d.scene.with_person:
        steps += meet(d, replace(person, here=False))
    phrase = str(node.production.fixed.get("phrase", "please_sign"))
    arguments: dict[str, Value] = {"question": d.sentence(phrase)}
    if person.known:
        arguments["person"] = person.value
    d.scene = replace(d.scene, person=person, holding=thing.value)
    d.deliveries = replace(d.deliveries, shown=thing.value)
    d.scene = d.scene.speaking_of(replace(thing, pronoun=True, place=None))
    return [*steps, Call("ask", arguments)]


@meaning("to_be_signed")
def to_be_signed(d: Discourse, node: Node) -> Steps:
    """ "the form needs Clara's signature": what is to be done with it is said then."""
    d.get(node, "person_ref")
    d.get(node, "thing")
    return aside(d, node)
