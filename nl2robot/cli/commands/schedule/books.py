"""The book of appointments, of this computer or of a server."""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import date, datetime
from typing import Any, Final, TypeVar

import msgspec

from nl2robot.paths import data_folder
from nl2robot.review.review import Review
from nl2robot.run.runlog import RunLog
from nl2robot.schedule.appointments import Appointment
from nl2robot.schedule.reminders import Reminder, reminders
from nl2robot.schedule.schedule import FILE, Came, Listed, Schedule, Told
from nl2robot.station.clients import client_of
from nl2robot.station.robots import Chosen
from robot_api.client import Robot

RUNS: Final = "runs.sqlite"
"""The run log's name, beside the book."""

T = TypeVar("T")


class Distant:
    """The book of a server, over the wire; see `Schedule`."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot

    def listed(self, language: str) -> list[Listed]:
        return self._ask("list", list[Listed], language=language)

    def history(self, number: int | None, last: int, language: str) -> list[Came]:
        one = {} if number is None else {"id": number}
        return self._ask("history", list[Came], last=last, language=language, **one)

    def notices(self, after: int, last: int, language: str) -> list[Told]:
        return self._ask("notices", list[Told], after=after, last=last, language=language)

    def reminders(self, since: float, last: int, language: str) -> list[Reminder]:
        return self._ask("reminders", list[Reminder], since=since, last=last, language=language)

    def pause(self, number: int, paused: bool = True) -> Appointment:
        return self._ask("pause" if paused else "resume", Appointment, id=number)

    def remove(self, number: int) -> None:
        self._robot.request("schedule.remove", {"id": number})

    def skip(self, number: int, day: date | None = None) -> list[float]:
        on = {} if day is None else {"date": day.isoformat()}
        return self._ask("skip", list[float], id=number, **on)

    def call_back(self, number: int, day: date) -> list[float]:
        return self._ask("skip", list[float], id=number, date=day.isoformat(), back=True)

    def _ask(self, method: str, kind: type[T], **given: Any) -> T:
        return msgspec.convert(self._robot.request(f"schedule.{method}", given), kind)


@contextmanager
def book_of(options: argparse.Namespace, robot: Chosen) -> Iterator[Schedule | Distant]:
    """The book of this computer, with the appointments of all its robots; or a server's."""
    if not robot.is_server:
        here = Schedule(data_folder() / FILE, lambda: None, _no_review, time.time)
        try:
            yield here
        finally:
            here.close()
        return
    with client_of(robot.server, options.token) as client:
        yield Distant(client)


def reminders_in(
    book: Schedule | Distant, since: float, last: int, language: str
) -> list[Reminder]:
    """The record of reminders, of this computer's book and run log or of a server's."""
    if isinstance(book, Distant):
        return book.reminders(since, last, language)
    path = data_folder() / RUNS
    log = RunLog(path) if path.exists() else None
    try:
        return reminders(book, log, since, language, last)
    finally:
        if log is not None:
            log.close()


def _no_review(program: str, language: str = "en", *, at: datetime | None = None) -> Review:
    raise AssertionError("nothing is approved in the book itself")
