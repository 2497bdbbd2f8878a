"""Who is where: of several people in their rooms, and on a round of places."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from msgspec.structs import replace as structs_replace

from grammar.chart import Node
from grammar.discourse import Discourse, Steps, Thing
from grammar.errors import NotUnderstood
from grammar.meanings.finding import go
from grammar.meanings.findings import found_told
from grammar.meanings.news import News, Told, go_back, take_back
from grammar.meanings.persons import together
from grammar.meanings.place_loops import last_round, places_of, round_of, round_of_visits
from grammar.meanings.places import unknown_place
from grammar.meanings.registry import meaning
from grammar.meanings.some_places import Claims
from grammar.meanings.surveys import replacing
from grammar.plan import (
    Ask,
    Both,
    Call,
    Collect,
    Compare,
    Condition,
    Either,
    ForEach,
    Holds,
    If,
    Items,
    Length,
    Not,
    Number,
    Recall,
    Remember,
    Sentence,
    Step,
    Text,
    Value,
)
from grammar.tidy import nodes

NONE_AND_SOME: Final = ("nobody_of_them", "these_are_there")
"""What is said of who is there."""


@meaning("presence_told")
def presence_told(d: Discourse, node: Node) -> Told:
    """ "which of Alice and Bob are in their offices", "who of them is there", "who is missing"."""
    if "people" not in node.parts:
        return found_told(d) if d.reports.news is not None else met_on_round(d, None)
    people = people_of(d, node)
    if "kind" not in node.parts:
        missing = bool(node.production.fixed.get("missing"))
        return those_met(d, people, d.get(node, "place"), missing=missing)
    kind, mark = str(d.get(node, "kind")), d.language.speech["possessive"]
    if len(d.lexicon.place_kinds[kind]) == 1:  # "in the library": there is only one
        return those_met(d, people, Text(d.lexicon.place_kinds[kind][0].name))
    known = {place.name.lower(): place.name for place in d.lexicon.place_kinds[kind]}
    found = d.variable("found")
    first: Steps = [Remember(found, Items(()))]
    for person in people:
        place = known.get(f"{person.text}{mark}{kind}".lower())
        if place is None:
            raise unknown_place(d, f"{person.text}{mark}{kind}", node)
        here = Holds(Ask("sees", {"thing": person.value}))
        first.append(Call("goto", {"place": Text(place)}))
        first.append(If(here, (Collect(found, person.value),)))
    d.scene = d.scene.wandered()
    d.round = replace(d.round, present_found=(found, people))
    none = d.say("nobody_of_them")
    some = d.say("these_are_there", names=Recall(found))
    return Told([if_any(found, none, some)], first)


def those_met(
    d: Discourse, people: list[Thing], place: Value | None = None, *, missing: bool = False
) -> Told:
    """ "whether Alice or Bob is there": which of them are, or are not, in a place, on the round or
    where the robot is."""
    going = [] if place is None else go(d, place)
    at = last_round(d) if place is None else None
    at = round_of_visits(d) if at is None and place is None else at
    loop = None if at is None else d.done[at]
    if loop is None and d.scene.at is None:
        raise NotUnderstood(d.language.phrase("which_places"))
    found = d.variable("found")
    seen = [Holds(Ask("sees", {"thing": each.value})) for each in people]
    notes: Steps = [
        If(Not(here) if missing else here, (Collect(found, each.value),))
        for here, each in zip(seen, people, strict=True)
    ]
    first: Steps = [Remember(found, Items(())), *going]
    if at is not None and isinstance(loop, ForEach):
        d.done[at] = structs_replace(loop, steps=(*loop.steps, *notes))
        d.done.insert(0, first.pop())
    else:
        first += notes
    if not missing:
        d.round = replace(d.round, present_found=(found, people))
    none, some = ("nobody_missing", "who_missing") if missing else NONE_AND_SOME
    return Told([if_any(found, d.say(none), d.say(some, names=Recall(found)))], first)


def people_of(d: Discourse, node: Node) -> list[Thing]:
    """Several people by their names, with "and" or with "or"."""
    people: Thing | list[Thing] = d.get(node, "people")
    if isinstance(people, list):
        return people
    if not isinstance(people.group, Items):
        raise NotUnderstood(d.language.phrase("one_person"))
    names = [each.value for each in people.group.items if isinstance(each, Text)]
    return [Thing(Text(name), known=True, person=True) for name in names]


def if_any(found: str, none: Step, some: Step) -> If:
    return If(Compare(Length(Recall(found)), "==", Number(0)), (none,), (some,))


@meaning("presence")
def presence(d: Discourse, node: Node) -> Steps:
    """ "see if Alice or Bob is in the office": told to the speaker, if nobody else is named."""
    told = presence_told(d, node)
    d.round = replace(d.round, lookout=None)
    d.reports = replace(d.reports, last=None, counted=None, checked=None)
    back = go_back(d, told.first)
    d.reports = replace(d.reports, news=News(told.words, True), told=told.words[-1])
    d.round = replace(d.round, present=d.reports.news)
    return [*told.first, *back, *told.words]


@meaning("present_so_many")
def present_so_many(d: Discourse, node: Node) -> Condition:
    """ "see if Alice and Bob are in. If both are there, ...", "if neither is in"."""
    if (
        d.round.present_found is None
        or d.reports.news is None
        or d.reports.news is not d.round.present
    ):
        return seen_here(d, node)
    found, people = d.round.present_found
    take_back(d, d.reports.news)
    d.reports = replace(d.reports, news=None)
    person = together(people)
    d.scene = replace(d.scene.speaking_of_person(person), group=person.group)
    d.branch = replace(d.branch, met=None)
    how = str(node.production.fixed["how"])
    operator, number = {
        "all": ("==", len(people)),
        "not_all": ("<", len(people)),
        "none": ("==", 0),
        "some": (">", 0),
        "one": ("==", 1),
    }[how]
    condition = Compare(Length(Recall(found)), operator, Number(number))
    none = d.say("who_missing", names=Text(joined_by(d, people)))
    some = d.say("these_are_there", names=Recall(found))
    either = if_any(found, none, some)
    so: Step = none if how == "none" else either if how == "not_all" else some
    claims = Claims(condition, so, either)
    d.round = replace(d.round, claims=claims)
    return condition


def seen_here(d: Discourse, node: Node) -> Condition:
    """The same of those who were spoken of, where nobody has looked for them yet."""
    group = d.scene.person.group if d.scene.person is not None else None
    how = str(node.production.fixed["how"])
    if not isinstance(group, Items) or how == "one":
        words = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("cannot_check", what=words))
    seen = tuple(Holds(Ask("sees", {"thing": each})) for each in group.items)
    if how in ("all", "not_all"):
        every: Condition = Both(seen)
        return every if how == "all" else Not(every)
    return Either(seen) if how == "some" else Not(Either(seen))


def joined_by(d: Discourse, people: list[Thing]) -> str:
    return ", ".join(d.called(each.text) for each in people)


@meaning("who_where")
def who_where(d: Discourse, node: Node) -> Told:
    """ "who is where", "who is in each of them", "who is in offices 1 to 4"."""
    if "kinds" in node.parts or "place_list" in node.parts:
        return met_on_round(d, places_of(d, node))
    return found_told(d) if d.reports.news is not None else met_on_round(d, None)


def met_on_round(d: Discourse, places: Value | None) -> Told:
    """Who is at each place of a round."""
    at = None if places is not None else last_round(d)
    if places is None and at is None:
        at = round_of_visits(d)
    if at is None and places is None:
        raise NotUnderstood(d.language.phrase("which_places"))
    names, found = d.variable("names"), d.variable("found")
    loop = d.done[at] if at is not None else None
    here = Recall(loop.variable if isinstance(loop, ForEach) else d.variable("place"))
    line = Sentence((here, Text(": "), Recall(names)))
    anybody = Compare(Length(Recall(names)), ">", Number(0))
    notes: Steps = [Remember(names, Ask("people")), If(anybody, (Collect(found, line),))]
    first: Steps = [Remember(found, Items(()))]
    if at is not None and isinstance(loop, ForEach):
        said = any(each is d.reports.step for each in nodes(loop))
        loop = structs_replace(loop, steps=loop.steps if said else (*loop.steps, *notes))
        d.done[at] = replacing(loop, d.reports.step, notes) if said else loop
        d.done.insert(0, first.pop())
    elif places is not None:
        first.append(round_of(d, places, notes, here.name))
    d.round = replace(d.round, lookout=None)
    d.reports = replace(d.reports, last=None)
    some = d.say("people_seen", value=Recall(found))
    return Told([if_any(found, d.say("nobody_there"), some)], first)
