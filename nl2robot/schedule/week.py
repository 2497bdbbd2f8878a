"""A week of appointments: what came of the times that are over, and when the next ones are."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from datetime import date, datetime, timedelta
from typing import Final, Literal

import msgspec

from nl2robot.schedule.appointments import Appointment, Occurrence, State
from nl2robot.schedule.rhythm import local, moment_of, times
from nl2robot.schedule.schedule import Schedule
from nl2robot.schedule.telling import outcome, when
from nl2robot.texts import texts_in
from robot_api.local_time import local_zone

DAYS: Final = 7
MOST_TIMES: Final = 3000
"""Of a week; so many are told, the earliest of them."""

Standing = State | Literal["coming", "off", "paused", "unapproved"]
"""Of a time of a week: what came of it, or of one that is to come, whether it will be done: it was
called off, its appointment is paused, or not approved for it."""


class Moment(msgspec.Struct, frozen=True, kw_only=True):
    """A time at which an appointment is due."""

    appointment: int
    sentence: str
    when: str
    """The rhythm of its appointment, in words."""
    due: float
    day: str
    """ "2026-11-30", by the clocks of the house."""
    at: str
    """ "08:00", by the same."""
    state: Standing
    told: str
    """Its state in words, with why."""
    run: int | None


class Week(msgspec.Struct, frozen=True, kw_only=True):
    """From a Monday to a Sunday."""

    zone: str
    """Whose clocks tell days and times."""
    now: float
    today: str
    at: str
    """What time it is there."""
    days: tuple[str, ...]
    times: tuple[Moment, ...]
    more: bool
    """Whether there are more times than are told."""


def week_of(schedule: Schedule, day: date | None = None, language: str = "en") -> Week:
    """The week with that day in it, or this one. Raises `BookError`."""
    zone, now = local_zone(), schedule.clock()
    here = local(now, zone)
    day = day or here.date()
    monday = day - timedelta(days=day.weekday())
    begins, ends = (
        moment_of(datetime.combine(monday + timedelta(days=ahead), datetime.min.time()), zone)
        for ahead in (0, DAYS)
    )
    book = schedule.book()
    found: list[Moment] = []
    if book is not None:
        tellers = {
            each.id: _Told(each, zone, language)
            for each in book.appointments(schedule.robot, removed=True)
        }
        in_book = [each for each in book.between(begins, ends) if each.appointment in tellers]
        found = [tellers[each.appointment].came(each, now) for each in in_book]
        there = {(each.appointment, each.due) for each in in_book}
        for number, teller in tellers.items():
            coming = teller.coming(max(now, begins - 1), ends)
            found += (each for each in coming if (number, each.due) not in there)
    found.sort(key=lambda each: (each.due, each.appointment))
    return Week(
        zone=zone,
        now=now,
        today=here.date().isoformat(),
        at=f"{here:%H:%M}",
        days=tuple((monday + timedelta(days=ahead)).isoformat() for ahead in range(DAYS)),
        times=tuple(found[:MOST_TIMES]),
        more=len(found) > MOST_TIMES,
    )


class _Told:
    """Tells the times of one appointment, so that its rhythm is put into words once."""

    def __init__(self, kept: Appointment, zone: str, language: str) -> None:
        self._kept, self._zone, self._language = kept, zone, language
        self._when = when(kept, language)
        self._standings = texts_in(language, "schedules")["standings"]

    def came(self, occurrence: Occurrence, now: float) -> Moment:
        """One that stands in the book."""
        if occurrence.state == "skipped" and occurrence.due > now:
            return self._moment(occurrence.due, "off", str(self._standings["off"]))
        told = outcome(occurrence, self._language)
        return self._moment(occurrence.due, occurrence.state, told, occurrence.run)

    def coming(self, after: float, until: float) -> Iterator[Moment]:
        """Those to come."""
        kept = self._kept
        if kept.rhythm is None or kept.removed is not None:
            return
        due_then = itertools.takewhile(lambda due: due < until, times(kept.rhythm, after))
        for due in itertools.islice(due_then, MOST_TIMES + 1):
            state: Standing = "coming"
            if kept.asked is not None or due >= kept.approved_until:
                state = "unapproved"
            elif kept.paused:
                state = "paused"
            yield self._moment(due, state, str(self._standings[state]))

    def _moment(self, due: float, state: Standing, told: str, run: int | None = None) -> Moment:
        there = local(due, self._zone)
        return Moment(
            appointment=self._kept.id,
            sentence=self._kept.sentence,
            when=self._when,
            due=due,
            day=there.date().isoformat(),
            at=f"{there:%H:%M}",
            state=state,
            told=told,
            run=run,
        )
