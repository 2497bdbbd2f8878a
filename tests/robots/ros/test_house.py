"""The robot and the house: where it must not drive, and the map that it drives by."""

from __future__ import annotations

import math

import pytest

from robot_api.errors import Blocked, LostConnection, NotPossible, NotSupported
from robot_api.robots.address import parse
from robot_api.robots.places import Places
from robot_api.robots.ros import grid
from robot_api.robots.ros.dialect import Dialect
from robot_api.robots.ros.grid import fetch_map
from robot_api.robots.ros.keep_out import KeepOut
from tests.robots.ros.stand_in import StandIn, free_port
from tests.robots.ros.ward import WARD, Under, call, connected

both = pytest.mark.parametrize("version", [1, 2])
STAIRS = [(2.0, -1.0), (3.0, -1.0), (3.0, 1.0), (2.0, 1.0)]


@both
def test_a_goal_on_the_stairs_is_refused(version) -> None:
    with StandIn(version) as robot, connected(robot, keep_out=[STAIRS]) as driver:
        with pytest.raises(NotPossible, match="must not drive"):
            call(driver, "goto", x=2.5, y=0)
        assert not robot.goals


@both
def test_it_is_stopped_before_the_stairs_when_its_navigation_leads_there(version) -> None:
    with StandIn(version, speed=0.4) as robot, connected(robot, keep_out=[STAIRS]) as driver:
        error = Under(driver, "goto", place="far end").ended()
        assert isinstance(error, Blocked)
        assert "must not drive" in str(error)
        robot.until(lambda: robot.stands and robot.goal is None)
        assert 2.0 <= robot.body.x < 2.5


def test_it_is_stopped_when_somebody_drives_it_there() -> None:
    with StandIn(start=(1.6, 0, 0)) as robot, connected(robot, keep_out=[STAIRS]) as driver:
        error = Under(driver, "drive", linear=0.5, angular=0, seconds=20).ended()
        assert isinstance(error, Blocked)
        robot.until(lambda: robot.stands)
        assert robot.body.x < 2.4


def test_it_may_be_driven_out_of_it() -> None:
    with StandIn(start=(2.5, 0, 0)) as robot, connected(robot, keep_out=[STAIRS]) as driver:
        call(driver, "move", metres=0.8)
        assert robot.body.x > 3.2


def test_a_robot_with_a_filter_is_given_the_zones_as_a_mask() -> None:
    robot = StandIn(keep_out_filter=True)
    with robot, connected(robot, keep_out=[STAIRS]):
        robot.until(lambda: robot.heard("/costmap_filter_info"))
        (info,) = robot.heard("/costmap_filter_info")
        assert (info["type"], info["filter_mask_topic"]) == (0, "/keepout_filter_mask")
        (mask,) = robot.heard("/keepout_filter_mask")
        assert _at(mask, 2.5, 0.0) == 100
        assert _at(mask, 2.01, 0.99) == 100
        assert _at(mask, 1.85, 0.0) == 0
        robot.cut()
        robot.mend()
        robot.until(lambda: len(robot.heard("/costmap_filter_info")) == 2)


@both
def test_a_zone_that_is_drawn_while_it_is_driven_holds_at_once(version) -> None:
    known = Places(WARD)
    with StandIn(version) as robot, connected(robot, known=known) as driver:
        known.keep_out_of([STAIRS])
        with pytest.raises(NotPossible, match="must not drive"):
            call(driver, "goto", x=2.5, y=0)
        known.keep_out_of([])
        call(driver, "goto", x=2.5, y=0)


def test_the_mask_is_given_anew_when_zones_are_drawn() -> None:
    robot, known = StandIn(keep_out_filter=True), Places(WARD)
    with robot, connected(robot, known=known):
        assert not robot.heard("/keepout_filter_mask")
        known.keep_out_of([STAIRS])
        robot.until(lambda: robot.heard("/costmap_filter_info"))
        (mask,) = robot.heard("/keepout_filter_mask")
        assert _at(mask, 2.5, 0.0) == 100
        known.keep_out_of([])
        robot.until(lambda: len(robot.heard("/keepout_filter_mask")) == 2)
        assert not any(robot.heard("/keepout_filter_mask")[1]["data"])


def test_a_robot_without_a_filter_is_given_none() -> None:
    with StandIn() as robot, connected(robot, keep_out=[STAIRS]):
        assert not robot.heard("/keepout_filter_mask")


def test_a_mask_of_a_large_house_becomes_coarser() -> None:
    zones = KeepOut([[(0, 0), (900, 0), (900, 900), (0, 900)]])
    mask = zones.mask(Dialect(2), "map", 0.05)
    assert len(mask["data"]) < 300_000
    assert mask["info"]["resolution"] > 1
    assert len(mask["data"]) == mask["info"]["width"] * mask["info"]["height"]


# --- the map -------------------------------------------------------------------------------------


@both
def test_the_map_is_fetched_as_a_picture(version) -> None:
    with StandIn(version) as robot:
        found = fetch_map(parse(f"ros{version}://127.0.0.1:{robot.port}"))
        assert (found.width, found.height, found.resolution) == (60, 40, 1.0)
        assert (found.origin.x, found.origin.y, found.origin.theta) == (-20, -20, 0)
        picture = found.picture()
        assert picture.size == (60, 40)
        assert picture.getpixel((0, 5)) == 0  # the wall on the left
        assert picture.getpixel((30, 20)) == 254
        assert picture.getpixel((59, 0)) == 205  # the last cell is the corner at the top right
        robot.until(lambda: robot.connections == 0)


@pytest.mark.parametrize(
    "wrong",
    [
        {"info": {"width": 61}},
        {"info": {"resolution": 0}},
        {"info": {"resolution": math.nan}},
        {"info": {"origin": {"position": {"x": math.nan, "y": 0}}}},
        {"data": "AAAA"},
    ],
)
def test_a_map_that_is_none_is_refused(wrong) -> None:
    with StandIn() as robot:
        info = robot.map["info"] | wrong.get("info", {})
        robot.map = robot.map | wrong | {"info": info}
        with pytest.raises(NotSupported, match="for its map is none"):
            fetch_map(parse(f"ros2://127.0.0.1:{robot.port}"))
        with connected(robot) as driver:  # which drives, but cannot check goals by it
            call(driver, "goto", place="pharmacy")


def test_a_robot_without_a_map_says_so(monkeypatch) -> None:
    monkeypatch.setattr(grid, "_MAP_WITHIN", 0.2)
    with (
        StandIn(without=("/map",)) as robot,
        pytest.raises(NotSupported, match="gives no map"),
    ):
        fetch_map(parse(f"ros2://127.0.0.1:{robot.port}"))
    with pytest.raises(LostConnection):
        fetch_map(parse(f"ros2://127.0.0.1:{free_port()}"))


def _at(mask, x: float, y: float) -> int:
    info = mask["info"]
    origin = info["origin"]["position"]
    column = int((x - origin["x"]) / info["resolution"])
    row = int((y - origin["y"]) / info["resolution"])
    return int(mask["data"][row * info["width"] + column])
