"""Reminders on good days and bad ones: Alice shall drink at ten and at four, and the ward wants to
know whether she did."""

from __future__ import annotations

import csv
import io
import json
import sqlite3
from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import Any

import msgspec
import pytest

from nl2robot.knowledge import Knowledge
from nl2robot.review.review import digest
from nl2robot.run.runlog import RunLog
from nl2robot.schedule.book import Book
from nl2robot.schedule.reminders import Reminder, as_csv
from nl2robot.schedule.schedule import FILE
from nl2robot.translate.translation import translate
from robot_api.capabilities.screen import SimulatedScreen
from sim.world.loading import load_world
from sim.world.model import World
from tests.schedule.conftest import ZURICH, Clock, Ward, add, at, keeping_time, rhythm

SMALL = load_world("ward")
TEN_AND_FOUR = {"begins": "2026-11-30T10:00", "zone": ZURICH, "rule": "FREQ=DAILY;BYHOUR=10,16"}


def program(sentence: str = "remind Alice to drink", language: str = "en") -> str:
    made = translate(sentence, Knowledge(SMALL), language).program
    assert made is not None and "reminder_done" in made
    return made


def world(*answers: str, **changed: Any) -> World:
    """The ward with Alice in it, who answers so."""
    alice, henry = SMALL.people
    alice = msgspec.structs.replace(alice, answers=answers, **changed)
    return msgspec.structs.replace(SMALL, people=(alice, henry))


Opened = Callable[..., AbstractContextManager[Ward]]


@pytest.fixture
def opened(log: RunLog, clock: Clock, monkeypatch: pytest.MonkeyPatch) -> Opened:
    """A station of that world, whose robot has no touchscreen: on one, simulated people answer."""

    monkeypatch.setattr(SimulatedScreen, "touchable", False)

    def open_station(world: World, speed: float | None = None) -> AbstractContextManager[Ward]:
        return keeping_time(log, clock, world, speed)

    return open_station


def reminded(ward: Ward, **more: Any) -> None:
    values = {"sentence": "remind Alice to drink", "rhythm": TEN_AND_FOUR, **more}
    ward.add(program(), **values)


def record(ward: Ward) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = ward.ask("reminders")
    return list(reversed(found))


def kinds(ward: Ward) -> list[str]:
    return [each["notice"]["kind"] for each in ward.ask("notices")]


def test_she_has_done_it_and_nobody_is_bothered(opened: Opened) -> None:
    with opened(world("yes")) as ward:
        reminded(ward)
        ward.clock.set("2026-11-30 10:00")
        ward.until(["done"])
        [row] = record(ward)
        assert (row["person"], row["what"], row["result"]) == ("Alice", "Please drink.", "yes")
        assert (row["answer"], row["place"]) == ("yes", "ward a")
        assert row["due"] == at("2026-11-30 10:00") and row["said"] is not None
        assert row["approved_by"] == "Nurse Kim (appointment 1)"
        assert kinds(ward) == []
        assert ward.ask("history")[0]["told"] == "done: the answer was yes"


def test_she_says_no_and_the_ward_is_told(opened: Opened) -> None:
    with opened(world("no")) as ward:
        reminded(ward)
        ward.clock.set("2026-11-30 10:00")
        told = ward.notice("reminder_no")
        assert told["told"]["en"] == (
            "Alice answered “Have you done it?” with no. The reminder “Please drink.” was due on"
            " Monday, 30 November 2026 at 10:00. Please see to it."
        )
        assert told["told"]["de"].startswith("Alice antwortete auf «Have you done it?» mit nein.")
        assert [row["result"] for row in record(ward)] == ["no"]


def test_she_answers_nothing_that_anybody_understands(opened: Opened) -> None:
    with opened(world("brumm", "hm", "brumm", "hm")) as ward:
        reminded(ward)
        ward.clock.set("2026-11-30 10:00")
        assert "was not understood" in ward.notice("reminder_unclear")["told"]["en"]
        [row] = record(ward)
        assert (row["result"], row["answer"]) == ("unclear", None)


def test_she_does_not_answer_and_is_asked_once_more(opened: Opened) -> None:
    with opened(world("", "", "", "")) as ward:
        reminded(ward)
        ward.clock.set("2026-11-30 10:00")
        assert "does not answer" in ward.notice("reminder_silent")["told"]["en"]
        [run] = ward.log.runs()
        said = [each.method for each in ward.log.calls(run.id)]
        assert said == ["find", "say", "ask", "say", "ask"]
        assert [row["result"] for row in record(ward)] == ["silent"]


def test_she_answers_when_she_is_asked_once_more(opened: Opened) -> None:
    with opened(world("", "", "yes")) as ward:
        reminded(ward)
        ward.clock.set("2026-11-30 10:00")
        ward.until(["done"])
        assert [row["result"] for row in record(ward)] == ["yes"]
        assert kinds(ward) == []


def test_she_is_not_there(opened: Opened) -> None:
    with opened(world(at=None, pose=None)) as ward:
        reminded(ward)
        ward.clock.set("2026-11-30 10:00")
        assert ward.notice("reminder_away")["told"]["en"].startswith(
            "Alice was not found and was not reminded: “remind Alice to drink”"
        )
        [row] = record(ward)
        assert (row["result"], row["said"], row["what"]) == ("away", None, "Please drink.")


def test_she_is_somewhere_else_and_is_found_there(opened: Opened) -> None:
    with opened(world("yes", at="ward b", pose=None)) as ward:
        reminded(ward)
        ward.clock.set("2026-11-30 10:00")
        ward.until(["done"])
        assert [(row["result"], row["place"]) for row in record(ward)] == [("yes", "ward b")]


def test_she_walks_about_all_day(opened: Opened) -> None:
    """Where she was when it was approved is no matter."""
    with opened(world("yes", "yes", "yes", "yes", walks=("ward b", "corridor", "ward a"))) as ward:
        reminded(ward)
        for number, time in enumerate(("11-30 10", "11-30 16", "12-01 10", "12-01 16"), 1):
            ward.clock.set(f"2026-{time}:00")
            ward.until(["done"] * number)
        assert [row["result"] for row in record(ward)] == ["yes"] * 4


def test_two_reminders_for_one_person(opened: Opened) -> None:
    with opened(world("yes", "no")) as ward:
        reminded(ward)
        pills = program("remind Alice to take her pills")
        ward.add(pills, sentence="remind Alice to take her pills", rhythm=TEN_AND_FOUR, priority=4)
        ward.clock.set("2026-11-30 10:00")
        ward.until(["done", "done"])
        drink, take = sorted(record(ward), key=lambda row: row["appointment"])
        assert (drink["what"], drink["result"]) == ("Please drink.", "yes")
        assert (take["what"], take["result"]) == ("Please take your pills.", "no")
        assert kinds(ward).count("reminder_no") == 1


def test_two_persons_in_one_reminder(opened: Opened) -> None:
    both = world("yes")
    both = msgspec.structs.replace(
        both, people=(both.people[0], msgspec.structs.replace(both.people[1], answers=("no",)))
    )
    with opened(both) as ward:
        ward.add(program("remind Alice and Henry to drink"), rhythm=TEN_AND_FOUR)
        ward.clock.set("2026-11-30 10:00")
        assert ward.notice("reminder_no")["parts"]["person"] == "Henry"
        results = {row["person"]: row["result"] for row in record(ward)}
        assert results == {"Alice": "yes", "Henry": "no"}


def test_the_robot_is_busy_at_ten_and_comes_at_five_past(opened: Opened) -> None:
    with opened(world("yes"), speed=5) as ward:
        reminded(ward)
        at_once(ward, "robot.wait(15)\n", "wait for fifteen seconds")
        ward.clock.set("2026-11-30 10:00")
        ward.notice("waits")
        assert [row["result"] for row in record(ward)] == ["due"]
        ward.clock.set("2026-11-30 10:05")
        ward.until(["done"])
        [row] = record(ward)
        assert (row["due"], row["result"]) == (at("2026-11-30 10:00"), "yes")


def test_the_robot_is_stopped_on_its_way(opened: Opened) -> None:
    with opened(world("yes"), speed=5) as ward:
        reminded(ward)
        ward.clock.set("2026-11-30 10:00")
        ward.until(["running"])
        ward.robot.stop()
        assert ward.notice("failed")["told"]["en"].endswith("The robot was stopped.")
        [row] = record(ward)
        assert (row["person"], row["result"], row["said"]) == ("Alice", "broken_off", None)
        assert kinds(ward) == ["failed"]


def test_the_server_is_killed_in_the_middle(log: RunLog, clock: Clock) -> None:
    """The next one tells what is known of it: it was said, and there is no answer."""
    book = Book(log.path.with_name(FILE), clock)
    written = program()
    add(
        book,
        clock,
        program=written,
        sha256=digest(written),
        sentence="remind Alice to drink",
        robot="The simulated robot",
        rhythm=rhythm("FREQ=DAILY;BYHOUR=10", "2026-11-30 10:00"),
    )
    due = book.come(1, clock.set("2026-11-30 10:00"))
    assert due is not None and book.claim(due.id)
    run = log.begin(
        program=written,
        sha256=digest(written),
        approved_by="Nurse Kim (appointment 1)",
        approved_at=clock.now,
    )
    book.runs(due.id, run)
    for number, (line, method, given, result) in enumerate(
        [(1, "find", {"thing": "Alice"}, "true"), (3, "say", {"text": "Please drink."}, "null")], 1
    ):
        log.call_begins(run, number, line, method, json.dumps(given))
        log.call_ends(run, number, 1.0, result=result, place="ward a")
    log.call_begins(run, 3, 5, "ask", json.dumps({"question": "Have you done it?"}))
    for database, table in ((log.path, "runs"), (book.path, "occurrences")):
        with sqlite3.connect(database) as written_to:  # by a process that is gone
            written_to.execute(f"UPDATE {table} SET process = 1000000000")
    book.close()
    with keeping_time(log, clock, SMALL) as ward:
        assert "was broken off" in ward.notice("broken_off")["told"]["en"]
        [row] = record(ward)
        assert (row["result"], row["place"], row["answer"]) == ("broken_off", "ward a", None)
        assert row["what"] == "Please drink." and row["said"] is not None
        assert row["told"] == "was broken off before an answer"


@pytest.mark.parametrize("day", ["2026-03-29", "2026-10-25"])
def test_on_the_days_when_the_clocks_are_changed(opened: Opened, day: str) -> None:
    with opened(world("yes", "yes")) as ward:
        ward.clock.set(f"{day} 00:30")
        reminded(ward, rhythm={**TEN_AND_FOUR, "begins": f"{day}T10:00"})
        ward.clock.set(f"{day} 10:00")
        ward.until(["done"])
        ward.clock.set(f"{day} 16:00")
        ward.until(["done", "done"])
        assert [row["due"] for row in record(ward)] == [at(f"{day} 10:00"), at(f"{day} 16:00")]


def test_nobody_looked_at_ten(opened: Opened) -> None:
    with opened(world("yes")) as ward:
        reminded(ward)
        ward.clock.set("2026-11-30 12:00")
        ward.until(["missed"])
        [row] = record(ward)
        assert (row["person"], row["what"], row["result"]) == ("Alice", "Please drink.", "missed")
        assert row["told"] == "missed: nl2robot was not running"


def at_once(ward: Ward, written: str, sentence: str) -> None:
    given = {"program": written, "sha256": digest(written), "by": "Nurse Kim"}
    approval = ward.robot.request("program.approve", {**given, "utterance": sentence})
    ward.robot.request("program.run", {"approval": approval["id"]})


def test_one_that_is_said_at_once_is_in_the_record_and_told(opened: Opened) -> None:
    with opened(world("no")) as ward:
        at_once(ward, program(), "remind Alice to drink")
        told = ward.notice("reminder_no")
        assert told["appointment"] == 0 and told["told"]["en"].startswith("Alice answered")
        [row] = record(ward)
        assert (row["result"], row["appointment"]) == ("no", None)
        assert (row["sentence"], row["approved_by"]) == ("remind Alice to drink", "Nurse Kim")
        assert kinds(ward) == ["reminder_no"], "once"


def a_row(**given: Any) -> Reminder:
    values = {
        **dict.fromkeys(("said", "place", "answer", "appointment", "occurrence", "run")),
        "due": at("2026-11-30 10:00"),
        "person": "Alice",
        "what": "Please drink.",
        "result": "away",
        "told": "was not found",
        "question": "Have you done it?",
        "robot": "Temi",
        "approved_by": "Nurse Kim",
        "sentence": "remind Alice to drink",
    }
    return Reminder(**{**values, **given})


@pytest.mark.parametrize("start", ["=", "+", "-", "@", "\t", "\r", "\n"])
def test_a_spreadsheet_computes_nothing_of_what_people_say(start: str) -> None:
    evil = f'{start}HYPERLINK("http://x","y")'
    text = as_csv([a_row(what=evil, person=evil, approved_by=evil)], ZURICH)
    head, row = csv.reader(io.StringIO(text.removeprefix("\ufeff"), newline=""))
    found = dict(zip(head, row, strict=True))
    assert found["what"] == found["person"] == found["approved_by"] == f"'{evil}"
    assert found["due"] == "2026-11-30T10:00:00+01:00" and found["said"] == ""
