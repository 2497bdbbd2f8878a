"""The rules of a language as a planner: quick, and exact where they know a sentence."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from grammar.plan import Plan, calls
from grammar.planning.planner import Answer, Draft, Drafts, Question, Refusal, Service, Watch
from grammar.planning.turn import Turn
from grammar.planning.whereabouts import brought_to_speaker
from grammar.refusals import forbidden
from grammar.understand import understand
from grammar.understanding import Understanding

NAME: Final = "grammar"
_MUST_NOT: Final = ("no_harm", "no_medicine", "no_computer")
"""What is said where nothing must be done, whoever understands the sentence better."""
_BRIEF: Final = 8
"""Tokens up to which "leave it" dismisses all that was said: a longer sentence may say more."""


class RulesPlanner:
    """Understands what the rules can say, as a whole or not at all."""

    name = NAME

    def plan(self, turn: Turn, watch: Watch) -> Answer:
        understood = understand(turn.text, turn.lexicon, turn.language.code, turn.context)
        if understood.request is not None:
            return Service(understood.request, understood.context)
        if understood.plan is not None:
            plan = brought_to_speaker(turn, understood.plan)
            context = replace(understood.context, plan=plan)
            return Drafts((Draft(plan, NAME, understood.confidence, context, exact=True),))
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
    for end, token in enumerate(turn.tokens):
        if not end or (token.kind != "mark" and token.norm not in subjects):
            continue
        cry = turn.text[: turn.tokens[end - 1].end]
        plan = understand(cry, turn.lexicon, turn.language.code).plan
        if plan is not None:
            if {call.method for call in calls(plan)} != {"stop"}:
                return None
            rest = turn.text[token.start :].lstrip(" ,;.!")
            halt = Plan(plan.steps, plan.language, (*plan.background, *([rest] if rest else [])))
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
