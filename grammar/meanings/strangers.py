"""Guests whom nobody here knows: their name says nothing to the robot, so that whoever comes is
asked for it."""

from __future__ import annotations

from dataclasses import dataclass, replace

from grammar.chart import Node
from grammar.discourse import ANYONE, Discourse, Steps, Thing, Where
from grammar.meanings.finding import go
from grammar.meanings.registry import meaning
from grammar.meanings.remarks import aside
from grammar.plan import Call, Compare, Items, Recall, RepeatUntil, Text, Value


@dataclass(frozen=True)
class Announced:
    """A guest of whom it was said that they come, and where to."""

    name: str
    place: Value | None


@meaning("meet_stranger")
def meet_stranger(d: Discourse, node: Node) -> Steps:
    """ "meet Mr Keller at the elevator": whoever comes there is asked whether they are."""
    spot: Where | None = d.get(node, "from")
    return asked_for(d, called(d, node), None if spot is None else spot.place)


@meaning("stranger_comes")
def stranger_comes(d: Discourse, node: Node) -> Steps:
    """ "Mr Keller is coming to the reception": waited for there when they are to be met."""
    spot: Where | None = d.get(node, "from")
    place = None if spot is None else spot.place
    d.people = replace(d.people, announced=Announced(called(d, node), place))
    host = d.get(node, "host") or d.people.host
    d.people = replace(d.people, host=host)
    d.scene = replace(
        d.scene, person=Thing(Text(ANYONE), person=True, first=True, place=place), thing_last=False
    )
    if place is not None:
        d.scene = replace(d.scene, place=place)
    return aside(d, node)


def announced_one(d: Discourse, node: Node, place: Value | None = None) -> Steps | None:
    """How somebody is met who was announced, if a command to meet "them" is about that one."""
    guest: Announced | None = d.people.announced
    part = node.parts.get("person_ref", node.parts.get("thing"))
    them = isinstance(part, Node) and part.means in ("person_pronoun", "thing_it")
    if guest is None or not them or d.scene.person is None or not d.scene.person.first:
        return None
    d.people = replace(d.people, announced=None)
    return asked_for(d, guest.name, place or guest.place)


def as_announced(d: Discourse, going: Steps) -> Steps:
    """Whoever was announced is waited for, where the robot goes for that or where they come to."""
    guest: Announced = d.people.announced
    d.people = replace(d.people, announced=None)
    return [*going, *asked_for(d, guest.name, None if going else guest.place)]


def asked_for(d: Discourse, name: str, place: Value | None) -> Steps:
    """Whoever comes to a place, one after the other, is asked until one is who was expected."""
    going = go(d, place) if place is not None else []
    yes, no = Text(d.language.phrase("yes")), Text(d.language.phrase("no"))
    answer = d.variable("answer")
    question = Text(d.language.phrase("are_you", name=name))
    asking = Call("ask", {"question": question, "options": Items((yes, no))}, save_as=answer)
    visitor = Thing(Text(ANYONE), person=True, here=True)
    d.people = replace(d.people, visitor=visitor)
    d.scene = replace(d.scene.speaking_of_person(visitor), with_person=visitor.value)
    wait = Call("wait_for", {"thing": visitor.value})
    return [*going, RepeatUntil(Compare(Recall(answer), "==", yes), (wait, asking))]


def called(d: Discourse, node: Node) -> str:
    """The name that somebody is announced by."""
    part = node.parts["name"]
    part = part.parts.get("own", part) if isinstance(part, Node) else part  # "a visitor called Max"
    return d.words(part.start, part.end).title()
