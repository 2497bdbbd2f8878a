"""A stop is told to be one only if the robot has confirmed it; and a guard when we are gone."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from robot_api.errors import StopNotConfirmed
from robot_api.robots.ros.settings import RosSettings
from robot_api.robots.ros.wire import Where, Wire
from tests.robots.ros.stand_in import HEARTBEAT, StandIn
from tests.robots.ros.ward import Heard, Under, call, connected

both = pytest.mark.parametrize("version", [1, 2])


@both
def test_a_robot_that_stands_confirms_it(version) -> None:
    with StandIn(version) as robot, connected(robot) as driver:
        assert driver.capabilities().stop_within == 2.0
        driver.stop("Just to be sure.")
        call(driver, "stop")


@both
def test_a_stop_is_not_confirmed_by_what_was_said_before_the_robot_heard_it(version) -> None:
    """Over a slow network: it stands already, and says so all the time."""
    with StandIn(version) as robot, connected(robot) as driver:
        call(driver, "wait", seconds=0.5)  # what is advertised is then known
        robot.faults.hears_after = 0.7
        driver.stop("Just to be sure.")
        assert robot.heard("/cmd_vel")


@both
def test_the_stop_returns_when_it_stands_and_not_before(version) -> None:
    with StandIn(version, speed=1.5) as robot, connected(robot) as driver:
        robot.body.braking = 3.0  # half a second to stand
        Under(driver, "goto", place="far end")
        robot.until(lambda: robot.body.speed > 1.4)
        began = time.monotonic()
        driver.stop("The nurse said stop.")
        assert robot.stands
        assert 0.3 < time.monotonic() - began < 2.0


@both
def test_a_robot_that_drives_on_has_not_confirmed(version) -> None:
    settings = RosSettings(stop_within=0.5)
    with StandIn(version, speed=0.5) as robot, connected(robot, settings) as driver:
        heard = Heard(driver)
        under_way = Under(driver, "goto", place="far end")
        robot.until(lambda: robot.body.speed > 0.3)
        robot.faults.runs_away = True
        began = time.monotonic()
        with pytest.raises(StopNotConfirmed, match="Use the robot's own button"):
            driver.stop("The nurse said stop.")
        assert time.monotonic() - began < 1.0
        assert not heard.of("stopped")
        assert type(under_way.ended(1)).__name__ == "Stopped"  # the program ends all the same


@pytest.mark.parametrize("fault", ["no_odometry", "nan_odometry", "mute", "nonsense"])
def test_who_says_nothing_that_can_be_understood_has_not_confirmed(fault) -> None:
    settings = RosSettings(stop_within=0.3)
    with StandIn() as robot, connected(robot, settings) as driver:
        setattr(robot.faults, fault, True)
        with pytest.raises(StopNotConfirmed):
            driver.stop("The nurse said stop.")


def test_a_goal_that_is_heard_of_after_the_stop_is_cancelled_again() -> None:
    """The goal came to the robot later than the cancel."""
    with StandIn(speed=0.5) as robot, connected(robot) as driver:
        under_way = Under(driver, "goto", place="far end")
        robot.until(lambda: robot.body.x > 0.05)
        goal = robot.goal
        driver.stop("The nurse said stop.")
        assert type(under_way.ended(1)).__name__ == "Stopped"

        def late() -> None:
            robot.goal = goal

        # Its result is out, so nothing is known of it any more but by a stop.
        robot.at_the_robot(late)
        robot.until(lambda: robot.body.speed > 0.1)
        driver.stop("Once more.")
        assert robot.stands and robot.goal is None


@both
def test_a_stop_while_it_is_lost_is_not_confirmed_and_is_the_first_that_it_hears(version) -> None:
    with StandIn(version, speed=0.5) as robot, connected(robot) as driver:
        heard = Heard(driver)
        Under(driver, "goto", place="far end")
        robot.until(lambda: robot.body.x > 0.05)
        robot.cut()
        began = time.monotonic()
        with pytest.raises(StopNotConfirmed):
            driver.stop("The nurse said stop.")
        assert time.monotonic() - began < 0.5
        assert not robot.stands
        robot.mend()
        heard.wait(lambda: [data["state"] for data in heard.of("link")] == ["lost", "connected"])
        robot.until(lambda: robot.stands and robot.goal is None)


def test_while_it_is_connected_its_heart_is_heard_and_then_a_goodbye() -> None:
    with StandIn() as robot:
        with connected(robot):
            robot.until(lambda: len(robot.heartbeats) > 3)
            assert set(robot.heartbeats) == {"here"}
        robot.until(lambda: robot.heartbeats[-1] == "bye")
        robot.until(lambda: robot.connections == 0)


# --- the guard on the robot ----------------------------------------------------------------------


@contextmanager
def guarded(robot: StandIn) -> Iterator[None]:
    command = [sys.executable, "-m", "robot_api.robots.ros.guard"]
    guard = subprocess.Popen([*command, f"ros{robot.version}://127.0.0.1:{robot.port}"])
    try:
        robot.until(lambda: robot.listens(HEARTBEAT), within=30)
        yield
    finally:
        guard.terminate()
        guard.wait(10)


@both
def test_the_guard_stops_the_robot_when_the_server_is_gone(version) -> None:
    with StandIn(version, speed=0.5) as robot, guarded(robot), connected(robot) as driver:
        Under(driver, "goto", place="far end")
        robot.until(lambda: robot.body.x > 0.2)
        robot.cut_off_from_outside()
        robot.until(lambda: robot.stands and robot.goal is None, within=5)
        assert robot.body.x < 5


@both
def test_the_guard_stops_it_when_its_rosbridge_is_there_again(version) -> None:
    with StandIn(version, speed=0.5) as robot, guarded(robot):
        server = Wire.open(Where("127.0.0.1", robot.port))
        server.advertise(HEARTBEAT, robot.kind("std_msgs/String"))
        server.publish(HEARTBEAT, {"data": "here"})
        robot.until(lambda: robot.heartbeats)
        robot.at_the_robot(lambda: robot.pursue(30, 0))
        robot.cut()
        robot.until(lambda: robot.body.x > 0.2)
        robot.mend()
        robot.until(lambda: robot.stands and robot.goal is None, within=20)
        assert robot.body.x < 15


def test_the_guard_lets_a_robot_be_that_was_left_with_a_goodbye() -> None:
    with StandIn(speed=0.5) as robot, guarded(robot):
        with connected(robot):
            robot.until(lambda: robot.heartbeats)
        robot.until(lambda: robot.heartbeats[-1] == "bye")
        published = len(robot.published)
        time.sleep(2)  # longer than its patience: that nothing comes is what is looked for
        assert len(robot.published) == published
