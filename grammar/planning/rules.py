"""The rules of a language as a planner: quick, and exact where they know a sentence."""

from __future__ import annotations

from typing import Final

from grammar.planning.planner import Answer, Draft, Drafts, Question, Refusal, Service, Watch
from grammar.planning.turn import Turn
from grammar.refusals import forbidden, why_not
from grammar.understand import understand
from grammar.understanding import Understanding

NAME: Final = "grammar"
_OPEN: Final = frozenset({"not_understood_at_all"})
"""Reasons of the rules that another planner may know better."""

_MUST_NOT: Final = ("no_harm", "no_medicine", "dismissed")
"""What is said where the rules have understood that nothing shall be done."""


class RulesPlanner:
    """Understands what the rules can say, as a whole or not at all."""

    name = NAME

    def plan(self, turn: Turn, watch: Watch) -> Answer:
        understood = understand(turn.text, turn.lexicon, turn.language.code, turn.context)
        if understood.request is not None:
            return Service(understood.request, understood.context)
        if understood.plan is not None:
            draft = Draft(
                understood.plan, NAME, understood.confidence, understood.context, exact=True
            )
            return Drafts((draft,))
        message, suggestions = understood.message or "", tuple(understood.suggestions)
        if understood.status == "clarify":
            return Question(message, suggestions, understood.context)
        return Refusal(message, suggestions, _is_final(turn, understood), understood.context)


def _is_final(turn: Turn, understood: Understanding) -> bool:
    """Whether the rules refuse because something must not be done, or is none of a robot's
    business: not only because they do not understand it."""
    tokens = turn.tokens
    if not tokens or forbidden(tokens, turn.language) is not None:
        return True
    if understood.message in [turn.language.phrases.get(each) for each in _MUST_NOT]:
        return True
    reason = why_not(tokens, turn.language, turn.reader.names.called)
    return reason not in _OPEN and understood.message == turn.language.phrases.get(reason)


__all__ = ["NAME", "RulesPlanner"]
