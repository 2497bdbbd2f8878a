"""Whether the first draft of a language model will do, so that nobody waits for others."""

from __future__ import annotations

from typing import Final

from grammar.planning.planner import Draft
from grammar.planning.turn import Turn
from nl2robot.deliberation.considering import consider

SURE: Final = 0.3
"""How likely the model has to have found each token. Others take as long as the first did; below
this, one of them is worth it."""


def will_do(turn: Turn, draft: Draft) -> bool:
    """Whether the model was sure of it, and the check has neither an objection nor a doubt."""
    if draft.surest < SURE:
        return False
    considered = consider(turn, draft)
    return considered is not None and considered.checked.sound and not considered.checked.doubts
