"""A book, a clock that is set by hand, and a round that somebody has approved."""

from __future__ import annotations

import queue
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path
from typing import Any

import pytest

from nl2robot.review.review import digest
from nl2robot.run.runlog import RunLog
from nl2robot.schedule.appointments import HOLDS, ORDINARY, Appointment
from nl2robot.schedule.book import Book
from nl2robot.schedule.clerk import Settings
from nl2robot.schedule.quiet import quiet_hours
from nl2robot.schedule.rhythm import Rhythm, checked, moment_of
from nl2robot.schedule.service import Timing
from nl2robot.station.station import SimulatedStation, simulated_station
from robot_api.client import Robot
from sim.world.loading import load_world
from sim.world.model import World

ZURICH = "Europe/Zurich"
ROUND = 'robot.goto("ward a")\nrobot.say("Good morning.")\n'
ROBOT = "simulated robot"


class Clock:
    """Seconds since the epoch, as a test sets them."""

    def __init__(self) -> None:
        self.now = at("2026-11-30 06:00")

    def __call__(self) -> float:
        return self.now

    def set(self, local: str) -> float:
        self.now = at(local)
        return self.now


def at(local: str) -> float:
    """When the clocks of Zurich show that."""
    return moment_of(datetime.fromisoformat(local), ZURICH)


def rhythm(rule: str | None = "FREQ=DAILY", begins: str = "2026-11-30 08:00") -> Rhythm:
    return checked(Rhythm(datetime.fromisoformat(begins), ZURICH, rule))


def add(book: Book, clock: Clock, **given: Any) -> Appointment:
    """An approved round, every day at eight if nothing else is said."""
    values: dict[str, Any] = {
        "program": ROUND,
        "sha256": digest(ROUND),
        "sentence": "go to ward a and say good morning",
        "language": "en",
        "robot": ROBOT,
        "approved_by": "Nurse Kim",
        "approved_until": clock.now + HOLDS,
        "reviewed": "{}",
        "priority": ORDINARY,
        "makes_up": 0,
        "rhythm": rhythm(),
        **given,
    }
    return book.add(**values)


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def book(tmp_path: Path, clock: Clock) -> Iterator[Book]:
    book = Book(tmp_path / "schedule.sqlite", clock)
    yield book
    book.close()


Added = Callable[..., Appointment]


@pytest.fixture
def added(book: Book, clock: Clock) -> Added:
    return lambda **given: add(book, clock, **given)


# --- a station that keeps time -------------------------------------------------------------------

DAILY = {"begins": "2026-11-30T08:00", "zone": ZURICH, "rule": "FREQ=DAILY"}
EVERY = 0.02


class Ward:
    """A ward with a robot, somebody who talks to it over the wire, and a clock."""

    def __init__(self, station: SimulatedStation, robot: Robot, log: RunLog, clock: Clock) -> None:
        self.station, self.robot, self.log, self.clock = station, robot, log, clock
        self._events: queue.SimpleQueue[tuple[str, Mapping[str, Any]]] = queue.SimpleQueue()
        told = ("notice", "schedule", "schedule.buttons")
        robot.subscribe(told, lambda kind, data: self._events.put((kind, data)))

    def add(self, program: str = ROUND, **given: Any) -> dict[str, Any]:
        values = {
            "program": program,
            "sha256": digest(program),
            "by": "Nurse Kim",
            "sentence": "go to ward a and say good morning",
            "rhythm": DAILY,
            **given,
        }
        added: dict[str, Any] = self.robot.request("schedule.add", values)
        return added

    def ask(self, method: str, **given: Any) -> Any:
        return self.robot.request(f"schedule.{method}", given)

    def states(self) -> list[str]:
        return [each["occurrence"]["state"] for each in reversed(self.ask("history"))]

    def until(self, states: list[str]) -> None:
        """Wait until that is what became of the times that came."""
        self.until_true(lambda: self.states() == states)

    def until_true(self, holds: Callable[[], bool]) -> None:
        """Look again whenever the station says that something has changed."""
        ends = time.monotonic() + 60.0
        while not holds():
            self._events.get(timeout=max(0.01, ends - time.monotonic()))

    def notice(self, kind: str) -> Mapping[str, Any]:
        """Wait for a notice of that kind."""
        ends = time.monotonic() + 60.0
        while True:
            event, data = self._events.get(timeout=max(0.01, ends - time.monotonic()))
            if event == "notice" and data["kind"] == kind:
                return data


@pytest.fixture
def log(tmp_path: Path) -> Iterator[RunLog]:
    log = RunLog(tmp_path / "log" / "runs.sqlite")
    yield log
    log.close()


@pytest.fixture
def ward(log: RunLog, clock: Clock, request: pytest.FixtureRequest) -> Iterator[Ward]:
    with keeping_time(log, clock, load_world("ward"), getattr(request, "param", None)) as ward:
        yield ward


@contextmanager
def keeping_time(
    log: RunLog, clock: Clock, world: World, speed: float | None = None
) -> Iterator[Ward]:
    settings = Settings(quiet=quiet_hours("22:00-06:00", ZURICH))
    timing = Timing(settings=settings, clock=clock, every=EVERY)
    with (
        simulated_station(world, log, seed=1, speed=speed, timing=timing) as station,
        station.connect() as robot,
    ):
        yield Ward(station, robot, log, clock)


slow = pytest.mark.parametrize("ward", [5], indirect=True)
