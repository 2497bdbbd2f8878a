"""Things that change places: "swap the mugs of Alice and Bob", "bring a new one back"."""

from __future__ import annotations

from dataclasses import replace

from grammar.chart import Node
from grammar.discourse import Discourse, Steps, Thing, Where
from grammar.errors import NotUnderstood
from grammar.meanings.carrying import deliver
from grammar.meanings.deliveries import Delivery
from grammar.meanings.finding import go
from grammar.meanings.nouns import spoken_of, thing
from grammar.meanings.places import own_place
from grammar.meanings.registry import meaning
from grammar.plan import Text


@meaning("thing_owned")
def thing_owned(d: Discourse, node: Node) -> Thing:
    """ "Bob's folder": in his office, if nobody says where it is."""
    owner: Thing = d.get(node, "owner")
    d.scene = replace(d.scene, person=owner)  # "Bob's folder in his office"
    found = thing(d, node)
    if found.place is None and found.furniture is None and d.scene.at is None:
        found = replace(found, place=own_place(d, owner))
    d.scene = replace(d.scene, person=owner)
    d.scene = d.scene.speaking_of(found)
    return found


@meaning("swap")
def swap(d: Discourse, node: Node) -> Steps:
    """Two things that change places: the first goes where the second is, and that where it was."""
    first: Thing = d.get(node, "first")
    second: Thing = d.get(node, "second")
    return swapped(d, node, first, second)


@meaning("swap_owned")
def swap_owned(d: Discourse, node: Node) -> Steps:
    """ "swap the mugs of Alice and Bob"."""
    what: Thing = d.get(node, "thing")
    one: Thing = d.get(node, "first")
    other: Thing = d.get(node, "second")
    first, second = (replace(what.single, place=own_place(d, each)) for each in (one, other))
    return swapped(d, node, first, second)


@meaning("swap_between")
def swap_between(d: Discourse, node: Node) -> Steps:
    """ "swap the plants in the library and in the lounge"."""
    what: Thing = d.get(node, "thing")
    places = (d.get(node, "one"), d.get(node, "other"))
    first, second = (replace(what.single, place=place) for place in places)
    return swapped(d, node, first, second)


def swapped(d: Discourse, node: Node, first: Thing, second: Thing) -> Steps:
    if not isinstance(first.place, Text) or not isinstance(second.place, Text):
        words = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("swap_where", what=words))
    its_place = Where(first.place, first.furniture)
    other_place = Where(second.place, second.furniture)
    if first.value == second.value:
        # The robot could take back the one that it has just put there: one waits where it starts.
        aside = deliver(d, first, None, Where(d.start()))
        there = deliver(d, second, None, its_place)
        back = go(d, d.start())
        waiting = replace(first, place=None, furniture=None, here=True)
        return [*aside, *there, *back, *deliver(d, waiting, None, other_place)]
    there = deliver(d, first, None, other_place)
    return [*there, *deliver(d, second, None, its_place)]


@meaning("one_of_them_so")
def one_of_them_so(d: Discourse, node: Node) -> Thing:
    """ "a new one", after a bottle was spoken of."""
    noun = spoken_of(d, node).noun
    return Thing(Text(f"{d.described_by(node.parts['adjectives'])} {noun}"), noun=noun)


@meaning("bring_one_back")
def bring_one_back(d: Discourse, node: Node) -> Steps:
    """ "take the bottle to the kitchen and bring a full one back": from there to where that was."""
    another: Thing = d.get(node, "thing")
    before: Delivery | None = d.deliveries.last
    spot: Where | None = d.get(node, "where")
    moved = before is not None and before.spot is not None and before.spot.place is not None
    if before is None or before.spot is None or not moved or another.place is not None:
        return deliver(d, another, None, spot)
    taken = replace(another, place=before.spot.place)
    back = Where(before.thing.place, before.thing.furniture)
    if back.place is None and spot is None:
        return deliver(d, taken, None, None)
    return deliver(d, taken, None, spot or back)
