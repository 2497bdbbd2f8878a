"""Conditions: what is seen, heard, answered or scanned, the battery, the time."""

from __future__ import annotations

from grammar.chart import Node
from grammar.discourse import Discourse, NotUnderstood, Thing, as_value
from grammar.meanings.finding import noun_of
from grammar.meanings.nouns import sought
from grammar.meanings.registry import meaning
from grammar.plan import (
    Ask,
    Both,
    Call,
    Compare,
    Condition,
    Either,
    Holds,
    Not,
    Number,
    Recall,
    Text,
    Value,
)


@meaning("and")
def and_(d: Discourse, node: Node) -> Condition:
    return Both((d.get(node, "left"), d.get(node, "right")))


@meaning("or")
def or_(d: Discourse, node: Node) -> Condition:
    return Either((d.get(node, "left"), d.get(node, "right")))


@meaning("not")
def not_(d: Discourse, node: Node) -> Condition:
    from grammar.meanings.control import negated

    return negated(d.get(node, "condition"))


@meaning("is_seen")
def is_seen(d: Discourse, node: Node) -> Condition:
    """ "you see a cup", "Alice is there", "there is somebody"."""
    thing = noun_of(d, node)
    if thing.person:
        d.person = Thing(thing.value, known=thing.known, person=True, here=True)
        d.with_person = thing.value
    method = "find" if thing.place is not None and thing.place != d.at else "sees"
    arguments: dict[str, Value] = {"thing": sought(d, thing)}
    if method == "find" and thing.place is not None:
        arguments["place"] = thing.place
    result: Condition = Holds(Ask(method, arguments))
    return Not(result) if node.production.fixed.get("no") else result


@meaning("is_found")
def is_found(d: Discourse, node: Node) -> Condition:
    thing = noun_of(d, node)
    if thing.person:
        d.person = Thing(thing.value, known=thing.known, person=True, here=True)
    arguments: dict[str, Value] = {"thing": sought(d, thing)}
    if thing.place is not None:
        arguments["place"] = thing.place
    result: Condition = Holds(Ask("find", arguments))
    return Not(result) if node.production.fixed.get("no") else result


@meaning("counted")
def counted(d: Discourse, node: Node) -> Condition:
    """ "there are more than three people"."""
    thing = noun_of(d, node)
    if thing.person:
        d.person = thing
    if thing.place is not None and thing.place != d.at:
        d.went(thing.place)
        d.pending.append(Call("goto", {"place": thing.place}))
    operator = d.get(node, "operator", "==")
    return Compare(
        Ask("count", {"thing": sought(d, thing)}), operator, Number(int(d.get(node, "count")))
    )


@meaning("battery_is")
def battery_is(d: Discourse, node: Node) -> Condition:
    return Compare(Ask("battery"), d.get(node, "operator", "=="), as_value(d.get(node, "percent")))


@meaning("time_is")
def time_is(d: Discourse, node: Node) -> Condition:
    """Times of day compare as "HH:MM" texts do."""
    return Compare(
        Ask("clock", field="time"), d.get(node, "operator", ">="), Text(d.get(node, "clock_time"))
    )


@meaning("weekday_is")
def weekday_is(d: Discourse, node: Node) -> Condition:
    return Compare(Ask("clock", field="weekday"), "==", Text(d.get(node, "weekday")))


@meaning("weekend")
def weekend(d: Discourse, node: Node) -> Condition:
    day = Ask("clock", field="weekday")
    return Either((Compare(day, "==", Text("Saturday")), Compare(day, "==", Text("Sunday"))))


@meaning("robot_is_at")
def robot_is_at(d: Discourse, node: Node) -> Condition:
    return Compare(Ask("location", field="place"), "==", d.get(node, "place"))


@meaning("answered")
def answered(d: Discourse, node: Node) -> Condition:
    """ "if they say yes", "if the answer is radiology"."""
    if d.answer is None:
        raise NotUnderstood(d.language.phrase("no_question"))
    fixed = node.production.fixed
    if "answer" in fixed:
        wanted = d.language.phrase(str(fixed["answer"]))
    else:
        place = node.parts.get("place")
        if place is not None:
            value: Value = d.build(place)
            assert isinstance(value, Text)
            wanted = value.value
        else:
            wanted = str(d.get(node, "text"))
    for option in d.answer_options:
        if option.lower() == wanted.lower():
            return Compare(Recall(d.answer), "==", Text(option))
    return Compare(Text(wanted), "in", Recall(d.answer))


@meaning("code_is")
def code_is(d: Discourse, node: Node) -> Condition:
    if d.code is None:
        raise NotUnderstood(d.language.phrase("no_code"))
    return Compare(Recall(d.code), "==", Text(str(d.get(node, "text"))))


@meaning("is_heard")
def is_heard(d: Discourse, node: Node) -> Condition:
    """ "you hear help"."""
    heard: Value = Recall(d.heard) if d.heard else Ask("listen")
    return Compare(Text(str(d.get(node, "text"))), "in", heard)
