"""A robot of the fleet that keeps appointments, with a clock that a story sets."""

from __future__ import annotations

import threading
from datetime import timedelta
from pathlib import Path
from typing import Any

from msgspec.structs import replace

from nl2robot.fleet.keeping import Keeping
from nl2robot.review.review import Review, digest
from nl2robot.schedule.appointments import HOLDS, ORDINARY, Appointment, Occurrence
from nl2robot.schedule.book import Book
from nl2robot.schedule.clerk import Clerk, Settings
from nl2robot.schedule.handing import Handing
from nl2robot.schedule.plans import Planned, planned
from nl2robot.schedule.rhythm import Rhythm, local
from tests.fleet.conftest import NOTHING_FOUND, FakeNetwork, FakeRobot, Killed

ZURICH = "Europe/Zurich"
WAITS = 120.0
"""Seconds after its time in which an appointment may still be begun."""


def no_review(*_: object, **__: object) -> Review:
    raise AssertionError("nobody approves anything in this story")


class Keeper(FakeRobot):
    """Its books outlive its process, as a data folder does."""

    def __init__(self, net: FakeNetwork, name: str, x: float = 0.0, **about: Any) -> None:
        self.schedule = Book(about.pop("schedule", ":memory:"), lambda: self.wall)
        super().__init__(net, name, x, **about)
        net.robots.append(self)

    def starts(self) -> None:
        super().starts()
        clerk = Clerk(self.schedule, "robot", Settings(waits=WAITS))
        self.company = Keeping(
            self.hub,
            threading.RLock(),
            no_review,
            self.name,
            lambda errand: self.hub.dispatcher.add(errand, self.net.now),
            lambda: self.net.now,
        )
        self.clerk = clerk
        self.handing = Handing(self.schedule, "robot", clerk, self.company)

    def looks(self) -> None:
        """As `nl2robot.schedule.service.Timekeeper` does every second."""
        try:
            going = self.handing.look()
            begin = self.clerk.look(self.wall, None, self.handing.waits, going)
            if begin is not None:
                if self.dies_at == "claim":
                    raise Killed
                self.handing.hand_out(begin)
                if self.dies_at == "hand":
                    raise Killed
            self.handing.tell(self.wall)
        except Killed:
            self.alive = False

    def plans(
        self, program: str, after: float, rule: str | None = None, **more: Any
    ) -> Appointment:
        """Somebody approves this for any robot of the fleet, so many seconds from now."""
        begins = local(self.wall, ZURICH).replace(tzinfo=None) + timedelta(seconds=after)
        given: dict[str, Any] = {
            "program": program,
            "sha256": digest(program),
            "sentence": "go to ward a and say good morning",
            "language": "en",
            "robot": "robot",
            "approved_by": "Nurse Kim",
            "approved_until": self.wall + HOLDS,
            "reviewed": NOTHING_FOUND,
            "priority": ORDINARY,
            "makes_up": 0,
            "rhythm": Rhythm(begins, ZURICH, rule),
            "fleet": self.id,
            **more,
        }
        return self.schedule.add(**given)

    def came(self, run: int) -> tuple[str | None, str | None]:
        return self.over.get(run), None

    @property
    def times(self) -> list[Occurrence]:
        """All that came of its appointments, the oldest first."""
        return self.schedule.history()[::-1]

    def told(self) -> list[str]:
        """The kinds of the notices at its console."""
        return [each.kind for each in self.schedule.notices()]

    def knows_of(self, other: FakeRobot, language: str = "en") -> list[Planned]:
        """What its console shows of the appointments that another robot keeps."""
        [known] = [
            each.known(self.net.now)
            for each in self.hub.roll.members.values()
            if each.id == other.id
        ] or [False]
        plans = self.hub.plans.known.get(other.id)
        return [planned(each, known, self.wall, language) for each in plans.plans] if plans else []


def goes_on(net: FakeNetwork, seconds: float, step: float = 0.5) -> None:
    """Time passes in which all that is said comes at once, and each keeper looks at its clock."""
    ends = net.now + seconds
    while net.now < ends:
        net.goes_on(step, step)
        for each in net.robots:
            if each.alive and isinstance(each, Keeper):
                each.looks()


def copied(net: FakeNetwork, keeper: Keeper, folder: Path, name: str) -> Keeper:
    """Another robot with a copy of its data folder."""
    files = {}
    for kind, book in (("book", keeper.book._db), ("schedule", keeper.schedule._db)):
        files[kind] = folder / f"{kind}.sqlite"
        book.execute("VACUUM INTO ?", (str(files[kind]),))
    return Keeper(net, name, x=9.0, **files)


def is_busy(robot: FakeRobot, busy: bool = True) -> None:
    robot.standing = replace(robot.standing, waits="busy" if busy else None)
