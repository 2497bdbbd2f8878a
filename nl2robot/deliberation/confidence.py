"""How likely it is that a draft is what was meant, as one number that means what it says.

What planners think of themselves is not comparable, and too sure. So what is known of a draft (how
its planner liked it, how many votes it has, what the check doubts, what it leaves unused) is
weighed by a logistic regression, fitted on sentences whose outcome is known and that nobody has
learned from: `python -m nl2robot.training.planner.calibrate`. Of a draft of the rules, what they
have read tells most: some rules are nearly always right, others often take words for something
else.
"""

from __future__ import annotations

import functools
import json
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

from grammar.checking.words import content
from grammar.planning.planner import Draft
from grammar.planning.turn import Turn
from nl2robot.paths import PACKAGED

if TYPE_CHECKING:  # trying drafts needs the sandbox, which takes a moment to load
    from nl2robot.deliberation.considering import Considered
    from nl2robot.deliberation.voting import Count, Vote

WEIGHTS: Final = PACKAGED / "confidence.json"
READ: Final = "read: "
"""Before the name of a meaning, or of a slot, that a reading has."""
_TEXT: Final = "text"
_CORRECTED: Final = "“"
"""Begins what stands in a reading for a word that was put right."""


def features(turn: Turn, vote: Vote, count: Count) -> dict[str, float]:
    """What is known of the first draft of a vote."""
    draft = vote.first.draft
    known = features_alone(turn, vote.first)
    return known | {
        "share": vote.share,
        "score": draft.score,
        "score by line": draft.score / max(1.0, math.expm1(known["lines"])),
        "surest": draft.surest,
        "dropped": len(count.dropped) / (len(count.dropped) + len(vote.drafts)),
        "rivals": min(3, len(count.votes) - 1),
    }


def features_alone(turn: Turn, considered: Considered) -> dict[str, float]:
    """What is known of a draft that has no rivals."""
    checked, draft = considered.checked, considered.draft
    doubts = [each.kind for each in checked.doubts]
    words = sum(1 for _ in content(turn.tokens, turn.language)) or 1
    program = considered.program
    return {
        "lines": math.log1p(program.count("\n")),
        "words": math.log1p(words),
        "unused": len(checked.unused) / words,
        "unused words": math.log1p(len(checked.unused)),
        "unasked": min(3, doubts.count("unasked")),
        "hardly asked": min(3, doubts.count("hardly asked")),
        "unheeded": min(3, doubts.count("unheeded")),
        "own": min(3, len(checked.own)),
        "branches": program.count("if ") + program.count("for "),
        "remarks": len(draft.plan.background),
    } | _features_of_reading(turn, draft)


def _features_of_reading(turn: Turn, draft: Draft) -> dict[str, float]:
    """What is known of how rules have read the sentence."""
    if not draft.reading:
        return {}
    texts = [len(each.words.split()) for each in draft.reading if each.meaning == _TEXT]
    read = {each.meaning for each in draft.reading if not each.meaning.startswith(_CORRECTED)}
    return {
        "sure": draft.probability,
        "parts": math.log1p(len(draft.reading)),
        "texts": len(texts),
        "text words": math.log1p(sum(texts)),
        "marks": sum(token.kind == "mark" for token in turn.tokens),
        **{f"{READ}{each}": 1.0 for each in sorted(read)},
    }


@functools.cache
def _weights() -> Mapping[str, Mapping[str, float]]:
    known: Mapping[str, Mapping[str, float]] = json.loads(WEIGHTS.read_text("utf-8"))
    return known


def confidence(turn: Turn, vote: Vote, count: Count) -> float:
    """The probability that the first draft of a vote is what was meant: its share of the votes, as
    long as nothing is known of its planner."""
    weights = _weights().get(vote.first.draft.planner)
    if weights is None:
        return min(1.0, vote.share)
    return _probability(weights, features(turn, vote, count))


def confidence_alone(turn: Turn, considered: Considered) -> float:
    """The same for the only draft of a planner: what it says itself, if nothing else is known."""
    weights = _weights().get(considered.draft.planner)
    if weights is None:
        return considered.draft.probability
    return _probability(weights, features_alone(turn, considered))


def _probability(weights: Mapping[str, float], known: Mapping[str, float]) -> float:
    total = weights["bias"] + sum(weights.get(name, 0.0) * value for name, value in known.items())
    return 1 / (1 + math.exp(-max(-30.0, min(30.0, total))))
