"""A logged run can be lived through again: same branches, same way, same end."""

import contextlib
import json
import sqlite3
from datetime import datetime

import pytest

from nl2robot.errors import ExitStatus
from nl2robot.run.going_on import recall_of
from nl2robot.run.replay import Replay, replay
from nl2robot.run.runlog import Run, RunLog
from sim.simulation import Simulation
from sim.world.builtin import BUILTIN
from sim.world.loading import load_world
from tests.nl2robot.test_pausing import Watching
from tests.nl2robot.test_runner import start

ASKING = """\
robot.goto("ward a")
place = robot.ask("Where to?", ["ward a", "ward b"], person="Alice")
robot.goto("ward b" if place == "ward a" else "corridor")
"""


@pytest.fixture
def run(operator, log):
    """Run a program; returns its row in the log."""

    def run(program: str) -> Run:
        number = start(operator, program)
        operator.wait(number)
        row = log.run(number)
        assert row is not None
        return row

    return run


def again(log: RunLog, row: Run, seed: int | None = None) -> tuple[Replay, Simulation]:
    """Replay it in a fresh simulation."""
    assert row.world is not None
    simulation = Simulation(load_world(row.world), seed=row.seed if seed is None else seed)
    recall = recall_of(log, row.continues)
    calls, nobody = log.calls(row.id), lambda line, method, given: None
    return replay(row, calls, simulation, nobody, recall), simulation


def test_a_run_comes_out_the_same(run, log, station) -> None:
    row = run(ASKING)
    told, simulation = again(log, row)
    assert (told.status, told.message, told.differences) == ("done", None, ())
    assert simulation.robot.place == station.simulation.robot.place


def test_it_begins_at_the_time_of_day_of_the_run(run, log, station) -> None:
    station.simulation.set_clock(datetime(2026, 11, 30, 21, 5))
    row = run('robot.goto("ward b" if robot.clock().time >= "21:00" else "ward a")\n')
    told, simulation = again(log, row)
    assert (told.status, told.differences) == ("done", ())
    assert simulation.robot.place == "ward b"
    assert f"{simulation.clock():%Y-%m-%d %H}" == "2026-11-30 21"


def test_what_people_said_comes_from_the_log(run, log) -> None:
    row = run(ASKING)
    with sqlite3.connect(log.path) as database:
        database.execute("UPDATE calls SET result = '\"ward a\"' WHERE method = 'ask'")
    told, simulation = again(log, row)
    assert told.status == "done"
    assert simulation.robot.place == "ward b"


def test_the_second_run_of_a_session_starts_where_the_first_ended(run, log, station) -> None:
    run('robot.goto("ward b")\n')
    began = station.simulation.robot
    row = run('robot.move(0.5)\nrobot.goto("corridor")\n')
    told, simulation = again(log, row)
    assert told.differences == ()
    first = simulation.record.samples[0]
    assert (first.x, first.y) == pytest.approx((began.x, began.y), abs=0.01)


def test_the_same_numbers_are_drawn_again(run, log) -> None:
    row = run("import random\nrobot.wait(random.randint(1, 1000))\nrobot.turn(random.random())\n")
    calls = []
    simulation = Simulation(load_world("ward"), seed=row.seed)
    replay(row, log.calls(row.id), simulation, lambda line, method, given: calls.append(given))
    assert [str(given) for given in calls] == [
        call.arguments.replace('":', '": ').replace('"', "'") for call in log.calls(row.id)
    ]


def test_the_dry_run_draws_the_numbers_that_the_run_will(run, log, operator) -> None:
    program = "import random\nrobot.wait(random.randint(1, 60))\n"
    foreseen = operator.check(program).dry_run.seconds
    [call] = log.calls(run(program).id)
    assert json.loads(call.arguments)["seconds"] == pytest.approx(foreseen, abs=0.1)


def test_another_course_is_told(run, log) -> None:
    row = run('print(robot.count("person"))\nrobot.goto("ward a")\nrobot.sees("unicorn")\n')
    with sqlite3.connect(log.path) as database:
        database.execute("UPDATE calls SET result = 'true' WHERE method = 'sees'")
        database.execute("UPDATE calls SET error = 'Blocked: A bed.' WHERE method = 'goto'")
    told, _ = again(log, row)
    assert told.differences == (
        "Line 2: goto did not fail this time (Blocked: A bed.).",
        "Line 3: sees returned False this time, not true.",
    )


def test_a_failure_fails_again(run, log) -> None:
    row = run('robot.goto("ward a")\nrobot.grab("unicorn")\nrobot.dock()\n')
    told, _ = again(log, row)
    assert (told.status, told.differences) == ("failed", ())


def test_a_program_that_stops_itself_is_the_same_three_times(run, log, operator) -> None:
    program = 'robot.say("one")\nrobot.stop()\nrobot.say("two")\n'
    dry_run = operator.check(program).dry_run
    assert (dry_run.status, dry_run.line, dry_run.says) == ("stopped", 2, ("one",))
    row = run(program)
    assert (row.status, row.message) == ("stopped", dry_run.message)
    assert [call.method for call in log.calls(row.id)] == ["say", "stop"]
    told, _ = again(log, row)
    assert (told.status, told.message, told.differences) == ("stopped", row.message, ())


def test_a_run_that_was_broken_off_ends_at_the_same_call(slow_operator, log) -> None:
    begun = []
    slow_operator.watch(
        lambda kind, data: begun.append(data) if data["what"] == "call" else None, "program"
    )
    approval = slow_operator.approve(slow_operator.check('robot.wait(1)\nrobot.goto("ward b")\n'))
    number = slow_operator.run(approval)
    slow_operator.stop()
    slow_operator.wait(number)
    row = log.run(number)
    told, simulation = again(log, row)
    assert (told.status, told.differences) == ("stopped", ())
    assert simulation.robot.place == "charger"


def test_a_killed_run_ends_where_it_was_killed(run, log) -> None:
    row = run('robot.goto("ward a")\nrobot.goto("ward b")\n')
    with sqlite3.connect(log.path) as database:
        database.execute("UPDATE runs SET status = NULL, finished = NULL")
        database.execute("UPDATE calls SET seconds = NULL, result = NULL WHERE number = 2")
    told, simulation = again(log, log.run(row.id))
    assert (told.status, told.message) == ("stopped", "The first run ended here.")
    assert simulation.robot.place == "ward a"


# --- from the command line -----------------------------------------------------------------------


def test_a_run_in_a_world_of_ones_own_is_found_from_anywhere(
    nl2robot, tmp_path, monkeypatch
) -> None:
    here, elsewhere = tmp_path / "here", tmp_path / "elsewhere"
    here.mkdir()
    elsewhere.mkdir()
    text = (BUILTIN / "ward.yaml").read_text(encoding="utf-8")
    (here / "mine.yaml").write_text(text.replace("name: ward\n", "name: mine\n"), encoding="utf-8")
    monkeypatch.chdir(here)
    assert nl2robot("run", "--world", "mine.yaml", "-y", "go to ward b")[0] == ExitStatus.OK
    monkeypatch.chdir(elsewhere)
    picture = elsewhere / "again.png"
    status, out, _ = nl2robot("log", "1", "--replay", "--picture", str(picture))
    assert status == ExitStatus.OK
    assert "goto(place='ward b')" in out
    assert "Every call came out as it did the first time." in out
    assert picture.read_bytes().startswith(b"\x89PNG")
    (here / "mine.yaml").unlink()
    status, _, err = nl2robot("log", "1", "--replay")
    assert status == ExitStatus.BAD_INPUT
    assert "mine.yaml: There is no such world" in err


def test_a_log_of_the_first_version_is_read_and_goes_on(nl2robot, home) -> None:
    go = ("run", "--world", "ward", "-y", "go to ward b")
    assert nl2robot(*go)[0] == ExitStatus.OK
    with contextlib.closing(sqlite3.connect(home / "runs.sqlite")) as database:
        database.execute("ALTER TABLE runs DROP COLUMN start")
        database.execute("PRAGMA user_version = 1")
    assert "go to ward b" in nl2robot("log")[1]
    assert nl2robot("log", "1", "--replay")[0] == ExitStatus.OK
    assert nl2robot(*go)[0] == ExitStatus.OK
    log = RunLog(home / "runs.sqlite")
    assert log.run(1).start is None
    assert log.run(2).start is not None
    log.close()


def test_what_was_paused_is_replayed_in_one_and_nothing_came_out_otherwise(
    slow_operator, log
) -> None:
    watch = Watching(slow_operator)
    run = start(slow_operator, 'robot.goto("ward b")\nrobot.move(0.5)\nrobot.say("Here.")\n')
    watch.until_fast()
    slow_operator.pause()
    watch.until_state("paused")
    slow_operator.resume()
    assert slow_operator.wait(run).state == "done"
    replayed, simulation = again(log, log.run(run))
    assert (replayed.status, replayed.differences) == ("done", ())
    assert simulation.robot.place == "ward b"


def test_what_went_on_after_a_stop_is_replayed_from_there(slow_operator, log) -> None:
    program = 'robot.say("I begin.")\nrobot.goto("ward b")\nrobot.say("Here.")\n'
    watch = Watching(slow_operator)
    first = start(slow_operator, program)
    watch.until_fast()
    slow_operator.stop()
    slow_operator.wait(first)
    rest = slow_operator.check(program, "en", first)
    second = slow_operator.run(slow_operator.approve(rest, continues=first))
    assert slow_operator.wait(second).state == "done"
    replayed, _ = again(log, log.run(second))
    assert (replayed.status, replayed.differences) == ("done", ())
