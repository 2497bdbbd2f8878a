"""The commands as a user meets them, and Ctrl-C at any moment."""

import os
import signal

import pytest

from nl2robot import __version__
from nl2robot.cli.main import COMMANDS
from nl2robot.errors import ExitStatus
from nl2robot.run.runlog import RunLog

ROUND = ("run", "--world", "ward", "--speed", "1", "go to ward a and then to ward b")
INTERRUPTS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]


@pytest.fixture
def last_run(home):
    """What the log says of the last run: its row and its calls."""

    def last_run():
        log = RunLog(home / "runs.sqlite")
        try:
            runs = log.runs(1)
            return (runs[0], log.calls(runs[0].id)) if runs else (None, [])
        finally:
            log.close()

    return last_run


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_says_what_it_is_for(nl2robot, command) -> None:
    status, out, _ = nl2robot(command, "--help")
    assert status == ExitStatus.OK
    assert out.startswith(f"usage: nl2robot {command}")


def test_version(nl2robot) -> None:
    assert nl2robot("--version")[:2] == (ExitStatus.OK, f"nl2robot {__version__}\n")


def test_a_sentence_is_shown_tried_and_run(nl2robot, last_run, home, tmp_path) -> None:
    picture = tmp_path / "pictures" / "round.svg"
    status, out, err = nl2robot(
        *("run", "--world", "ward", "-y", "--picture", str(picture), "go to ward a and say hello")
    )
    assert (status, err) == (ExitStatus.OK, "")
    for part in (
        '1 robot.goto("ward a")',
        "In words: I will go to",
        "Dry run: It would take",
        "way: charger → corridor → ward a",
        "1 goto(place='ward a')",
        "2 say(text='Hello!')",
    ):
        assert part in out
    assert out.rstrip().endswith(f"I said “Hello!” here: ward a.\nPicture: {picture}")
    assert picture.read_text().startswith("<svg")
    row, calls = last_run()
    assert (row.approved_by, row.status, row.message) == ("Nurse Kim", "done", None)
    assert [call.method for call in calls] == ["goto", "say"]
    status, out, _ = nl2robot("log", "1")
    assert status == ExitStatus.OK
    assert "go to ward a and say hello" in out
    assert str(home / "pictures" / "run-1.svg") in out


def test_a_run_that_fails_says_so(nl2robot, tmp_path) -> None:
    (tmp_path / "grab.py").write_text('robot.grab("unicorn")\n')
    program = ("run", "--world", "ward", "-y", "--program", str(tmp_path / "grab.py"))
    status, out, _ = nl2robot(*program)
    assert status == ExitStatus.FAILED
    assert "It would fail at line 1" in out
    assert "The robot could not finish." in out


# --- Ctrl-C, kill, a terminal that is closed -----------------------------------------------------


@pytest.mark.parametrize("number", INTERRUPTS, ids=lambda number: number.name)
def test_an_interrupt_stops_the_robot_on_its_way(start, last_run, number) -> None:
    command = start(*ROUND, "--yes", at_terminal=True)
    command.until("goto(place='ward a')")
    command.kill(number)
    assert command.end() == ExitStatus.INTERRUPTED
    assert "Stopped." in command.output
    assert "Traceback" not in command.output
    row, calls = last_run()
    assert row.status == "stopped"
    assert [(call.method, call.error is not None) for call in calls] == [("goto", True)]


@pytest.mark.parametrize("number", INTERRUPTS[:2], ids=lambda number: number.name)
def test_an_interrupt_at_the_question_runs_nothing(start, last_run, number) -> None:
    command = start(*ROUND, at_terminal=True)
    command.until("eject? ")
    command.interrupt(number)
    assert command.end() == ExitStatus.INTERRUPTED
    assert "Traceback" not in command.output
    assert last_run() == (None, [])


@pytest.mark.parametrize("said", ["Program", "way:"])
def test_ctrl_c_in_between_leaves_nothing_behind(start, last_run, said) -> None:
    command = start(*ROUND, "--yes", at_terminal=True)
    command.until(said)
    command.kill(signal.SIGINT)
    assert command.end() == ExitStatus.INTERRUPTED
    assert "Traceback" not in command.output
    row, _ = last_run()
    assert row is None or row.status == "stopped"


def test_impatient_ctrl_c_ends_at_once(start) -> None:
    command = start(*ROUND, "--yes", at_terminal=True)
    command.until("goto(place='ward a')")
    for _ in range(5):
        command.kill(signal.SIGINT)
    # A signal while Python itself is ending is the death by that signal, as for any program.
    assert command.end() in (ExitStatus.INTERRUPTED, -signal.SIGINT)
    assert "Traceback" not in command.output


def test_ctrl_c_while_a_picture_is_drawn(start, tmp_path) -> None:
    film = ("--yes", "--picture", str(tmp_path / "film.webp"))
    command = start("run", "--world", "ward", *film, "go to ward b", at_terminal=True)
    command.until("Done.")
    command.kill(signal.SIGINT)
    assert command.end() in (ExitStatus.INTERRUPTED, ExitStatus.OK)
    assert "Traceback" not in command.output


def test_a_killed_run_reads_interrupted(start, nl2robot, last_run) -> None:
    command = start(*ROUND, "--yes", at_terminal=True)
    command.until("goto(place='ward a')")
    os.kill(command.process.pid, signal.SIGKILL)
    command.end()
    row, [call] = last_run()
    assert (row.status, call.seconds) == (None, None)
    status, out, _ = nl2robot("log", str(row.id))
    assert status == ExitStatus.OK
    assert "interrupted" in out
    assert "never came back" in out
