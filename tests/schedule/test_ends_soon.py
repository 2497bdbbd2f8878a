"""That an approval ends is told three days before, once, and when it ends."""

from __future__ import annotations

import pytest

from nl2robot.schedule.appointments import DAY
from nl2robot.schedule.book import Book
from nl2robot.schedule.clerk import Clerk
from nl2robot.schedule.telling import told
from nl2robot.schedule.triggers import Trigger
from tests.schedule.conftest import ROBOT, ZURICH, Added, Clock, at, rhythm


@pytest.fixture
def clerk(book: Book) -> Clerk:
    return Clerk(book, ROBOT)


def kinds(clerk: Clerk) -> list[str]:
    return [each.kind for each in clerk.notices()]


BUTTON = Trigger(what="pressed", text="Call a nurse")


def test_three_days_before_and_when_it_ends(
    clerk: Clerk, book: Book, added: Added, clock: Clock
) -> None:
    until = at("2026-12-20 12:00")
    added(rhythm=None, trigger=BUTTON, approved_until=until)
    clerk.look(clock.set("2026-12-17 11:59"))
    assert kinds(clerk) == []
    clerk.look(clock.set("2026-12-17 12:00"))
    [notice] = clerk.notices()
    assert "by Nurse Kim ends on Sunday, 20 December 2026 at 12:00" in told(notice, "en", ZURICH)
    assert "läuft am Sonntag, 20. Dezember 2026, um 12:00 ab" in told(notice, "de", ZURICH)
    assert "expire le dimanche 20 décembre 2026 à 12:00" in told(notice, "fr", ZURICH)
    clerk.look(clock.set("2026-12-18 12:00"))
    again = Clerk(book, ROBOT)  # another server in its place
    again.look(clock.set("2026-12-19 12:00"))
    assert kinds(clerk) == []
    clerk.look(clock.set("2026-12-20 12:00"))
    assert kinds(clerk) == ["ended"]


def test_a_new_approval_ends_anew(clerk: Clerk, book: Book, added: Added, clock: Clock) -> None:
    kept = added(rhythm=None, trigger=BUTTON, approved_until=at("2026-12-20 12:00"))
    clerk.look(clock.set("2026-12-18 12:00"))
    assert kinds(clerk) == ["ends_soon"]
    book.approve(kept.id, "Nurse Kim", at("2027-01-10 12:00"), kept.reviewed, False)
    clerk.look(clock.set("2026-12-19 12:00"))
    assert kinds(clerk) == []
    clerk.look(clock.set("2027-01-08 12:00"))
    assert kinds(clerk) == ["ends_soon"]


def test_nothing_is_told_of_what_would_not_come_again_or_was_short(
    clerk: Clerk, added: Added, clock: Clock
) -> None:
    added(rhythm=rhythm("FREQ=DAILY;COUNT=3"), approved_until=clock.now + 20 * DAY)
    added(rhythm=None, trigger=BUTTON, approved_until=clock.now + 2 * DAY)
    clerk.look(clock.now + DAY)
    clerk.look(clock.now + 1.9 * DAY)
    clerk.look(clock.now + 19 * DAY)
    assert "ends_soon" not in kinds(clerk)
