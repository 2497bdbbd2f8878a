"""A porter with wheels: moves and turns end by odometry, and every fault of it ends in a stop."""

from __future__ import annotations

import itertools
import math

import pytest

from robot_api.errors import Blocked, NotPossible, Stopped
from robot_api.robots.robot_file import Limits, RobotFile
from robot_api.robots.ros.settings import RosSettings
from tests.robots.ros.stand_in import StandIn
from tests.robots.ros.ward import Heard, Under, call, connected

both = pytest.mark.parametrize("version", [1, 2])


@both
@pytest.mark.parametrize("stamped", [False, True])
def test_it_moves_as_far_as_it_is_told_whichever_twist_it_takes(version, stamped) -> None:
    with StandIn(version, stamped=stamped) as robot, connected(robot) as driver:
        call(driver, "move", metres=0.4)
        assert robot.body.x == pytest.approx(0.4, abs=0.05)
        call(driver, "move", metres=-0.2)
        assert robot.body.x == pytest.approx(0.2, abs=0.05)
        assert robot.stands


@both
def test_it_turns_left_and_right_and_more_than_once_round(version) -> None:
    with StandIn(version) as robot, connected(robot, RosSettings(turn_rate=120)) as driver:
        call(driver, "turn", degrees=90)
        assert math.degrees(robot.body.theta) == pytest.approx(90, abs=6)
        call(driver, "turn", degrees=-400)
        assert math.degrees(robot.body.theta) == pytest.approx(50, abs=12)
        assert robot.stands


def test_a_velocity_is_repeated_at_least_ten_times_a_second_and_ends_with_zero() -> None:
    with StandIn() as robot, connected(robot) as driver:
        call(driver, "drive", linear=0.2, angular=0, seconds=1)
        sent = [message["linear"]["x"] for message in robot.heard("/cmd_vel")]
        assert len(sent) >= 10
        assert sent[-1] == 0.0
        assert max(sent) == pytest.approx(0.2)


def test_the_limits_of_its_file_are_held_on_the_wire() -> None:
    file = RobotFile(limits=Limits(speed=0.2, acceleration=0.4, turn_rate=20))
    with StandIn() as robot, connected(robot, file=file) as driver:
        call(driver, "drive", linear=2, angular=180, seconds=1)
        sent = robot.heard("/cmd_vel")
        assert max(message["linear"]["x"] for message in sent) <= 0.2
        assert max(message["angular"]["z"] for message in sent) <= math.radians(20)
        steps = [message["linear"]["x"] for message in sent]
        rises = [after - before for before, after in itertools.pairwise(steps)]
        assert max(rises) <= 0.4 * 0.05 + 1e-9


def test_without_a_word_from_its_odometry_it_does_not_drive_on() -> None:
    with StandIn() as robot, connected(robot) as driver:
        under_way = Under(driver, "move", metres=50)
        robot.until(lambda: robot.body.speed > 0.1)
        robot.faults.no_odometry = True
        error = under_way.ended()
        assert isinstance(error, NotPossible)
        assert "do not tell how far I have come" in str(error)
        robot.until(lambda: robot.stands)


def test_odometry_that_is_no_number_counts_as_none() -> None:
    with StandIn() as robot, connected(robot) as driver:
        under_way = Under(driver, "turn", degrees=3600)
        robot.until(lambda: robot.body.turning > 0.1)
        robot.faults.nan_odometry = True
        error = under_way.ended()
        assert isinstance(error, NotPossible)
        assert "tell nonsense" in str(error)
        robot.until(lambda: robot.stands)


@pytest.mark.parametrize(
    ("method", "arguments", "kind"),
    [
        ("move", {"metres": 5}, Blocked),
        ("drive", {"linear": 0.3, "angular": 0, "seconds": 30}, Blocked),
        ("turn", {"degrees": 90}, NotPossible),
    ],
)
def test_wheels_that_are_held_end_the_movement_with_a_sentence(method, arguments, kind) -> None:
    with StandIn() as robot, connected(robot) as driver:
        robot.faults.frozen = True
        error = Under(driver, method, **arguments).ended()
        assert type(error) is kind
        assert "do not move" in str(error)
        robot.until(lambda: robot.heard("/cmd_vel")[-1]["linear"]["x"] == 0.0)


@both
def test_a_stop_ends_a_movement_at_once(version) -> None:
    with StandIn(version) as robot, connected(robot) as driver:
        under_way = Under(driver, "drive", linear=0.5, angular=20, seconds=60)
        robot.until(lambda: robot.body.speed > 0.2)
        driver.stop("The nurse said stop.")
        assert robot.stands
        assert isinstance(under_way.ended(0.5), Stopped)


def test_cut_off_in_a_movement_the_robots_own_time_limit_stops_it() -> None:
    with StandIn() as robot, connected(robot) as driver:
        heard = Heard(driver)
        under_way = Under(driver, "drive", linear=0.5, angular=0, seconds=60)
        robot.until(lambda: robot.body.speed > 0.2)
        robot.cut()
        assert type(under_way.ended(1)).__name__ == "LostConnection"
        robot.until(lambda: robot.stands, within=2)
        assert heard.of("link")[0]["state"] == "lost"


def test_a_base_without_odometry_is_not_offered() -> None:
    with StandIn(without=("/odom",)) as robot, connected(robot) as driver:
        methods = driver.capabilities().methods
        assert not {"drive", "move", "turn", "goto", "location"} & set(methods)
        assert "say" in methods
        driver.stop("Nothing can move.")
        assert any("no odometry" in line for line in call(driver, "log", lines=20))
