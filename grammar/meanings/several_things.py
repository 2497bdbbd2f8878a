"""What is done with several things: fetched one by one, for a hand holds one."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from msgspec import structs

from grammar.chart import Node
from grammar.discourse import START, Discourse, Steps, Thing, Where
from grammar.errors import Ambiguous, NotUnderstood
from grammar.meanings.chosen import by_choice, chosen_of
from grammar.meanings.deliveries import inside
from grammar.meanings.finding import found, named, not_found
from grammar.meanings.one_round import One, round_of_steps
from grammar.meanings.sources import where_told
from grammar.naming import place_called
from grammar.plan import (
    Ask,
    Both,
    Call,
    Compare,
    Condition,
    End,
    ForEach,
    Holds,
    If,
    Increase,
    Items,
    Not,
    Number,
    Recall,
    Remember,
    Repeat,
    Step,
    Text,
    Value,
    While,
)
from grammar.tidy import LOOPS

HANDED: Final = frozenset({"bring", "grab", "put"})
"""Commands that change where things are."""


def as_many(d: Discourse, node: Node, people: Thing, count: int) -> bool:
    """Whether there are as many things as people who get them: "bring Alice and Bob two coffees",
    and not "two coffees each"."""
    each = d.language.words_called("apiece").intersection(d.norms(node.start, node.end))
    return isinstance(people.group, Items) and len(people.group.items) == count and not each


def over_things(d: Discourse, node: Node, thing: Thing, one: One) -> Steps:
    """ "two cups", "all the cups in the kitchen": one after the other, for the hand holds one."""
    if is_there_already(d, node, d.done[-1] if d.done else None):
        return []
    around = take_back(d) if node.means != "thing" else None
    if thing.place is None and d.deliveries.taken_from is not None:
        thing = replace(
            thing, place=d.deliveries.taken_from.place, furniture=d.deliveries.taken_from.furniture
        )
    thing = where_told(d, thing)
    put = last_deed(d)
    if thing.place is None and d.scene.at is not None and (put is None or put.method != "put"):
        thing = replace(thing, place=d.scene.at)  # but "..., and three pillows to ward b"
    at = d.scene.at
    single = thing.single
    if thing.count is None:  # "them" are all of them
        thing = replace(thing, every=True)

    d.scene = replace(d.scene, at=None if thing.count is not None else thing.place)
    d.scene = d.scene.speaking_of(single)
    body = round_of_steps(
        d, lambda: one(single if d.scene.at is None else replace(single, here=True))
    )
    if not body:
        return []
    if thing.here and thing.count is not None and thing.place is None and not is_grab(body):
        back = Call("goto", {"place": d.start()})  # "these two cups": the second is here, too
        d.scene = d.scene.speaking_of(thing)
        return [Repeat(Number(thing.count), (back, *body))]
    if is_grab(body):  # "collect the cups": where to is said next
        d.deliveries = replace(d.deliveries, collected=thing)
        d.scene = replace(d.scene.speaking_of(thing), at=at)
        return []
    d.deliveries = replace(d.deliveries, collected=None)
    if moves_nothing(body):
        raise NotUnderstood(d.language.phrase("one_thing"))
    steps = rounds(d, node, thing, single, body)
    if d.scene.delivered is not None:
        d.deliveries = replace(d.deliveries, delivered_in=steps[-1])
    if around is not None:
        steps = [structs.replace(around, steps=(*around.steps[:-1], *steps))]
    d.scene = d.scene.speaking_of(thing)
    return steps


def last_deed(d: Discourse) -> Call | None:
    """The last step, or that of the last round, if something was handed over or put down in it."""
    said = d.done or next((steps for steps in reversed(d.around) if steps), [])
    last: Step | None = said[-1] if said else None
    while isinstance(last, LOOPS) and last.steps:
        last = last.steps[-1]
    return last if isinstance(last, Call) and last.method in ("give", "put") else None


def put_more_exactly(d: Discourse, node: Node) -> bool:
    """ "bring three folders to the lab and put them on the table": each is put down once, there."""
    last, where = last_deed(d), node.parts.get("where")
    they = node.parts.get("thing")
    them = isinstance(they, Node) and they.means == "thing_it" and d.scene.thing is not None
    if node.means != "put" or not them or where is None or last is None or not d.done:
        return False
    if (
        d.scene.thing is None
        or not d.scene.thing.several
        or last.arguments != {"thing": d.scene.thing.value}
    ):
        return False
    if last.method != "put":  # and not only fetched
        return False
    scene = d.scene
    spot: Where = d.build(where)
    if spot.place or not spot.furniture:
        d.scene = scene
        return False
    there = structs.replace(last, arguments={**last.arguments, "where": Text(spot.furniture)})
    d.done[-1] = ending(d.done[-1], there)
    return True


def ending(step: Step, last: Step) -> Step:
    """A step, or a round of steps, with another for its last one."""
    if not isinstance(step, LOOPS):
        return last
    return structs.replace(step, steps=(*step.steps[:-1], ending(step.steps[-1], last)))


def rounds(d: Discourse, node: Node, thing: Thing, single: Thing, body: Steps) -> Steps:
    """The loop over several things: as many as were named, or all that are there."""
    target = put_where(body)
    if thing.place is not None or target is None:
        if thing.count is not None:
            return [Repeat(Number(thing.count), tuple(body))]
        if thing.place is not None:
            return [While(Holds(Ask("find", found(d, single).arguments)), tuple(body))]
        if not (isinstance(body[-1], Call) and body[-1].method == "give"):
            raise where_from(d, node, thing)
    source = Recall(d.variable("source"))
    sought = found(d, single).arguments
    search = Holds(Ask("find", {**sought, "place": source}))
    body = without_find(body, sought["thing"])
    if target is None:  # what is handed over is not found again
        return [ForEach(source.name, Ask("places"), (While(search, tuple(body)),))]
    other = is_other(d, source, target)
    if thing.count is None:
        return [ForEach(source.name, Ask("places"), (While(Both((other, search)), tuple(body)),))]
    brought = Recall(d.variable("brought"))
    few = Compare(brought, "<", Number(thing.count))
    loop = While(Both((few, other, search)), (*body, Increase(brought.name)))
    only = d.say("found_only", number=brought, things=named(d, single))
    return [
        Remember(brought.name, Number(0)),
        ForEach(source.name, Ask("places"), (loop,)),
        If(few, (only,)),
    ]


def without_find(body: Steps, thing: Value) -> Steps:
    """A round whose loop has already found the thing, but not who gets it."""
    return [
        step
        for step in body
        if not (
            isinstance(step, Call) and step.method == "find" and step.arguments["thing"] == thing
        )
    ]


def another_one(d: Discourse, body: Steps) -> Steps:
    """The steps of a round that brings one to a place: from any place that is none of those."""
    target = put_where(body)
    search = next((at for at, step in enumerate(body) if is_search(step)), None)
    if target is None or search is None:
        return body
    looking = body[search]
    assert isinstance(looking, Call)
    source = Recall(d.variable("source"))
    there = Holds(Ask("find", {**looking.arguments, "place": source}))
    missing = body[search + 1 :]
    place = If(Both((is_other(d, source, target), there)), (*missing, End()))
    return [*body[:search], ForEach(source.name, Ask("places"), (place,))]


def is_search(step: Step) -> bool:
    """Whether a step looks for a thing anywhere."""
    return isinstance(step, Call) and step.method == "find" and "place" not in step.arguments


def is_other(d: Discourse, source: Recall, target: Value) -> Condition:
    """Whether a place is none of those that something is brought to."""
    targets = d.loops.places.get(target.name) if isinstance(target, Recall) else None
    if targets is None:
        return Compare(source, "!=", target)
    return Not(Compare(source, "in", targets))


def put_where(body: Steps) -> Value | None:
    """The place that a thing is brought to and put down; None for one that is handed over."""
    going = [step for step in body if isinstance(step, Call) and step.method == "goto"]
    last = body[-1] if body else None
    if not (going and isinstance(last, Call) and last.method == "put"):
        return None
    target = going[-1].arguments.get("place")
    return None if target == Recall(START) else target


def is_grab(body: Steps) -> bool:
    """Whether a round leaves the thing in the hand."""
    return bool(body) and isinstance(body[-1], Call) and body[-1].method == "grab"


def moves_nothing(body: Steps) -> bool:
    """Whether a round takes up what it has just put down."""
    return not any(isinstance(step, Call) and step.method in ("find", "goto") for step in body)


def take_back(d: Discourse) -> ForEach | None:
    """ "collect the cups in the ward and take them to the kitchen": straight there, and not first
    to who says so. The round of places in which they were to be fetched, if there was one."""
    at = len(d.done) - 1
    while at >= 0 and goes(d.done[at]):
        at -= 1
    last = d.done[at] if at >= 0 else None
    around = last if isinstance(last, ForEach) and last.steps else None
    inner = last if around is None else around.steps[-1]
    if d.deliveries.delivered_in is not None and inner is d.deliveries.delivered_in:
        del d.done[at]
        d.deliveries = replace(d.deliveries, delivered_in=None)
        d.scene = replace(d.scene, delivered=None)
        return around
    listed = d.deliveries.listed_last
    if listed and tuple(d.done[-len(listed) :]) == listed:
        del d.done[-len(listed) :]  # "find three cups in the ward and bring them here"
        d.deliveries = replace(d.deliveries, listed_last=())
    return None


def begun_before(d: Discourse) -> Thing | None:
    """Several things that were to be fetched, before it was said for whom."""
    several = d.scene.thing if d.scene.thing is not None and d.scene.thing.several else None
    if several is not None:
        take_back(d)
        d.deliveries = replace(d.deliveries, collected=None)
        d.scene = replace(d.scene, holding=None)
    return several


def goes(step: Step) -> bool:
    return isinstance(step, Call) and step.method == "goto"


def is_there_already(d: Discourse, node: Node, last: Step | None) -> bool:
    """ "the boxes belong in the store, take them there": whether that has been done."""
    there = any(each.means == "place_there" for each in inside(node.parts.get("where")))
    there = there or bool(node.production.fixed.get("there"))
    ends = getattr(last, "steps", ())
    put = ends[-1] if ends else None
    return there and isinstance(put, Call) and put.method == "put" and "from" not in node.parts


def where_from(d: Discourse, node: Node, thing: Thing) -> Ambiguous:
    """The question where all the cups are that are to be brought."""
    where = d.language.speech["from_place"]
    return Ambiguous(
        d.language.phrase("from_where", things=d.words(node.start, node.end)),
        node.end,
        node.end,
        tuple(
            where.format(place=place_called(place.name, d.lexicon, d.language))
            for place in d.lexicon.places
        ),
    )


def over_either_thing(d: Discourse, node: Node, things: list[Thing], one: One) -> Steps:
    """ "the red cup, or if there is none the blue one": the first that is found; "tea or coffee",
    between which somebody was asked to choose: what they chose."""
    chosen = chosen_of(d, [each.text for each in things])
    if chosen is not None:
        source = things[-1].place  # "a tea or a coffee from the kitchen": either is from there
        things = [replace(each, place=each.place or source) for each in things]
        steps = by_choice(d, chosen, things, one)
        d.scene = d.scene.speaking_of(Thing(Recall(str(d.answers.last))))
        return steps
    # "a tea or a coffee from the kitchen": either is from there, if they are but named
    unplaced = all(each.place is None and each.furniture is None for each in things[:-1])
    spot = d.deliveries.taken_from or Where(things[-1].place, things[-1].furniture)
    if unplaced and spot.place is not None:
        things = [replace(each, place=spot.place, furniture=spot.furniture) for each in things]
    return first_found(d, things, one)


def first_found(d: Discourse, things: list[Thing], one: One) -> Steps:
    """Look for one after the other; the steps are those for the first that is found."""
    before, known = d.scene, d.variables
    otherwise: Steps = [not_found(d, things[-1])]
    for thing in reversed(things):
        here, held, whom = before.at, before.holding, before.with_person
        d.scene = replace(d.scene, at=here, holding=held, with_person=whom)
        d.variables = known  # the same names in either branch
        d.loops = replace(d.loops, found_already=True)
        body = round_of_steps(d, lambda t=thing: one(replace(t, here=True)))  # type: ignore[misc]
        d.loops = replace(d.loops, found_already=False)
        if not body:
            otherwise = [If(Not(Holds(Ask("find", found(d, thing).arguments))), tuple(otherwise))]
            continue
        otherwise = [
            If(Holds(Ask("find", found(d, thing).arguments)), tuple(body), tuple(otherwise))
        ]
    d.scene = d.scene.wandered()
    return otherwise
