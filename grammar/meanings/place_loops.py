"""Rounds of places among the steps so far, and the places that a noun phrase makes one of."""

from __future__ import annotations

from typing import Final

from grammar.chart import Node
from grammar.discourse import Discourse, Steps
from grammar.errors import NotUnderstood
from grammar.meanings.news import News
from grammar.meanings.places import kind_places
from grammar.meanings.searches import searched, searches
from grammar.plan import (
    Ask,
    Call,
    Collect,
    ForEach,
    Increase,
    Items,
    Recall,
    Remember,
    SetItem,
    Step,
    Text,
    Value,
)
from grammar.tidy import nodes

CARRIES: Final = frozenset({"grab", "guide", "follow", "wait_for", "scan"})
"""By these what is done at a place may go on elsewhere."""


def places_of(d: Discourse, node: Node) -> Value:
    """The places that are gone round: all of a kind, or those listed."""
    listed: list[Value] | None = d.get(node, "place_list")
    if listed:
        places = (d.get(node, "place"), *listed)
        if not all(isinstance(each, Text | Recall) for each in places):
            raise NotUnderstood(d.language.phrase("which_places"))
        return Items(places)
    return kind_places(d, d.get(node, "kinds"))


def round_of(d: Discourse, places: Value, what: Steps, place: str) -> Step:
    """Go to each place and do something there."""
    going = Call("goto", {"place": Recall(place)})
    return ForEach(place, places, (going, *what))


def last_round(d: Discourse) -> int | None:
    """Where among the steps so far the last round of places is."""
    for at in range(len(d.done) - 1, -1, -1):
        step = d.done[at]
        if isinstance(step, ForEach) and step.steps and goes_to(step.steps[0], step.variable):
            return at
    return None


def same_round(d: Discourse, places: Value) -> bool:
    """Whether these places were gone round just before, and what was found out is told already: "I
    need to know which labs are free. Go round the labs and tell me"."""
    at = last_round(d)
    loop = None if at is None else d.done[at]
    found: News | None = d.reports.news
    told = found is not None and d.done[len(d.done) - len(found.words) :] == found.words
    return told and isinstance(loop, ForEach) and loop.items == places


def of_those(d: Discourse, places: Value) -> Value:
    """ "visit offices 1 to 4. In every office ...": of all places of a kind, those that the step
    before went to for nothing else, which then comes to nothing."""
    loop = visits_alone(d)
    visited = loop.items.items if loop is not None and isinstance(loop.items, Items) else ()
    kinds = d.lexicon.place_kinds
    meant = next((kinds[kind] for kind in kinds if kind_places(d, kind) == places), ())
    names = [Text(each.name) for each in meant]
    if loop is None or not visited or not all(each in names for each in visited):
        return places
    d.done.pop()
    return loop.items


def of_them(d: Discourse) -> Value:
    """ "visit the labs. See if there is a fan in each of them": of the places that the steps before
    went to for nothing else."""
    round_of_visits(d)
    loop = visits_alone(d)
    if loop is None:
        raise NotUnderstood(d.language.phrase("which_places"))
    d.done.pop()
    return loop.items


def visits_alone(d: Discourse) -> ForEach | None:
    """The step before, if it is a round that does nothing at any place."""
    loop = d.done[-1] if d.done else None
    if not isinstance(loop, ForEach) or len(loop.steps) > 1:
        return None
    return loop if loop.steps and goes_to(loop.steps[0], loop.variable) else None


def round_of_visits(d: Discourse) -> int | None:
    """ "go to the lobby and the kitchen and see where ...", "check the lobby and the kitchen for
    cups and tell me which ...": what was said of both, as a round."""
    visits: list[Value] = []
    condition = searched(d.done[-1] if d.done else None)
    looked_in = [] if condition is None else [each.arguments for each in searches(condition)]
    if len(looked_in) > 1 and all("place" in each for each in looked_in):
        d.done[-1:] = [Call("goto", {"place": each["place"]}) for each in looked_in]
    while d.done and isinstance(last := d.done[-1], Call) and "place" in last.arguments:
        if last.method != "goto":
            break
        visits.insert(0, last.arguments["place"])
        d.done.pop()
    if len(visits) < 2:
        d.done += [Call("goto", {"place": each}) for each in visits]
        return None
    d.done.append(round_of(d, Items(tuple(visits)), [], d.variable("place")))
    return len(d.done) - 1


def goes_to(step: Step, variable: str) -> bool:
    return step == Call("goto", {"place": Recall(variable)})


def end_of_stop(steps: Steps, here: Recall) -> int:
    """Where what is done at each place ends, and what is done once begins, when all have been
    visited: "go to every ward and say good night, then go to the charger". What is brought there
    from a place, and what is told there of it, belongs to the place."""
    made = {
        each.name
        for each in nodes(tuple(steps))
        if isinstance(each, Remember | Collect | Increase | SetItem)
    } | {here.name}
    if any(isinstance(each, Call | Ask) and each.method in CARRIES for each in nodes(tuple(steps))):
        return len(steps)
    for at, step in enumerate(steps):
        used = {each.name for each in nodes(tuple(steps[at:])) if isinstance(each, Recall)}
        if at and goes_to_name(step) and not used & made:
            return at
    return len(steps)


def goes_to_name(step: Step) -> bool:
    """Whether a step goes to a place that has a name, whatever came before."""
    match step:
        case Call(method="goto", arguments={"place": Text()}):
            return True
    return False


def looked_over(d: Discourse) -> ForEach | None:
    """The places that the step before looks for something in, as a round."""
    condition = searched(d.done[-1] if d.done else None)
    looked = [] if condition is None else searches(condition)
    places = tuple(each.arguments["place"] for each in looked if "place" in each.arguments)
    return ForEach("", Items(places), ()) if len(places) > 1 else None
