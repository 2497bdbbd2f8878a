"""Conditions: and, or, not; the battery, the time, what is touched, scanned, heard or awaited."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from grammar.chart import Leaf, Node
from grammar.discourse import Discourse, Meeting, Steps, as_value
from grammar.errors import NotUnderstood
from grammar.meanings.deliveries import inside
from grammar.meanings.finding import noun_of
from grammar.meanings.places import sought
from grammar.meanings.registry import meaning
from grammar.meanings.searches import searches
from grammar.plan import (
    Ask,
    Both,
    Call,
    Compare,
    Condition,
    Either,
    Holds,
    If,
    Items,
    Not,
    Recall,
    Remember,
    Step,
    Text,
    Truth,
    Try,
    Value,
)
from grammar.tidy import nodes

TELLING: Final = frozenset({"tell_that", "tell_me_that"})
"""Clauses that only say whom to tell of what was found out."""
ABOUT_ANSWERS: Final = frozenset(
    {
        *("so", "answered", "answer_counts", "answers_many", "answers_same", "unanswered"),
        *("answer_is", "answers_reached", "answered_besides"),
        *("code_is", "cannot_check"),
    }
)
"""Conditions on what somebody has said."""


@meaning("and")
def and_(d: Discourse, node: Node) -> Condition:
    left = d.get(node, "left")
    met, pending = d.branch.met, len(d.command.pending)
    right = d.get(node, "right")
    if not searches(left) and any(_goes(step) for step in d.command.pending[pending:]):
        # What is so in one place is noted before the robot goes to look at the other.
        name = d.variable("so")
        noted: Steps = [Remember(name, Truth(False)), If(left, (Remember(name, Truth(True)),))]
        first, then = d.command.pending[:pending], d.command.pending[pending:]
        d.command = replace(d.command, pending=(*first, *noted, *then))
        left = Holds(Recall(name))
    d.branch = replace(d.branch, met=d.branch.met or met)
    return Both((left, right))


def _goes(step: Step) -> bool:
    return isinstance(step, Call) and step.method == "goto"


@meaning("or")
def or_(d: Discourse, node: Node) -> Condition:
    either = Either((d.get(node, "left"), d.get(node, "right")))
    d.branch = replace(d.branch, met=None)
    return either


@meaning("not")
def not_(d: Discourse, node: Node) -> Condition:
    condition = negated(d.get(node, "condition"))
    if d.branch.met is not None:
        d.branch = replace(d.branch, met=replace(d.branch.met, holds=not d.branch.met.holds))
    return condition


_OPPOSITE: Final = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "==": "!=", "!=": "=="}


def negated(condition: Condition) -> Condition:
    if isinstance(condition, Not):
        return condition.condition
    if isinstance(condition, Compare) and condition.operator in _OPPOSITE:
        return Compare(condition.left, _OPPOSITE[condition.operator], condition.right)
    return Not(condition)


def condition_of(d: Discourse, node: Node, name: str = "condition") -> tuple[Steps, Condition]:
    """The condition of a clause, and the steps that it needs before it can be checked; whom it is
    about is then `d.met`."""
    named_before(d, node, name)
    outer = d.command.pending
    d.command = replace(d.command, pending=())
    d.branch = replace(d.branch, met=None)
    d.round = replace(d.round, told_of=only_told_of(node))
    condition: Condition = d.get(node, name)
    before = d.command.pending
    d.command = replace(d.command, pending=outer)
    return list(before), condition


def only_told_of(node: Node) -> bool:
    """Whether what depends on a condition is that somebody is told of it, and nothing is done where
    it is so: "if any lab is free, tell Bob"."""
    then = node.parts.get("then")
    if then is None:
        return node.means == "tell_condition"
    means = {each.means for each in inside(then)}
    return bool(means & TELLING) and "place_there" not in means


def named_before(d: Discourse, node: Node, name: str) -> None:
    """ "give it to Clara when she comes", "... if she is in her office": she is named in what is
    said first and done later."""
    then = node.parts.get("then")
    if d.scene.person is None and then is not None and then.start < node.parts[name].start:
        names = (each for each in inside(then) if each.production.means == "person_name")
        if who := next(names, None):
            d.build(who)


@meaning("battery_is")
def battery_is(d: Discourse, node: Node) -> Condition:
    last = d.done[-1] if d.done else None
    if d.reports.open and last is not None and Ask("battery") in nodes(last):
        d.done.pop()  # "check your battery. If ...": nobody is told
        d.reports = replace(d.reports, open=False)
    return Compare(Ask("battery"), d.get(node, "operator", "=="), as_value(d.get(node, "percent")))


@meaning("time_is")
def time_is(d: Discourse, node: Node) -> Condition:
    """Times of day compare as "HH:MM" texts do."""
    return Compare(
        Ask("clock", field="time"), d.get(node, "operator", ">="), Text(d.get(node, "clock_time"))
    )


@meaning("weekday_is")
def weekday_is(d: Discourse, node: Node) -> Condition:
    day = Compare(Ask("clock", field="weekday"), "==", Text(d.get(node, "weekday")))
    more: Condition | None = d.get(node, "more")
    if more is None:
        return day
    return Either((day, *(more.conditions if isinstance(more, Either) else (more,))))


FULL_HOUR: Final = Compare(Text(":00"), "in", Ask("clock", field="time"))


@meaning("full_hour")
def full_hour(d: Discourse, node: Node) -> Condition:
    return FULL_HOUR


@meaning("weekend")
def weekend(d: Discourse, node: Node) -> Condition:
    """ "it is the weekend", or no day of the weekend."""
    day = Ask("clock", field="weekday")
    free = Either((Compare(day, "==", Text("Saturday")), Compare(day, "==", Text("Sunday"))))
    return Not(free) if node.production.fixed.get("no") else free


@meaning("robot_is_at")
def robot_is_at(d: Discourse, node: Node) -> Condition:
    return Compare(Ask("location", field="place"), "==", d.get(node, "place"))


@meaning("is_touched")
def is_touched(d: Discourse, node: Node) -> Condition:
    """ "somebody touches the screen": a button is shown there; nobody need touch it."""
    touched = Recall(d.variable("touched"))
    button = Text(d.language.phrase("button"))
    nobody = Remember(touched.name, Text(""))
    showing = Call("touch", {"options": Items((button,))}, save_as=touched.name)
    d.need_first(Try((showing,), (nobody,)))
    return Compare(touched, "==", button)


@meaning("code_is")
def code_is(d: Discourse, node: Node) -> Condition:
    if d.answers.code is None:
        raise NotUnderstood(d.language.phrase("no_code"))
    part = node.parts["text"]  # its digits as they were said, should it be a number
    number = isinstance(part, Leaf) and part.slot == "number"
    text = d.words(part.start, part.end) if number else str(d.build(part))
    return Compare(Recall(d.answers.code), "==", Text(text))


@meaning("is_awaited")
def is_awaited(d: Discourse, node: Node) -> Condition:
    """ "nobody comes within five minutes": waited for so long, and no longer."""
    thing = noun_of(d, node)
    if thing.place is not None and thing.place != d.scene.at:
        d.went(thing.place)
        d.need_first(Call("goto", {"place": thing.place}))
    d.scene = replace(d.scene, person=replace(thing, here=True))
    seconds = as_value(d.get(node, "seconds"))
    waited = Holds(Ask("wait_for", {"thing": sought(d, thing), "timeout": seconds}))
    no = bool(node.production.fixed.get("no"))
    d.branch = replace(d.branch, met=Meeting(thing, holds=not no))
    return Not(waited) if no else waited


@meaning("is_heard")
def is_heard(d: Discourse, node: Node) -> Condition:
    """ "you hear help". Where nobody speaks, nothing was heard, and that is no failure."""
    if d.answers.heard is None:
        name = d.variable("heard")
        silence = Remember(name, Text(""))
        d.need_first(Try((Call("listen", save_as=name),), (silence,)))
        heard: Value = Recall(name)
    else:
        heard = Recall(d.answers.heard)
    part = node.parts.get("text")
    if isinstance(part, Leaf) and part.slot == "text":
        first = d.tokens[part.start].norm
        if first in d.language.speech.get("articles", ()):  # a sound, and nothing that is said
            words = d.words(node.start, node.end)
            raise NotUnderstood(d.language.phrase("cannot_check", what=words))
    if node.production.fixed.get("own_name"):
        if not d.lexicon.robot_name:
            words = d.words(node.start, node.end)
            raise NotUnderstood(d.language.phrase("cannot_check", what=words))
        return Compare(Text(d.lexicon.robot_name), "in", heard)
    return Compare(Text(str(d.get(node, "text"))), "in", heard)
