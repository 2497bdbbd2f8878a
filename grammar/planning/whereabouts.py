"""Where somebody is who gives an order: "fetch me the marker, I'm in the gym"."""

from __future__ import annotations

import msgspec

from grammar.checking.sources import Sources
from grammar.checking.words import content, weighty
from grammar.discourse import START
from grammar.normal import normal
from grammar.plan import Call, Plan, Recall, Text
from grammar.planning.asides import asides, clauses
from grammar.planning.mentions import Mention
from grammar.planning.turn import Turn
from grammar.tidy import replaced, without_unused
from grammar.traversal import nodes


def brought_to_speaker(turn: Turn, plan: Plan) -> Plan:
    """A plan that comes back to where the robot starts comes to where the speaker says to be, if
    that is no part of a message."""
    if Recall(START) not in nodes(plan.steps):
        return plan
    where = speakers_place(turn)
    if where is None:
        return plan
    told = {at for each in Sources(turn, plan).found for at in each.tokens}
    if told.intersection(_sense(turn), range(where.start, where.end)):
        return plan
    steps = replaced(plan.steps, Recall(START), Text(where.value))
    return normal(without_unused(msgspec.structs.replace(plan, steps=steps)))


def speakers_place(turn: Turn) -> Mention | None:
    """The place of which somebody says nothing but to be there: "I'm waiting in the gym"."""
    words = weighty(turn.language)
    sense = _sense(turn)
    for each in turn.mentions:
        if each.sort != "place":
            continue
        start, end = _sentence(turn, each.start)
        clause = [turn.tokens[at].norm for at in range(start, end)]
        others = sense.intersection(range(start, end)) - {*range(each.start, each.end)}
        rest = {turn.tokens[at].norm for at in others}
        if clause[0] in words.speakers and words.staying & {*clause} and rest <= words.staying:
            return each
    return None


def brought_where_it_happened(turn: Turn, plan: Plan) -> Plan:
    """A plan that fetches somebody for no other reason than what is said to be so elsewhere brings
    them there: "somebody has fallen in ward b, fetch a doctor"."""
    led_to = {
        each.arguments.get("place")
        for each in nodes(plan.steps)
        if isinstance(each, Call) and each.method == "guide"
    }
    if led_to != {Recall(START)}:
        return plan
    for start, end in asides(turn, plan):
        within = [each for each in turn.mentions if start <= each.start and each.end <= end]
        places = {each.value for each in within if each.sort == "place"}
        if len(places) == 1 and any(each.sort == "person" for each in within):
            steps = replaced(plan.steps, Recall(START), Text(places.pop()))
            return normal(without_unused(msgspec.structs.replace(plan, steps=steps)))
    return plan


def _sense(turn: Turn) -> set[int]:
    """The tokens of words with a sense of their own: "the" of "the gym" is said of all things."""
    return {at for at, _ in content(turn.tokens, turn.language)}


def _sentence(turn: Turn, at: int) -> tuple[int, int]:
    """The tokens between two marks."""
    return next((start, end) for start, end in clauses(turn) if start <= at < end)
