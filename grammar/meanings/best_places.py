"""Places told by what is found there: "the office with the fewest people", "any empty office"."""

from __future__ import annotations

from dataclasses import dataclass, replace

from grammar.chart import Node
from grammar.discourse import Discourse, Steps, Thing
from grammar.meanings.place_loops import round_of
from grammar.meanings.places import kind_places, only_taken_apart, sought
from grammar.meanings.registry import meaning
from grammar.meanings.rounds import best_counted
from grammar.meanings.traits import Trait
from grammar.plan import (
    Ask,
    Compare,
    Condition,
    Either,
    End,
    If,
    Number,
    Recall,
    Remember,
    Text,
    Value,
)


@dataclass(frozen=True)
class Best:
    """Which place is meant: of these places, the one with the most such things, or the fewest."""

    places: Value | None
    """None for those of the round before."""
    thing: Thing
    most: bool


@meaning("place_best")
def place_best(d: Discourse, node: Node) -> Best:
    """ "the ward with the most patients": found out by going round."""
    only_taken_apart(d, node)
    before = d.scene
    thing: Thing = d.get(node, "thing")
    d.scene = d.scene.speaking_as(before)
    of_round = node.production.fixed.get("one")
    places = None if of_round else kind_places(d, d.get(node, "kind"))
    return Best(places, thing, not node.production.fixed.get("fewest"))


@dataclass(frozen=True)
class Such:
    """Which place is meant: the first of these of which something is true."""

    places: Value
    variable: str
    """What the place is called in the round that looks for it."""
    trait: Trait


@meaning("place_such")
def place_such(d: Discourse, node: Node) -> Such:
    """ "an empty office", "any lab that has a microscope": the first that is so."""
    only_taken_apart(d, node)
    place = d.variable("place")
    before = d.scene
    d.scene = replace(d.scene, at=Recall(place))
    trait: Trait = d.get(node, "place_trait")
    d.scene = replace(d.scene.speaking_as(before), at=before.at)
    return Such(kind_places(d, d.get(node, "kind")), place, trait)


def first_such(d: Discourse, such: Such) -> tuple[Steps, Recall, Condition]:
    """The round that finds the place, its name, and whether there is none."""
    found = d.variable("found_place")
    noting = If(such.trait.condition, (Remember(found, Recall(such.variable)), End()))
    going = round_of(d, such.places, [*such.trait.first, noting], such.variable)
    d.scene = replace(d.scene.wandered(), looked_in=Recall(found))
    return [Remember(found, Text("")), going], Recall(found), Compare(Recall(found), "==", Text(""))


def survey(d: Discourse, best: Best) -> tuple[Steps, Recall]:
    """The round that finds the place, and its name. Where there are none at all, any is as good."""
    if best.places is None:
        return [], best_counted(d, best.most)
    place, count = d.variable("place"), d.variable("count")
    kept, most = d.variable("best"), d.variable("most" if best.most else "fewest")
    better = Compare(Recall(count), ">" if best.most else "<", Recall(most))
    first = Compare(Recall(kept), "==", Text(""))
    counting = Remember(count, Ask("count", {"thing": sought(d, best.thing)}))
    noting = If(
        Either((first, better)), (Remember(most, Recall(count)), Remember(kept, Recall(place)))
    )
    going = round_of(d, best.places, [counting, noting], place)
    d.scene = d.scene.wandered()
    return [Remember(most, Number(0)), Remember(kept, Text("")), going], Recall(kept)
