"""A book, a clock that is set by hand, and a round that somebody has approved."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from datetime import datetime
from pathlib import Path
from typing import Any

import pytest

from nl2robot.review.review import digest
from nl2robot.schedule.appointments import HOLDS, ORDINARY, Appointment
from nl2robot.schedule.book import Book
from nl2robot.schedule.rhythm import Rhythm, checked, moment_of

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
