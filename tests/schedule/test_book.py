"""What was decided stands in the book, whatever becomes of the process that decided it."""

from __future__ import annotations

import os
import signal
import sqlite3
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from nl2robot.run.process import lives
from nl2robot.schedule.appointments import DAY
from nl2robot.schedule.book import Book, BookError, NoAppointment
from nl2robot.schedule.triggers import Trigger
from tests.schedule.conftest import ROBOT, Added, Clock, at, rhythm


def test_an_appointment_is_kept_as_it_was_approved(
    book: Book, added: Added, tmp_path: Path
) -> None:
    kept = added(rhythm=rhythm("FREQ=WEEKLY"), priority=7, makes_up=20, plan='{"steps": []}')
    again = Book(tmp_path / "schedule.sqlite")
    assert again.appointments() == [kept]
    assert (tmp_path / "schedule.sqlite").stat().st_mode & 0o077 == 0, "it tells of patients"
    again.close()


def test_one_begun_by_something_else_keeps_what_that_is(book: Book, added: Added) -> None:
    wish = Trigger(what="battery", below=20)
    kept = added(rhythm=None, trigger=wish)
    assert book.appointment(kept.id).trigger == wish
    assert book.appointment(kept.id).rhythm is None


def test_a_time_is_in_the_book_once(book: Book, added: Added) -> None:
    kept = added()
    assert book.come(kept.id, at("2026-11-30 08:00")) is not None
    assert book.come(kept.id, at("2026-11-30 08:00")) is None


def test_only_one_process_claims_what_is_due(book: Book, added: Added, tmp_path: Path) -> None:
    occurrence = book.come(added().id, at("2026-11-30 08:00"))
    assert occurrence is not None
    books = [Book(tmp_path / "schedule.sqlite") for _ in range(8)]
    won: list[bool] = []
    together = threading.Barrier(len(books))

    def claim(mine: Book) -> None:
        together.wait()
        won.append(mine.claim(occurrence.id))

    threads = [threading.Thread(target=claim, args=(each,)) for each in books]
    for each in threads:
        each.start()
    for each in threads:
        each.join()
    assert sorted(won) == [False] * 7 + [True]
    for mine in books:
        mine.close()


def test_an_end_is_told_once(book: Book, added: Added) -> None:
    occurrence = book.come(added().id, at("2026-11-30 08:00"))
    assert occurrence is not None and book.claim(occurrence.id)
    book.runs(occurrence.id, 7)
    assert book.end(occurrence.id, "done")
    assert not book.end(occurrence.id, "failed", "broken_off")
    [told] = book.history()
    assert (told.state, told.run, told.note) == ("done", 7, None)


def test_what_is_removed_is_not_done_any_more(book: Book, added: Added) -> None:
    kept = added()
    book.come(kept.id, at("2026-11-30 08:00"))
    book.remove(kept.id)
    assert book.waiting(ROBOT) == [] and book.appointments() == []
    assert [each.state for each in book.history(kept.id)] == ["skipped"]
    with pytest.raises(NoAppointment, match=f"no appointment {kept.id}"):
        book.appointment(kept.id)
    with pytest.raises(NoAppointment):
        book.appointment(10**30)


def test_numbers_are_never_given_again(book: Book, added: Added, clock: Clock) -> None:
    first = added()
    book.remove(first.id)
    book.forget(clock.now + 1)
    assert book.appointments(removed=True) == []
    assert added().id == first.id + 1


def test_what_is_old_is_forgotten(book: Book, added: Added, clock: Clock) -> None:
    kept = added()
    occurrence = book.come(kept.id, clock.now, "missed", "busy")
    book.come(kept.id, clock.now + DAY)
    book.tell("missed", kept.id, occurrence.id if occurrence else None)
    book.forget(clock.now + DAY + 1)
    assert [each.state for each in book.history()] == ["due"], "what is not over stays"
    assert book.notices() == [] and book.appointments() == [kept]


KILLED = """
import os, sys
from nl2robot.schedule.book import Book
book = Book(sys.argv[1])
[(occurrence, _)] = book.waiting("simulated robot")
assert book.claim(occurrence.id)
if sys.argv[2] == "running":
    book.runs(occurrence.id, 41)
print("claimed", flush=True)
sys.stdin.read()
"""


@pytest.mark.parametrize("state", ["claimed", "running"])
def test_what_a_killed_process_had_begun_is_known_afterwards(
    book: Book, added: Added, tmp_path: Path, state: str
) -> None:
    kept = added()
    book.come(kept.id, at("2026-11-30 08:00"))
    with subprocess.Popen(
        [sys.executable, "-c", KILLED, str(tmp_path / "schedule.sqlite"), state],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as child:
        assert child.stdout is not None
        assert child.stdout.readline() == "claimed\n"
        os.kill(child.pid, signal.SIGKILL)
        child.wait()
    [(occurrence, appointment)] = book.begun(ROBOT)
    assert occurrence.process is not None and not lives(occurrence.process)
    assert appointment == kept and occurrence.state == state
    assert occurrence.run == (41 if state == "running" else None)
    assert not book.claim(occurrence.id), "it is not begun again"


def test_what_is_written_at_once_is_there_whole_or_not_at_all(book: Book, added: Added) -> None:
    kept = added()
    with pytest.raises(RuntimeError), book.at_once():
        book.come(kept.id, at("2026-11-30 08:00"))
        raise RuntimeError("killed here")
    assert book.history() == []


def test_a_full_disk_is_told_in_a_sentence(book: Book, added: Added) -> None:
    kept = added()
    [[pages]] = book._db.execute("PRAGMA page_count")
    book._db.execute(f"PRAGMA max_page_count = {pages}")  # SQLite's own "disk full"
    with pytest.raises(BookError, match="Free some disk space"):
        for number in range(2000):
            book.come(kept.id, float(number), "missed", "x" * 1000)
    assert book.appointments() == [kept]
    book._db.execute(f"PRAGMA max_page_count = {10 * pages}")
    assert book.come(kept.id, 1e9) is not None, "and it goes on when there is room"


def test_a_file_that_is_no_book_is_told_in_a_sentence(tmp_path: Path) -> None:
    file = tmp_path / "schedule.sqlite"
    file.write_text("Dear diary, " * 100)
    with pytest.raises(BookError, match="cannot be used"):
        Book(file)


def test_a_book_of_a_later_version_is_left_as_it_is(tmp_path: Path) -> None:
    file = tmp_path / "schedule.sqlite"
    Book(file).close()
    with sqlite3.connect(file) as database:
        database.execute("PRAGMA user_version = 99")
    Book(file).close()
    with sqlite3.connect(file) as database:
        assert database.execute("PRAGMA user_version").fetchone() == (99,)
