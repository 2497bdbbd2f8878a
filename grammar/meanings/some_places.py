"""How many of several places something is true of, as a condition: "any meeting room is free", "all
labs are empty", "more than two wards have no wheelchair"; and what is done at each where it is. It
is found out on a round of them; where one such place is enough, that is what "there" is from then
on."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

from grammar.chart import Node
from grammar.discourse import ANYONE, Claim, Discourse, Steps, Thing, Where, as_value
from grammar.meanings.best_places import Such, first_such
from grammar.meanings.carrying import deliver
from grammar.meanings.conditions import TELLING, negated
from grammar.meanings.deliveries import inside
from grammar.meanings.found_places import sought_place
from grammar.meanings.news import in_round
from grammar.meanings.place_loops import last_round, round_of
from grammar.meanings.places import kind_places
from grammar.meanings.registry import meaning
from grammar.meanings.rounds import how_many
from grammar.meanings.traits import Trait
from grammar.plan import (
    Collect,
    Compare,
    Condition,
    If,
    Items,
    Length,
    Number,
    Recall,
    Remember,
    Share,
    Step,
    Value,
)

SOME_PLACES: Final = "some_places"


@dataclass(frozen=True)
class Claims:
    """What is so if a condition on several places holds, and what if not."""

    condition: Condition
    yes: Step
    no: Step


@meaning(SOME_PLACES)
def some_places(d: Discourse, node: Node) -> Condition:
    return so_in(d, node, str(node.production.fixed.get("how", "some")))


def at_none(d: Discourse, node: Node) -> Condition | None:
    """ "none of the labs has a fan", where no round of them was spoken of before."""
    if "kinds" not in node.parts or in_round(d) or last_round(d) is not None:
        return None
    return so_in(d, node, "none")


def so_in(d: Discourse, node: Node, how: str) -> Condition:
    such = sought_place(d, node)
    if how == "some" and not d.round.told_of:
        return one_such(d, such)
    found = d.variable("found")
    so = such.trait.condition if how != "all" else negated(such.trait.condition)
    noted = If(so, (Collect(found, Recall(such.variable)),))
    going = round_of(d, such.places, [*such.trait.first, noted], such.variable)
    d.need_first(Remember(found, Items(())), going)
    d.scene = replace(d.scene.wandered(), away=True)
    condition = enough(d, node, how, Length(Recall(found)), such.places)
    named = d.say("such_places", places=Recall(found))
    yes, no = named, d.say("no_such_places")
    if how == "all":
        yes, no = d.say("yes_all"), d.say("no_not_these", places=Recall(found))
    elif how == "none":
        yes, no = no, yes
    elif how != "some":
        no = d.say("so_many_places", number=Length(Recall(found)))
    claims = Claims(condition, yes, no)
    d.round = replace(d.round, claims=claims)
    d.branch = replace(d.branch, met=None)
    return condition


def one_such(d: Discourse, such: Such) -> Condition:
    """The first place that is so is where the robot stays, and what "there" means."""
    going, place, none = first_such(d, such)
    d.need_first(*going)
    d.round = replace(d.round, such=place.name)
    there, nowhere = d.say("it_is_there", place=place), d.say("no_such_places")
    claims = Claims(negated(none), there, nowhere)
    d.round = replace(d.round, claims=claims)
    d.scene = d.scene.arrived(place)
    thing = such.trait.thing
    if thing is not None and thing.person and not such.trait.denied:
        d.scene = d.scene.speaking_of_person(
            Thing(thing.value, person=True, here=True, plural=True)
        )
        d.scene = replace(d.scene, with_person=None if thing.text != ANYONE else thing.value)
    elif thing is not None and not thing.person:
        d.scene = d.scene.speaking_of(thing)
    return negated(none)


def enough(d: Discourse, node: Node, how: str, number: Value, places: Value) -> Condition:
    """Whether it is so in as many of the places as it has to be."""
    match how:
        case "some":
            return Compare(number, ">", Number(0))
        case "none" | "all":
            return Compare(number, "==", Number(0))
        case "most":
            return Compare(Share(number, how_many(places)), ">", Number(50))
    return Compare(number, d.get(node, "operator", "=="), as_value(d.get(node, "count")))


@meaning("if_any_such")
def if_any_such(d: Discourse, node: Node) -> Steps:
    """ "if any lab has no stapler, bring one there": to each of them; "if any lab is free, take the
    visitor there": to one."""
    means = {each.means for each in inside(node.parts["steps"])}
    told_of = bool(means & TELLING)
    if not told_of and "guide" not in means:
        return for_each_place_such(d, node)
    outer = d.command.pending
    d.round = replace(d.round, told_of=told_of)
    d.command = replace(d.command, pending=())
    condition = so_in(d, node, "some")
    before = d.command.pending
    d.command = replace(d.command, pending=outer)
    if told_of:
        d.branch = replace(d.branch, claim=Claim(d.round.claims.yes, d.known_by_now()))
    return [*before, If(condition, tuple(d.build(node.parts["steps"])))]


@meaning("for_each_place_such")
def for_each_place_such(d: Discourse, node: Node) -> Steps:
    """ "bring a stapler to every office that has none": done where it is seen to be so."""
    place = Recall(d.variable("place"))
    thing: Thing | None = d.get(node, "thing")
    d.scene = d.scene.arrived(place)
    trait: Trait = d.get(node, "place_trait")
    outer = d.loops.in_loop
    d.loops = replace(d.loops, in_loop=True)
    if thing is not None:
        d.scene = replace(d.scene, at=None)
        body = deliver(d, thing, None, Where(place))
    else:
        body = d.build(node.parts["steps"])
    d.loops = replace(d.loops, in_loop=outer)
    d.scene = d.scene.wandered()
    found_out = (*trait.first, If(trait.condition, tuple(body)))
    return [round_of(d, kind_places(d, d.get(node, "kinds")), [*found_out], place.name)]
