"""The week of a ward, as pages show it."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import date
from pathlib import Path

import pytest

from nl2robot.schedule import week as weeks
from nl2robot.schedule.book import Book
from nl2robot.schedule.schedule import Schedule
from nl2robot.schedule.week import Week, week_of
from tests.schedule.conftest import ROBOT, ZURICH, Added, Clock, at, rhythm


@pytest.fixture
def schedule(tmp_path: Path, book: Book, clock: Clock) -> Iterator[Schedule]:
    def no_review(*_: object, **__: object) -> None:
        raise AssertionError("nothing is approved here")

    schedule = Schedule(tmp_path / "schedule.sqlite", lambda: ROBOT, no_review, clock)  # type: ignore[arg-type]
    yield schedule
    schedule.close()


@pytest.fixture(autouse=True)
def _in_zurich(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(weeks, "local_zone", lambda: ZURICH)


def told(week: Week) -> list[tuple[str, str, str]]:
    return [(each.day, each.at, each.state) for each in week.times]


def test_of_what_is_over_it_tells_what_came_of_it_and_of_the_rest_whether_it_will_be_done(
    schedule: Schedule, book: Book, clock: Clock, added: Added
) -> None:
    kept = added(approved_until=at("2026-12-05 00:00"))
    for day, state, note in (("11-30", "done", None), ("12-01", "missed", "nobody_looked")):
        book.come(kept.id, at(f"2026-{day} 08:00"), state, note)
    clock.set("2026-12-02 09:00")
    schedule.skip(kept.id, date(2026, 12, 3))
    week = week_of(schedule, language="de")
    assert told(week) == [
        ("2026-11-30", "08:00", "done"),
        ("2026-12-01", "08:00", "missed"),
        ("2026-12-03", "08:00", "off"),
        ("2026-12-04", "08:00", "coming"),
        ("2026-12-05", "08:00", "unapproved"),
        ("2026-12-06", "08:00", "unapproved"),
    ]
    assert [each.told for each in week.times[:4]] == [
        "erledigt",
        "verpasst: nl2robot lief nicht",
        "abgesagt",
        "vorgesehen",
    ]
    assert week.times[0].when == "jeden Tag um 08:00"
    assert (week.days[0], week.days[-1]) == ("2026-11-30", "2026-12-06")
    assert (week.today, week.at, week.zone) == ("2026-12-02", "09:00", ZURICH)


def test_what_is_paused_or_waits_for_an_approval_is_there_all_the_same(
    schedule: Schedule, book: Book, clock: Clock, added: Added
) -> None:
    clock.set("2026-12-05 12:00")
    paused, asked = added().id, added().id
    book.pause(paused)
    book.ask(asked, "changed")
    assert {(each.appointment, each.state) for each in week_of(schedule).times} == {
        (paused, "paused"),
        (asked, "unapproved"),
    }


def test_what_was_removed_keeps_what_was_done_and_does_not_come_again(
    schedule: Schedule, book: Book, clock: Clock, added: Added
) -> None:
    kept = added()
    book.come(kept.id, at("2026-11-30 08:00"), "done")
    clock.set("2026-11-30 12:00")
    book.remove(kept.id)
    assert told(week_of(schedule)) == [("2026-11-30", "08:00", "done")]
    assert told(week_of(schedule, date(2026, 12, 9))) == []


def test_a_week_has_seven_days_also_when_the_clocks_are_set(
    schedule: Schedule, clock: Clock, added: Added
) -> None:
    clock.set("2027-03-20 06:00")
    added(rhythm=rhythm("FREQ=DAILY", "2027-03-20 02:30"))
    week = week_of(schedule, date(2027, 3, 28))
    assert week.days == tuple(f"2027-03-{day}" for day in range(22, 29))
    assert [each.at for each in week.times] == ["02:30"] * 6 + ["03:00"]


def test_of_very_many_times_the_earliest_are_told(
    schedule: Schedule, monkeypatch: pytest.MonkeyPatch, added: Added
) -> None:
    monkeypatch.setattr(weeks, "MOST_TIMES", 10)
    added(rhythm=rhythm("FREQ=MINUTELY;INTERVAL=5"))
    week = week_of(schedule)
    assert week.more and len(week.times) == 10
    assert week.times[-1].at == "08:45"
