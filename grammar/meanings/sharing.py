"""Things that are shared out: "an apple for me and one for Bob", "two apples, one for each".

A robot holds one thing, so that each share is fetched and handed over by itself. Where the first is
taken from, the others are, too, unless something else is said; and what was to be fetched before
("get two apples from the kitchen") is now fetched for those who get it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

from grammar.chart import Leaf, Node
from grammar.discourse import ANYONE, Discourse, Steps, Thing, Where
from grammar.errors import NotUnderstood
from grammar.meanings.carrying import deliver
from grammar.meanings.nouns import spoken_of
from grammar.meanings.places import source_of
from grammar.meanings.registry import meaning
from grammar.meanings.several_things import begun_before
from grammar.meanings.sources import where_told
from grammar.meanings.thing_lists import off_the_list, other_of_two
from grammar.plan import Items, Text, Value


@dataclass(frozen=True)
class Share:
    """What one of them gets, or what is put in one place."""

    thing: Thing
    person: Thing | None
    where: Where | None = None


@meaning("one_more")
def one_more(d: Discourse, node: Node) -> Thing:
    """ "one", "the other one": of what was spoken of, where that is taken from."""
    other = other_of_two(d, "") if node.production.fixed.get("other") else None
    one = other or replace(spoken_of(d, node).single, here=False)
    spot: Where | None = d.get(node, "where")
    return one if spot is None else replace(one, place=spot.place, furniture=spot.furniture)


@meaning("one_there")
def one_there(d: Discourse, node: Node) -> Thing:
    """ "the one in the lounge": another of what was spoken of, or somebody if that was no thing."""
    if d.scene.thing is not None and (d.scene.thing_last or d.scene.person is None):
        return one_more(d, node)
    spot: Where = d.get(node, "where")
    person = Thing(Text(ANYONE), person=True, place=spot.place, furniture=spot.furniture)
    d.scene = d.scene.speaking_of_person(person)
    return person


@meaning("several_of")
def several_of(d: Discourse, node: Node) -> Thing:
    """ "two apples", before it is said who gets which."""
    thing: Thing = d.get(node, "thing")
    return replace(thing, count=int(d.get(node, "count")))


@meaning("share")
def share(d: Discourse, node: Node) -> Share:
    """ "a coffee for Alice": who gets what; "one in the lobby": what is put where."""
    return Share(d.get(node, "thing"), d.get(node, "person_ref"), d.get(node, "where"))


@meaning("receivers")
def receivers(d: Discourse, node: Node) -> list[Thing]:
    """ "Bob and me": each gets one."""
    named = [d.build(part) for part in node.parts.values()]
    return [
        person for each in named for person in (each if isinstance(each, list) else named_in(each))
    ]


def named_in(person: Thing) -> list[Thing]:
    """Somebody, or all of those who are named together."""
    if not isinstance(person.group, Items):
        return [person]
    return [Thing(name, known=True, person=True) for name in person.group.items]


@meaning("shares")
def shares(d: Discourse, node: Node) -> Steps:
    """ "Alice a coffee and Bob a tea"."""
    whole: Thing | None = d.get(node, "whole")
    source: Where | None = d.get(node, "from")
    begun = begun_before(d) if whole is None else whole
    return shared_out(d, shares_in(d, node), begun, source)


@meaning("shared_with")
def shared_with(d: Discourse, node: Node) -> Steps:
    """ "an apple for Bob and me", "... to both of them, one each"."""
    begun = begun_before(d)
    thing: Thing = d.get(node, "thing") or one_more(d, node)
    people: list[Thing] = d.get(node, "all")
    return shared_out(d, [Share(thing, person) for person in people], begun, None)


@meaning("lacking_there")
def lacking_there(d: Discourse, node: Node) -> Steps:
    """ "two chairs are missing in the lab": what is brought next is for there."""
    spot: Where = d.get(node, "where")
    thing: Thing = d.get(node, "thing")
    d.scene = d.scene.speaking_of(thing)
    d.scene = replace(d.scene, lacking=replace(thing, place=spot.place, furniture=spot.furniture))
    d.background += (d.words(node.start, node.end),)
    return []


def shares_in(d: Discourse, node: Node) -> list[Share]:
    """The shares of a list, from left to right."""
    found: list[Share] = []
    each: Leaf | Node | None = node
    while isinstance(each, Node):
        found.append(d.build(each.parts["first"]))
        each = each.parts.get("rest")
    return found


def shared_out(
    d: Discourse, given: list[Share], whole: Thing | None, source: Where | None
) -> Steps:
    """One delivery for each share, taken from where the first one is unless it says otherwise."""
    if whole is not None and whole.count is not None and whole.count != len(given):
        raise NotUnderstood(
            d.language.phrase("not_all_shared", number=whole.count, shares=len(given))
        )
    first = where_told(d, whole or given[0].thing)
    source = source or d.deliveries.taken_from
    place = first.place if source is None else source.place
    furniture = first.furniture if source is None else source.furniture
    place = place or d.scene.at
    steps: Steps = []
    for each in given:
        thing = off_the_list(d, each.thing)
        if thing.place is None and not thing.here:
            thing = replace(thing, place=place, furniture=thing.furniture or furniture)
        if each.where is not None and thing.place is None and not thing.here and steps:
            place = source_in(d, steps, thing)  # and not where the share before was put
            thing = replace(thing, place=place)
        if thing.place is None:
            d.scene = replace(
                d.scene, at=None
            )  # nobody says that it is where the share before was brought to
        steps += d.sequence(partial(hand_out, d, thing, each))
    return steps


def source_in(d: Discourse, steps: Steps, thing: Thing) -> Value | None:
    """Where a thing was taken in steps that are not among those done yet."""
    outer, d.done = d.done, steps
    try:
        return source_of(d, thing)
    finally:
        d.done = outer


def hand_out(d: Discourse, thing: Thing, share: Share) -> None:
    """Bring one of them to whom, or where, it is for."""
    d.done.extend(deliver(d, thing, share.person, share.where))
