"""What comes of the drafts for a turn: a program, one short question, or the reason why not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from grammar.checking import Objection
from grammar.explain import explain_steps
from grammar.naming import naming
from grammar.plan import Plan
from grammar.planning.planner import Draft, Question, Refusal
from grammar.planning.turn import Turn
from nl2robot.deliberation.considering import Considered, consider
from nl2robot.knowledge import Knowledge

ACCEPTED: Final = 0.5
"""From this probability on a program is shown as understood."""
CLOSE: Final = 0.6
"""A second that has so much of the votes of the first makes a question of them."""


@dataclass(frozen=True)
class Chosen:
    """A draft that may be shown as understood."""

    considered: Considered
    confidence: float

    @property
    def draft(self) -> Draft:
        return self.considered.draft

    @property
    def plan(self) -> Plan:
        return self.considered.draft.plan


@dataclass(frozen=True)
class Offer:
    """One of two that may be meant, by what tells it from the other."""

    told: str
    chosen: Chosen


@dataclass(frozen=True)
class Open:
    """A question that two drafts leave open."""

    question: Question
    offers: tuple[Offer, ...]


def decide(turn: Turn, drafts: Sequence[Draft], knowledge: Knowledge) -> Chosen | Open | Refusal:
    """What comes of some drafts."""
    if len(drafts) == 1 and drafts[0].exact:
        return _only(turn, drafts[0])
    # Trying drafts needs the sandbox, which takes a moment to load.
    from nl2robot.deliberation.confidence import confidence
    from nl2robot.deliberation.voting import count

    votes = count(turn, drafts, knowledge)
    if not votes.votes:
        return _refused(turn, votes.dropped)
    first = votes.votes[0]
    chosen = Chosen(first.first, round(confidence(turn, first, votes), 3))
    if len(votes.votes) > 1 and votes.votes[1].share >= CLOSE * first.share:
        second = votes.votes[1]
        other = Chosen(second.first, round(confidence(turn, second, votes), 3))
        question = _either(turn, chosen, other)
        if question is not None:
            return question
    if chosen.confidence < ACCEPTED:
        return Refusal(turn.language.phrase("not_sure_enough"))
    return chosen


def _only(turn: Turn, draft: Draft) -> Chosen | Refusal:
    """What comes of the one draft of a planner that is exact."""
    considered = consider(turn, draft)
    if considered is None or not considered.checked.sound:
        return _refused(turn, (considered,) if considered else ())
    return Chosen(considered, draft.probability)


def _refused(turn: Turn, dropped: Sequence[Considered]) -> Refusal:
    """Why none of the drafts will do, as far as that is for people to know."""
    objections: list[Objection] = [
        each for considered in dropped for each in considered.checked.objections
    ]
    told = next((each.message for each in objections if each.message), "")
    if told:
        return Refusal(told, final=any(each.kind == "refused" for each in objections))
    return Refusal(turn.language.phrase("not_sure_enough"))


def _either(turn: Turn, one: Chosen, other: Chosen) -> Open | None:
    """The question which of two is meant, by the first thing that they do differently."""
    called = naming(turn.lexicon, turn.language).called
    lines = [
        [text for _, text in explain_steps(each.plan, turn.language.code, called)]
        for each in (one, other)
    ]
    mine = [line for line in lines[0] if line not in lines[1]]
    theirs = [line for line in lines[1] if line not in lines[0]]
    if not mine or not theirs:
        return None
    message = turn.language.phrase("shall_i_either", one=mine[0], other=theirs[0])
    question = Question(message, (mine[0], theirs[0]), turn.context)
    return Open(question, (Offer(mine[0], one), Offer(theirs[0], other)))
