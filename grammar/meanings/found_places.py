"""One place of several that is as it should be, and what is then done with it: "find an empty
office, tell me which one it is, and take the guests there". If there is none, whoever said so hears
that instead."""

from __future__ import annotations

from dataclasses import replace

from msgspec.structs import replace as structs_replace

from grammar.chart import Node
from grammar.discourse import Discourse, Steps
from grammar.meanings.best_places import Such, first_such
from grammar.meanings.lookouts import Lookout
from grammar.meanings.news import BACK, News, go_back
from grammar.meanings.places import kind_places
from grammar.meanings.registry import meaning
from grammar.meanings.traits import Trait
from grammar.plan import Collect, Compare, ForEach, If, Recall, Step, Text


@meaning("find_such")
def find_such(d: Discourse, node: Node) -> Steps:
    """ "find an empty office", "check the labs until you find one that is free"."""
    such = sought_place(d, node)
    d.round = replace(d.round, lookout=None)
    d.reports = replace(d.reports, last=None, news=None, counted=None, checked=None)
    going, place, none = first_such(d, such)
    d.round = replace(d.round, such=place.name)
    d.scene = d.scene.arrived(place)
    missing = d.say("no_such_places")
    if not node.production.fixed.get("ask"):
        return [*going, If(none, (missing,))]
    words: Steps = [If(none, (missing,), (d.say("it_is_there", place=place),))]
    d.reports = replace(d.reports, news=News(words, True), told=words[-1])
    return [*going, *go_back(d, going), *words]


def first_of_round(d: Discourse) -> bool:
    """Let a round that was to find out which places are so find the first of them: "check which
    room is free, then take the visitor there"; whether there was such a round."""
    lookout: Lookout | None = d.round.lookout
    at = lookout.at(d) if lookout is not None else None
    if lookout is not None and at is not None:
        such: Such | None = Such(lookout.places, lookout.place, lookout.trait)
        end = at + 1
    else:
        at, such = told_round(d)
        end = len(d.done)
    if at is None or such is None:
        return False
    going, place, none = first_such(d, such)
    d.done[at:end] = [*going, If(none, (d.say("no_such_places"),))]
    d.round = replace(d.round, lookout=None)
    d.reports = replace(d.reports, news=None, told=None)
    d.round = replace(d.round, such=place.name)
    d.scene = d.scene.arrived(place)
    return True


def told_round(d: Discourse) -> tuple[int | None, Such | None]:
    """The round whose news are the last steps, and what it looks for: "see which room is free"."""
    if d.reports.news is None or d.done[-1:] != [d.reports.told]:
        return None, None
    for at, step in enumerate(d.done):
        match step:
            case ForEach(variable=place, items=places, steps=(_, *first, If() as noted)):
                if noted.then and isinstance(noted.then[-1], Collect):
                    trait = Trait(noted.condition, list(first))
                    return at, Such(places, place, trait)
            case _:
                pass
    return None, None


def sought_place(d: Discourse, node: Node) -> Such:
    """The places that are asked about and what they are to be like; what is there is not spoken
    of yet."""
    part = node.parts.get("place")
    if part is not None:  # "there is a free meeting room"
        d.loops = replace(d.loops, taking_apart=True)
        try:
            such: Such = d.build(part)
        finally:
            d.loops = replace(d.loops, taking_apart=False)
        return such
    place = d.variable("place")
    before = d.scene
    d.scene = replace(d.scene, at=Recall(place))
    trait = d.get(node, "place_trait")
    d.scene = replace(d.scene.speaking_as(before), at=before.at)
    return Such(kind_places(d, d.get(node, "kinds")), place, trait)


def if_such(d: Discourse, done: Steps) -> Steps:
    """Steps in which all that is done with a place that was looked for is done if there is one."""
    for at, step in enumerate(done):
        rest = done[at + 1 :]
        if rest and is_such(d, step):
            assert isinstance(step, If)
            back = [] if BACK in step.then else go_back(d, done[:at])
            return [
                *done[:at],
                structs_replace(step, then=(*back, *step.then), otherwise=tuple(rest)),
            ]
    return done


def is_such(d: Discourse, step: Step) -> bool:
    """Whether a step only says that there is no such place."""
    return (
        isinstance(step, If)
        and not step.otherwise
        and isinstance(step.condition, Compare)
        and step.condition.right == Text("")
        and step.then == (d.say("no_such_places"),)
    )
