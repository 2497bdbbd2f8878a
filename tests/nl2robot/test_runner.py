"""Nothing runs that was not approved; what runs is in view, and stops at once."""

import os
import queue
import signal
import sqlite3
import threading
import time
from contextlib import closing
from pathlib import Path

import pytest

from nl2robot.cli.operator import Operator
from nl2robot.run.runlog import LogError
from robot_api.errors import AccessDenied, NotPossible, Stopped
from sandbox.execution import DIED
from sim.world.model import Zone
from tests.attacks.disasters import deleted, replaced, without_what_was_just_written
from tests.sandbox.ward import children

linux = pytest.mark.skipif(not Path("/proc").exists(), reason="looks at processes in /proc")

ROUND = 'robot.goto("ward a")\nrobot.say("Good night.")\nrobot.goto("ward b")\n'
ENDLESS = 'while True:\n    robot.goto("ward a")\n    robot.goto("ward b")\n'


def start(operator, program: str) -> int:
    """As somebody does who wants it run whatever came of it when it was tried."""
    review = operator.check(program)
    return operator.run(operator.approve(review, insists=not review.came_through))


class Watch:
    """The events of a run as they come."""

    def __init__(self, operator) -> None:
        self.events = queue.SimpleQueue()
        self.seen = []
        operator.watch(lambda kind, data: self.events.put((kind, data)), "program", "speech")

    def until(self, fits, seconds: float = 20.0):
        ends = time.monotonic() + seconds
        while True:
            kind, data = self.events.get(timeout=max(0.01, ends - time.monotonic()))
            self.seen.append((kind, data))
            if fits(kind, data):
                return data


def what(name: str, **expected):
    def fits(kind, data) -> bool:
        return (
            kind == "program"
            and data["what"] == name
            and all(data.get(key) == value for key, value in expected.items())
        )

    return fits


def test_an_approved_round_is_made_and_logged(operator, log, station) -> None:
    status = operator.wait(start(operator, ROUND))
    assert status.state == "done"
    [row] = log.runs()
    assert (row.approved_by, row.status, row.world) == ("Nurse Kim", "done", "ward")
    assert [(c.method, c.line, c.error) for c in log.calls(row.id)] == [
        ("goto", 1, None),
        ("say", 2, None),
        ("goto", 3, None),
    ]
    assert station.simulation.robot.place == "ward b"


def test_nothing_runs_without_an_approval(operator, station) -> None:
    before = station.simulation.robot
    with pytest.raises(AccessDenied, match="no approval"):
        operator.robot.request("program.run", {"approval": "made up"})
    assert station.simulation.robot == before


def test_an_edit_voids_the_approval(operator) -> None:
    review = operator.check(ROUND)
    with pytest.raises(AccessDenied, match="changed after its review"):
        operator.robot.request(
            "program.approve",
            {"program": ROUND + "robot.dock()\n", "sha256": review.sha256, "by": "Nurse Kim"},
        )


def test_an_approval_is_good_for_ten_minutes(operator, monkeypatch) -> None:
    approval = operator.approve(operator.check('robot.say("Good morning.")\n'))
    later = time.monotonic() + 601
    monkeypatch.setattr("nl2robot.run.runner.time.monotonic", lambda: later)
    with pytest.raises(AccessDenied, match="no approval that is still good"):
        operator.run(approval)


def test_an_approval_ends_with_the_connection_over_which_it_was_given(station, monkeypatch) -> None:
    noticed, left = threading.Event(), station.server._on_left
    monkeypatch.setattr(
        station.server, "_on_left", lambda connection: (left(connection), noticed.set())
    )
    with station.connect() as robot:
        first = Operator(robot, "Nurse Kim")
        approval = first.approve(first.check('robot.say("Good morning.")\n'))
    with station.connect() as robot:
        second = Operator(robot, "Somebody")
        assert noticed.wait(20)
        with pytest.raises(AccessDenied, match="no approval that is still good"):
            second.run(approval)


def test_an_approval_is_good_for_one_run(operator) -> None:
    approval = operator.approve(operator.check('robot.say("Once.")\n'))
    operator.wait(operator.run(approval))
    with pytest.raises(AccessDenied):
        operator.run(approval)


@pytest.mark.parametrize(
    ("program", "told"),
    [
        ("robot.fly()\n", "fly"),
        ('robot.goto("moon")\n', "moon"),
        ("import os\n", "os"),
        ("robot.goto(\n", "line 1"),
    ],
)
def test_what_the_review_refuses_cannot_be_approved(operator, program, told) -> None:
    review = operator.check(program)
    assert not review.acceptable
    assert review.dry_run is None
    with pytest.raises(AccessDenied, match="cannot be approved") as refusal:
        operator.approve(review)
    assert told in str(refusal.value)


def test_the_dry_run_tells_what_would_happen_and_moves_nothing(operator, station) -> None:
    before = station.simulation.robot
    dry_run = operator.check(ROUND).dry_run
    assert dry_run.status == "done"
    assert dry_run.says == ("Good night.",)
    assert dry_run.metres > 2
    assert {"ward a", "ward b"} <= set(dry_run.places)
    assert station.simulation.robot == before


def test_an_edited_program_is_read_as_it_stands(operator) -> None:
    lines = operator.check('for bed in range(3):\n    robot.say("Hello.")\n').reading
    assert [(told.line, told.depth) for told in lines] == [(1, 0), (2, 1)]
    assert "three times" in lines[0].text.lower()
    assert "Hello." in lines[1].text


def test_a_dry_run_of_an_endless_round_comes_back(operator) -> None:
    dry_run = operator.check(ENDLESS).dry_run
    assert dry_run.status == "unfinished"


def test_every_line_and_result_is_told_as_it_comes(operator) -> None:
    watch = Watch(operator)
    run = start(operator, 'print(robot.battery() > 5)\nrobot.say("Hello.")\n')
    watch.until(what("state", state="done", run=run))
    told = [(d["what"], d["line"]) for kind, d in watch.seen if kind == "program"]
    assert told.index(("line", 1)) < told.index(("result", 1)) < told.index(("line", 2))
    assert ("print", 1) in told
    assert any(kind == "speech" and d["text"] == "Hello." for kind, d in watch.seen)


def test_stop_ends_an_endless_round_at_once(slow_operator, slow_station, log) -> None:
    watch = Watch(slow_operator)
    run = start(slow_operator, ENDLESS)
    watch.until(what("call", method="goto"))
    slow_operator.stop()
    status = slow_operator.wait(run)
    assert status.state == "stopped"
    assert slow_station.simulation.robot.speed == 0
    assert log.run(run).status == "stopped"


def test_a_stop_by_anybody_ends_the_program(slow_operator, slow_station) -> None:
    watch = Watch(slow_operator)
    run = start(slow_operator, "while True:\n    try:\n        robot.wait(60)\n"
                               "    except Exception:\n        pass\n")  # fmt: skip
    watch.until(what("call", method="wait"))
    with slow_station.connect() as somebody_else:
        somebody_else.stop()
    assert slow_operator.wait(run).state == "stopped"


def test_stopping_the_program_breaks_off_what_the_robot_does(slow_operator, slow_station) -> None:
    watch = Watch(slow_operator)
    run = start(slow_operator, "robot.wait(3600)\n")
    watch.until(what("call", method="wait"))
    slow_operator.robot.request("program.stop")
    assert slow_operator.wait(run).state == "stopped"


def test_pause_step_and_resume(slow_operator) -> None:
    watch = Watch(slow_operator)
    request = slow_operator.robot.request
    run = start(
        slow_operator, 'for word in ["one", "two", "three", "four"]:\n    robot.say(word)\n'
    )
    watch.until(what("call", number=1))
    request("program.pause")
    watch.until(what("result", number=1))
    request("program.step")
    watch.until(what("result", number=2))
    watch.until(what("state", state="paused"))
    assert request("program.state")["state"] == "paused"
    assert request("station.state")["state"] == "paused"
    request("program.resume")
    watch.until(what("state", state="done", run=run))
    assert [d["number"] for k, d in watch.seen if what("call")(k, d)] == [1, 2, 3, 4]


def test_one_program_at_a_time(slow_operator) -> None:
    run = start(slow_operator, ENDLESS)
    with pytest.raises(NotPossible, match="Another program is running"):
        start(slow_operator, ROUND)
    slow_operator.stop()
    slow_operator.wait(run)
    assert slow_operator.wait(start(slow_operator, ROUND)).state == "done"


def test_nothing_is_approved_while_another_program_runs(slow_operator) -> None:
    run = start(slow_operator, ENDLESS)
    review = slow_operator.check(ROUND)
    with pytest.raises(NotPossible, match="Another program is running"):
        slow_operator.approve(review)
    slow_operator.stop()
    slow_operator.wait(run)
    slow_operator.approve(review)


def test_an_approved_program_goes_on_when_its_client_leaves(slow_station, sit_down) -> None:
    operator = sit_down(slow_station)
    watch = Watch(operator)
    run = start(operator, ROUND)
    watch.until(what("call", method="goto"))
    operator.robot.close()
    assert sit_down(slow_station).wait(run).state == "done"


def test_a_failure_is_told_with_its_line_and_can_be_caught(operator) -> None:
    status = operator.wait(start(operator, 'robot.say("Now.")\nrobot.grab("unicorn")\n'))
    assert (status.state, status.line) == ("failed", 2)
    assert "unicorn" in status.message
    program = (
        'try:\n    robot.grab("unicorn")\nexcept Exception:\n    robot.say("There is none.")\n'
    )
    assert operator.wait(start(operator, program)).state == "done"


def test_what_cannot_be_logged_is_not_done(operator, station, log, monkeypatch) -> None:
    def full(*_values, **_more) -> None:
        raise LogError("The run log cannot be used (database or disk is full).")

    monkeypatch.setattr(log, "call_begins", full)
    before = station.simulation.robot
    status = operator.wait(start(operator, ROUND))
    assert status.state == "stopped"
    assert "disk is full" in status.message
    assert station.simulation.robot.x == before.x


def emptied(path: Path) -> None:
    with path.open("r+b") as file:
        file.truncate(0)


@pytest.mark.parametrize("tampered", [emptied, deleted, without_what_was_just_written, replaced])
def test_what_goes_into_a_log_that_nobody_will_read_is_not_done(
    slow_operator, slow_station, log, tampered
) -> None:
    watch = Watch(slow_operator)
    run = start(slow_operator, 'robot.goto("ward b")\nrobot.say("There.")\n')
    watch.until(what("call", method="goto"))
    tampered(log.path)
    status = slow_operator.wait(run)
    assert status.state == "stopped" and "deleted, replaced or cut" in status.message
    assert not [data for kind, data in watch.seen if kind == "speech"]
    with pytest.raises(NotPossible, match="deleted, replaced or cut"):  # and no other run
        start(slow_operator, 'robot.say("Once more.")\n')


def test_a_run_ends_before_it_fills_the_disk(operator, monkeypatch) -> None:
    monkeypatch.setattr("nl2robot.run.performance.LETTERS_LOGGED", 100_000)
    page = 'while True:\n    robot.show(html="a" * 30000)\n'
    status = operator.wait(start(operator, page))
    assert status.state == "stopped" and "more than the log of one run holds" in status.message
    assert status.calls < 6


@linux
def test_a_robot_stands_when_its_program_is_killed(slow_operator, slow_station) -> None:
    before = children()
    watch = Watch(slow_operator)
    run = start(slow_operator, 'robot.goto("ward b")\n')
    watch.until(what("call", method="goto"))
    for each in children() - before:
        os.kill(each, signal.SIGKILL)
    status = slow_operator.wait(run)
    assert (status.state, status.message) == ("failed", DIED)
    assert slow_station.simulation.robot.place != "ward b"
    assert slow_station.simulation.robot.speed == 0


def test_nobody_else_moves_the_robot_while_a_program_runs(slow_operator, slow_station) -> None:
    watch = Watch(slow_operator)
    run = start(slow_operator, ENDLESS)
    watch.until(what("call", method="goto"))
    with slow_station.connect() as script:
        for call in (lambda: script.say("Hello."), lambda: script.goto("ward b"), script.dock):
            with pytest.raises(NotPossible, match="A program is running"):
                call()
        assert script.battery() > 0  # to look is free
        slow_operator.stop()
        slow_operator.wait(run)
        script.say("Hello.")


def test_what_somebody_does_by_hand_is_logged_or_not_done(station, log, monkeypatch) -> None:
    with station.connect() as script:
        script.say("Hello.")
        script.battery()  # to look is nothing
        [done] = log.done_by_hand()
        assert (done.who, done.method) == ("somebody", "say") and "Hello." in done.arguments

        def full(*values) -> None:
            raise LogError("The run log cannot be used (database or disk is full).")

        monkeypatch.setattr(log, "by_hand", full)
        before = station.simulation.robot
        with pytest.raises(NotPossible, match="disk is full"):
            script.goto("ward b")
        script.stop()  # which always is done
        assert station.simulation.robot.x == before.x


def test_two_operators_see_the_same_run(slow_station, sit_down) -> None:
    first, second = sit_down(slow_station), sit_down(slow_station)
    watch = Watch(second)
    run = start(first, ROUND)
    watch.until(what("state", state="done", run=run))
    assert first.wait(run) == second.wait(run)


def test_a_run_is_over_when_it_is_logged_and_the_next_one_may_begin(
    operator, log, monkeypatch
) -> None:
    end, states = log.end, []

    def slowly(*values) -> None:
        """As on a slow disk: somebody asks and presses pause meanwhile."""
        states.append(operator.robot.request("program.state")["state"])
        with pytest.raises(NotPossible):
            operator.robot.request("program.pause")
        end(*values)

    monkeypatch.setattr(log, "end", slowly)
    for _ in range(3):
        assert operator.wait(start(operator, "robot.battery()\n")).state == "done"
    assert states == ["running"] * 3
    assert operator.robot.request("program.state")["state"] == "done"


def test_where_it_looked_in_vain_is_told_in_the_language_of_who_approved_it(operator, log) -> None:
    review = operator.check('print(robot.find("unicorn"))\n')
    parameters = {"program": review.program, "sha256": review.sha256, "by": "Kim"}
    approval = operator.robot.request("program.approve", {**parameters, "language": "de"})
    run = operator.robot.request("program.run", {"approval": approval["id"]})
    assert operator.wait(run).state == "done"
    told = log.output(run)[0]
    assert told.startswith("Hier habe ich vergeblich gesucht: ")
    assert "ward a" in told or "Station" in told


def test_a_round_goes_on_when_a_place_is_closed_and_says_so(operator, station, log) -> None:
    place = station.simulation.world.place("ward b")
    x, y = place.pose.x, place.pose.y
    around = ((x - 1, y - 1), (x + 1, y - 1), (x + 1, y + 1), (x - 1, y + 1))
    station.simulation.set_zones((Zone(name="wet floor", polygon=around),))
    program = 'for place in ["ward b", "ward a"]:\n    robot.goto(place)\n    robot.say(place)\n'
    review = operator.check(program)
    assert review.dry_run.closed == ("ward b",)
    run = operator.run(operator.approve(review))
    assert operator.wait(run).state == "done"
    assert log.output(run)[0].startswith("ward b was closed to me. (")
    assert "wet floor" in log.output(run)[0]
    assert [call.method for call in log.calls(run)] == ["goto", "goto", "say"]


def test_who_stops_the_robot_waits_for_no_disk(slow_operator, slow_station, log) -> None:
    """Somebody else writes to the log just then, for as long as the log would wait for them."""
    watch = Watch(slow_operator)
    run = start(slow_operator, 'robot.goto("ward a")\nrobot.goto("ward b")\n')
    watch.until(what("call", number=1))
    with closing(sqlite3.connect(log.path, isolation_level=None)) as other:
        other.execute("BEGIN IMMEDIATE")
        began = time.monotonic()
        slow_operator.stop()
        assert time.monotonic() - began < 1
        assert slow_station.simulation.robot.speed == 0
        other.execute("ROLLBACK")
    assert slow_operator.wait(run).state == "stopped"
    assert log.states(run)[-1]["state"] == "stopping"


def test_a_program_that_is_stopped_before_its_first_line_was_stopped(
    operator, log, monkeypatch, recwarn
) -> None:
    def stopped(*_: object) -> None:
        raise Stopped("The nurse pressed stop.")

    monkeypatch.setattr("nl2robot.run.spoken_language.SpokenLanguage.adopt", stopped)
    status = operator.wait(start(operator, 'robot.say("Good morning.")\n'))
    assert (status.state, status.message) == ("stopped", "The nurse pressed stop.")
    assert log.run(status.run).status == "stopped" and not log.calls(status.run)
    assert not recwarn.list  # nobody reads a traceback of it


def test_who_hears_that_a_run_was_stopped_may_ask_why_at_once(
    slow_station, slow_operator, monkeypatch
) -> None:
    heard, asked = slow_station.note, []

    def note(run: int, state: str) -> bool:
        if state == "stopped":
            asked.append(slow_operator.robot.request("program.state")["message"])
        return heard(run, state)

    monkeypatch.setattr(slow_station, "note", note)
    run = start(slow_operator, ENDLESS)
    slow_operator.stop()
    slow_operator.wait(run)
    assert asked == ["The robot was stopped."]
