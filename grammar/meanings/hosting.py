"""What a host does: introducing people to each other, leading somebody to somebody or by a way, and
knowing whom a guest is for."""

from __future__ import annotations

from dataclasses import replace

from grammar.chart import Node, what_it_means
from grammar.discourse import ANYONE, Discourse, Steps, Thing, Where
from grammar.errors import NotUnderstood
from grammar.meanings.carrying import deliver
from grammar.meanings.driving import go_to
from grammar.meanings.finding import meet, named, speak_to, where_sent
from grammar.meanings.genders import means_thing
from grammar.meanings.leading import lead
from grammar.meanings.people import guide, leave_out_fetching, led
from grammar.meanings.places import own_place, owner_of
from grammar.meanings.registry import meaning
from grammar.meanings.remarks import aside, expected
from grammar.meanings.reports import Report, found_out
from grammar.meanings.sights import who_has_come
from grammar.meanings.speaking import sentence_form
from grammar.plan import Call, Text, Value


@meaning("introduce")
def introduce(d: Discourse, node: Node) -> Steps:
    """ "introduce Mary to the guests in the living room": take her there, and say who she is."""
    who = led(d, node)
    remembered = d.scene.person
    to: Thing = where_sent(d, d.get(node, "to"))
    d.scene = replace(d.scene, person=remembered)
    steps: Steps = []
    if to.place is not None and to.place != d.scene.at:
        steps = [*meet(d, who), lead(d, who, to.place)]
        to = replace(to, here=to.plural)
    if to.known and to.group is None:
        saying = d.say("introducing_to", to=named(d, to), who=named(d, who))
    else:
        saying = d.say("introducing", who=named(d, who))
    return [*steps, *speak_to(d, to, [saying])]


@meaning("guide_to_person")
def guide_to_person(d: Discourse, node: Node) -> Steps:
    """ "take her to the man in the study": to where he is. Asks for a place that is not said."""
    things = means_thing(d, node.parts["person_ref"])
    before = d.scene.person
    thing = None if things else led(d, node)
    to = node.parts["other"]
    if thing is not None and isinstance(to, Node) and what_it_means(to) == "person_pronoun":
        someone_else = before is not None and before.value != thing.value
        person = before if someone_else else d.one_called(to.start, to.end)
        d.scene = replace(d.scene, person=person)  # "her" is no visitor
    other: Thing = d.get(node, "other")
    if things and d.scene.thing is not None:
        return deliver(d, replace(d.scene.thing, pronoun=True), other, None)
    return led_to(d, thing, other)


def led_to(d: Discourse, person: Thing | None, other: Thing) -> Steps:
    """Lead somebody to where somebody else is: where they are said to be, else to their own place,
    as "bring the visitor to Alice" is to her office."""
    place = other.place
    if place is None and other.known:
        place = own_place(d, other)
    if place is None or person is None or other.value == person.value:
        host = named(d, other)
        words = host if isinstance(host, str) else d.language.phrase("somebody")
        raise NotUnderstood(d.language.phrase("where_is_person", person=words))
    if person.value == d.scene.with_person:
        leave_out_fetching(d)
    steps: Steps = [*meet(d, person), lead(d, person, place)]
    told_apart = other.known or " " in other.text
    if other.place is not None and told_apart and not other.plural:  # "to the man waving there"
        steps.append(Call("find", {"thing": other.value, "place": place}))
    d.scene = replace(
        d.scene, person_on_arrival=d.scene.person
    )  # "take the visitor to Clara and tell her ...": it is her place
    return steps


@meaning("guide_by_way")
def guide_by_way(d: Discourse, node: Node) -> Steps:
    """ "take her to the study via the kitchen"."""
    way: Value = d.get(node, "by_way")
    steps = guide(d, node)
    last = steps[-1]
    if not isinstance(last, Call) or last.method != "guide":
        raise NotUnderstood(d.language.phrase("guide_needs_place"))
    return [*steps[:-1], Call("guide", {**last.arguments, "place": way}), last]


@meaning("go_by_way")
def go_by_way(d: Discourse, node: Node) -> Steps:
    """ "go to the study via the kitchen"."""
    way: Value = d.get(node, "by_way")
    return [Call("goto", {"place": way}), *go_to(d, node)]


@meaning("bare_place")
def bare_place(d: Discourse, node: Node) -> Value:
    place: Value | Where = d.get(node, "place")
    return place.place or Text("") if isinstance(place, Where) else place


@meaning("cannot_do")
def cannot_do(d: Discourse, node: Node) -> Steps:
    """ "pour the milk into the cup": known, and beyond the methods of a robot."""
    raise NotUnderstood(d.language.phrase("cannot_do", what=d.words(node.start, node.end)))


@meaning("guest_for")
def guest_for(d: Discourse, node: Node) -> Steps:
    """ "there is a visitor for Clara in the lobby": it is about the visitor; who is told of it is
    Clara."""
    host = d.get(node, "host")
    d.people = replace(d.people, host=host)
    guest: Thing = d.get(node, "person_ref")
    spot: Where | None = d.get(node, "where")
    if spot is not None:
        guest = replace(guest, place=spot.place, furniture=spot.furniture)
    if node.production.fixed.get("coming"):
        guest = expected(guest)
    d.scene = replace(d.scene, person=guest)
    d.people = replace(d.people, visitor=guest)
    d.scene = replace(d.scene, place=guest.place or d.scene.place, thing_last=False)
    told = d.words(node.start, node.end)
    d.reports = replace(
        d.reports, last=Report("only", Text(sentence_form(told)), about_here=False), step=None
    )
    return aside(d, node)


@meaning("announce_guest")
def announce_guest(d: Discourse, node: Node) -> Steps:
    """ "ask for her name, take her to Clara and announce her": whom she is with by then, or whom
    she is for, is told who has come."""
    here, known = owner_of(d), d.people.last_named
    guest: Thing = led(d, node) or Thing(Text(ANYONE), person=True, here=True)
    host: Thing | None = d.get(node, "host")
    if host is None and here is not None:
        host = Thing(here, known=True, person=True)
    host = host or d.people.host or known
    if host is None:
        raise NotUnderstood(d.language.phrase("announced_to"))
    d.people = replace(d.people, visitor=d.people.visitor or guest)
    news = who_has_come(d)
    return [] if news is None else found_out(d, news, host, back=False)
