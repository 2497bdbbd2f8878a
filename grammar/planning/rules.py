"""The rules of a language as a planner: quick, and exact where they know a sentence."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import Final

import msgspec

from grammar.plan import methods
from grammar.planning.heeding import heeded
from grammar.planning.planner import Answer, Draft, Drafts, Question, Refusal, Service, Watch
from grammar.planning.turn import Turn
from grammar.refusals import forbidden
from grammar.understand import understand
from grammar.understanding import Understanding

NAME: Final = "grammar"
_MUST_NOT: Final = ("no_harm", "no_medicine", "no_computer")
"""What is said where nothing must be done, whoever understands the sentence better."""
_BRIEF: Final = 8
"""Tokens up to which "leave it" dismisses all that was said (a longer sentence may say more), and
that a cry of stop has at most."""


class RulesPlanner:
    """Understands what the rules can say, as a whole or not at all."""

    name = NAME

    def plan(self, turn: Turn, watch: Watch) -> Answer:
        understood = understand(turn.text, turn.lexicon, turn.language.code, turn.context)
        if understood.request is not None:
            return Service(understood.request, understood.context)
        if understood.plan is not None:
            plan = heeded(turn, understood.plan)
            context = replace(understood.context, plan=plan)
            sure, reading = understood.confidence, tuple(understood.parts)
            return Drafts((Draft(plan, NAME, sure, context, exact=True, reading=reading),))
        if understood.status == "rejected" and (halt := _halt(turn)) is not None:
            return Drafts((halt,))
        message, suggestions = understood.message or "", tuple(understood.suggestions)
        if understood.status == "clarify":
            return Question(message, suggestions, understood.context)
        return Refusal(message, suggestions, _is_final(turn, understood), understood.context)


def _halt(turn: Turn) -> Draft | None:
    """A cry of stop is obeyed, whatever is said after it: "please stop right now, you are going to
    hit somebody". None if this is not one."""
    subjects = turn.language.speech["after_stop"]
    for last, behind in itertools.pairwise(turn.tokens[: _BRIEF + 1]):
        if behind.kind != "mark" and behind.norm not in subjects:
            continue
        cry = understand(turn.text[: last.end], turn.lexicon, turn.language.code).plan
        if cry is not None:
            if methods(cry) != {"stop"}:
                return None
            rest = turn.text[behind.start :].lstrip(" ,;.!")
            said = (*cry.background, rest) if rest else cry.background
            halt = msgspec.structs.replace(cry, background=said)
            return Draft(halt, NAME, 1.0, turn.context, exact=True)
    return None


def _is_final(turn: Turn, understood: Understanding) -> bool:
    """Whether the rules refuse because it must not be done: not only because they do not understand
    it, or take a word of it for idle talk."""
    if not turn.tokens or forbidden(turn.tokens, turn.language) is not None:
        return True
    said = (*_MUST_NOT, *(("dismissed",) if len(turn.tokens) <= _BRIEF else ()))
    return understood.message in [turn.language.phrases.get(each) for each in said]


__all__ = ["NAME", "RulesPlanner"]
