"""Whether the first draft will do, so that nobody waits for others."""

from __future__ import annotations

from typing import Final

from grammar.planning.planner import Draft
from grammar.planning.turn import Turn
from nl2robot.deliberation.confidence import confidence_alone
from nl2robot.deliberation.considering import Considered, consider

SURE: Final = 0.3
"""How likely the model has to have found each token. Others take as long as the first did; below
this, one of them is worth it."""

SURE_OF_RULES: Final = 0.4
"""How likely a draft of the rules has to be right, so that no language model is asked; whatever
does something else than an author's program was counted as wrong. From here on 828 of 912 programs
for commands of a robot competition are right and 53 of 56 for everyday errands, below 42 of 50 and
26 of 43; of typed sentences, to which it is fitted, 788 of 851 and 47 of 72."""


def is_sure(turn: Turn, considered: Considered) -> bool:
    """Whether a draft of the rules will do: it is short, and the check doubts nothing in it."""
    return confidence_alone(turn, considered) >= SURE_OF_RULES


def will_do(turn: Turn, draft: Draft) -> bool:
    """Whether the model was sure of it, and the check has neither an objection nor a doubt."""
    if draft.surest < SURE:
        return False
    considered = consider(turn, draft)
    return considered is not None and considered.checked.sound and not considered.checked.doubts
