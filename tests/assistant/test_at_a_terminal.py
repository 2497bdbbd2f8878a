"""`nl2robot proposals`: somebody at a terminal sees what is proposed, and decides."""

from __future__ import annotations

import io
import json
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from nl2robot.cli.main import main
from nl2robot.cli.operator import Operator
from nl2robot.cli.terminal import Terminal
from nl2robot.errors import ExitStatus
from nl2robot.run.runlog import RunLog
from nl2robot.station.station import simulated_station
from sim.world.loading import load_world
from tests.proposed import Asked

LONG = 'while True:\n    robot.goto("ward a")\n    robot.goto("ward b")\n'
Command = Callable[..., int]


@pytest.fixture
def ward(tmp_path: Path) -> Iterator[Asked]:
    log = RunLog(tmp_path / "runs.sqlite")
    with (
        simulated_station(load_world("ward"), log, seed=1) as station,
        station.connect() as robot,
    ):
        yield Asked(robot)
    log.close()


@pytest.fixture
def proposals(ward: Asked, monkeypatch: pytest.MonkeyPatch) -> Command:
    """The command, with what is typed at its questions."""

    def command(*words: str, typed: tuple[str, ...] = ()) -> int:
        answers = iter(typed)
        monkeypatch.setattr("builtins.input", lambda question="": next(answers))
        return main(["proposals", "--robot", f"ws://{ward.robot.address}", *words])

    return command


def test_what_waits_is_listed(
    ward: Asked, proposals: Command, capsys: pytest.CaptureFixture[str]
) -> None:
    assert proposals() == ExitStatus.OK
    assert "No program is proposed" in capsys.readouterr().out
    ward.propose()
    assert proposals("--lang", "de") == ExitStatus.OK
    told = capsys.readouterr().out
    assert "“Sam”" in told and "say hello in ward a" in told
    assert proposals("--json") == ExitStatus.OK
    assert json.loads(capsys.readouterr().out)["state"] == "waiting"
    assert proposals("7") == ExitStatus.BAD_INPUT
    assert "There is no proposal 7" in capsys.readouterr().err


def test_it_is_shown_with_its_review_approved_and_watched_to_its_end(
    ward: Asked, proposals: Command, capsys: pytest.CaptureFixture[str]
) -> None:
    ward.propose(why="The visitors are here.")
    assert proposals("1", typed=("a",)) == ExitStatus.OK
    told = capsys.readouterr().out
    assert "“Sam” proposes this program" in told and "The visitors are here." in told
    assert "It would take" in told and "I said “Hello!”" in told
    assert ward.ask("show", id=1)["state"] == "approved"


def test_whoever_says_no_may_say_why(
    ward: Asked, proposals: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    ward.propose()
    monkeypatch.setattr(Terminal, "somebody_is_there", True)
    assert proposals("1", typed=("r", "They sleep.")) == ExitStatus.NOT_APPROVED
    found = ward.ask("show", id=1)
    assert (found["state"], found["reason"]) == ("declined", "They sleep.")


@pytest.mark.parametrize(
    ("piped", "told"),
    [
        ("", "Nobody is there to answer, so the proposal waits on."),
        ("a\n", "“a” decides nothing here, so the proposal waits on."),
    ],
)
def test_a_script_that_answers_otherwise_is_asked_once_and_told(
    piped: str,
    told: str,
    ward: Asked,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Who runs on does so until somebody insists, for which an "approve" is not enough."""
    ward.propose('robot.goto("ward a")\nint("two")\n')
    monkeypatch.setattr("sys.stdin", io.StringIO(piped))
    command = ["proposals", "1", "--robot", f"ws://{ward.robot.address}"]
    assert main(command) == ExitStatus.NOT_APPROVED
    said = capsys.readouterr()
    assert said.out.count("It did not come to its end when it was tried.") == 1
    assert told in said.err and "--yes" not in said.err
    assert ward.ask("show", id=1)["state"] == "waiting"


def test_ctrl_c_stops_what_was_approved(
    ward: Asked, proposals: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(self: Operator, run: int) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Operator, "wait", interrupted)
    ward.propose(LONG)
    assert proposals("1", typed=("a",)) == ExitStatus.INTERRUPTED
    run = ward.ask("show", id=1)["run"]
    assert ward.robot.request("program.wait", {"run": run})["state"] == "stopped"


@pytest.mark.parametrize("piped", ["approv\n", "maybe later\n", "\n"])
def test_a_script_that_is_not_understood_decides_nothing(
    piped: str,
    ward: Asked,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    ward.propose()
    monkeypatch.setattr("sys.stdin", io.StringIO(piped))
    command = ["proposals", "1", "--robot", f"ws://{ward.robot.address}"]
    assert main(command) == ExitStatus.NOT_APPROVED
    assert "decides nothing here, so the proposal waits on." in capsys.readouterr().err
    assert ward.ask("show", id=1)["state"] == "waiting"


def test_a_typo_is_no_decision(
    ward: Asked, proposals: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    ward.propose()
    monkeypatch.setattr(Terminal, "somebody_is_there", True)
    assert proposals("1", typed=("aprove", "", "approve")) == ExitStatus.OK
    assert ward.ask("show", id=1)["state"] == "approved"


@pytest.mark.parametrize(
    ("typed", "state"),
    [("approve", "approved"), ("a", "approved"), ("reject", "declined"), ("r", "declined")],
)
def test_the_english_words_count_in_every_language(
    typed: str, state: str, ward: Asked, proposals: Command
) -> None:
    ward.propose()
    proposals("1", "--lang", "de", typed=(typed,))
    assert ward.ask("show", id=1)["state"] == state


def test_who_changes_it_first_approves_what_they_made_of_it(
    ward: Asked, proposals: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    ward.propose()
    monkeypatch.setattr(Terminal, "edit", lambda self, program: 'robot.say("Good night.")\n')
    assert proposals("1", typed=("edit", "a")) == ExitStatus.OK
    assert ward.ask("show", id=1)["ran"] == 'robot.say("Good night.")\n'


def test_of_what_is_decided_nobody_is_asked(
    ward: Asked, proposals: Command, capsys: pytest.CaptureFixture[str]
) -> None:
    ward.approve(ward.propose()["proposal"])
    ward.propose()
    ward.ask("decline", id=2, by="Nurse Kim")
    for number, said in (("1", "freigegeben"), ("2", "abgelehnt")):
        assert proposals(number, "--lang", "de") == ExitStatus.BAD_INPUT
        told = capsys.readouterr()
        assert f"Vorschlag {number} wurde schon von" in told.err and said in told.err
        assert "robot." not in told.out
