"""How commands follow, repeat and depend on each other."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final

import msgspec

from grammar.chart import Leaf, Node
from grammar.discourse import ANYONE, Discourse, NotUnderstood, Steps, Thing, as_value
from grammar.meanings.finding import not_found, speak_to
from grammar.meanings.nouns import is_me, kind_places
from grammar.meanings.registry import meaning
from grammar.meanings.speaking import sentence_form
from grammar.meanings.surveys import counting, moved
from grammar.plan import (
    Ask,
    Call,
    Compare,
    Condition,
    ForEach,
    Forever,
    Holds,
    If,
    Items,
    Not,
    Number,
    Recall,
    Remember,
    Repeat,
    RepeatUntil,
    Step,
    Text,
    Value,
    While,
)
from grammar.tidy import nodes
from grammar.wordorder import direct_clause

NEEDS_IT: Final = frozenset({"grab", "put", "give", "guide", "follow", "describe"})
"""Methods that say themselves when what was looked for is not there."""
LOOK_EVERY: Final = 10
"""Seconds between two looks at a condition that is waited for."""


@meaning("steps")
def steps(d: Discourse, node: Node) -> Steps:
    """Clauses one after the other: `first`, then `rest`."""

    def make() -> None:
        clauses: list[tuple[str, int]] = []
        each: Node | None = node
        further: list[Node] = []
        joint = "stop"
        while each is not None:
            before = len(d.done)
            first = each.parts["first"]
            assert isinstance(first, Node)
            d.done.extend(d.build(first))
            clauses.append((joint, len(d.done) - before))
            joint = str(each.production.fixed.get("joint", "and"))
            rest, beyond = each.parts.get("rest"), each.parts.get("further")
            if isinstance(beyond, Node):  # after the rest
                further.append(beyond)
            each = rest if isinstance(rest, Node) else further.pop() if further else None
        d.done[:] = guard_finds(d, speak_codes(d, d.done))

    return d.sequence(make)


def guard_finds(d: Discourse, done: Steps) -> Steps:
    """Where something is looked for, what follows holds only if it is found.

    Steps that need the thing fail by themselves and say so; speaking to somebody who was not found
    would not, so it goes under a condition."""
    result: Steps = []
    for number, step in enumerate(done):
        if not (isinstance(step, Call) and step.method == "find"):
            result.append(step)
            continue
        following = done[number + 1] if number + 1 < len(done) else None
        if isinstance(following, Call) and following.method in NEEDS_IT:
            result.append(step)
            continue
        found = Holds(Ask("find", step.arguments))
        missing = not_found(d, found_thing(d, step))
        body: Steps = []
        for later in done[number + 1 :]:
            if isinstance(later, Call) and (
                later.method in ("goto", "find", "dock") or later.method in NEEDS_IT
            ):
                break
            if not isinstance(later, Call | Remember):
                break
            body.append(later)
        if body:
            result.append(If(found, tuple(body), (missing,)))
        else:
            result.append(If(Not(found), (missing,)))
        return [*result, *guard_finds(d, done[number + 1 + len(body) :])]
    return result


def speak_codes(d: Discourse, done: Steps) -> Steps:
    """A code that is scanned for nothing else is read out."""
    result: Steps = []
    for number, step in enumerate(done):
        result.append(step)
        if isinstance(step, Call) and step.method == "scan" and step.save_as:
            code = Recall(step.save_as)
            if not mentions(done[number + 1 :], code):
                result.append(d.say("code_is", value=code))
    return result


def found_thing(d: Discourse, step: Call) -> Thing:
    value = step.arguments["thing"]
    named = isinstance(value, Text) and any(value.value == each.name for each in d.lexicon.people)
    return Thing(value, known=named, person=named)


@meaning("reversed")
def reversed_(d: Discourse, node: Node) -> Steps:
    """ "before you go, say goodbye" and "go after you have said goodbye"."""
    return [*d.build(node.parts["earlier"]), *d.build(node.parts["later"])]


@meaning("corrected")
def corrected(d: Discourse, node: Node) -> Steps:
    """ "go to the kitchen, no, the lobby": only what stands last counts."""
    result: Steps = d.build(node.parts["second"])
    return result


# --- conditions


@meaning("if")
def if_(d: Discourse, node: Node) -> Steps:
    condition: Condition = d.get(node, "condition")
    before_it, d.pending = d.pending, []
    if node.production.fixed.get("unless"):
        condition = Not(condition)
    before = (d.at, d.holding, d.with_person)
    then = d.build(node.parts["then"])
    after_then = d.at
    d.at, d.holding, d.with_person = before
    otherwise: Steps = []
    if "otherwise" in node.parts:
        otherwise = d.build(node.parts["otherwise"])
    if d.at != after_then:
        d.at = None
        d.with_person = None
    return [*before_it, If(condition, tuple(then), tuple(otherwise))]


@meaning("tell_condition")
def tell_condition(d: Discourse, node: Node) -> Steps:
    """ "if there are more than three people, tell Alice": that there are more than three people."""
    condition: Condition = d.get(node, "condition")
    before_it, d.pending = d.pending, []
    part = node.parts["condition"]
    text = Text(sentence_form(direct_clause(d, part.start, part.end)))
    person: Thing = d.get(node, "person_ref")
    then = speak_to(d, person, [Call("say", {"text": text})])
    if is_me(person) and moved([*before_it, If(condition, ())]):  # looked for somewhere else
        then = [Call("goto", {"place": d.start()}), *then]
    d.at = d.with_person = None
    return [*before_it, If(condition, tuple(then))]


@meaning("when")
def when(d: Discourse, node: Node) -> Steps:
    """ "when somebody comes, ...": wait for it, then do it; "whenever": again and again."""
    condition: Condition = d.get(node, "condition")
    wait = wait_until(condition)
    body = d.build(node.parts["then"])
    if node.production.fixed.get("always"):
        return [Forever((*wait, *body))]
    return [*wait, *body]


def wait_until(condition: Condition) -> Steps:
    """Wait until a condition holds."""
    if (
        isinstance(condition, Holds)
        and isinstance(condition.value, Ask)
        and condition.value.method in ("sees", "wait_for")
    ):
        return [Call("wait_for", condition.value.arguments)]
    return [While(negated(condition), (Call("wait", {"seconds": Number(LOOK_EVERY)}),))]


_OPPOSITE: Final = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "==": "!=", "!=": "=="}


def negated(condition: Condition) -> Condition:
    if isinstance(condition, Not):
        return condition.condition
    if isinstance(condition, Compare) and condition.operator in _OPPOSITE:
        return Compare(condition.left, _OPPOSITE[condition.operator], condition.right)
    return Not(condition)


@meaning("wait_until")
def wait_until_(d: Discourse, node: Node) -> Steps:
    return wait_until(d.get(node, "condition"))


@meaning("until")
def until(d: Discourse, node: Node) -> Steps:
    condition_first = node.production.fixed.get("first", False)
    if condition_first:
        condition: Condition = d.get(node, "condition")
        body = d.build(node.parts["steps"])
    else:
        body = d.build(node.parts["steps"])
        condition = d.get(node, "condition")
    if all(isinstance(step, Call) and step.method in ("wait",) for step in body):
        return wait_until(condition)
    before, body = counting(d, body)
    return [*before, RepeatUntil(condition, tuple(body))]


@meaning("while")
def while_(d: Discourse, node: Node) -> Steps:
    condition: Condition = d.get(node, "condition")
    body = d.build(node.parts["steps"])
    return [While(condition, tuple(body))]


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


@meaning("delayed")
def delayed(d: Discourse, node: Node) -> Steps:
    """ "in five minutes, ...", "at three o'clock, ..."."""
    waiting: Steps = d.build(node.parts["delay"])
    return [*waiting, *d.build(node.parts["then"])]


@meaning("at_time")
def at_time(d: Discourse, node: Node) -> Steps:
    """Wait until it is that late."""
    time = Compare(Ask("clock", field="time"), ">=", Text(d.get(node, "clock_time")))
    return wait_until(time)


@meaning("forever")
def forever(d: Discourse, node: Node) -> Steps:
    return [Forever(tuple(d.build(node.parts["steps"])))]


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
    return [RepeatUntil(d.get(node, "condition"), all_before(d))]


@meaning("do_that_while")
def do_that_while(d: Discourse, node: Node) -> Steps:
    return [While(d.get(node, "condition"), all_before(d))]


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


def mentions(body: Steps, value: Recall) -> bool:
    """Whether some steps use a variable."""
    return any(node == value for node in nodes(body))


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
