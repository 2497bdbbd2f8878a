"""How likely it is that a draft is what was meant, as one number that means what it says.

What planners think of themselves is not comparable, and too sure. So what is known of a draft (how
its planner liked it, how many votes it has, what the check doubts, what it leaves unused) is
weighed by a logistic regression, fitted on sentences whose outcome is known and that nobody has
learned from: `python -m nl2robot.training.planner.calibrate`.
"""

from __future__ import annotations

import functools
import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Final

from grammar.checking.words import content
from grammar.planning.turn import Turn
from nl2robot.deliberation.voting import Count, Vote

WEIGHTS: Final = Path(__file__).parents[1] / "data" / "confidence.json"


def features(turn: Turn, vote: Vote, count: Count) -> dict[str, float]:
    """What is known of the first draft of a vote."""
    first, draft = vote.first, vote.first.draft
    checked = first.checked
    doubts = [each.kind for each in checked.doubts]
    words = sum(1 for _ in content(turn.tokens, turn.language)) or 1
    lines = first.program.count("\n")
    return {
        "share": vote.share,
        "score": draft.score,
        "score by line": draft.score / max(1, lines),
        "surest": draft.surest,
        "lines": math.log1p(lines),
        "words": math.log1p(words),
        "unused": len(checked.unused) / words,
        "unused words": math.log1p(len(checked.unused)),
        "unasked": min(3, doubts.count("unasked")),
        "hardly asked": min(3, doubts.count("hardly asked")),
        "unheeded": min(3, doubts.count("unheeded")),
        "own": min(3, len(checked.own)),
        "dropped": len(count.dropped) / (len(count.dropped) + len(vote.drafts)),
        "rivals": min(3, len(count.votes) - 1),
        "branches": first.program.count("if ") + first.program.count("for "),
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
    known = features(turn, vote, count)
    total = weights["bias"] + sum(weights.get(name, 0.0) * value for name, value in known.items())
    return 1 / (1 + math.exp(-max(-30.0, min(30.0, total))))
