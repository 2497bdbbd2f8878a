"""What people do with appointments: make one, see them, pause, call off, approve anew.

An appointment is made of a program that somebody has just reviewed; it is reviewed once more here,
and what that finds is kept with the approval.
"""

from __future__ import annotations

import itertools
import threading
from collections.abc import Callable, Sequence
from datetime import date, datetime
from pathlib import Path
from typing import Any, Final, Protocol

import msgspec

from grammar.language import languages
from nl2robot.errors import UserError
from nl2robot.review.review import Review, digest
from nl2robot.schedule.appointments import (
    DAY,
    HOLDS,
    MAKES_UP_AT_MOST,
    NONE,
    ORDINARY,
    PRIORITIES,
    Appointment,
    Notice,
    Occurrence,
)
from nl2robot.schedule.book import Book, BookError
from nl2robot.schedule.findings import encoded, findings_of
from nl2robot.schedule.handing import Company
from nl2robot.schedule.rhythm import (
    Rhythm,
    checked,
    local,
    next_begin,
    next_time,
    shown_at,
    times,
)
from nl2robot.schedule.telling import outcome, told, trouble, when
from nl2robot.schedule.triggers import Trigger
from nl2robot.schedule.triggers import checked as checked_trigger
from robot_api.errors import AccessDenied
from robot_api.local_time import local_zone

FILE: Final = "schedule.sqlite"
"""The book's name, beside the run log."""
SHOWN: Final = 5
"""Times to come that are told of each appointment."""
HOLDS_AT_MOST: Final = 366 * DAY
MOST: Final = 500
"""Appointments of a robot."""
MOST_OF_FLEET: Final = 100
"""Of those, the ones that it keeps for its fleet: all its robots are told of them."""
OF_ANYBODY: Final = ("message", "pressed", "scanned")
"""What may begin something that another robot does."""
_A_DAY_AT_MOST: Final = 300
"""Times of one day; a rhythm has fewer."""


class Checks(Protocol):
    """Reviews a program as `nl2robot.run.runner.Runner.check` does."""

    def __call__(
        self, program: str, language: str = "en", *, at: datetime | None = None
    ) -> Review: ...


class Listed(msgspec.Struct, frozen=True, kw_only=True):
    """An appointment as it is shown."""

    appointment: Appointment
    when: str
    """In words: "every weekday at 08:00"."""
    next: tuple[float, ...]
    """When it is done next, as far as it is approved and not paused; seconds since the epoch."""
    due: float | None
    """When its next time is, whether it is done then or not: a review for an approval anew is made
    as of then (`program.check` with `at`). None if there is none, or an event begins it."""
    off: tuple[float, ...]
    """The times to come that were called off."""
    state: str
    """Of the last time that came, "" if none did; see `nl2robot.schedule.appointments.State`."""
    last: float | None
    """When it came last, None if it never did, or so long ago that the book has forgotten it."""
    came: int
    """How many times it came, as far back as the book goes; without those that were called off."""


class Came(msgspec.Struct, frozen=True, kw_only=True):
    """A time that came, with what became of it in words."""

    occurrence: Occurrence
    sentence: str
    told: str


class Told(msgspec.Struct, frozen=True, kw_only=True):
    """A notice with its sentence."""

    notice: Notice
    told: str


class Schedule:
    """Of one robot. Any thread may use it. The book is made when the first appointment is; until
    then nothing is opened."""

    def __init__(
        self,
        file: Path | None,
        robot: Callable[[], str | None],
        check: Checks,
        clock: Callable[[], float],
        noticed: Callable[[Trigger], Trigger] = checked_trigger,
    ) -> None:
        """`file`: where the book is or will be, None to keep it in memory.
        `robot`: its name; None for those of all robots, to which none can be added.
        `noticed` raises `BadTrigger` for what this robot would never notice."""
        self._file = file
        self._robot = robot
        self._check = check
        self.noticed = noticed
        self.clock = clock
        self.company: Company | None = None
        """The robot's fleet, if it has joined one."""
        self._book: Book | None = None
        self._lock = threading.Lock()

    @property
    def robot(self) -> str | None:
        return self._robot()

    def book(self) -> Book | None:
        """The book, if there ever was an appointment. Raises `BookError`."""
        if self._book is None and self._file is not None and self._file.exists():
            self._open()
        return self._book

    def opened(self) -> Book:
        """The book, made if there is none yet. Raises `BookError`."""
        return self._open()

    def close(self) -> None:
        with self._lock:
            if self._book is not None:
                self._book.close()

    # --- making one

    def add(
        self,
        *,
        program: str,
        sha256: str,
        by: str,
        sentence: str,
        language: str = "en",
        rhythm: Rhythm | None = None,
        trigger: Trigger | None = None,
        plan: str | None = None,
        priority: int = ORDINARY,
        makes_up: int = 0,
        until: float | None = None,
        insists: bool = False,
        fleet: bool = False,
    ) -> Appointment:
        """Approve exactly this program for those times, until then (30 days if nobody says).
        `insists`: though it does not come to its end when it is tried. `fleet`: by any robot of the
        fleet. Raises `AccessDenied` for a
        program that cannot be approved so, `UserError` for times that cannot be."""
        if (rhythm is None) == (trigger is None):
            raise UserError("An appointment has a rhythm or a trigger. Give one of them.")
        now = self.clock()
        if rhythm is not None:
            rhythm = checked(rhythm)
            if next_time(rhythm, now) is None:
                raise UserError("That time is over. Choose one that is still to come.")
        if trigger is not None:
            trigger = self.noticed(trigger)
            if fleet and trigger.what not in OF_ANYBODY:
                raise UserError(
                    "What a robot notices of itself and around it, it sees to itself. Have it done"
                    " by this robot, or choose a message, a code or a button."
                )
        if not PRIORITIES[0] <= priority <= PRIORITIES[1]:
            raise UserError(f"A priority is {PRIORITIES[0]} to {PRIORITIES[1]}. Choose another.")
        if not 0 <= makes_up <= MAKES_UP_AT_MOST:
            raise UserError(
                f"What was missed is made up for within {MAKES_UP_AT_MOST} minutes at most."
                " Choose fewer."
            )
        until, robot = self._until(until, now), self.robot
        assert robot is not None
        company = self._of_fleet() if fleet else None
        review = self._reviewed(program, sha256, language, insists, rhythm, company)
        book = self._open()
        kept = book.appointments(robot)
        if len(kept) >= MOST:
            raise UserError(f"This robot has {MOST} appointments. Remove some first.")
        if fleet and sum(each.fleet is not None for each in kept) >= MOST_OF_FLEET:
            raise UserError(
                f"This robot keeps {MOST_OF_FLEET} appointments of the fleet. Remove some first, or"
                " make it at another robot."
            )
        return book.add(
            program=program,
            sha256=sha256,
            sentence=sentence,
            language=language,
            robot=robot,
            approved_by=by,
            approved_until=until,
            reviewed=encoded(findings_of(review)),
            priority=priority,
            makes_up=makes_up,
            rhythm=rhythm,
            trigger=trigger,
            plan=plan,
            insists=insists,
            fleet=company.id if company is not None else None,
        )

    def approve(
        self,
        number: int,
        sha256: str,
        by: str,
        until: float | None = None,
        insists: bool = False,
    ) -> Appointment:
        """Approve an appointment anew, as it is reviewed now. Raises as `add` does."""
        book, kept = self._kept(number)
        until = self._until(until, self.clock())
        company = self._of_fleet() if kept.fleet is not None else None
        review = self._reviewed(kept.program, sha256, kept.language, insists, kept.rhythm, company)
        keeper = company.id if company is not None else None
        with book.at_once():
            if keeper != kept.fleet:  # what another robot handed out is not followed here
                for occurrence, appointment in book.begun(kept.robot):
                    if appointment.id == number:
                        book.end(occurrence.id, "failed", "broken_off")
            book.approve(number, by, until, encoded(findings_of(review)), insists, keeper)
        return book.appointment(number)

    # --- changing one

    def pause(self, number: int, paused: bool = True) -> Appointment:
        book, _ = self._kept(number)
        book.pause(number, paused)
        return book.appointment(number)

    def remove(self, number: int) -> None:
        book, _ = self._kept(number)
        book.remove(number)

    def skip(self, number: int, day: date | None = None) -> list[float]:
        """Call off what waits or comes next, or all of a day; returns the times. Raises
        `UserError` if there are none."""
        book, kept = self._kept(number)
        dues = self._on_day(kept, day) if day is not None else self._next_due(book, kept)
        off = []
        for due in dues:
            there = book.of_moment(number, due)
            if there is None:
                off += [due] if book.come(number, due, "skipped", "unwanted") else []
            elif there.state == "due":
                off += [due] if book.end(there.id, "skipped", "unwanted") else []
        if not off:
            raise UserError(f"Appointment {number} is not done then. Choose another day.")
        return off

    def call_back(self, number: int, day: date) -> list[float]:
        """Have what was called off on a day done after all; returns the times. Raises `UserError`
        if there are none."""
        book, kept = self._kept(number)
        back = [due for due in self._on_day(kept, day) if book.call_back(number, due)]
        if not back:
            raise UserError(f"Nothing of appointment {number} was called off then.")
        return back

    # --- seeing them

    def is_done_on(self, number: int, day: date) -> bool:
        """Whether it comes on that day, from now on, and was not called off."""
        book, kept = self._kept(number)
        off = {each.due for each in book.skipped_from(number, self.clock())}
        return any(due not in off for due in self._on_day(kept, day))

    def listed(self, language: str = "en") -> list[Listed]:
        book = self.book()
        if book is None:
            return []
        return [self._listed(book, each, language) for each in book.appointments(self.robot)]

    def one(self, number: int, language: str = "en") -> Listed:
        """Raises `NoAppointment`."""
        book, kept = self._kept(number)
        return self._listed(book, kept, language)

    def history(
        self, number: int | None = None, last: int = 100, language: str = "en"
    ) -> list[Came]:
        """The latest times that came, of one appointment or all, the newest first."""
        book = self.book()
        if book is None:
            return []
        known = {each.id: each for each in book.appointments(self.robot, removed=True)}
        return [
            Came(
                occurrence=each,
                sentence=known[each.appointment].sentence,
                told=outcome(each, language),
            )
            for each in book.history(number, last)
            if each.appointment in known
        ]

    def notices(self, after: int = 0, last: int = 100, language: str = "en") -> list[Told]:
        """The newest notices with a higher number than that, the oldest of them first."""
        book = self.book()
        if book is None:
            return []
        zone = local_zone()
        known = {each.id for each in book.appointments(self.robot, removed=True)}
        return [
            Told(notice=each, told=told(each, language, zone))
            for each in book.notices(after, last)
            if each.appointment in known or self._is_mine(each)
        ]

    def trouble(self, sentence: str) -> dict[str, Any]:
        """Keep one of our own sentences, about no appointment, among the notices; returns it as the
        event `notice`. Without a number if the book is not to be written."""
        try:
            parts = {"sentence": sentence, "robot": self.robot}
            notice = self.opened().tell("trouble", NONE, parts=parts)
        except BookError:
            return trouble(sentence)
        said = {code: told(notice, code) for code in languages()}
        return {**msgspec.to_builtins(notice), "told": said}

    # --- inside

    def _is_mine(self, notice: Notice) -> bool:
        """Whether it is about a run of this robot without an appointment, or its trouble."""
        return notice.appointment == NONE and self.robot in (None, notice.parts.get("robot"))

    def _open(self) -> Book:
        with self._lock:
            if self._book is None:
                self._book = Book(self._file or ":memory:", self.clock)
            return self._book

    def _kept(self, number: int) -> tuple[Book, Appointment]:
        """Raises `NoAppointment`, also for another robot's."""
        book = self._open()
        kept = book.appointment(number)
        if self.robot not in (None, kept.robot):
            raise UserError(f"Appointment {number} is one of {kept.robot}. Change it there.")
        return book, kept

    def _of_fleet(self) -> Company:
        if self.company is None:
            raise UserError("This robot has joined no fleet. Serve it with --fleet NAME.")
        return self.company

    def _reviewed(
        self,
        program: str,
        sha256: str,
        language: str,
        insists: bool,
        rhythm: Rhythm | None,
        company: Company | None = None,
    ) -> Review:
        """A review of a program that may be approved, as it would go the next time."""
        if digest(program) != sha256:
            raise AccessDenied(
                "The program was changed after its review. Review it again, then approve it."
            )
        check = company.check if company is not None else self._check
        now = self.clock()
        at = next_begin(rhythm, now) or shown_at(now, rhythm)
        review = check(program, language, at=at)
        errors = [each for each in review.findings if each.severity == "error"]
        if errors:
            raise AccessDenied(
                f"The program cannot be approved: line {errors[0].line}: {errors[0].message}"
            )
        if not review.came_through and not insists:
            dry_run = review.dry_run
            said = dry_run.message if dry_run is not None else None
            ends = (
                f"line {dry_run.line}: {said}" if dry_run is not None and said else "it broke off"
            )
            raise AccessDenied(
                f"The program did not come to its end when it was tried ({ends.rstrip('.')})."
                " Change it, or say that you want it run all the same (`insists`)."
            )
        return review

    @staticmethod
    def _until(until: float | None, now: float) -> float:
        if until is None:
            return now + HOLDS
        if not now < until <= now + HOLDS_AT_MOST:
            raise UserError("An approval holds for a year at most, and ends in the future.")
        return until

    def _listed(self, book: Book, kept: Appointment, language: str) -> Listed:
        now = self.clock()
        off = [each.due for each in book.skipped_from(kept.id, now)]
        coming: Sequence[float] = ()
        if kept.rhythm is not None and not kept.paused and kept.asked is None:
            coming = tuple(
                itertools.islice(
                    (
                        due
                        for due in itertools.islice(times(kept.rhythm, now), SHOWN + len(off))
                        if due not in off and due < kept.approved_until
                    ),
                    SHOWN,
                )
            )
        came, last = book.how_often(kept.id, now)
        latest = [each for each in book.history(kept.id, SHOWN + len(off)) if each.due not in off]
        return Listed(
            appointment=kept,
            when=when(kept, language),
            next=tuple(coming),
            due=next_time(kept.rhythm, now) if kept.rhythm is not None else None,
            off=tuple(off),
            state=latest[0].state if latest else "",
            last=last,
            came=came,
        )

    def _next_due(self, book: Book, kept: Appointment) -> list[float]:
        waiting = [each.due for each, of in book.waiting(kept.robot) if of.id == kept.id]
        if waiting or kept.rhythm is None:
            return waiting
        off = {each.due for each in book.skipped_from(kept.id, self.clock())}
        coming = (due for due in times(kept.rhythm, self.clock()) if due not in off)
        return list(itertools.islice(coming, 1))

    def _on_day(self, kept: Appointment, day: date) -> list[float]:
        """The times of a day that are to come."""
        if kept.rhythm is None:
            return []
        zone = kept.rhythm.zone
        coming = itertools.islice(times(kept.rhythm, self._before(day, zone)), _A_DAY_AT_MOST)
        found = itertools.takewhile(lambda due: local(due, zone).date() <= day, coming)
        return [due for due in found if local(due, zone).date() == day]

    def _before(self, day: date, zone: str) -> float:
        """Now, or the day before that day if that is later."""
        ahead = (day - local(self.clock(), zone).date()).days
        return self.clock() + max(0, ahead - 1) * DAY
