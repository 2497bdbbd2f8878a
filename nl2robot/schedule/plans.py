"""The fleet's appointments as the other robots know them: what their keeper told of them last, and
what nobody knows while it is silent."""

from __future__ import annotations

import itertools
from typing import Final

import msgspec

from nl2robot.schedule.appointments import Appointment, Occurrence, Why
from nl2robot.schedule.book import Book
from nl2robot.schedule.rhythm import Rhythm, times
from nl2robot.schedule.telling import outcome, when_of
from nl2robot.schedule.triggers import Trigger

LONGEST: Final = 200
"""Letters of a sentence that the others are told."""
MOST_OFF: Final = 50
"""Times called off that they are told of."""
SHOWN: Final = 3
"""Times to come that are shown of each."""
_LOOKS_BACK: Final = 1000
"""Times that may have come while nothing was heard of the keeper."""


class Plan(msgspec.Struct, frozen=True, kw_only=True):
    """An appointment of the fleet. Times are seconds since the epoch, by its keeper's clock."""

    number: int
    """At its keeper."""
    sentence: str
    language: str
    rhythm: Rhythm | None
    trigger: Trigger | None
    approved_by: str
    approved_until: float
    paused: bool
    asked: Why | None
    off: tuple[float, ...]
    """Times to come that were called off."""
    looked: float
    """Its keeper told what came of all times until then."""
    latest: Occurrence | None
    """The last time that came."""


class Planned(msgspec.Struct, frozen=True, kw_only=True):
    """A plan as it is shown."""

    plan: Plan
    when: str
    """In words: "every weekday at 08:00"."""
    next: tuple[float, ...]
    """When it is to be done next, as far as its keeper is there then."""
    unknown: float | None
    """A time that came of which nobody knows whether it was done: its keeper is silent. The last
    of them."""
    told: str
    """What came of the last time that its keeper told of, in words; empty if none came."""


def plans_in(book: Book, robot: str, now: float) -> tuple[Plan, ...]:
    """Those that a robot keeps for its fleet."""
    return tuple(
        _plan(book, each, now) for each in book.appointments(robot) if each.fleet is not None
    )


def planned(plan: Plan, known: bool, now: float, language: str) -> Planned:
    """`known`: whether its keeper is heard of."""
    ends = min(now, plan.approved_until)
    stands = plan.asked is None and not plan.paused
    latest = plan.latest
    unknown = latest.due if latest is not None and not known and _open(latest) else None
    coming: tuple[float, ...] = ()
    if plan.rhythm is not None and stands:
        if not known:
            came = itertools.takewhile(lambda due: due <= ends, times(plan.rhythm, plan.looked))
            for due in itertools.islice(came, _LOOKS_BACK):
                unknown = due if due not in plan.off else unknown
        ahead = itertools.takewhile(lambda due: due < plan.approved_until, times(plan.rhythm, now))
        coming = tuple(itertools.islice((due for due in ahead if due not in plan.off), SHOWN))
    return Planned(
        plan=plan,
        when=when_of(plan.rhythm, plan.trigger, language),
        next=coming,
        unknown=unknown,
        told=outcome(latest, language) if latest is not None else "",
    )


def _plan(book: Book, kept: Appointment, now: float) -> Plan:
    off = tuple(each.due for each in book.skipped_from(kept.id, now))
    came = (each for each in book.history(kept.id, SHOWN + len(off)) if each.due not in off)
    # What somebody said and answered is the keeper's record, not the fleet's.
    latest = next((_shortened(each) for each in came), None)
    return Plan(
        number=kept.id,
        sentence=kept.sentence[:LONGEST],
        language=kept.language,
        rhythm=kept.rhythm,
        trigger=kept.trigger,
        approved_by=kept.approved_by,
        approved_until=kept.approved_until,
        paused=kept.paused,
        asked=kept.asked,
        off=off[:MOST_OFF],
        looked=kept.looked,
        latest=latest,
    )


def _shortened(each: Occurrence) -> Occurrence:
    note = each.note[:LONGEST] if each.note is not None else None
    return msgspec.structs.replace(each, reminded=(), note=note)


def _open(occurrence: Occurrence) -> bool:
    return occurrence.state in ("due", "claimed", "running")
