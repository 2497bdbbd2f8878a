"""A pause halts the wheels at once, and what was broken off goes on to its goal."""

import contextlib
import math
import threading

import pytest

from nl2robot.run import performance
from nl2robot.run.pausing import Odometer, comes_to_rest, rest_of
from nl2robot.run.runlog import RunLog
from nl2robot.station.station import robot_station, simulated_station
from robot_api.robots.wire import WireDriver
from robot_api.values import Location
from sim.world.loading import load_world
from tests.nl2robot.test_runner import Watch, start, what

DRIVE = 'robot.goto("ward a")\nrobot.goto("ward b")\n'


class Watching(Watch):
    """Hears of the present state, and where the robot is."""

    def __init__(self, operator) -> None:
        super().__init__(operator)
        operator.watch(lambda kind, data: self.events.put((kind, data)), "state", "pose")

    def until_state(self, name: str):
        return self.until(lambda kind, data: kind == "state" and data["state"] == name)

    def until_fast(self):
        return self.until(lambda kind, data: kind == "pose" and data["speed"] > 0.3)


def errors(log, run) -> list[tuple[str, str | None]]:
    return [(call.method, (call.error or "").split(":")[0]) for call in log.calls(run)]


def test_a_drive_is_halted_at_once_and_goes_on_to_its_goal(
    slow_operator, slow_station, log
) -> None:
    watch, request = Watching(slow_operator), slow_operator.robot.request
    run = start(slow_operator, DRIVE)
    watch.until_fast()
    assert request("program.pause")["state"] in ("pausing", "paused")
    watch.until_state("paused")
    robot = slow_station.simulation.robot
    assert robot.speed == 0 and robot.place != "ward a"
    slow_operator.robot.wait(2)  # simulated: it stays where it is
    now = slow_station.simulation.robot
    assert (now.x, now.y) == (robot.x, robot.y)
    assert request("program.resume")["state"] == "running"
    assert slow_operator.wait(run).state == "done"
    assert slow_station.simulation.robot.place == "ward b"
    assert errors(log, run) == [("goto", "Paused"), ("goto", ""), ("goto", "")]
    states = [each["state"] for each in log.states(run)]
    assert states == ["running", "pausing", "paused", "running"]


def test_a_drive_that_ends_by_itself_as_it_is_broken_off_leaves_a_paused_robot(
    slow_operator, monkeypatch
) -> None:
    """What breaks it off comes too late, whenever that is."""
    monkeypatch.setattr("robot_api.client.Robot.cancel", lambda self: None)
    watch, request = Watching(slow_operator), slow_operator.robot.request
    run = start(slow_operator, 'robot.goto("ward a")\nrobot.goto("ward b")\n')
    watch.until_fast()
    request("program.pause")
    watch.until_state("paused")
    assert request("program.state")["state"] == "paused"
    assert request("program.resume")["state"] == "running"
    assert slow_operator.wait(run).state == "done"


@pytest.mark.parametrize(
    ("program", "metres", "degrees"),
    [
        ("robot.move(2)\n", 2.0, 0.0),
        ("robot.turn(270)\n", 0.0, 270.0),
        ("robot.drive(0.3, 0, 5)\n", 1.5, 0.0),
        ("robot.drive(0, 40, 8)\n", 0.0, 320.0),
    ],
)
def test_of_a_measured_movement_only_the_rest_is_made(log, sit_down, program, metres, degrees):
    with simulated_station(load_world("ward"), log, seed=1, speed=4) as station:
        operator = sit_down(station)
        operator.robot.goto("corridor" if "corridor" in operator.robot.places() else "ward a")
        before = station.simulation.robot
        watch, request = Watching(operator), operator.robot.request
        run = start(operator, program)
        watch.until(what("call", number=1))
        watch.until(lambda kind, data: kind == "pose")
        watch.until(lambda kind, data: kind == "pose")
        request("program.pause")
        watch.until_state("paused")
        request("program.resume")
        assert operator.wait(run).state == "done"
        assert len(log.calls(run)) == 2
        after = station.simulation.robot
        gone = math.hypot(after.x - before.x, after.y - before.y)
        turned = (after.theta - before.theta - degrees + 180) % 360 - 180
        assert gone == pytest.approx(metres, abs=0.12)
        assert turned == pytest.approx(0, abs=6)


def test_a_sentence_may_end_while_the_robot_is_paused(slow_operator, log) -> None:
    watch, request = Watching(slow_operator), slow_operator.robot.request
    run = start(slow_operator, 'robot.say("Good morning to all of you.")\nrobot.goto("ward a")\n')
    watch.until(what("call", method="say"))
    request("program.pause")
    watch.until_state("paused")
    slow_operator.robot.wait(20)
    assert errors(log, run) == [("say", "")]
    request("program.resume")
    assert slow_operator.wait(run).state == "done"


def test_a_stop_wins_over_a_pause(slow_operator, slow_station, log) -> None:
    watch, request = Watching(slow_operator), slow_operator.robot.request
    run = start(slow_operator, DRIVE)
    watch.until_fast()
    request("program.pause")
    slow_operator.stop()
    assert slow_operator.wait(run).state == "stopped"
    assert request("station.state")["state"] == "stopped"
    assert slow_station.simulation.robot.speed == 0


def test_whoever_pauses_and_goes_on_in_haste_loses_nothing(slow_operator, slow_station) -> None:
    watch, request = Watching(slow_operator), slow_operator.robot.request
    run = start(slow_operator, DRIVE)
    watch.until_fast()
    for _ in range(5):
        request("program.pause")
        request("program.resume")
    assert slow_operator.wait(run).state == "done"
    assert slow_station.simulation.robot.place == "ward b"


def test_a_step_makes_the_rest_of_what_was_broken_off(slow_operator, slow_station) -> None:
    watch, request = Watching(slow_operator), slow_operator.robot.request
    run = start(slow_operator, DRIVE)
    watch.until_fast()
    request("program.pause")
    watch.until_state("paused")
    request("program.step")
    watch.until_state("running")
    watch.until_state("paused")
    assert slow_station.simulation.robot.place == "ward a"
    request("program.resume")
    assert slow_operator.wait(run).state == "done"


def test_whoever_looks_late_whether_the_robot_stands_stops_nothing(
    slow_operator, slow_station, monkeypatch
) -> None:
    """Two look: whoever broke the movement off, and whoever made it. The one has seen the robot
    stand and drives on when the other comes to look."""
    looks, drives = threading.Event(), threading.Event()
    rests = performance.comes_to_rest

    def comes_to_rest(robot, within, goes_on) -> bool:
        if threading.current_thread().name == "halt":
            looks.set()
            assert drives.wait(60)
            return rests(robot, 0.05, goes_on)
        assert looks.wait(60)
        return rests(robot, within, goes_on)

    monkeypatch.setattr("nl2robot.run.performance.comes_to_rest", comes_to_rest)
    watch, request = Watching(slow_operator), slow_operator.robot.request
    run = start(slow_operator, DRIVE)
    watch.until_fast()
    request("program.pause")
    watch.until_state("paused")
    request("program.resume")
    watch.until_fast()
    drives.set()
    assert slow_operator.wait(run).state == "done"
    assert slow_station.simulation.robot.place == "ward b"


def test_a_robot_at_another_server_is_paused_as_well(log, tmp_path, sit_down) -> None:
    """Its runner is here; the robot is reached over the wire."""
    there = RunLog(tmp_path / "there.sqlite")
    with contextlib.ExitStack() as leave:
        far = leave.enter_context(simulated_station(load_world("ward"), there, seed=1, speed=10))
        driver = WireDriver(far.address, far.token)
        here, _ = leave.enter_context(robot_station(driver, load_world("ward"), log))
        operator = sit_down(here)
        watch, request = Watching(operator), operator.robot.request
        run = start(operator, DRIVE)
        watch.until_fast()
        request("program.pause")
        watch.until_state("paused")
        assert far.simulation.robot.speed == 0
        request("program.resume")
        assert operator.wait(run).state == "done"
        assert far.simulation.robot.place == "ward b"
    there.close()


def test_a_robot_that_does_not_come_to_rest_is_stopped(
    slow_operator, slow_station, monkeypatch
) -> None:
    monkeypatch.setattr("nl2robot.run.performance.comes_to_rest", lambda *_: False)
    watch, request = Watching(slow_operator), slow_operator.robot.request
    run = start(slow_operator, DRIVE)
    watch.until_fast()
    request("program.pause")
    status = slow_operator.wait(run)
    assert status.state == "stopped"
    assert "did not come to rest" in status.message


def test_who_comes_late_is_told_the_present_state_first(slow_operator, slow_station, sit_down):
    watch = Watching(slow_operator)
    run = start(slow_operator, DRIVE)
    watch.until_state("running")
    told, first = threading.Event(), []

    def tell(kind, data) -> None:
        first.append(data)
        told.set()

    sit_down(slow_station).watch(tell, "state")
    assert told.wait(10)
    assert (first[0]["state"], first[0]["run"]) == ("running", run)
    slow_operator.stop()
    slow_operator.wait(run)
    assert slow_operator.robot.request("station.state")["sequence"] > first[0]["sequence"]


def test_a_robot_whose_radio_falters_is_not_taken_for_one_that_stands() -> None:
    """Twice it is told the pose from before, while it still rolls."""
    told = iter([0.0, 0.2, 0.2, 0.4, 0.5])

    class Rolling:
        x = 0.0

        def location(self) -> Location:
            self.x = next(told, 0.5)
            return Location(self.x, 0, 0)

    robot = Rolling()
    assert comes_to_rest(robot, 10, lambda: True)
    assert robot.x == 0.5


def pose(x: float, y: float, theta: float) -> dict[str, float]:
    return {"x": x, "y": y, "theta": theta}


def test_an_odometer_counts_backwards_and_round_and_round() -> None:
    odometer = Odometer(pose(0, 0, 170))
    for theta in (-170, -90, 0, 90, 170, -170):
        odometer.at(pose(0, 0, theta))
    assert odometer.made.degrees == pytest.approx(380)
    back = Odometer(pose(0, 0, 0))
    back.at(pose(-0.4, 0, 0))
    assert back.made.metres == pytest.approx(-0.4)
    assert rest_of("move", {"metres": -1.0}, back.made) == {"metres": -0.6}
    assert rest_of("move", {"metres": -0.41}, back.made) is None
    assert rest_of("drive", {"linear": 0.0, "angular": 0.0, "seconds": 2.0}, back.made) is not None
