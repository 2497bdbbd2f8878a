"""A station that keeps time: appointments over the wire, run, stopped, and told."""

from __future__ import annotations

import sqlite3
import subprocess
import sys
from datetime import datetime
from typing import Any

import pytest

from nl2robot.review.review import digest
from nl2robot.run.runlog import RunLog
from nl2robot.run.state import State
from nl2robot.schedule.rhythm import local
from nl2robot.schedule.schedule import FILE
from nl2robot.schedule.service import RESTS_AFTER_STOP, waits_for
from robot_api.errors import AccessDenied, InvalidCall
from sim.world.model import Zone
from tests.schedule.conftest import DAILY, ROUND, ZURICH, Ward, at, slow

LONG = 'while True:\n    robot.goto("ward a")\n    robot.goto("ward b")\n'


def test_a_round_is_made_each_morning_in_the_name_of_who_approved_it(ward: Ward) -> None:
    added = ward.add()
    ward.clock.set("2026-11-30 08:00")
    ward.until(["done"])
    ward.clock.set("2026-12-01 08:00")
    ward.until(["done", "done"])
    second, first = ward.log.runs()
    assert first.status == second.status == "done"
    assert first.approved_by == f"Nurse Kim (appointment {added['id']})"
    assert first.utterance == "go to ward a and say good morning"
    assert [each["occurrence"]["run"] for each in ward.ask("history")] == [second.id, first.id]


OTHER_SERVER = """
import os, sys
from nl2robot.schedule.book import Book

made, file, robot = sys.argv[1:]
book = Book(made)
book.kept_by(robot)
book.close()
os.replace(made, file)  # at once: nobody finds it before its keeper is in it
print("keeps time", flush=True)
sys.stdin.read()
"""


def test_a_second_server_of_the_same_robot_begins_nothing_until_the_first_has_ended(
    ward: Ward,
) -> None:
    file = ward.log.path.with_name(FILE)
    made = file.with_name("made.sqlite")
    robot = ward.robot.capabilities().name
    arguments = [sys.executable, "-c", OTHER_SERVER, str(made), str(file), robot]
    with subprocess.Popen(arguments, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as other:
        assert other.stdout is not None and other.stdout.readline() == b"keeps time\n"
        ward.add()
        ward.clock.set("2026-11-30 08:00")
        told = ward.notice("trouble")["told"]
        assert f"process {other.pid}" in told["en"] and robot in told["en"]
        assert "Prozess" in told["de"] and "processus" in told["fr"]
        assert ward.states() == [] and ward.log.runs() == []
        other.kill()
    ward.until(["done"])


def test_what_is_said_goes_by_the_clock_of_the_station(ward: Ward) -> None:
    """Whatever the computer's shows."""
    ward.clock.set("2026-11-30 10:00")
    made = ward.robot.request("program.translate", {"utterance": "in two hours go to ward a"})
    begins = made["schedule"]["rhythm"]["begins"]
    zone = made["schedule"]["rhythm"]["zone"]
    assert local(at("2026-11-30 12:00"), zone).strftime("%Y-%m-%dT%H:%M") == begins[:16]


def test_what_is_planned_is_told(ward: Ward) -> None:
    ward.add(rhythm={**DAILY, "rule": "FREQ=WEEKLY;BYDAY=MO,TU,WE,TH,FR"})
    [listed] = ward.ask("list", language="de")
    assert listed["when"] == "montags bis freitags um 08:00"
    assert listed["next"][:2] == [at("2026-11-30 08:00"), at("2026-12-01 08:00")]
    assert listed["appointment"]["approved_by"] == "Nurse Kim"


def test_not_tomorrow_and_then_after_all(ward: Ward) -> None:
    number = ward.add()["id"]
    assert ward.ask("skip", id=number, date="2026-12-01") == [at("2026-12-01 08:00")]
    [listed] = ward.ask("list")
    assert listed["off"] == [at("2026-12-01 08:00")]
    assert listed["next"][:2] == [at("2026-11-30 08:00"), at("2026-12-02 08:00")]
    with pytest.raises(InvalidCall, match="not done then"):
        ward.ask("skip", id=number, date="2026-12-01")
    assert ward.ask("skip", id=number, date="2026-12-01", back=True) == [at("2026-12-01 08:00")]
    assert ward.ask("list")[0]["off"] == []
    assert ward.ask("skip", id=number) == [at("2026-11-30 08:00")], "what comes next"
    with pytest.raises(InvalidCall, match="Nothing of appointment"):
        ward.ask("skip", id=number, date="2026-12-01", back=True)


def test_a_paused_one_waits_until_it_is_resumed(ward: Ward) -> None:
    number = ward.add()["id"]
    assert ward.ask("pause", id=number)["paused"] is True
    assert ward.ask("list")[0]["next"] == []
    ward.clock.set("2026-11-30 08:00")
    ward.until(["skipped"])
    ward.ask("resume", id=number)
    ward.clock.set("2026-12-01 08:00")
    ward.until(["skipped", "done"])
    ward.ask("remove", id=number)
    assert ward.ask("list") == []
    assert ward.states() == ["skipped", "done"], "what was done is still told"


@slow
def test_a_stop_ends_the_run_and_nothing_begins_it_again(ward: Ward) -> None:
    ward.add(LONG, insists=True)
    ward.clock.set("2026-11-30 08:00")
    ward.until(["running"])
    ward.robot.stop()
    assert ward.notice("failed")["told"]["en"].endswith("The robot was stopped.")
    assert ward.states() == ["failed"] and len(ward.log.runs()) == 1
    assert ward.log.runs()[0].status == "stopped"
    ward.clock.set("2026-12-01 08:00")
    told = ward.notice("waits")["told"]
    assert told["de"].endswith("wartet: Der Roboter wurde angehalten."), "nothing begins so soon"


@slow
def test_a_program_that_runs_makes_it_wait(ward: Ward) -> None:
    ward.add()
    approval = ward.robot.request(
        "program.approve",
        {"program": LONG, "sha256": digest(LONG), "by": "Dr Weber", "insists": True},
    )
    ward.robot.request("program.run", {"approval": approval["id"]})
    ward.clock.set("2026-11-30 08:00")
    assert ward.notice("waits")["told"]["en"].endswith("waits: another program is running.")
    ward.clock.set("2026-11-30 08:31")
    assert "another program was running" in ward.notice("missed")["told"]["en"]
    ward.robot.request("program.stop")


def test_a_simulation_whose_clock_runs_ahead_is_reviewed_by_the_one_on_the_wall(ward: Ward) -> None:
    """With `--speed 100` it is soon night in there, and no greeting was approved for the night."""
    ward.add()
    happens = {"what": "pressed", "text": "Say hello"}
    ward.add(rhythm=None, trigger=happens)
    ward.station.simulation.set_clock(datetime(2026, 11, 30, 23))
    ward.clock.set("2026-11-30 08:00")
    ward.until(["done"])
    ward.ask("press", button="Say hello")
    ward.until(["done", "done"])


def test_a_zone_that_was_drawn_since_asks_for_a_new_approval(ward: Ward) -> None:
    added = ward.add('robot.goto("ward a")\n')
    zone = Zone("wet floor", ((2.0, 4.0), (4.0, 4.0), (4.0, 6.5), (2.0, 6.5)))
    ward.station.simulation.set_zones((zone,))
    ward.clock.set("2026-11-30 08:00")
    told = ward.notice("changed")["told"]["en"]
    assert "wet floor" in told and told.endswith("Review it and approve it anew.")
    assert ward.states() == ["asked"] and ward.log.runs() == []
    assert ward.ask("list")[0]["appointment"]["asked"] == "changed"
    with pytest.raises(AccessDenied, match="did not come to its end"):
        ward.ask("approve", id=added["id"], sha256=added["sha256"], by="Dr Weber")
    ward.station.simulation.set_zones(())
    approved = ward.ask("approve", id=added["id"], sha256=added["sha256"], by="Dr Weber")
    assert approved["asked"] is None and approved["approved_by"] == "Dr Weber"
    ward.clock.set("2026-12-01 08:00")
    ward.until(["asked", "done"])


def test_where_the_robot_happens_to_stand_is_no_news(ward: Ward) -> None:
    ward.add()
    ward.robot.goto("ward b")
    ward.clock.set("2026-11-30 08:00")
    ward.until(["done"])


def test_an_approval_ends_when_it_was_said_to(ward: Ward) -> None:
    ward.add(until=at("2026-12-01 00:00"))
    ward.clock.set("2026-12-01 08:00")
    assert "has ended" in ward.notice("ended")["told"]["en"]
    assert any("a expiré" in each["told"] for each in ward.ask("notices", language="fr"))


@pytest.mark.parametrize(
    ("changed", "error", "sentence"),
    [
        ({"sha256": "0" * 64}, AccessDenied, "changed after its review"),
        ({"program": "robot.fly()\n"}, AccessDenied, "cannot be approved: line 1"),
        ({"program": 'robot.goto("roof")\n'}, AccessDenied, "cannot be approved|its end"),
        ({"rhythm": None}, InvalidCall, "a rhythm or a trigger"),
        ({"trigger": {"what": "battery", "below": 20}}, InvalidCall, "a rhythm or a trigger"),
        ({"rhythm": {"begins": "soon"}}, InvalidCall, "no time at which something begins"),
        ({"rhythm": {**DAILY, "rule": "FREQ=MINUTELY"}}, InvalidCall, "more often than"),
        ({"rhythm": {"begins": "2026-11-30T05:00", "zone": ZURICH}}, InvalidCall, "is over"),
        ({"until": 0}, InvalidCall, "a year at most"),
        ({"priority": 10}, InvalidCall, "priority"),
    ],
)
def test_what_is_no_appointment_is_refused_with_a_sentence(
    ward: Ward, changed: dict[str, Any], error: type[Exception], sentence: str
) -> None:
    program = changed.get("program", ROUND)
    with pytest.raises(error, match=sentence):
        ward.add(**{"sha256": digest(program), **changed})
    assert ward.ask("list") == []


def test_nothing_is_made_or_opened_where_there_is_no_appointment(ward: Ward, log: RunLog) -> None:
    assert ward.ask("list") == ward.ask("history") == ward.ask("notices") == []
    assert not log.path.with_name("schedule.sqlite").exists()
    with pytest.raises(InvalidCall, match="no appointment 3"):
        ward.ask("pause", id=3)


def test_a_book_that_cannot_be_written_is_told_once_and_nothing_runs(ward: Ward) -> None:
    ward.add()
    file = ward.log.path.with_name("schedule.sqlite")
    with sqlite3.connect(file) as database:
        database.execute(
            "CREATE TRIGGER full BEFORE INSERT ON occurrences"
            " BEGIN SELECT RAISE(ABORT, 'database or disk is full'); END"
        )
    ward.clock.set("2026-11-30 08:00")
    told = ward.notice("trouble")["told"]
    assert "Free some disk space" in told["en"] and "Speicherplatz" in told["de"]
    assert ward.log.runs() == []
    with sqlite3.connect(file) as database:
        database.execute("DROP TRIGGER full")
    ward.until(["done"])


def test_a_robot_that_charges_begins_when_it_has_enough() -> None:
    state = State(sequence=1, state="charging", charging=True)
    assert waits_for(state, 0.0, 12.0) == "charging"
    assert waits_for(state, 0.0, 80.0) is None
    assert waits_for(state, 0.0, None) is None


@pytest.mark.parametrize(
    ("state", "why"),
    [
        (State(sequence=1), None),
        (State(sequence=1, state="reviewing"), None),
        (State(sequence=1, state="running", run=3), "busy"),
        (State(sequence=1, state="paused", run=3), "busy"),
        (State(sequence=1, state="stopping", run=3), "stopped"),
        (State(sequence=1, unconfirmed=True), "stopped"),
        (State(sequence=1, state="stopped", since=1.0), "stopped"),
        (State(sequence=1, driven_by="Ann"), "driven"),
        (State(sequence=1, state="lost", lost_since=5.0), "lost"),
    ],
)
def test_what_a_robot_has_to_be_for_something_to_begin(state: State, why: str | None) -> None:
    assert waits_for(state, 2.0, 50.0) == why
    assert waits_for(State(sequence=1, state="stopped"), RESTS_AFTER_STOP, 50.0) is None
