"""What comes of the drafts for a turn: a program, one short question, or the reason why not."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

from grammar.checking import Objection
from grammar.explain import explain, explain_steps
from grammar.language import speech
from grammar.naming import naming
from grammar.plan import Plan
from grammar.planning.planner import Draft, Question, Refusal
from grammar.planning.turn import Turn
from nl2robot.deliberation.confidence import confidence, confidence_alone
from nl2robot.deliberation.considering import Considered, consider
from nl2robot.knowledge import Knowledge

ACCEPTED: Final = 0.6
"""From this probability on a program is shown as understood."""
ASKED: Final = 0.15
"""From this one on it is asked whether it was meant."""
LIKELY: Final = 0.3
"""From this one on a draft of the rules is shown of which no other planner knows anything."""
CLOSE: Final = 0.6
"""A second that has so much of the votes of the first makes a question of them."""
LONGEST: Final = 160
"""Characters of what is offered: nobody listens to more."""
LONGEST_OF_ONE: Final = 320
"""The same, where it is all that is to be done."""
MUST_NOT: Final = frozenset({"refused", "harmful"})
"""Objections after which no other planner need be asked."""
CLAUSE: Final = ":"
"""Ends a line that says when, or how often, the lines below it are done."""


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
    """One of those that may be meant."""

    told: str
    """What tells it from the other; all that it does, if there is no other."""
    chosen: Chosen


@dataclass(frozen=True)
class Open:
    """A question that one draft, or two, leave open."""

    question: Question
    offers: tuple[Offer, ...]


def decide(turn: Turn, drafts: Sequence[Draft], knowledge: Knowledge) -> Chosen | Open | Refusal:
    """What comes of some drafts."""
    if len(drafts) == 1 and drafts[0].exact:
        return _only(turn, drafts[0])
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
    if chosen.confidence >= ACCEPTED and chosen.considered.checked.clear:
        return chosen
    question = _really(turn, chosen) if chosen.confidence >= ASKED else None
    return question or Refusal(turn.language.phrase("not_sure_enough"))


def _only(turn: Turn, draft: Draft) -> Chosen | Refusal:
    """What comes of the one draft of a planner that is exact."""
    considered = consider(turn, draft)
    if considered is None or not considered.checked.sound:
        return _refused(turn, (considered,) if considered else ())
    return Chosen(considered, draft.probability)


def between(turn: Turn, exact: Chosen, other: Chosen | Open | Refusal) -> Chosen | Open | Refusal:
    """What comes of a draft of an exact planner that may be wrong, and of what another one says: if
    that is the same, it is right. Otherwise the other one is believed, if it is sure; else it is
    asked which of the two is meant. Where the other one knows nothing, the draft is shown if it is
    likely to be right, and else asked about."""
    from nl2robot.deliberation.voting import same

    match other:
        case Chosen(considered=theirs):
            return exact if same(turn, exact.considered, theirs) else other
        case Open(offers=(Offer(chosen=theirs),)):
            if same(turn, exact.considered, theirs.considered):
                return exact
            return _either(turn, theirs, exact) or other
        case Refusal(final=False):
            likely = confidence_alone(turn, exact.considered) >= LIKELY
            return exact if likely else _really(turn, exact) or exact  # it is read in any case
        case _:
            return other


def _refused(turn: Turn, dropped: Sequence[Considered]) -> Refusal:
    """Why none of the drafts will do, as far as that is for people to know."""
    objections: list[Objection] = [
        each for considered in dropped for each in considered.checked.objections
    ]
    told = next((each for each in objections if each.message), None)
    if told is not None:
        final = any(each.kind in MUST_NOT for each in objections)
        return Refusal(told.message, told.suggestions, final=final)
    return Refusal(turn.language.phrase("not_sure_enough"))


def _either(turn: Turn, one: Chosen, other: Chosen) -> Open | None:
    """The question which of two is meant, by the first thing that they do differently; None if no
    short question tells them apart."""
    called = naming(turn.lexicon, turn.language).called
    language = turn.language.code
    lines = [
        [text for _, text in explain_steps(each.plan, language, called, deeds_only=True)]
        for each in (one, other)
    ]
    mine, theirs = _difference(*lines)
    if not mine or not theirs:  # one does more than the other, or the same in another order
        mine, theirs = (_whole(each, language) for each in lines)
    if mine == theirs or max(len(mine), len(theirs)) > LONGEST:
        return None
    message = turn.language.phrase("shall_i_either", one=mine, other=theirs)
    question = Question(message, (mine, theirs), turn.context)
    return Open(question, (Offer(mine, one), Offer(theirs, other)))


def _really(turn: Turn, chosen: Chosen) -> Open | None:
    """The question whether this was meant; None if that would be too long to listen to."""
    called = naming(turn.lexicon, turn.language).called
    told = explain(chosen.plan, turn.language.code, called, deeds_only=True)
    if len(told) > LONGEST_OF_ONE:
        return None
    yes = turn.language.speech["agree"][0]
    question = Question(turn.language.phrase("do_you_mean", deeds=told), (yes,), turn.context)
    return Open(question, (Offer(told, chosen),))


def _difference(mine: Sequence[str], theirs: Sequence[str]) -> tuple[str, str]:
    """What two do differently first; "" for one that does nothing that the other does not."""
    told = [
        next((_done(own[at:]) for at, line in enumerate(own) if line not in others), "")
        for own, others in ((mine, theirs), (theirs, mine))
    ]
    return told[0], told[1]


def _done(lines: Sequence[str]) -> str:
    """What is done first, and when if that is told before: "wave, if I see a person"."""
    return next(_deeds(lines), "")


def _whole(lines: Sequence[str], language: str) -> str:
    """All that is done, in one breath."""
    words = speech(language)
    joining = words.joining
    *first, last = [*_deeds(lines)] or [words.sentences["nothing"]]
    if len(first) < 2:
        return joining["two"].join([*first, last])
    return joining["comma"].join(first) + joining["last"] + last


def _deeds(lines: Sequence[str]) -> Iterator[str]:
    """What is done, with the clause that stands right before it."""
    clauses: list[str] = []
    for line in lines:
        if line.endswith(CLAUSE):
            clauses.append(line.removesuffix(CLAUSE))
        else:
            yield ", ".join([line, *clauses])
            clauses = []
