"""A porter with a map: where it is, where it goes, and why it did not arrive, in words."""

from __future__ import annotations

import math

import pytest

from robot_api.errors import (
    Blocked,
    InvalidCall,
    LostConnection,
    NotPossible,
    Stopped,
    UnknownPlace,
)
from robot_api.robots.ros import navigation
from robot_api.robots.ros.settings import RosSettings, Topics
from tests.robots.ros.stand_in import StandIn
from tests.robots.ros.ward import Heard, Under, call, connected

both = pytest.mark.parametrize("version", [1, 2])


@both
def test_it_goes_to_a_place_by_name_or_alias_and_tells_where_it_is(version) -> None:
    with StandIn(version) as robot, connected(robot) as driver:
        heard = Heard(driver)
        call(driver, "goto", place="Drugstore")
        here = call(driver, "location")
        assert (here.place, here.theta) == ("pharmacy", pytest.approx(90, abs=3))
        assert (here.x, here.y) == (pytest.approx(4, abs=0.1), pytest.approx(3, abs=0.1))
        told = heard.of("pose")
        assert {"charger", "pharmacy"} <= {pose["place"] for pose in told}
        assert max(pose["speed"] for pose in told) > 1
        call(driver, "goto", x=1, y=1)
        assert call(driver, "location").place == "charger"  # which is near


def test_without_a_heading_it_faces_where_it_goes() -> None:
    with StandIn() as robot, connected(robot) as driver:
        call(driver, "goto", x=0, y=2)
        assert call(driver, "location").theta == pytest.approx(90, abs=3)


def test_a_place_that_is_not_on_the_map_is_refused_before_it_moves() -> None:
    with StandIn() as robot, connected(robot) as driver:
        with pytest.raises(UnknownPlace, match="Nobody has said where the attic is"):
            call(driver, "goto", place="attic")
        with pytest.raises(UnknownPlace, match="Did you mean the pharmacy"):
            call(driver, "goto", place="farmacy")
        with pytest.raises(NotPossible, match="outside my map"):
            call(driver, "goto", x=900, y=0)
        with pytest.raises(InvalidCall):
            call(driver, "goto", place={"x": math.nan, "y": 0})
        assert not robot.goals


@pytest.mark.parametrize(
    ("version", "code", "text", "kind", "words"),
    [
        (2, 208, "", Blocked, "found no way"),
        (2, 204, "", NotPossible, "outside my map"),
        (2, 105, "", Blocked, "could not get on"),
        (2, 207, "", NotPossible, "taken too long"),
        (2, 9999, "", Blocked, "given up on my way"),
        (1, 0, "Failed to find a valid plan. Even after executing", Blocked, "found no way"),
        (1, 0, "Robot is oscillating. Even after executing", Blocked, "could not get on"),
        (1, 0, "The sky fell down.", Blocked, r"given up on my way \(The sky fell down\)"),
    ],
)
def test_why_it_did_not_arrive_is_said_in_words(version, code, text, kind, words) -> None:
    with StandIn(version) as robot, connected(robot) as driver:
        robot.faults.aborts = code, text
        with pytest.raises(kind, match=words):
            call(driver, "goto", place="pharmacy")


@both
def test_a_goal_that_somebody_else_cancels_is_no_stop(version) -> None:
    with StandIn(version, speed=1.0) as robot, connected(robot) as driver:
        under_way = Under(driver, "goto", place="far end")
        robot.until(lambda: robot.body.x > 0.2)
        robot.at_the_robot(robot.cancel)
        error = under_way.ended()
        assert isinstance(error, NotPossible)
        assert "called me off" in str(error)


def test_a_robot_that_says_it_has_arrived_and_has_not_is_not_believed() -> None:
    with StandIn() as robot, connected(robot) as driver:
        robot.faults.lies = True
        with pytest.raises(NotPossible, match=r"I stand 5\.0 metres away"):
            call(driver, "goto", place="pharmacy")


def test_a_goal_that_nothing_comes_of_is_given_up(monkeypatch) -> None:
    monkeypatch.setattr(navigation, "_BEGINS_WITHIN", 0.5)
    with StandIn() as robot, connected(robot) as driver:
        robot.faults.silent_goals = True
        with pytest.raises(NotPossible, match="nothing has begun"):
            call(driver, "goto", place="pharmacy")
        robot.until(lambda: robot.goal is None)  # it was cancelled


def test_who_does_not_get_on_gives_up(monkeypatch) -> None:
    with StandIn() as robot, connected(robot, RosSettings(patience=0.5)) as driver:
        robot.faults.frozen = True
        with pytest.raises(Blocked, match="not got on"):
            call(driver, "goto", place="far end")
        robot.until(lambda: robot.goal is None)


def test_a_stop_is_felt_on_a_connection_that_a_goal_blocks() -> None:
    """By default, rosbridge hears nothing on it until the goal is reached."""
    with StandIn(speed=1.0) as robot, connected(robot) as driver:
        under_way = Under(driver, "goto", place="far end")
        robot.until(lambda: robot.body.x > 0.2)
        call(driver, "say", text="I am on my way.")
        assert call(driver, "location").x > 0.1
        driver.stop("The nurse said stop.")
        assert robot.stands and robot.goal is None
        assert isinstance(under_way.ended(0.5), Stopped)


def test_it_leads_the_way_and_asks_to_be_followed() -> None:
    with StandIn() as robot, connected(robot) as driver:
        heard = Heard(driver)
        call(driver, "guide", person="visitor", place="pharmacy")
        assert "follow me" in heard.of("speech")[0]["text"]
        assert call(driver, "location").place == "pharmacy"


# --- where it is ---------------------------------------------------------------------------------


def test_a_map_that_gives_nan_for_a_place_is_not_believed() -> None:
    with StandIn() as robot, connected(robot) as driver:
        robot.faults.nan_pose = True
        robot.until(lambda: _error(driver) is not None)
        error = _error(driver)
        assert isinstance(error, NotPossible)
        assert "a place that is none" in str(error)


def test_who_has_driven_far_since_it_knew_where_it_is_says_so() -> None:
    with StandIn() as robot, connected(robot, RosSettings(drift=0.3)) as driver:
        robot.unheard = "/amcl_pose"
        call(driver, "move", metres=0.5)
        with pytest.raises(NotPossible, match="since I last knew where I am"):
            call(driver, "location")


@both
def test_it_is_shown_where_it_is(version) -> None:
    with StandIn(version) as robot, connected(robot) as driver:
        call(driver, "localize", place="pharmacy")
        assert call(driver, "location").place == "pharmacy"
        assert (robot.body.x, robot.body.y) == (4, 3)


def test_a_robot_that_is_not_shown_where_it_is_has_no_localize() -> None:
    with StandIn(without=("/initialpose",)) as robot, connected(robot) as driver:
        assert "localize" not in driver.capabilities().methods
        assert "goto" in driver.capabilities().methods


def test_where_it_is_may_come_from_the_transforms() -> None:
    robot = StandIn(types={"/tf": "tf2_msgs/msg/TFMessage"}, start=(4.0, 3.0, 0.0))
    settings = RosSettings(topics=Topics(pose="/tf"))
    with robot, connected(robot, settings) as driver:
        assert call(driver, "location").place == "pharmacy"


def test_a_robot_that_is_mute_is_lost_within_the_time_that_is_said() -> None:
    with StandIn(speed=1.0) as robot, connected(robot, RosSettings(lost_after=1.0)) as driver:
        heard = Heard(driver)
        under_way = Under(driver, "goto", place="far end")
        robot.until(lambda: robot.body.x > 0.1)
        robot.faults.mute = True
        assert isinstance(under_way.ended(3), LostConnection)
        assert "not answered" in heard.of("link")[0]["because"]
        robot.faults.mute = False
        heard.wait(lambda: [data["state"] for data in heard.of("link")] == ["lost", "connected"])
        robot.until(lambda: robot.stands)  # a stop was the first that it heard


def test_a_robot_that_answers_late_is_not_lost() -> None:
    with StandIn() as robot, connected(robot) as driver:
        heard = Heard(driver)
        robot.faults.answers_after = 0.3
        call(driver, "goto", place="pharmacy")
        assert call(driver, "location").place == "pharmacy"
        assert not heard.of("link")


def _error(driver) -> BaseException | None:
    try:
        call(driver, "location")
    except NotPossible as error:
        return error
    return None
