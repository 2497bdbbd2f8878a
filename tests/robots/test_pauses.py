"""A nurse pauses a real robot: it stands, and going on brings it to its goal, on every wire.

The runner is ours; the robot is a stand-in that speaks the wire of its maker.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import pytest

from nl2robot.cli.operator import Operator
from nl2robot.run.runlog import RunLog
from nl2robot.station.station import robot_station
from robot_api.driver import Driver
from robot_api.robots.ros.settings import RosSettings
from tests.robots.errand import PLACES, ward_in
from tests.robots.ros.stand_in import StandIn as RosStandIn
from tests.robots.ros.ward import connected

Pose = tuple[float, float, float]


class Robot:
    """A stand-in, as these stories see it."""

    def __init__(self, driver: Driver, pose: Callable[[], Pose], stands: Callable[[], bool]):
        self.driver, self.pose, self.stands = driver, pose, stands
        self.cut: Callable[[], None] | None = None
        self.mend: Callable[[], None] | None = None


@contextmanager
def ros(version: int) -> Iterator[Robot]:
    with (
        RosStandIn(version, speed=0.8) as robot,
        connected(robot, RosSettings(speed=0.5), places=PLACES) as driver,
    ):
        body = robot.body
        ours = Robot(
            driver,
            lambda: (body.x, body.y, math.degrees(body.theta)),
            lambda: robot.stands and robot.goal is None,
        )
        ours.cut, ours.mend = robot.cut, robot.mend
        yield ours


@contextmanager
def pepper() -> Iterator[Robot]:
    pytest.importorskip("qi", reason="qi has no wheel for this Python")
    from robot_api.robots.address import parse
    from robot_api.robots.pepper import PepperSettings
    from robot_api.robots.pepper.driver import connect
    from robot_api.robots.places import Places
    from robot_api.robots.registry import Setup
    from robot_api.robots.robot_file import RobotFile
    from tests.robots.pepper.conftest import MAP, StandIn

    robot = StandIn(hurry=2.0)
    where = parse(f"pepper://127.0.0.1:{robot.port}")
    settings = PepperSettings(map=MAP)
    driver = connect(
        Setup(address=where, file=RobotFile(), settings=settings, places=Places(PLACES))
    )
    try:
        yield Robot(
            driver,
            lambda: (robot.pose[0], robot.pose[1], math.degrees(robot.pose[2])),
            lambda: robot.speed < 0.001,
        )
    finally:
        driver.close()
        robot.close()


KINDS: dict[str, Callable[[], Any]] = {
    "ros2": lambda: ros(2),
    "ros1": lambda: ros(1),
    "pepper": pepper,
}


class Ward:
    """The robot, and a nurse at the station that it is connected with."""

    def __init__(self, robot: Robot, nurse: Operator, log: RunLog) -> None:
        self.robot, self.nurse, self.log = robot, nurse, log

    def begin(self, program: str, continues: int | None = None) -> int:
        """Somebody may stand in the way of the dry run, in the simulation."""
        review = self.nurse.check(program, "en", continues)
        approval = self.nurse.approve(review, continues=continues, insists=True)
        return self.nurse.run(approval)

    def until(self, true: Callable[[], Any], within: float = 20.0) -> None:
        ends = time.monotonic() + within
        while not true():
            assert time.monotonic() < ends, f"not within {within} s: {self.nurse.state()}"
            time.sleep(0.01)

    def gone(self) -> float:
        x, y, _ = self.robot.pose()
        return math.hypot(x, y)

    def pause(self) -> None:
        self.nurse.pause()
        self.until(lambda: self.nurse.state() == "paused")
        # The robot and its server share this machine; where it is busy, word comes late.
        self.until(self.robot.stands, within=1.0)
        before = self.robot.pose()
        self.nurse.robot.wait(0.3)
        assert self.robot.pose() == pytest.approx(before, abs=0.001)

    def go_on(self, run: int) -> None:
        self.nurse.resume()
        status = self.nurse.wait(run)
        assert (status.state, status.message) == ("done", None)

    def ends(self, run: int) -> list[tuple[str, str]]:
        """Each call with how it ended."""
        return [(c.method, (c.error or "").split(":")[0]) for c in self.log.calls(run)]


@pytest.fixture(params=KINDS)
def ward(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Ward]:
    with ExitStack() as leave:
        robot = leave.enter_context(KINDS[request.param]())
        log = RunLog(tmp_path / "runs.sqlite")
        leave.callback(log.close)
        station, _ = leave.enter_context(robot_station(robot.driver, ward_in(tmp_path), log))
        nurse = Operator(leave.enter_context(station.connect()), "Nurse Kim")
        yield Ward(robot, nurse, log)


def test_a_robot_on_its_way_is_paused_and_comes_to_its_goal(ward: Ward) -> None:
    run = ward.begin('robot.goto("pharmacy")\nrobot.say("Here I am.")\n')
    ward.until(lambda: ward.gone() > 0.4)
    ward.pause()
    assert ward.gone() < 3
    ward.go_on(run)
    x, y, _ = ward.robot.pose()
    assert math.hypot(x - 3, y - 2) < 0.2
    assert ward.ends(run) == [("goto", "Paused"), ("goto", ""), ("say", "")]


@pytest.mark.parametrize("metres", [1.5, -1.5])
def test_of_a_move_only_the_rest_is_made(ward: Ward, metres: float) -> None:
    run = ward.begin(f"robot.move({metres})\n")
    ward.until(lambda: ward.gone() > 0.3)
    ward.pause()
    ward.go_on(run)
    assert ward.robot.pose() == pytest.approx((metres, 0, 0), abs=0.2)
    assert ward.ends(run) == [("move", "Paused"), ("move", "")]


def test_of_a_turn_only_the_rest_is_made(ward: Ward) -> None:
    run = ward.begin("robot.turn(135)\n")
    ward.until(lambda: ward.robot.pose()[2] > 30)
    ward.pause()
    ward.go_on(run)
    assert ward.robot.pose()[2] == pytest.approx(135, abs=12)
    assert ward.ends(run) == [("turn", "Paused"), ("turn", "")]


def test_of_a_drive_only_the_rest_is_made(ward: Ward) -> None:
    run = ward.begin("robot.drive(0.3, 0, 4)\n")
    ward.until(lambda: ward.gone() > 0.4)
    ward.pause()
    ward.go_on(run)
    assert ward.robot.pose() == pytest.approx((1.2, 0, 0), abs=0.2)


def test_after_a_stop_only_the_rest_of_a_move_is_made(ward: Ward) -> None:
    run = ward.begin("robot.move(1.5)\n")
    ward.until(lambda: ward.gone() > 0.3)
    ward.nurse.stop()
    assert ward.nurse.wait(run).state == "stopped"
    left = ward.nurse.unfinished()
    assert left is not None
    assert "only the rest of it is left" in left.told[-1]
    again = ward.begin(left.program, left.run)
    assert ward.nurse.wait(again).state == "done"
    assert ward.robot.pose() == pytest.approx((1.5, 0, 0), abs=0.2)


@pytest.mark.parametrize("ward", ["ros2", "ros1"], indirect=True)
def test_a_robot_that_was_lost_in_a_move_does_not_make_all_of_it_again(ward: Ward) -> None:
    assert ward.robot.cut is not None and ward.robot.mend is not None
    run = ward.begin("robot.move(1.5)\n")
    ward.until(lambda: ward.gone() > 0.4)
    ward.robot.cut()
    assert ward.nurse.wait(run).error == "LostConnection"
    ward.robot.mend()
    ward.until(lambda: ward.nurse.state() == "stopped" and ward.robot.stands())
    left = ward.nurse.unfinished()
    assert left is not None
    assert "only the rest of it is left" in left.told[1]
    kept = ward.log.run(run)
    assert kept is not None and kept.stood is not None
