"""`nl2robot schedule`: a round is put in the book, looked at, called off, and taken out again."""

from __future__ import annotations

import json
from datetime import datetime
from pathlib import Path
from typing import Any

import pytest

from nl2robot.cli.commands.schedule.times import rhythm_of_options
from nl2robot.cli.main import main
from nl2robot.errors import ExitStatus, UserError
from nl2robot.run.runlog import RunLog
from nl2robot.schedule.book import Book
from nl2robot.schedule.schedule import FILE
from nl2robot.schedule.words import in_words
from nl2robot.station.station import simulated_station
from sim.world.loading import load_world
from tests.schedule.conftest import ROUND, ZURICH

ADD = ("add", "every weekday at eight", "go to ward a and say good morning", "--world", "ward")


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("NL2ROBOT_HOME", str(tmp_path / "home"))
    monkeypatch.setenv("NL2ROBOT_USER", "Nurse Kim")
    monkeypatch.setenv("COLUMNS", "200")
    return tmp_path / "home"


def schedule(*words: str) -> int:
    return main(["schedule", *words])


def listed(capsys: pytest.CaptureFixture[str], *more: str) -> list[dict[str, Any]]:
    capsys.readouterr()
    assert schedule("list", "--json", *more) == ExitStatus.OK
    return [json.loads(line) for line in capsys.readouterr().out.splitlines()]


def test_a_round_is_added_in_words_and_nothing_runs(
    home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert schedule(*ADD, "--yes", "--priority", "7", "--make-up", "30") == ExitStatus.OK
    shown = capsys.readouterr().out
    assert "When: every weekday at 08:00" in shown and 'robot.goto("ward a")' in shown
    assert "Appointment 1: every weekday at 08:00. Next on" in shown
    [kept] = listed(capsys)
    about = kept["appointment"]
    assert (about["program"], about["approved_by"]) == (ROUND, "Nurse Kim")
    assert (about["priority"], about["makes_up"]) == (7, 30)
    assert json.loads(about["plan"])["steps"], "the plan is kept as the run log keeps it"
    assert len(kept["next"]) == 5
    assert RunLog(home / "runs.sqlite").runs() == []


def test_nobody_is_asked_nothing_is_added(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stdin", Path("/dev/null").open())  # noqa: SIM115
    assert schedule(*ADD) == ExitStatus.NOT_APPROVED
    assert listed(capsys) == []


def test_a_program_at_times_that_options_name(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "round.py"
    file.write_text(ROUND)
    words = ("add", "--program", str(file), "--at", "7:30", "--every", "monday,Freitag")
    until = ("--until", f"{datetime.now().year + 1}-01-15", "--world", "ward")
    assert schedule(*words, *until, "--yes") == ExitStatus.OK
    [kept] = listed(capsys, "--lang", "de")
    assert kept["when"].startswith("jeden Montag und Freitag um 07:30, bis 15. Januar")
    assert kept["appointment"]["sentence"] == str(file)


def test_something_that_happens_begins_one(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("add", "go to ward a", "--when", "battery:20", "--world", "ward", "--yes")
    assert schedule(*words) == ExitStatus.OK
    assert "when the battery falls below 20 %" in capsys.readouterr().out
    [kept] = listed(capsys, "--lang", "fr")
    assert kept["when"] == "quand la batterie descend sous 20 %"
    assert kept["appointment"]["trigger"] == {"what": "battery", "below": 20}
    assert schedule() == ExitStatus.OK  # a table without a time to come


def test_what_was_added_is_paused_called_off_and_removed(
    capsys: pytest.CaptureFixture[str],
) -> None:
    schedule(*ADD, "--yes")
    assert schedule("pause", "1") == ExitStatus.OK
    assert "is paused" in capsys.readouterr().out
    assert schedule("--lang", "de") == ExitStatus.OK
    assert "ausgesetzt" in capsys.readouterr().out
    assert schedule("resume", "1") == ExitStatus.OK
    assert schedule("skip", "1") == ExitStatus.OK
    [kept] = listed(capsys)
    [off] = kept["off"]
    assert off < kept["next"][0]
    day = datetime.fromtimestamp(off).date().isoformat()
    assert schedule("skip", "1", "--on", day, "--back") == ExitStatus.OK
    assert listed(capsys)[0]["next"][0] == off
    assert schedule("skip", "1") == ExitStatus.OK
    assert schedule("history") == ExitStatus.OK
    assert "skipped: somebody called it off" in capsys.readouterr().out
    assert schedule("remove", "1") == ExitStatus.OK
    assert listed(capsys) == []


def test_an_appointment_is_approved_anew(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    schedule(*ADD, "--yes")
    book = Book(home / FILE)
    book.ask(1, "changed")
    book.close()
    assert schedule("list") == ExitStatus.OK
    assert "waits for approval" in capsys.readouterr().out
    assert schedule("approve", "1", "--yes", "--world", "ward") == ExitStatus.OK
    assert 'robot.goto("ward a")' in capsys.readouterr().out, "whoever approves sees it"
    assert listed(capsys)[0]["appointment"]["asked"] is None
    assert schedule("approve", "2", "--yes", "--world", "ward") == ExitStatus.BAD_INPUT


def test_it_is_reviewed_as_it_would_go_at_its_time(capsys: pytest.CaptureFixture[str]) -> None:
    """Who approves a round at three sees that it would talk at night, whenever they approve it."""
    at_three = ("add", "go to ward a and say good morning", "--at", "03:00", "--every", "day")
    assert schedule(*at_three, "--world", "ward", "--yes") == ExitStatus.OK
    assert "It speaks at 03:00, at night" in capsys.readouterr().out
    assert schedule("approve", "1", "--yes", "--world", "ward") == ExitStatus.OK
    assert "It speaks at 03:00, at night" in capsys.readouterr().out


def test_the_book_of_a_server_is_changed_over_the_wire(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = RunLog(tmp_path / "server" / "runs.sqlite")
    with simulated_station(load_world("ward"), log) as station:
        there = ("--robot", f"ws://{station.address}")
        assert schedule(*ADD, "--yes", *there) == ExitStatus.OK
        for action in ("pause", "resume", "skip", "history", "notices"):
            number = ("1",) if action in ("pause", "resume", "skip") else ()
            assert schedule(action, *number, *there) == ExitStatus.OK
        assert len(listed(capsys, *there)) == 1
        assert schedule("remove", "1", *there) == ExitStatus.OK
        assert listed(capsys, *there) == []
    log.close()
    assert listed(capsys) == [], "the book of this computer is another one"


def test_run_puts_in_the_book_what_is_to_be_done_at_set_times(
    capsys: pytest.CaptureFixture[str],
) -> None:
    words = "every morning at eight go to every ward and say good morning"
    assert main(["run", words, "--world", "ward", "--yes"]) == ExitStatus.OK
    assert "Appointment 1: every day at 08:00." in capsys.readouterr().out
    [kept] = listed(capsys)
    assert 'robot.places("ward")' in kept["appointment"]["program"]


@pytest.mark.parametrize(
    ("words", "status", "sentence"),
    [
        (("add",), ExitStatus.BAD_INPUT, "Write it so"),
        (("add", "go to ward a", "--yes"), ExitStatus.BAD_INPUT, "says no times"),
        (("add", "every day at eight", "fly", "--yes"), ExitStatus.NOT_UNDERSTOOD, ""),
        (("add", "fly", "--at", "8:00", "--yes"), ExitStatus.NOT_UNDERSTOOD, ""),
        (("add", "daily", "say hello", "--at", "8:00"), ExitStatus.BAD_INPUT, "not both"),
        (("add", "say hello", "--every", "day"), ExitStatus.BAD_INPUT, "what time of day"),
        (("add", "say hello", "--at", "8 pm"), ExitStatus.BAD_INPUT, "is no time"),
        (("add", "say hello", "--at", "8:00", "--every", "blue moon"), 2, "is no rhythm"),
        (("add", "say hello", "--when", "fire"), ExitStatus.BAD_INPUT, "There are: battery:20"),
        (("add", "say hello", "--when", "place:garden"), ExitStatus.BAD_INPUT, "no place “garden”"),
        (
            ("add", "say hello", "--when", "battery:20", "--at", "8:00"),
            ExitStatus.BAD_INPUT,
            "or by --when",
        ),
        (("add", "say hello", "--every", "2m"), ExitStatus.BAD_INPUT, "more often than"),
        (("add", "say hello", "--at", "2020-01-01 08:00", "-y"), 2, "is over"),
        (("pause",), ExitStatus.BAD_INPUT, "by its number"),
        (("pause", "the round"), ExitStatus.BAD_INPUT, "is no number"),
        (("remove", "7"), ExitStatus.BAD_INPUT, "no appointment 7"),
        (("skip", "7", "--back"), ExitStatus.BAD_INPUT, "--on"),
        (("skip", "7", "--on", "tomorrow"), ExitStatus.BAD_INPUT, "no day tomorrow"),
    ],
)
def test_what_cannot_be_is_told_in_a_sentence(
    capsys: pytest.CaptureFixture[str], words: tuple[str, ...], status: int, sentence: str
) -> None:
    assert schedule(*words, "--world", "ward") == status
    assert sentence in capsys.readouterr().err


@pytest.mark.parametrize(
    ("at", "every", "told"),
    [
        ("08:00", None, "once on Tuesday, 1 December 2026 at 08:00"),
        ("10:00", None, "once on Monday, 30 November 2026 at 10:00"),
        ("2026-12-24 8:00", None, "once on Thursday, 24 December 2026 at 08:00"),
        ("08:00", "day", "every day at 08:00"),
        ("08:00", "weekend", "on Saturdays and Sundays at 08:00"),
        ("08:00", "lundi", "every Monday at 08:00"),
        (None, "30m", "every 30 minutes, from 30 November 2026 at 09:16"),
        ("09:30", "2 hours", "every 2 hours, from 30 November 2026 at 09:30"),
    ],
)
def test_times_by_options(at: str | None, every: str | None, told: str) -> None:
    now = datetime(2026, 11, 30, 9, 15, 20)
    assert in_words(rhythm_of_options(at, every, None, ZURICH, now)) == told


def test_a_day_that_there_is_not_is_no_end() -> None:
    with pytest.raises(UserError, match="no day 2026-13-01"):
        rhythm_of_options("08:00", "day", "2026-13-01", ZURICH, datetime(2026, 11, 30))


def test_the_record_of_reminders_is_shown_and_saved(
    home: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert schedule("reminders") == ExitStatus.OK
    assert "No reminder has been due yet." in capsys.readouterr().out
    assert not (home / FILE).exists(), "to look makes nothing"
    assert main(["run", "-y", "remind Alice to drink", "--world", "ward"]) == ExitStatus.OK
    capsys.readouterr()
    assert schedule("reminders") == ExitStatus.OK
    shown = capsys.readouterr().out
    assert "Please drink." in shown and "ward a" in shown and "Nurse Kim" in shown
    assert schedule("reminders", "--json", "--since", "2026-01-01") == ExitStatus.OK
    [row] = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert (row["person"], row["result"], row["place"]) == ("Alice", "yes", "ward a")
    file = tmp_path / "reminders.csv"
    assert schedule("reminders", "--csv", str(file), "--lang", "de") == ExitStatus.OK
    assert "Erinnerungen: 1." in capsys.readouterr().out
    head, line = file.read_text(encoding="utf-8-sig").splitlines()
    assert head.startswith("due,said,person,what,place,result,told")
    assert ",Alice,Please drink.,ward a,yes,sagte ja," in line
    assert file.stat().st_mode & 0o077 == 0, "it tells of patients"
    assert schedule("reminders", "--csv", str(tmp_path)) == ExitStatus.BAD_INPUT
    assert "cannot be written" in capsys.readouterr().err
    assert schedule("reminders", "--since", "yesterday") == ExitStatus.BAD_INPUT


def test_the_record_of_a_server_comes_over_the_wire(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = RunLog(tmp_path / "server" / "runs.sqlite")
    with simulated_station(load_world("ward"), log) as station:
        there = ("--robot", f"ws://{station.address}")
        assert main(["run", "-y", "remind Alice to drink", *there]) == ExitStatus.OK
        capsys.readouterr()
        assert schedule("reminders", "--csv", "-", *there) == ExitStatus.OK
        assert ",Alice,Please drink.,ward a,yes," in capsys.readouterr().out
    log.close()
