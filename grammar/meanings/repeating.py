"""What is said of all that was said before: "do that again", "the same for Bob", "stop at noon"."""

from __future__ import annotations

import itertools
from dataclasses import replace

from grammar.chart import Node
from grammar.discourse import Discourse, Steps, Thing, as_value
from grammar.errors import NotUnderstood
from grammar.meanings.conditions import condition_of
from grammar.meanings.guards import guard_finds
from grammar.meanings.loops import looped, one_round
from grammar.meanings.places import kind_places, owner_of
from grammar.meanings.registry import meaning
from grammar.meanings.round_ends import STOP, ended_there
from grammar.meanings.waiting import awaited
from grammar.plan import (
    Ask,
    Call,
    ForEach,
    Forever,
    If,
    Items,
    Number,
    Recall,
    Repeat,
    Step,
    Text,
    Value,
    While,
)
from grammar.tidy import mentions, nodes, replaced


def all_before(d: Discourse, *, keep: bool = False) -> tuple[Step, ...]:
    """The steps so far, which "do that ..." speaks of; they are taken out of the sequence, unless
    they are done besides."""
    if not d.done:
        raise NotUnderstood(d.language.phrase("repeat_what"))
    before = tuple(one_round(guard_finds(d, d.done)))
    if not keep:
        d.done.clear()
    return before


@meaning("ended")
def ended(d: Discourse, node: Node) -> Steps:
    """ "stop at noon", "stop after the third visitor": the end of what goes on, or of a round of
    places, or as often as all that was said before is done; of anything else, a stop when it is so
    far."""
    often: Node = d.get(node, "loop")
    last = d.done[-1] if d.done else None
    if isinstance(last, Forever):
        d.done.pop()
        return looped(d, often, lambda: list(last.steps))
    if "times" in often.parts:
        return looped(d, often, lambda: list(all_before(d)))
    looking, condition = condition_of(d, often)
    there = ended_there(d, looking, condition)
    return there if there is not None else [*awaited(looking, condition), STOP]


@meaning("do_that_times")
def do_that_times(d: Discourse, node: Node) -> Steps:
    """ "do that three times": all that was said before, so often in all."""
    return [Repeat(as_value(d.get(node, "times")), all_before(d))]


@meaning("do_that_more")
def do_that_more(d: Discourse, node: Node) -> Steps:
    """ "do that three more times": once it was said to be done already."""
    return [Repeat(Number(int(d.get(node, "times")) + 1), all_before(d))]


@meaning("do_that_again")
def do_that_again(d: Discourse, node: Node) -> Steps:
    """ "and again", "repeat that": once more."""
    return [Repeat(as_value(d.get(node, "times", 2)), all_before(d))]


@meaning("again_later")
def again_later(d: Discourse, node: Node) -> Steps:
    """ "..., and again at half past twelve": once more then, without the wait it began with."""
    waiting: Steps = d.build(node.parts["delay"])
    return [*waiting, *itertools.dropwhile(only_waits, all_before(d, keep=True))]


def only_waits(step: Step) -> bool:
    inner = step.steps if isinstance(step, While) else (step,)
    return all(isinstance(each, Call) and each.method == "wait" for each in inner)


@meaning("same_for")
def same_for(d: Discourse, node: Node) -> Steps:
    """ "do the same for Bob": the steps before, with Bob in the place of the person before, and
    what is his in the place of what was theirs; "for the next two visitors": that often more."""
    if not d.done:
        raise NotUnderstood(d.language.phrase("repeat_what"))
    before = d.scene.person
    person: Thing = d.get(node, "person_ref")
    if person.count is not None:
        return [Repeat(Number(person.count), all_before(d, keep=True))]
    if before is not None and isinstance(person.group, Items):
        return [step for name in person.group.items for step in done_with(d, before.value, name)]
    if before is None or person.group is not None or not person.known:
        raise NotUnderstood(d.language.phrase("one_person"))
    return done_with(d, before.value, person.value)


def done_with(d: Discourse, before: Value, person: Value) -> Steps:
    """The steps with one person once more with another, from the clause on that is about them."""
    steps = [replaced(step, before, person) for step in d.done]
    first = next((at for at, step in enumerate(d.done) if step != steps[at]), None)
    if first is None:  # nothing was said to be done for anybody
        raise NotUnderstood(d.language.phrase("repeat_what"))
    steps = steps[max(begin for begin in (0, *d.begins) if begin <= first) :]
    lost = unknown_places(d, steps)
    if lost:
        raise NotUnderstood(d.language.phrase("unknown_place", name=lost[0]))
    d.scene = replace(
        d.scene, with_person=person if d.scene.with_person == before else d.scene.with_person
    )
    return steps


def unknown_places(d: Discourse, steps: Steps) -> list[str]:
    """Places of somebody that there are none of: "Bob's office", where only Alice has one."""
    known = {each.name for each in d.lexicon.places}
    return [
        place.value
        for each in nodes(tuple(steps))
        if isinstance(each, Call | Ask)
        and isinstance(place := each.arguments.get("place"), Text)
        and place.value not in known
    ]


@meaning("only_if")
def only_if(d: Discourse, node: Node) -> Steps:
    """ "do that only if she is awake": all that was said before."""
    before = all_before(d)
    looking, condition = condition_of(d, node)
    return [*looking, If(condition, before)]


@meaning("loop_that")
def loop_that(d: Discourse, node: Node) -> Steps:
    """ "do that every hour": all that was said before."""
    return looped(d, d.get(node, "loop"), lambda: list(all_before(d)))


@meaning("same_at")
def same_at(d: Discourse, node: Node) -> Steps:
    """ "do the same in the kitchen", "do that for every office, too": the steps before, with the
    place that they are about changed."""
    kinds = d.get(node, "kinds")
    steps = d.done[:]
    old = next((each for each in reversed([*nodes(tuple(steps))]) if _is_place(d, each)), None)
    if not steps or old is None:
        raise NotUnderstood(d.language.phrase("repeat_what"))
    assert isinstance(old, Text)
    if kinds is None:
        more = d.get(node, "place_list") or ()
        return [
            step
            for place in (d.get(node, "place"), *more)
            for step in done_at(d, steps, old, place)
        ]
    variable = d.variable("place")
    d.scene = d.scene.wandered()
    body = tuple(replaced(step, old, Recall(variable)) for step in steps)
    return [ForEach(variable, kind_places(d, kinds), body)]


def done_at(d: Discourse, steps: Steps, old: Text, place: Value) -> Steps:
    """The steps at one place once more at another; with whoever works there, where they were with
    whoever works at the one."""
    d.scene = replace(d.scene, place=old)
    before = owner_of(d)
    d.went(place)
    d.scene = replace(d.scene, place=place)
    person = owner_of(d)
    if before is not None and person is not None and mentions(tuple(steps), before):
        steps = [replaced(step, before, person) for step in steps]
        d.scene = d.scene.speaking_of_person(Thing(person, known=True, person=True))
    return [replaced(step, old, place) for step in steps]


def _is_place(d: Discourse, value: object) -> bool:
    return isinstance(value, Text) and any(value.value == each.name for each in d.lexicon.places)
