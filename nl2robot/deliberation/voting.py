"""Which of several drafts is meant.

    drafts -> check -> what each would do in a few scenes -> drafts that do the same are one vote

What the check objects to, what this robot cannot do, and what fails where all is as it should be,
has no vote. The words of messages may differ within a vote: not where they are said, to whom, and
after what.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

from rapidfuzz import fuzz

from grammar.planning.planner import Draft
from grammar.planning.turn import Turn
from grammar.roles import ANYBODY
from nl2robot.deliberation.considering import Considered, consider
from nl2robot.deliberation.paper_robot import Event, Scene
from nl2robot.deliberation.playing import Course, played
from nl2robot.deliberation.staging import scenes
from nl2robot.knowledge import Knowledge
from nl2robot.review.policy import violations

SPOKEN: Final = frozenset({"says", "asks", "shows"})
ALIKE: Final = 60.0
"""Of 100: texts that are so alike tell the same in other words."""
UNSEEN: Final = frozenset({"looks for", "counts"})
"""Events that change nothing for anybody."""


@dataclass(frozen=True)
class Tried:
    """A draft, and what it would do."""

    considered: Considered
    courses: tuple[Course, ...]

    @cached_property
    def traces(self) -> tuple[tuple[Event, ...], ...]:
        """What would happen in each scene, as far as anybody notices."""
        return tuple(_noticed(course) for course in self.courses)

    @property
    def fails(self) -> bool:
        """Whether it fails where everything is at its place."""
        return self.courses[0].end == "failed"


@dataclass(frozen=True)
class Vote:
    """Drafts that do the same."""

    drafts: tuple[Considered, ...]
    share: float
    """Of all that was drafted, by how likely it is."""

    @property
    def first(self) -> Considered:
        return self.drafts[0]


@dataclass(frozen=True)
class Count:
    votes: tuple[Vote, ...]
    """The most-voted first."""
    dropped: tuple[Considered, ...]
    """Drafts without a vote, and why."""


def count(turn: Turn, drafts: Sequence[Draft], knowledge: Knowledge) -> Count:
    """The votes of some drafts for a turn."""
    considered = [each for draft in drafts if (each := consider(turn, draft)) is not None]
    standing: list[Tried] = []
    dropped: list[Considered] = []
    for each in considered:
        if each.checked.sound and _possible(each, knowledge):
            standing.append(Tried(each, ()))
        else:
            dropped.append(each)
    tried = _tried(turn, [each.considered for each in standing])
    dropped += [each.considered for each in tried if each.fails]
    groups: list[list[Tried]] = []
    for one in tried:
        if one.fails:
            continue
        group = next((others for others in groups if _same(others[0], one)), None)
        if group is None:
            groups.append([one])
        else:
            group.append(one)
    total = sum(draft.probability for draft in drafts) or 1.0
    votes = [_vote(group, total) for group in groups]
    return Count(tuple(sorted(votes, key=lambda vote: -vote.share)), tuple(dropped))


def same(turn: Turn, one: Considered, other: Considered) -> bool:
    """Whether two do the same."""
    return _same(*_tried(turn, (one, other)))


def _vote(group: Sequence[Tried], total: float) -> Vote:
    drafts = tuple(each.considered for each in group)
    return Vote(drafts, sum(each.draft.probability for each in drafts) / total)


def _possible(each: Considered, knowledge: Knowledge) -> bool:
    """Whether this robot can do it in this world."""
    return not any(found.severity == "error" for found in violations(each.program, knowledge))


def _tried(turn: Turn, considered: Sequence[Considered]) -> list[Tried]:
    people = {each.value for each in turn.spoken_of if each.sort == "person"} - {ANYBODY}
    stage = scenes(turn.lexicon, [each.program for each in considered], people)
    return [Tried(each, tuple(_courses(each.program, stage))) for each in considered]


def _courses(program: str, stage: Sequence[Scene]) -> Iterator[Course]:
    """What it does in each scene; if it fails in the first, that is all there is to know."""
    for number, scene in enumerate(stage):
        course = played(program, scene)
        yield course
        if number == 0 and course.end == "failed":
            return


def _noticed(course: Course) -> tuple[Event, ...]:
    events: list[Event] = []
    for event in course.events:
        if event.kind in UNSEEN or (events and event == events[-1] and event.kind == "waits"):
            continue
        events.append(event)
    return tuple(events)


def _same(one: Tried, other: Tried) -> bool:
    ends = [[course.end for course in each.courses] for each in (one, other)]
    return ends[0] == ends[1] and all(
        _happens_alike(mine, theirs) for mine, theirs in zip(one.traces, other.traces, strict=True)
    )


def _happens_alike(one: Iterable[Event], other: Iterable[Event]) -> bool:
    mine, theirs = list(one), list(other)
    return len(mine) == len(theirs) and all(map(_alike, mine, theirs))


def _alike(one: Event, other: Event) -> bool:
    if (one.kind, one.at, one.whom) != (other.kind, other.at, other.whom):
        return False
    if one.kind in SPOKEN:
        return fuzz.token_set_ratio(one.what.lower(), other.what.lower()) >= ALIKE
    return one.what == other.what
