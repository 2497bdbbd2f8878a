"""`nl2robot log`: what was done is found, and deleted, in a terminal."""

from __future__ import annotations

import json

import pytest

from nl2robot.errors import ExitStatus
from nl2robot.paths import data_file
from nl2robot.run.runlog import RunLog


@pytest.fixture
def log(home):
    log = RunLog(data_file("runs.sqlite"))
    yield log
    log.close()


def ran(log: RunLog, text: str, started: float | None = None) -> int:
    run = log.begin(program=text, sha256="", approved_by="Kim", approved_at=0.0)
    log.end(run, "done", None)
    if started is not None:
        log._write("UPDATE runs SET started = ? WHERE id = ?", started, run)
    return run


def test_a_run_is_deleted_at_once(nl2robot, log) -> None:
    first, second = ran(log, "robot.say('a')"), ran(log, "robot.say('b')")
    status, out, _ = nl2robot("log", str(first), "--delete")
    assert (status, "One run was deleted" in out) == (ExitStatus.OK, True)
    assert [each.id for each in log.runs()] == [second]
    assert nl2robot("log", str(first), "--delete")[0] == ExitStatus.BAD_INPUT


def test_old_runs_are_deleted(nl2robot, log) -> None:
    ran(log, "robot.say('a')", started=0.0)
    kept = ran(log, "robot.say('b')")
    status, out, _ = nl2robot("log", "--delete-older-than", "30")
    assert (status, "One run was deleted" in out) == (ExitStatus.OK, True)
    assert [each.id for each in log.runs()] == [kept]


def test_a_run_that_goes_on_is_not_deleted(nl2robot, log) -> None:
    run = log.begin(program="", sha256="", approved_by="Kim", approved_at=0.0)
    status, _, err = nl2robot("log", str(run), "--delete")
    assert status == ExitStatus.BAD_INPUT and "is going on" in err
    assert nl2robot("log", "--delete")[0] == ExitStatus.BAD_INPUT


def test_what_was_done_by_hand_is_listed(nl2robot, log) -> None:
    assert "Nobody had the robot do anything" in nl2robot("log", "--by-hand")[1]
    log.by_hand("Ruth", "goto", '{"place": "lobby"}')
    assert "goto(place='lobby')" in nl2robot("log", "--by-hand")[1]
    told = json.loads(nl2robot("log", "--by-hand", "--json")[1])
    assert (told["who"], told["arguments"]) == ("Ruth", {"place": "lobby"})


@pytest.mark.parametrize(
    ("language", "empty", "listed", "detailed"),
    [
        ("de", "Es wurde noch nichts ausgeführt.", "gescheitert", "frei:       von Kim um"),
        ("fr", "Rien n'a encore été exécuté.", "échoué", "approuvé:   par Kim à"),
    ],
)
def test_it_is_told_in_the_language_asked_for(
    nl2robot, log, language: str, empty: str, listed: str, detailed: str
) -> None:
    assert empty in nl2robot("log", "--lang", language)[1]
    run = log.begin(program="robot.say('a')", sha256="", approved_by="Kim", approved_at=0.0)
    log.call_begins(run, 1, 1, "goto", '{"place": "ward z"}')
    log.call_ends(run, 1, 0.1, error="Blocked: My left track is off.")
    log.end(run, "failed", "My left track is off.")
    assert listed in nl2robot("log", "--lang", language)[1]
    told = nl2robot("log", str(run), "--lang", language)[1]
    assert detailed in told and "My left track is off." in told
    assert "approved" not in told and "failed" not in told


@pytest.mark.parametrize(
    ("language", "who", "robot"),
    [
        ("en", "root (proposed by “mcp”)", "The simulated robot in ward"),
        ("de", "root (vorgeschlagen von “mcp”)", "Der simulierte Roboter in ward"),
        ("fr", "root (proposé par “mcp”)", "Le robot simulé dans ward"),
    ],
)
def test_who_proposed_it_and_what_robot_it_was_is_told_in_that_language(
    nl2robot, log, language: str, who: str, robot: str
) -> None:
    run = log.begin(
        program="robot.say('a')",
        sha256="",
        approved_by="root (proposed by “mcp”)",
        approved_at=0.0,
        robot="The simulated robot",
        world="ward",
    )
    log.end(run, "done", None)
    told = nl2robot("log", str(run), "--lang", language)[1]
    assert who in told and robot in told
    assert who.split()[1] in nl2robot("log", "--lang", language)[1]
