"""Where something may be, if nobody knows for sure: in one of several places. Whatever takes it, or
asks whether it is there, then looks in one after the other (`Items` as the place of a `Thing`)."""

from __future__ import annotations

from dataclasses import replace

from grammar.chart import Node
from grammar.discourse import Discourse, Meeting, Steps, Thing, Where
from grammar.errors import NotUnderstood
from grammar.meanings.carrying import deliver
from grammar.meanings.deliveries import Delivery, delivered_last, taken_back
from grammar.meanings.finding import look_for
from grammar.meanings.place_sets import names_of
from grammar.meanings.registry import meaning
from grammar.meanings.searches import named_places, searched, searches
from grammar.plan import Call, ForEach, Items, Recall, Text, Value


@meaning("where_any")
def where_any(d: Discourse, node: Node) -> Where:
    """ "in the lobby or in the lounge", "in one of the three meeting rooms"."""
    kind: str | None = d.get(node, "kind")
    if kind is None:
        said = [d.get(node, "place"), *d.get(node, "place_list")]
        places: list[Value] = [name for each in said for name in names_of(d, each)]
    else:
        places = [Text(each.name) for each in d.lexicon.place_kinds[kind]]
        number = d.get(node, "number")
        if number is not None and int(number) != len(places):
            raise NotUnderstood(d.language.phrase("which_places"))
    if not all(isinstance(each, Text | Recall) for each in places):
        raise NotUnderstood(d.language.phrase("which_places"))
    return Where(places[0] if len(places) == 1 else Items(tuple(places)))


@meaning("where_others")
def where_others(d: Discourse, node: Node) -> Where:
    """ "from another copy room": from whichever of them has it."""
    places: Value = d.get(node, "kinds")
    named = named_places(d, places)
    if named is None:
        raise NotUnderstood(d.language.phrase("which_places"))
    return Where(named[0] if len(named) == 1 else Items(tuple(named)))


@meaning("other_ones")
def other_ones(d: Discourse, node: Node) -> Value:
    """ "the other two", after one of three: those of its kind."""
    looked = {each for each in _looked_in(d) if isinstance(each, Text)}
    kinds = [tuple(Text(each.name) for each in known) for known in d.lexicon.place_kinds.values()]
    alike = [kind for kind in kinds if looked and looked < set(kind)]
    narrowest = min(alike, key=len, default=())  # copy rooms, not all rooms
    others = tuple(each for each in narrowest if each not in looked)
    number = d.get(node, "number")
    if not others or (number is not None and int(number) != len(others)):
        raise NotUnderstood(d.language.phrase("which_places"))
    return Items(others)


def _looked_in(d: Discourse) -> list[Value | None]:
    """The places where something was looked for in vain."""
    condition = searched(d.done[-1] if d.done else None)
    if condition is not None:
        return [each.arguments.get("place") for each in searches(condition)]
    lost = d.scene.missing.place if d.scene.missing is not None else None
    return list(lost.items) if isinstance(lost, Items) else [lost or d.scene.place]


@meaning("look_on")
def look_on(d: Discourse, node: Node) -> Steps:
    """ "look in the other copy rooms": for what was looked for in vain, else going round them."""
    places: Value = d.get(node, "kinds")
    named = named_places(d, places)
    if named is not None:
        looked = looked_further(d, named)
        if looked is not None:
            return looked
    place = Recall(d.variable("place"))
    d.scene = d.scene.wandered()
    return [ForEach(place.name, places, (Call("goto", {"place": place}),))]


def looked_on_in(d: Discourse, places: Value) -> Steps | None:
    """The steps that look in places for what was just not found; None if nothing was."""
    named = named_places(d, places) if d.scene.missing is not None else None
    return looked_further(d, named) if named else None


def looked_further(d: Discourse, places: list[Value]) -> Steps | None:
    """The steps that look in more places for what was not found, or may not be found, before; None
    if nothing was looked for."""
    there = Items(tuple(places)) if len(places) > 1 else places[0]
    if d.scene.missing is not None:
        return look_for(d, replace(d.scene.missing, place=there, furniture=None))
    condition = searched(d.done[-1] if d.done else None)
    if (
        condition is not None
        and (thing := d.scene.thing if d.scene.thing_last else d.scene.person) is not None
    ):
        before = [each.arguments.get("place") for each in searches(condition)]
        d.done.pop()
        known = tuple(each for each in before if each is not None)
        return look_for(d, replace(thing, place=Items((*known, *places))))
    delivery = delivered_last(d)
    if delivery is None:
        return None
    taken = taken_back(d, delivery, Meeting(delivery.thing, holds=False))
    if taken is None:
        return None
    before = [each.arguments.get("place") for each in searches(taken.condition)]
    first = [each for each in before if each is not None]
    somewhere = Items((*first, *places))
    return [*look_for(d, replace(delivery.thing, place=somewhere)), *taken.steps]


@meaning("bring_instead")
def bring_instead(d: Discourse, node: Node) -> Steps:
    """ "if there is none, a banana": brought as what there was none of should have been."""
    thing: Thing = d.get(node, "thing")
    wanted: Delivery | None = (
        d.deliveries.meant_for if isinstance(d.deliveries.meant_for, Delivery) else None
    )
    if wanted is None:
        words = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("not_understood", part=words))
    if thing.place is None and d.scene.at is None:
        thing = replace(thing, place=wanted.thing.place)
    return deliver(d, thing, wanted.person, wanted.spot)
