"""The days of a ward, by a clock that is set by hand: what begins, what waits, what was missed."""

from __future__ import annotations

from pathlib import Path

import pytest

from nl2robot.errors import UserError
from nl2robot.schedule.appointments import DAY, HOLDS
from nl2robot.schedule.book import Book
from nl2robot.schedule.clerk import MISSED_AT_ONCE, Begin, Clerk, Settings
from nl2robot.schedule.findings import News
from nl2robot.schedule.quiet import quiet_hours
from nl2robot.schedule.telling import outcome, told
from nl2robot.schedule.triggers import Trigger
from tests.schedule.conftest import ROBOT, ZURICH, Added, Clock, at, rhythm


@pytest.fixture
def clerk(book: Book) -> Clerk:
    return Clerk(book, ROBOT)


def begun(begin: Begin | None) -> int:
    """The number of the appointment that is to begin."""
    assert begin is not None
    return begin.appointment.id


def finish(clerk: Clerk, begin: Begin | None, run: int = 1) -> None:
    assert begin is not None
    clerk.runs(begin.occurrence, run)
    clerk.ended(begin.occurrence, begin.appointment, "done", None)


def states(book: Book) -> list[str]:
    return [each.state for each in reversed(book.history())]


def sentences(clerk: Clerk, language: str = "en") -> list[str]:
    return [told(each, language) for each in clerk.notices()]


def test_the_round_begins_at_eight_and_once(
    clerk: Clerk, book: Book, added: Added, clock: Clock
) -> None:
    kept = added()
    assert clerk.look(clock.set("2026-11-30 07:59")) is None
    assert clerk.next_look(clock.now) == at("2026-11-30 08:00")
    begin = clerk.look(clock.set("2026-11-30 08:00"))
    assert begun(begin) == kept.id
    assert clerk.look(clock.set("2026-11-30 08:01"), "busy") is None
    finish(clerk, begin)
    assert clerk.look(clock.set("2026-11-30 08:10")) is None
    assert states(book) == ["done"] and sentences(clerk) == []
    assert clerk.look(clock.set("2026-12-01 08:00")) is not None


def test_a_week_goes_by(clerk: Clerk, book: Book, added: Added, clock: Clock) -> None:
    """Each minute of it."""
    added(rhythm=rhythm("FREQ=WEEKLY;BYDAY=MO,TU,WE,TH,FR"))
    added(rhythm=rhythm("FREQ=DAILY;BYHOUR=10,16;BYMINUTE=0"), priority=9)
    runs = 0
    for _ in range(7 * 24 * 60):
        clock.now += 60
        begin = clerk.look(clock.now)
        if begin is not None:
            finish(clerk, begin, runs := runs + 1)
    assert runs == 5 + 14
    assert states(book) == ["done"] * 19 and sentences(clerk) == []


def test_a_robot_that_is_not_free_makes_it_wait_and_that_is_told_once(
    clerk: Clerk, book: Book, added: Added, clock: Clock
) -> None:
    added()
    assert clerk.look(clock.set("2026-11-30 08:00"), "busy") is None
    assert clerk.look(clock.set("2026-11-30 08:05"), "driven") is None
    assert sentences(clerk) == [
        "“go to ward a and say good morning”, due on Monday, 30 November 2026 at 08:00, waits:"
        " another program is running."
    ]
    assert outcome(book.history()[0]) == "waits: somebody is driving the robot"
    assert clerk.look(clock.set("2026-11-30 08:06")) is not None


def test_after_half_an_hour_of_waiting_it_is_missed(
    clerk: Clerk, book: Book, added: Added, clock: Clock
) -> None:
    added()
    for minute in range(31):
        assert clerk.look(clock.set(f"2026-11-30 08:{minute:02}"), "charging") is None
    assert states(book) == ["due"]
    assert clerk.look(clock.set("2026-11-30 08:31")) is None, "too late, though it is free now"
    assert states(book) == ["missed"]
    assert sentences(clerk, "de")[-1] == (
        "«go to ward a and say good morning» war am Montag, 30. November 2026, um 08:00 fällig und"
        " wurde nicht getan: der Roboter musste laden."
    )
    assert outcome(book.history()[0], "fr") == "manqué: le robot devait se recharger"


def test_who_waits_goes_by_priority_then_by_time(
    clerk: Clerk, book: Book, added: Added, clock: Clock
) -> None:
    round_ = added()
    late = added(rhythm=rhythm(begins="2026-11-30 08:02"))
    medicine = added(rhythm=rhythm(begins="2026-11-30 08:05"), priority=9)
    for minute in range(7):
        clerk.look(clock.set(f"2026-11-30 08:{minute:02}"), "busy")
    order = []
    while begin := clerk.look(clock.now):
        order.append(begin.appointment.id)
        finish(clerk, begin)
        clock.now += 60
    assert order == [medicine.id, round_.id, late.id]


def test_nobody_is_driven_into_at_night(book: Book, added: Added, clock: Clock) -> None:
    clerk = Clerk(book, ROBOT, Settings(quiet=quiet_hours("22:00-06:00", ZURICH)))
    added(rhythm=rhythm(begins="2026-11-30 23:00"))
    added(rhythm=rhythm(begins="2026-12-01 05:45"), sentence="bring the breakfast")
    for _ in range(24 * 60):
        clock.now += 60
        begin = clerk.look(clock.now)
        if begin is not None:
            assert begin.appointment.sentence == "bring the breakfast"
            assert clock.now == at("2026-12-01 06:00")
            finish(clerk, begin)
    assert states(book) == ["missed", "done"]
    assert "in the quiet hours" in sentences(clerk)[1]


def test_what_was_due_while_nobody_looked_is_told(
    clerk: Clerk, book: Book, added: Added, clock: Clock
) -> None:
    added()
    assert clerk.look(clock.set("2026-11-30 08:20")) is None
    assert states(book) == ["missed"]
    assert sentences(clerk) == [
        "“go to ward a and say good morning” was due on Monday, 30 November 2026 at 08:00 and was"
        " not done: nl2robot was not running."
    ]


def test_it_is_made_up_for_within_the_minutes_that_were_set(
    clerk: Clerk, book: Book, added: Added, clock: Clock
) -> None:
    added(makes_up=60)
    begin = clerk.look(clock.set("2026-11-30 08:50"))
    assert begin is not None and begin.occurrence.due == at("2026-11-30 08:00")
    finish(clerk, begin)
    assert clerk.look(clock.set("2026-12-01 09:01")) is None
    assert states(book) == ["done", "missed"]


def test_weeks_without_the_server_are_told_in_one_sentence(
    clerk: Clerk, book: Book, added: Added, clock: Clock
) -> None:
    added(rhythm=rhythm("FREQ=MINUTELY;INTERVAL=10"), approved_until=clock.now + 365 * DAY)
    assert clerk.look(clock.set("2026-12-10 07:59")) is None
    assert sentences(clerk) == [
        "“go to ward a and say good morning” was due 1440 times since 30 November 2026 at 08:00"
        " and was not done: nl2robot was not running."
    ]
    assert states(book) == ["missed"] * MISSED_AT_ONCE
    assert clerk.look(clock.set("2026-12-10 08:00")) is not None


def test_one_that_comes_again_while_it_waits_is_done_once(
    clerk: Clerk, book: Book, added: Added, clock: Clock
) -> None:
    added(rhythm=rhythm("FREQ=MINUTELY;INTERVAL=10"))
    for minute in range(26):
        assert clerk.look(clock.set(f"2026-11-30 08:{minute:02}"), "busy") is None
    begin = clerk.look(clock.set("2026-11-30 08:26"))
    assert begin is not None and begin.occurrence.due == at("2026-11-30 08:20")
    assert states(book) == ["missed", "missed", "claimed"]
    assert sum("when it was due again" in each for each in sentences(clerk)) == 2


def test_an_approval_ends_and_that_is_told(
    clerk: Clerk, book: Book, added: Added, clock: Clock
) -> None:
    kept = added(approved_until=at("2026-12-01 12:00"))
    finish(clerk, clerk.look(clock.set("2026-11-30 08:00")))
    finish(clerk, clerk.look(clock.set("2026-12-01 08:00")))
    assert clerk.look(clock.set("2026-12-02 08:00")) is None
    assert clerk.look(clock.set("2026-12-03 08:00")) is None
    assert states(book) == ["done", "done", "asked", "asked"]
    assert sentences(clerk, "fr") == [
        "L'approbation de « go to ward a and say good morning » par Nurse Kim a expiré. Ce ne sera"
        " plus fait tant que personne ne l'approuve à nouveau."
    ]
    book.approve(kept.id, "Dr Weber", clock.now + HOLDS, "{}", False)
    begin = clerk.look(clock.set("2026-12-04 08:00"))
    assert begin is not None and begin.appointment.approved_by == "Dr Weber"


def test_a_review_that_comes_out_another_way_waits_for_somebody(
    clerk: Clerk, book: Book, added: Added, clock: Clock
) -> None:
    kept = added()
    begin = clerk.look(clock.set("2026-11-30 08:00"))
    assert begin is not None
    clerk.changed(begin, (News("place", "ward c"), News("risk", "It drives through “wet floor”.")))
    assert book.appointment(kept.id).asked == "changed"
    assert sentences(clerk) == [
        "“go to ward a and say good morning” was not done on Monday, 30 November 2026 at 08:00,"
        " because its review came out another way: it now goes to ward c as well. It drives through"
        " “wet floor”. Review it and approve it anew."
    ]
    assert clerk.look(clock.set("2026-12-01 08:00")) is None
    assert states(book) == ["asked", "asked"]


def test_what_is_paused_is_skipped(clerk: Clerk, book: Book, added: Added, clock: Clock) -> None:
    kept = added()
    clerk.look(clock.set("2026-11-30 08:00"), "busy")
    book.pause(kept.id)
    assert clerk.look(clock.set("2026-11-30 08:01")) is None
    assert clerk.look(clock.set("2026-12-01 08:00")) is None
    book.pause(kept.id, False)
    assert clerk.look(clock.set("2026-12-01 08:05")) is None, "eight o'clock was skipped"
    assert clerk.look(clock.set("2026-12-02 08:00")) is not None
    assert states(book) == ["skipped", "skipped", "claimed"]


def test_not_tomorrow(clerk: Clerk, book: Book, added: Added, clock: Clock) -> None:
    kept = added()
    book.come(kept.id, at("2026-12-01 08:00"), "skipped", "unwanted")
    finish(clerk, clerk.look(clock.set("2026-11-30 08:00")))
    assert clerk.look(clock.set("2026-12-01 08:00")) is None
    assert clerk.look(clock.set("2026-12-02 08:00")) is not None
    assert outcome(book.of_moment(kept.id, at("2026-12-01 08:00"))) == (  # type: ignore[arg-type]
        "skipped: somebody called it off"
    )


def test_something_else_than_the_clock_begins_one(
    clerk: Clerk, book: Book, added: Added, clock: Clock
) -> None:
    """What notices that the battery is low says that it is due; the rest is the same."""
    kept = added(rhythm=None, trigger=Trigger(what="battery", below=20))
    assert clerk.look(clock.set("2026-11-30 08:00")) is None
    book.come(kept.id, clock.now)
    assert begun(clerk.look(clock.now)) == kept.id


def test_a_robot_that_is_not_free_after_all_makes_it_wait_again(
    clerk: Clerk, book: Book, added: Added, clock: Clock
) -> None:
    added()
    begin = clerk.look(clock.set("2026-11-30 08:00"))
    assert begin is not None
    clerk.not_begun(begin)
    assert clerk.look(clock.set("2026-11-30 08:01"), "busy") is None
    assert clerk.look(clock.set("2026-11-30 08:02")) is not None


def test_what_failed_and_what_could_not_begin_is_told(
    clerk: Clerk, book: Book, added: Added, clock: Clock
) -> None:
    added()
    begin = clerk.look(clock.set("2026-11-30 08:00"))
    assert begin is not None
    clerk.runs(begin.occurrence, 12)
    clerk.ended(begin.occurrence, begin.appointment, "stopped", None)
    begin = clerk.look(clock.set("2026-12-01 08:00"))
    assert begin is not None
    clerk.refused(begin, "This robot has no arm.")
    first, second = sentences(clerk)
    assert first.endswith("and did not come to its end: it was stopped.")
    assert second.endswith(
        "could not be begun on Tuesday, 1 December 2026 at 08:00: This robot has no arm."
    )
    assert states(book) == ["failed", "failed"]


def test_a_clock_that_is_set_back_does_nothing_twice(
    clerk: Clerk, book: Book, added: Added, clock: Clock
) -> None:
    added()
    finish(clerk, clerk.look(clock.set("2026-11-30 08:00")))
    clock.set("2026-11-30 07:30")
    for _ in range(60):
        clock.now += 60
        assert clerk.look(clock.now) is None
    assert clerk.look(clock.set("2026-12-01 08:00")) is not None


def test_another_robot_has_its_own_appointments(
    clerk: Clerk, book: Book, added: Added, clock: Clock
) -> None:
    added(robot="Pepper")
    assert clerk.look(clock.set("2026-11-30 08:00")) is None
    assert Clerk(book, "Pepper").look(clock.now) is not None


def test_two_servers_of_one_robot_begin_it_once(
    book: Book, added: Added, clock: Clock, tmp_path: Path
) -> None:
    added()
    other = Book(tmp_path / "schedule.sqlite", clock)
    both = Clerk(book, ROBOT), Clerk(other, ROBOT)
    clock.set("2026-11-30 08:00")
    assert [each.look(clock.now) is not None for each in both] == [True, False]
    other.close()


@pytest.mark.parametrize("written", ["at night", "22-6", "25:00-06:00", "22:00", "06:00-06:00"])
def test_hours_that_are_none_are_refused(written: str) -> None:
    with pytest.raises(UserError, match="uiet hours"):
        quiet_hours(written, ZURICH)


def test_quiet_hours_end_by_the_clock_of_the_ward() -> None:
    night = quiet_hours("22:00-6:00", ZURICH)
    assert str(night) == "22:00-06:00"
    assert night.cover(at("2026-03-29 03:30")) and not night.cover(at("2026-03-29 06:00"))
    assert night.over(at("2026-03-28 23:00")) == at("2026-03-29 06:00")
    assert night.over(at("2026-03-29 03:30")) == at("2026-03-29 06:00")
    noon = quiet_hours("12:00-14:00", ZURICH)
    assert noon.cover(at("2026-11-30 12:00")) and not noon.cover(at("2026-11-30 14:00"))
    assert noon.over(at("2026-11-30 13:00")) == at("2026-11-30 14:00")


def test_what_was_for_once_is_over_when_it_was_done(
    clerk: Clerk, book: Book, added: Added, clock: Clock
) -> None:
    added(rhythm=rhythm(None))
    begin = clerk.look(clock.set("2026-11-30 08:00"))
    assert clerk.look(clock.set("2026-11-30 08:01"), "busy") is None
    assert len(book.appointments()) == 1, "it is not over yet"
    finish(clerk, begin)
    assert clerk.look(clock.set("2026-11-30 08:05")) is None
    assert book.appointments() == [] and states(book) == ["done"]
    assert clerk.look(clock.set("2027-11-30 08:05")) is None
    assert sentences(clerk) == [], "and no approval of it has ended"
