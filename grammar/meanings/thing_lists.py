"""Lists of things: "the cup and the book", and what is said of them together afterwards.

"Get a pen and a notebook from the supply room and bring both to Bob": what is said of where the
last one is holds for those before it, "both" are all of the list, and what was only fetched goes
straight to Bob.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from grammar.chart import Leaf, Node
from grammar.discourse import Discourse, Steps, Thing
from grammar.meanings.one_round import One, round_of_steps
from grammar.meanings.places import listed, only_taken_apart
from grammar.meanings.registry import meaning
from grammar.meanings.several_things import is_grab
from grammar.meanings.sources import told_where, where_told
from grammar.plan import Call, ForEach, Items, Recall, Text, Value


@dataclass(frozen=True)
class FetchedList:
    """The things of a list that were fetched without a word to whom, and the steps for each."""

    things: tuple[Thing, ...]
    steps: dict[Value, Steps]
    at: Value | None
    """Where the robot was before."""
    since: Value | None
    """Where it was when they were fetched, or when the last one was taken off the list."""


@meaning("things")
def things(d: Discourse, node: Node) -> list[Thing]:
    """ "the cup and the book"; "a pen and a notebook from the supply room" are both from there."""
    only_taken_apart(d, node)
    return shared_place(listed(d, node))


def shared_place(things: list[Thing]) -> list[Thing]:
    """What is said of where the last thing is holds for those before it, if nothing else is."""
    *others, last = things
    if any(is_placed(thing) or thing.here or thing.pronoun for thing in others):
        return things
    return [*(lying_there(thing, last) for thing in others), last]


def lying_there(thing: Thing, other: Thing) -> Thing:
    """A thing, where another is."""
    return replace(
        thing, place=other.place, furniture=other.furniture, preposition=other.preposition
    )


def all_listed(d: Discourse, part: Leaf | Node | None) -> Thing | None:
    """ "there is a pen and a notebook": both are spoken of."""
    if not isinstance(part, Node) or part.means != "things":
        return None
    found = shared_place(listed(d, part))
    return as_list(d, found)


def as_list(d: Discourse, things: list[Thing]) -> Thing:
    """The last of some things, which all of them can be spoken of with."""
    d.deliveries = replace(d.deliveries, listed_before=tuple(things))
    return replace(things[-1], listed=d.deliveries.listed_before)


def is_placed(thing: Thing) -> bool:
    """Whether it is said where a thing is."""
    return thing.place is not None or thing.furniture is not None


def over_thing_list(d: Discourse, node: Node, things: list[Thing], one: One) -> Steps:
    """ "the cup and the book": one after the other."""
    things = [where_told(d, thing) for thing in things]
    from_here = None if any(map(is_placed, things)) else fetched_from_here(d, things, one)
    if from_here is not None:
        return from_here
    if d.deliveries.only_fetches:
        steps = fetched_for_later(d, things, one)
    elif any(is_placed(thing) for thing in things):
        steps = [step for thing in things for step in for_one(d, thing, one)]
    else:
        each = Recall(d.variable("thing"))
        d.scene = replace(d.scene, at=None)
        d.scene = d.scene.speaking_of(Thing(each))  # "them", bound to this one
        body = round_of_steps(d, lambda: one(Thing(each)))
        d.scene = d.scene.wandered()
        steps = [ForEach(each.name, Items(tuple(thing.value for thing in things)), tuple(body))]
    d.scene = d.scene.speaking_of(as_list(d, things))
    return steps


def fetched_from_here(d: Discourse, things: list[Thing], one: One) -> Steps | None:
    """ "go to the cafeteria and get a sandwich and an apple": from where the robot was just sent,
    unless that is where they are to be put down."""
    here = just_sent_to(d)
    if d.deliveries.only_fetches or here is None:
        return None
    scene = d.scene
    there = [replace(thing, place=here) for thing in things]
    steps = [step for thing in there for step in for_one(d, thing, one)]
    if (
        not any(isinstance(each, Call) and each.method == "grab" for each in steps)
        or d.scene.at == here
    ):
        d.scene = scene
        return None
    d.scene = d.scene.speaking_of(as_list(d, there))
    return steps


def just_sent_to(d: Discourse) -> Text | None:
    """Where the robot was sent in the step before."""
    last = d.done[-1] if d.done else None
    here = d.scene.at
    return here if isinstance(here, Text) and last == Call("goto", {"place": here}) else None


def fetched_for_later(d: Discourse, things: list[Thing], one: One) -> Steps:
    """ "get a pen and a notebook": to the speaker, unless it is said otherwise then; what is only
    taken has to go somewhere, for a hand holds one thing."""
    at = d.scene.at
    here = just_sent_to(d)
    if here is not None and not any(map(is_placed, things)):
        things = [replace(thing, place=here) for thing in things]
    steps = {thing.value: for_one(d, thing, one) for thing in things}
    if any(map(is_grab, steps.values())):
        d.scene = replace(d.scene, at=at, holding=None)
        d.deliveries = replace(d.deliveries, collected=things[-1])
        steps = {each: [] for each in steps}
    d.deliveries = replace(
        d.deliveries, fetched_list=FetchedList(tuple(things), steps, at, d.scene.at)
    )
    return [step for each in steps.values() for step in each]


def for_one(d: Discourse, thing: Thing, one: One) -> Steps:
    d.scene = d.scene.speaking_of(thing)  # "them", bound to this one
    return round_of_steps(d, lambda: one(thing))


def list_before(d: Discourse, node: Node) -> tuple[Thing, ...]:
    """The things that "both" or "them" stands for, if they were spoken of in a list."""
    if d.scene.thing is None or not d.scene.thing_last or not d.is_plural(node):
        return ()
    return d.scene.thing.listed


def over_list_before(d: Discourse, node: Node, things: tuple[Thing, ...], one: One) -> Steps:
    """ "bring both to Bob": what was fetched for it goes straight there."""
    fetched: FetchedList | None = d.deliveries.fetched_list
    if d.deliveries.only_fetches and fetched is not None and fetched.things == things:
        return []  # "Alice needs a pen and a notebook. Get them": for her, as was said
    spoken_of = [off_the_list(d, replace(thing, pronoun=True)) for thing in things]
    return over_thing_list(d, node, spoken_of, one)


def off_the_list(d: Discourse, thing: Thing) -> Thing:
    """ "get the letter and the parcel, and give the letter to Alice": one of a list that was
    fetched goes elsewhere, straight from where it is."""
    fetched: FetchedList | None = d.deliveries.fetched_list
    things = fetched.things if fetched is not None else ()
    one = next((each for each in things if each.value == thing.value), None)
    if fetched is None or one is None or (is_placed(thing) and thing.place != one.place):
        return thing
    steps = fetched.steps[one.value]
    begins = (at for at in range(len(d.done)) if d.done[at : at + len(steps)] == steps)
    at = next(begins, None)
    if steps and at is None:
        return thing
    if at is not None:
        del d.done[at : at + len(steps)]
    rest = tuple(each for each in fetched.things if each is not one)
    d.deliveries = replace(
        d.deliveries, fetched_list=replace(fetched, things=rest, since=d.scene.at) if rest else None
    )
    if d.scene.delivered == thing.value:
        d.scene = replace(d.scene, delivered=None)
    if not rest:
        d.deliveries = replace(d.deliveries, collected=None)
    if not rest and d.scene.at == fetched.since:  # none of them was brought anywhere yet
        d.scene = replace(d.scene, at=fetched.at)
    return replace(one, pronoun=False, listed=())


def told_where_all_are(d: Discourse, spoken_of: Thing) -> None:
    """ "They are in the supply room", of a list."""
    for thing in spoken_of.listed:
        told_where(d, lying_there(thing, spoken_of))


def other_of_two(d: Discourse, noun: str) -> Thing | None:
    """ "there is a red box and a blue box; the red one is for Alice, the other one for Bob"."""
    if d.scene.thing is None or len(d.deliveries.listed_before) != 2:
        return None
    here = [each.value == d.scene.thing.value for each in d.deliveries.listed_before]
    if sum(here) != 1 or (noun and any(each.noun != noun for each in d.deliveries.listed_before)):
        return None
    return d.deliveries.listed_before[here.index(False)]
