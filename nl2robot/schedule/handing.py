"""Appointments that any robot of the fleet may do: the robot where one was made keeps it, and has
it handed out at its time. Without threads and without I/O but for the books.

    claimed (in the book here) -> handed out (in the fleet's book, once) -> running -> over

What is handed out goes by an id that is made of its time, so it is the same after a crash: what was
claimed and is not in the fleet's book was given to nobody, and waits again; what is there is
followed until it is over, and never handed out once more. A silent robot that was told to begin
keeps it: nobody knows whether it was done until that robot says so.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from datetime import datetime
from typing import Final, Protocol

import msgspec

from nl2robot.review.review import Review
from nl2robot.schedule.appointments import Appointment, Occurrence
from nl2robot.schedule.book import Book
from nl2robot.schedule.clerk import Begin, Clerk, Waits
from nl2robot.schedule.outcomes import Outcome
from nl2robot.schedule.plans import Plan, plans_in

OPEN: Final = ("looking", "given", "begun")


class Handed(msgspec.Struct, frozen=True, kw_only=True):
    """How it stands with something that was handed out."""

    state: str
    """looking: for a robot; given: one may begin it; begun; called_off; nobody; else as its run
    ended, or "broken_off"."""
    robot: str | None = None
    """The name of the robot that may begin it, does it or did it."""
    known: bool = True
    """Whether it is known how that robot stands."""
    message: str | None = None
    refused: Mapping[str, str] = {}
    """Why a robot did not take it, by name."""
    reminded: tuple[Outcome, ...] = ()


class Company(Protocol):
    """The fleet of one robot, as whoever keeps appointments for it has to do with it."""

    @property
    def id(self) -> str:
        """Of this robot in the fleet."""

    @property
    def doubled(self) -> bool:
        """Whether another robot goes by the same id: then both would hand out the same."""

    def check(self, program: str, language: str = "en", *, at: datetime | None = None) -> Review:
        """Review a program as it would be done by whoever can."""

    def hand_out(self, id: str, appointment: Appointment, until: float) -> None:
        """Have it done once, by the best robot, if one takes it until then (seconds since the
        epoch by the clock here); nothing if that id is in the fleet's book. On disk when this
        returns. Raises `UserError` if too much is to be done already."""

    def handed(self, id: str) -> Handed | None:
        """How it stands with that; None if it is not in the fleet's book."""

    def call_off(self, id: str) -> None:
        """Not to be begun, if no robot was told to begin it."""

    def tell(self, plans: tuple[Plan, ...]) -> None:
        """These are the fleet's appointments that are kept here: have all others know."""


class Handing:
    """Of one robot. One thread at a time may use it."""

    def __init__(self, book: Book, robot: str, clerk: Clerk, company: Company | None) -> None:
        self._book = book
        self._robot = robot
        self._clerk = clerk
        self._company = company

    @property
    def waits(self) -> Waits | None:
        """Why nothing is handed out now."""
        if self._company is None:
            return "fleet"
        return "doubled" if self._company.doubled else None

    def look(self) -> frozenset[int]:
        """Follow all that was handed out; the numbers of the appointments of which one is being
        done, or a robot looked for. Where nobody knows, the next time is not kept waiting."""
        company, going = self._company, set()
        if company is None:
            return frozenset()
        for each in self._book.appointments(self._robot):
            if each.fleet is not None and each.fleet != company.id and each.asked is None:
                self._clerk.moved(each)
        for occurrence, appointment in self._book.begun(self._robot):
            if appointment.fleet is not None and self._follow(company, occurrence, appointment):
                going.add(appointment.id)
        return frozenset(going)

    def hand_out(self, begin: Begin) -> None:
        """Raises `UserError` if it cannot be now."""
        assert self._company is not None
        until = self._clerk.latest(begin.occurrence, begin.appointment)
        id = handed_as(self._company.id, begin.occurrence, begin.appointment)
        self._company.hand_out(id, begin.appointment, until)

    def tell(self, now: float) -> None:
        """Something in the book has changed."""
        if self._company is not None:
            self._company.tell(plans_in(self._book, self._robot, now))

    # --- inside

    def _follow(self, company: Company, occurrence: Occurrence, appointment: Appointment) -> bool:
        """Whether it goes on, as far as that is known."""
        id = handed_as(company.id, occurrence, appointment)
        handed = company.handed(id) if appointment.fleet == company.id else None
        if handed is None:
            if appointment.fleet == company.id and occurrence.state == "claimed":
                self._book.release(occurrence.id)
            else:  # the book that knew of it is gone
                self._clerk.ended(occurrence, appointment, None, None)
            return False
        if handed.robot != occurrence.done_by:
            self._book.done_by(occurrence.id, handed.robot)
        if handed.state == "looking":
            if self._unwanted(company, occurrence, appointment) is not None:
                company.call_off(id)
        elif handed.state == "begun":
            self._book.runs(occurrence.id, None)
        elif handed.state == "called_off":
            why = self._unwanted(company, occurrence, appointment)
            self._clerk.called_off(occurrence, appointment, why)
        elif handed.state == "nobody":
            self._clerk.nobody(occurrence, appointment, handed.refused)
        elif handed.state not in OPEN:
            status = None if handed.state == "broken_off" else handed.state
            if handed.reminded:
                self._book.reminded(occurrence.id, handed.reminded)
            self._clerk.ended(occurrence, appointment, status, handed.message, handed.reminded)
        return handed.state in OPEN and handed.known

    def _unwanted(
        self, company: Company, occurrence: Occurrence, appointment: Appointment
    ) -> str | None:
        """Why no robot is looked for any more: a word of `Clerk.called_off`."""
        if appointment.removed is not None:
            return "removed"
        if appointment.paused:
            return "paused"
        if appointment.asked is not None:
            return appointment.asked
        if company.doubled:
            return "doubled"
        later = (
            each.due > occurrence.due
            for each, of in self._book.waiting(self._robot)
            if of.id == appointment.id
        )
        return "overtaken" if any(later) else None


def handed_as(keeper: str, occurrence: Occurrence, appointment: Appointment) -> str:
    """The id by which that time of an appointment is handed out: ever the same, and no other's."""
    about = (keeper, appointment.id, appointment.added, occurrence.id, occurrence.due)
    return hashlib.sha256(msgspec.json.encode(about)).hexdigest()[:16]
