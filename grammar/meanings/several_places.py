"""What is done in several places, or in the first of them that is so."""

from __future__ import annotations

from dataclasses import replace

from grammar.chart import Node
from grammar.discourse import (
    ANYONE,
    Discourse,
    Steps,
    Thing,
)
from grammar.meanings.best_places import Best, Such, first_such, survey
from grammar.meanings.chosen import by_choice, chosen_of
from grammar.meanings.finding import found, look_for, not_found
from grammar.meanings.guards import guard_finds
from grammar.meanings.one_round import One, round_of_steps
from grammar.meanings.places import stands_behind_it
from grammar.meanings.searches import named_places, search_in, searched
from grammar.meanings.several_things import (
    another_one,
)
from grammar.plan import (
    Ask,
    Call,
    Choice,
    End,
    ForEach,
    Holds,
    If,
    Not,
    Recall,
    Remember,
    Step,
    Text,
    Truth,
    Value,
)


def over_places(d: Discourse, node: Node, places: Value, one: One) -> Steps:
    place = Recall(d.variable("place"))
    d.scene = replace(d.scene, at=None)
    d.loops = replace(d.loops, places={**d.loops.places, place.name: places})
    body = round_of_steps(d, lambda: one(place))
    d.scene = d.scene.wandered()
    return until_found(d, place, places, body) or [
        ForEach(place.name, places, tuple(another_one(d, body)))
    ]


def until_found(d: Discourse, place: Recall, places: Value, body: Steps) -> Steps:
    """ "search every ward for the thermometer": until it is found; nothing if that is not what is
    done at each place."""
    first = body[0] if len(body) == 1 else None
    search = searched(first)
    if search is None or not isinstance(first, If):
        return []
    known = named_places(d, places)
    thing = d.scene.thing if d.scene.thing_last else d.scene.person
    if known is not None and thing is not None:
        it, them = d.scene.thing, d.scene.person
        d.scene = replace(
            d.scene,
            thing=it and replace(it, place=None),
            person=them and replace(them, place=None),
        )
        return search_in(d, replace(thing, place=None), known)
    missing = first.then
    found_it = Recall(d.variable("found"))
    success = (Remember(found_it.name, Truth(True)), End())
    return [
        Remember(found_it.name, Truth(False)),
        ForEach(place.name, places, (If(search, success),)),
        If(Not(Holds(found_it)), missing),
    ]


def over_either_place(d: Discourse, node: Node, places: list[Value], one: One) -> Steps:
    """ "look for it in the lobby or the kitchen": in the one, then in the other; of those between
    which somebody was asked to choose, only the one they chose."""
    chosen = chosen_of(d, [each.value for each in places if isinstance(each, Text)])
    if chosen is not None and len(chosen) == len(places) > 1:
        return by_choice(d, chosen, places, one)
    looked: Value | None = None
    for place in places:
        d.scene = replace(d.scene, at=None)
        search = d.sequence(lambda p=place: d.done.extend(one(p)))  # type: ignore[misc]
        first = search[0] if len(search) == 1 else None
        if not (isinstance(first, Call) and first.method == "find"):
            named_places = tuple(each.value for each in places if isinstance(each, Text))
            raise d.which(node.start, node.end, named_places)
        looked = first.arguments["thing"]
    assert looked is not None
    return search_in(d, Thing(looked), places)


def over_any_place(d: Discourse, node: Node, places: Value, one: One) -> Steps:
    """ "any office": one of them, no matter which."""
    if isinstance(places, Text):
        return one(places)
    place = Recall(d.variable("place"))
    d.scene = replace(d.scene, place=place)
    return [Remember(place.name, Choice(places)), *one(place)]


def over_place_best(d: Discourse, node: Node, best: Best, one: One) -> Steps:
    """ "the office with the fewest people": gone round for first."""
    going, place = survey(d, best)
    d.scene = replace(d.scene, place=place)
    return [*going, *one(place)]


def over_place_such(d: Discourse, node: Node, such: Such, one: One) -> Steps:
    """ "an empty office": the first that is; if none is, that is said."""
    going, place, none = first_such(d, such)
    d.scene = replace(d.scene, place=place)
    return [*going, If(none, (d.say("no_such_places"),), tuple(guard_finds(d, one(place))))]


def over_place_where(d: Discourse, node: Node, thing: Thing, one: One) -> Steps:
    """ "where Bob is": he is looked for, and that is the place."""
    before = d.scene
    behind_it = stands_behind_it(d, node)
    held = d.scene.holding is not None
    searching = look_for(d, thing)
    place = Recall(d.variable("place"))
    d.scene = d.scene.arrived(place)
    if behind_it:
        d.scene = replace(d.scene.with_it_of(before), at=place if held else None)
    outer = d.loops.at_people
    d.loops = replace(d.loops, at_people=True)  # what is brought there need not be there
    body = one(place)
    d.loops = replace(d.loops, at_people=outer)
    it = before.thing if behind_it else None
    if it is not None and body[:1] == [Call("grab", {"thing": it.value})]:
        if (
            searched(d.done[-1] if d.done else None) is not None
        ):  # it was only found, and is elsewhere
            d.done.pop()
        body = [found(d, it), *body]
    if body == [Call("goto", {"place": place})]:
        return searching
    here: Step = Remember(place.name, Ask("location"))
    there = Holds(Ask("find", found(d, thing).arguments))
    if body[:1] == [Call("guide", {"person": Text(ANYONE), "place": place})]:
        body = [Call("goto", {"place": d.start()}), *body]  # whoever is led waits where it began
    return [If(there, (here, *guard_finds(d, body)), (not_found(d, thing),))]
