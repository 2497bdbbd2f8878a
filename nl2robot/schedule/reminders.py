"""The record of reminders: when each was due and said, to whom, where, and what came of it.

It is put together from the book (what was due, and was missed or called off) and the run log (what
was said and answered), whenever somebody asks for it; so nothing is in it that is in neither, and
nothing stays in it that was deleted there.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Mapping, Sequence
from datetime import datetime
from typing import Any, Final
from zoneinfo import ZoneInfo

import msgspec

from nl2robot.run.runlog import Run, RunLog
from nl2robot.schedule.appointments import OVER, Appointment, Occurrence, State
from nl2robot.schedule.outcomes import ANSWER, Asking, Outcome, Result, asking_of, outcomes
from nl2robot.schedule.schedule import Schedule
from nl2robot.schedule.telling import outcome
from nl2robot.texts import texts_in

COLUMNS: Final = (
    *("due", "said", "person", "what", "place", "result", "told", "question", "answer"),
    *("robot", "approved_by", "sentence", "appointment", "run"),
)
BYTE_ORDER_MARK: Final = "\ufeff"
"""By which spreadsheets know the letters."""
_COMPUTED: Final = ("=", "+", "-", "@", "\t", "\r", "\n")
MOST: Final = 1000
"""Runs, and times of appointments, that are looked through; the newest."""

Became = Result | State
"""What came of it: what they answered, or of what was not said, what became of its time."""


class Reminder(msgspec.Struct, frozen=True, kw_only=True):
    """A person reminded, or not. Times are seconds since the epoch."""

    due: float
    """Of one that somebody had said at once, when its run began."""
    said: float | None
    person: str
    what: str
    place: str | None
    result: Became
    told: str
    """The result in words."""
    question: str
    answer: str | None
    robot: str
    approved_by: str
    sentence: str
    appointment: int | None
    occurrence: int | None
    run: int | None


def reminders(
    schedule: Schedule,
    log: RunLog | None,
    since: float = 0.0,
    language: str = "en",
    last: int = MOST,
) -> list[Reminder]:
    """The newest reminders from a moment on, the newest first: those of appointments, and those
    that were said at once. Raises `BookError` and `nl2robot.run.runlog.LogError`."""
    record = _Record(log, language)
    book, robot = schedule.book(), schedule.robot
    found: list[Reminder] = []
    if book is not None:
        known = {each.id: each for each in book.appointments(robot, removed=True)}
        for occurrence in book.since(since, MOST):
            kept = known.get(occurrence.appointment)
            if kept is not None and occurrence.due <= schedule.clock():
                found += record.of_appointment(occurrence, kept)
    for run in log.runs_with(ANSWER, since, MOST) if log is not None else ():
        if (book is None or not book.has_run(run.id)) and robot in (None, run.robot):
            found += record.of_run(run)
    return sorted(found, key=lambda each: each.due, reverse=True)[:last]


class _Record:
    def __init__(self, log: RunLog | None, language: str) -> None:
        self.log = log
        self.language = language
        texts = texts_in(language, "schedules")
        self.words: Mapping[str, str] = {**texts["states"], **texts["reminders"]["results"]}

    def of_appointment(self, time: Occurrence, kept: Appointment) -> Iterator[Reminder]:
        asking = asking_of(kept.program)
        if asking is None:
            return
        run = self.log.run(time.run) if self.log is not None and time.run is not None else None
        came = list(time.reminded) or (self._came(run) if time.state in OVER else [])
        begun = time.run is not None or time.done_by is not None
        broken_off = time.state == "failed" and begun
        state: Became = "broken_off" if broken_off else time.state
        for each, became, told in [
            *((each, each.result, self.words[each.result]) for each in came),
            *((each, state, outcome(time, self.language)) for each in _meant(asking, came)),
        ]:
            yield Reminder(
                **_about(each, asking),
                due=time.due,
                result=became,
                told=told,
                robot=time.done_by or kept.robot,
                approved_by=_approved_by(run) or kept.approved_by,
                sentence=kept.sentence,
                appointment=kept.id,
                occurrence=time.id,
                run=time.run,
            )

    def of_run(self, run: Run) -> Iterator[Reminder]:
        asking = asking_of(run.program)
        if asking is None:
            return
        came = [] if run.going_on else self._came(run)
        became: Became = "running" if run.going_on else "broken_off"
        for each, result in [
            *((each, each.result) for each in came),
            *((each, became) for each in _meant(asking, came)),
        ]:
            yield Reminder(
                **_about(each, asking),
                due=run.started,
                result=result,
                told=self.words[result],
                robot=run.robot or "",
                approved_by=run.approved_by,
                sentence=run.utterance or "",
                appointment=None,
                occurrence=None,
                run=run.id,
            )

    def _came(self, run: Run | None) -> list[Outcome]:
        if run is None or self.log is None:
            return []
        return outcomes(run.program, self.log.calls(run.id))


def _meant(asking: Asking, came: Sequence[Outcome]) -> list[Outcome]:
    """Whom the program names and nobody came to, if it came to nobody at all."""
    if came:
        return []
    return [Outcome(person=each, result="broken_off") for each in asking.persons or ("",)]


def _about(each: Outcome, asking: Asking) -> dict[str, Any]:
    return {
        "said": each.said,
        "person": each.person,
        "what": each.what or asking.what,
        "place": each.place,
        "question": each.question or asking.question,
        "answer": each.answer,
    }


def _approved_by(run: Run | None) -> str:
    return run.approved_by if run is not None else ""


# --- as a table for a spreadsheet


def as_csv(found: Sequence[Reminder], zone: str) -> str:
    """The record as CSV with a row of names, times by the clocks of the zone. A text that a
    spreadsheet would compute stays a text."""
    written = io.StringIO()
    table = csv.writer(written)
    table.writerow(COLUMNS)
    for each in found:
        row = {**msgspec.to_builtins(each), "due": _iso(each.due, zone)}
        row["said"] = _iso(each.said, zone) if each.said is not None else ""
        table.writerow([_cell(row[name]) for name in COLUMNS])
    return BYTE_ORDER_MARK + written.getvalue()


def _cell(value: Any) -> Any:
    return f"'{value}" if isinstance(value, str) and value.startswith(_COMPUTED) else value


def _iso(moment: float, zone: str) -> str:
    return datetime.fromtimestamp(moment, ZoneInfo(zone)).isoformat(timespec="seconds")
