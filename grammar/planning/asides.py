"""What is said besides an order, and is no part of what it becomes: why, and what for."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import msgspec

from grammar.checking.sources import Sources
from grammar.checking.words import content
from grammar.phrases import Phrases
from grammar.plan import Call, Plan, Text
from grammar.planning.turn import Turn
from grammar.roles import FREE
from grammar.tidy import replaced
from grammar.traversal import nodes

_Span = tuple[int, int]
ENDS = ".!?…"


def clauses(turn: Turn) -> Iterator[_Span]:
    """The tokens between two marks: first, and behind the last."""
    marks = [at for at, token in enumerate(turn.tokens) if token.kind == "mark"]
    for before, after in itertools.pairwise((-1, *marks, len(turn.tokens))):
        if after > before + 1:
            yield before + 1, after


def asides(turn: Turn, plan: Plan) -> list[_Span]:
    """The clauses of which a plan makes nothing."""
    used = {at for each in Sources(turn, plan).found for at in each.tokens}
    sense = {at for at, _ in content(turn.tokens, turn.language)} | used
    return [
        (start, end)
        for start, end in clauses(turn)
        if sense & {*range(start, end)} and not used & {*range(start, end)}
    ]


def with_reasons(turn: Turn, plan: Plan) -> Plan:
    """A message with the reason that is given for it: "tell Alice to come, there is a fire"."""
    reasons = Phrases(
        turn.language.tokens_of(each) for each in turn.language.speech.get("reasons", ())
    )
    norms = [token.norm for token in turn.tokens]
    given = [each for each in clauses(turn) if any(reasons.lengths(norms, each[0]))]
    for start, end in asides(turn, plan) if given else ():
        message = _message(turn, plan) if (start, end) in given else None
        if message is None:
            continue
        text, at = message
        reason = turn.text[turn.tokens[start].start : turn.tokens[end - 1].end]
        reason = f"{reason[:1].upper()}{reason[1:]}."
        said = text if text[-1:] in ENDS else f"{text}."
        both = f"{said} {reason}" if at < start else f"{reason} {said}"
        steps = replaced(plan.steps, Text(text), Text(both))
        plan = msgspec.structs.replace(plan, steps=steps)
    return plan


def _message(turn: Turn, plan: Plan) -> tuple[str, int] | None:
    """What somebody is told, if that is one thing, and where it is said in the sentence."""
    people = [each for each in turn.mentions if each.sort == "person"]
    named = {at for each in people for at in range(each.start, each.end)}
    told = {
        each.literal.text: min(each.tokens - named)
        for each in Sources(turn, plan).found
        if each.literal.role == FREE and each.literal.method == "say" and each.tokens - named
    }
    says = {
        text.value
        for each in nodes(plan.steps)
        if isinstance(each, Call) and each.method == "say"
        for text in each.arguments.values()
        if isinstance(text, Text)
    }
    messages = [(text, at) for text, at in told.items() if text in says]
    return messages[0] if len(messages) == 1 else None
