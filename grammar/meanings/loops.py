"""Doing things more than once: so many times, until, at every place, for everybody."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import msgspec

from grammar.chart import Leaf, Node
from grammar.discourse import ANYONE, Discourse, NotUnderstood, Steps, Thing, as_value
from grammar.meanings.branches import meet_there
from grammar.meanings.conditions import condition_of
from grammar.meanings.control import guard_finds
from grammar.meanings.nouns import kind_places
from grammar.meanings.registry import meaning
from grammar.meanings.surveys import until_answered
from grammar.meanings.waiting import wait_until
from grammar.plan import (
    Ask,
    Call,
    ForEach,
    Forever,
    Holds,
    If,
    Items,
    Recall,
    Repeat,
    RepeatUntil,
    Step,
    Text,
    Value,
    While,
)
from grammar.tidy import mentions


@meaning("until")
def until(d: Discourse, node: Node) -> Steps:
    if node.production.fixed.get("first", False):
        looking, condition = condition_of(d, node)
        body = d.build(node.parts["steps"])
    else:
        body = d.build(node.parts["steps"])
        looking, condition = condition_of(d, node)
    if all(isinstance(step, Call) and step.method in ("wait",) for step in body):
        return [*looking, *wait_until(condition)]
    return until_answered(d, condition, [*body, *looking])


@meaning("while")
def while_(d: Discourse, node: Node) -> Steps:
    looking, condition = condition_of(d, node)
    meet_there(d, d.met)
    body = d.build(node.parts["steps"])
    return [*looking, While(condition, (*body, *looking))]


# --- repeating


@meaning("repeat")
def repeat(d: Discourse, node: Node) -> Steps:
    times = d.get(node, "times")
    body = d.build(node.parts["steps"])
    return [Repeat(as_value(times), tuple(body))]


@meaning("at_intervals")
def at_intervals(d: Discourse, node: Node) -> Steps:
    """ "every ten minutes, ...": again and again, with a pause in between."""
    seconds = as_value(d.get(node, "seconds"))
    return [Forever((*d.build(node.parts["steps"]), Call("wait", {"seconds": seconds})))]


@meaning("forever")
def forever(d: Discourse, node: Node) -> Steps:
    return [Forever(tuple(d.build(node.parts["steps"])))]


# --- all that was said before


def all_before(d: Discourse) -> tuple[Step, ...]:
    """The steps so far, which "do that ..." speaks of; they are taken out of the sequence."""
    if not d.done:
        raise NotUnderstood(d.language.phrase("repeat_what"))
    before = tuple(guard_finds(d, d.done))
    d.done.clear()
    return before


@meaning("do_that_times")
def do_that_times(d: Discourse, node: Node) -> Steps:
    """ "do that three times": all that was said before, so often in all."""
    return [Repeat(as_value(d.get(node, "times")), all_before(d))]


@meaning("do_that_again")
def do_that_again(d: Discourse, node: Node) -> Steps:
    """ "and again", "repeat that": once more."""
    return [Repeat(as_value(d.get(node, "times", 2)), all_before(d))]


@meaning("do_that_until")
def do_that_until(d: Discourse, node: Node) -> Steps:
    looking, condition = condition_of(d, node)
    return [RepeatUntil(condition, (*all_before(d), *looking))]


@meaning("do_that_while")
def do_that_while(d: Discourse, node: Node) -> Steps:
    looking, condition = condition_of(d, node)
    return [*looking, While(condition, (*all_before(d), *looking))]


@meaning("do_that_forever")
def do_that_forever(d: Discourse, node: Node) -> Steps:
    return [Forever(all_before(d))]


@meaning("same_for")
def same_for(d: Discourse, node: Node) -> Steps:
    """ "do the same for Bob": the steps before, with Bob in the place of the person before."""
    if d.person is None or not d.done:
        raise NotUnderstood(d.language.phrase("repeat_what"))
    old = d.person.value
    person: Thing = d.get(node, "person_ref")
    if person.group is not None or not person.known:
        raise NotUnderstood(d.language.phrase("one_person"))
    return [replaced(step, old, person.value) for step in d.done]


def replaced(part: Any, old: Value, new: Value) -> Any:
    """A part of a plan with one value put in the place of another, in texts too."""
    if part == old:
        return new
    if isinstance(part, tuple):
        return tuple(replaced(each, old, new) for each in part)
    if isinstance(part, dict):
        return {key: replaced(value, old, new) for key, value in part.items()}
    if isinstance(part, Text) and isinstance(old, Text) and isinstance(new, Text):
        return Text(part.value.replace(old.value, new.value))
    if isinstance(part, msgspec.Struct):
        fields = {name: replaced(getattr(part, name), old, new) for name in part.__struct_fields__}
        return msgspec.structs.replace(part, **fields)
    return part


# --- for each


@meaning("for_each_place")
def for_each_place(d: Discourse, node: Node) -> Steps:
    """ "for every office, go there and ...", "in all wards, ..." ("in" means going there)."""
    kind = d.get(node, "kinds")
    listed: list[Value] | None = d.get(node, "place_list")
    items: Value = Items((d.get(node, "place"), *listed)) if listed else kind_places(d, kind)
    return each_place(d, items, node.parts.get("steps"), bool(node.production.fixed.get("go")))


def each_place(d: Discourse, items: Value, steps: Leaf | Node | None, goes: bool) -> Steps:
    """Do some steps for each of the places; there, if that is how it was said."""
    variable = d.variable("place")
    here = Recall(variable)
    going = Call("goto", {"place": here})
    before = d.at
    d.place = here
    d.at = here if goes else None
    body: Steps = []
    if steps is not None:
        outer, d.in_loop = d.in_loop, True
        body = d.build(steps)
        d.in_loop = outer
    first = body[0] if body else None
    moves = isinstance(first, Call) and first.method in ("goto", "guide", "find")
    if not moves and (goes or not mentions(body, here)):
        body = [going, *body]
    d.at = None if body else before
    d.with_person = None
    return [ForEach(variable, items, tuple(body))]


@meaning("for_each_of_them")
def for_each_of_them(d: Discourse, node: Node) -> Steps:
    """ "go to the lobby and to ward 3, and in each of them ...": done at all these."""
    going: list[Call] = []
    while d.done and isinstance(d.done[-1], Call) and _goes_to_name(d.done[-1]):
        last = d.done.pop()
        assert isinstance(last, Call)
        going.insert(0, last)
    if len(going) < 2:
        d.done.extend(going)
        raise NotUnderstood(d.language.phrase("which_places"))
    places = Items(tuple(call.arguments["place"] for call in going))
    return each_place(d, places, node.parts["steps"], goes=True)


def _goes_to_name(step: Call) -> bool:
    return step.method == "goto" and isinstance(step.arguments.get("place"), Text)


@meaning("check_each_place")
def check_each_place(d: Discourse, node: Node) -> Steps:
    """ "check every ward for visitors and tell them ...": go there, and if one is seen, do it."""
    sought_for: Thing = d.get(node, "person_ref") or d.get(node, "thing")
    variable = d.variable("place")
    d.at = d.place = Recall(variable)
    if sought_for.person:
        d.person, d.with_person = replace(sought_for, here=True), sought_for.value
    outer, d.in_loop = d.in_loop, True
    body = d.build(node.parts["steps"])
    d.in_loop = outer
    d.at = d.with_person = None
    seen = If(Holds(Ask("sees", {"thing": sought_for.value})), tuple(body))
    going = Call("goto", {"place": Recall(variable)})
    return [ForEach(variable, kind_places(d, d.get(node, "kinds")), (going, seen))]


@meaning("for_each_person")
def for_each_person(d: Discourse, node: Node) -> Steps:
    """ "for each of the next three visitors, ..." """
    times = d.get(node, "times")
    person: Thing | None = d.get(node, "person_ref")
    who = person.value if person is not None else Text(ANYONE)
    d.person = Thing(who, person=True, here=True)
    wait = Call("wait_for", {"thing": who})
    body = d.build(node.parts["steps"])
    if times is None:
        return [Forever((wait, *body))]
    return [Repeat(as_value(times), (wait, *body))]
