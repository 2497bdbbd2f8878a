"""Waiting for a time, or for something to happen, and what is done then."""

from __future__ import annotations

from typing import Final

from grammar.chart import Node
from grammar.discourse import Discourse, Steps, Thing
from grammar.inference import takes_time
from grammar.meanings.branches import claim_of, meet_there
from grammar.meanings.conditions import condition_of, negated
from grammar.meanings.finding import speak_to
from grammar.meanings.nouns import is_me
from grammar.meanings.registry import meaning
from grammar.meanings.reports import known_words
from grammar.meanings.rounds import inside
from grammar.meanings.surveys import moved
from grammar.plan import Ask, Call, Compare, Condition, Forever, Holds, Number, Text, While

LOOK_EVERY: Final = 10
"""Seconds between two looks at a condition that is waited for."""


@meaning("when")
def when(d: Discourse, node: Node) -> Steps:
    """ "when somebody comes, ...": wait for it, then do it; "whenever": again and again."""
    named_before(d, node)
    wait = waiting(d, node)
    body = d.build(node.parts["then"])
    if node.production.fixed.get("always"):
        return [Forever((*wait, *body))]
    return [*wait, *body]


def named_before(d: Discourse, node: Node) -> None:
    """ "give it to Clara when she comes": she is named in what is said first and done later."""
    then = node.parts["then"]
    if d.person is None and then.start < node.parts["condition"].start:
        names = (each for each in inside(then) if each.production.means == "person_name")
        if name := next(names, None):
            d.build(name)


def waiting(d: Discourse, node: Node) -> Steps:
    """Wait until the condition of a clause holds; whoever is waited for is then here."""
    before, condition = condition_of(d, node)
    meet_there(d, d.met)
    return [*before, *wait_until(condition)]


@meaning("tell_when")
def tell_when(d: Discourse, node: Node) -> Steps:
    """ "as soon as Bob is here, tell me": wait for it, then say that it is so."""
    before_it, condition = condition_of(d, node)
    claim = claim_of(d, node, condition, d.met)
    meet_there(d, d.met)
    person: Thing = d.get(node, "person_ref")
    waiting = [*before_it, *wait_until(condition)]
    told = speak_to(d, person, known_words(d) if claim is None else [claim])
    if is_me(person) and moved(waiting):
        return [*waiting, Call("goto", {"place": d.start()}), *told]
    return [*waiting, *told]


def at_least(condition: Condition) -> Condition:
    """ "until there are three people": more are enough, too."""
    if (
        isinstance(condition, Compare)
        and condition.operator == "=="
        and isinstance(condition.left, Ask)
        and condition.left.method == "count"
    ):
        return Compare(condition.left, ">=", condition.right)
    return condition


def wait_until(condition: Condition) -> Steps:
    """Wait until a condition holds."""
    condition = at_least(condition)
    if isinstance(condition, Holds) and isinstance(condition.value, Ask):
        asked = condition.value
        if asked.method in ("sees", "wait_for"):
            return [Call("wait_for", asked.arguments)]
        if asked.method == "find" and "place" in asked.arguments:
            there = Call("goto", {"place": asked.arguments["place"]})
            return [there, Call("wait_for", {"thing": asked.arguments["thing"]})]
    pause = 1 if takes_time(condition) else LOOK_EVERY
    return [While(negated(condition), (Call("wait", {"seconds": Number(pause)}),))]


@meaning("wait_until")
def wait_until_(d: Discourse, node: Node) -> Steps:
    return waiting(d, node)


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
