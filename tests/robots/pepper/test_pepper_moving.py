"""Pepper drives, and says why not."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from robot_api.errors import Blocked, InvalidCall, NotPossible, NotSupported, UnknownPlace
from robot_api.robots.pepper import PepperSettings
from robot_api.robots.robot_file import Limits, RobotFile
from tests.robots.pepper.conftest import MAP, PLACES, Call, call, until


@pytest.mark.parametrize(
    ("method", "arguments", "pose"),
    [
        ("move", {"metres": 0.5}, (0.5, 0, 0)),
        ("move", {"metres": -0.5}, (-0.5, 0, 0)),
        ("turn", {"degrees": 90}, (0, 0, 1.571)),
        ("turn", {"degrees": -270}, (0, 0, -4.712)),  # the long way round, as it was told
        ("drive", {"linear": 0.3, "angular": 0, "seconds": 2}, (0.6, 0, 0)),
        ("drive", {"linear": 0.2, "angular": 45, "seconds": 2}, (0.255, 0.255, 1.571)),
    ],
)
def test_it_drives_as_far_as_it_is_told(
    standing_in: Callable[..., Any],
    drive: Callable[..., Any],
    method: str,
    arguments: Any,
    pose: tuple[float, float, float],
) -> None:
    pepper = standing_in()
    call(drive(pepper), method, **arguments)
    assert pepper.pose == pytest.approx(pose, abs=0.01)


def test_every_way_it_is_sent_ends_by_itself(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    """A joystick's call may be the last one that arrives."""
    pepper = standing_in()
    driver = drive(pepper)
    call(driver, "drive", linear=0.3, angular=30, seconds=0.5)
    assert {deed.split()[0] for deed in pepper.done} == {"load", "moveTo"}


def test_a_newer_joystick_takes_over(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in(hurry=1.0)
    driver = drive(pepper)
    first = Call(driver, "drive", linear=0.3, angular=0, seconds=30)
    assert until(lambda: pepper.speed > 0.1)
    call(driver, "drive", linear=-0.3, angular=0, seconds=0.5)
    assert first.over(2.0)
    assert first.error is None


def test_places_go_by_their_other_names(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    driver = drive(standing_in())
    call(driver, "goto", place="Drugstore")
    here = call(driver, "location")
    assert (here.place, round(here.x, 1), round(here.y, 1), round(here.theta)) == (
        "pharmacy",
        3.0,
        2.0,
        90,
    )
    assert call(driver, "places", kind="rooms") == ["pharmacy", "radiology", "cellar"]


def test_where_it_is_is_told_while_it_drives(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    driver = drive(standing_in(hurry=2.0))
    poses: list[Any] = []
    driver.subscribe(lambda kind, data: poses.append(data) if kind == "pose" else None)
    call(driver, "goto", place="pharmacy")
    assert len(poses) > 3
    assert max(pose["speed"] for pose in poses) > 0.3
    assert poses[0]["x"] < poses[-1]["x"] <= 3.01


def test_told_where_it_is_it_believes_it(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in(localised=False)
    driver = drive(pepper)
    for method, arguments in (("location", {}), ("goto", {"place": "pharmacy"})):
        with pytest.raises(NotPossible, match="do not know where I am"):
            call(driver, method, **arguments)
    call(driver, "localize", x=1, y=1, theta=45)
    here = call(driver, "location")
    assert (here.x, here.y, round(here.theta)) == (1, 1, 45)
    assert here.place is None


# --- what hinders it -----------------------------------------------------------------------------


def test_something_stands_in_its_way(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in()
    driver = drive(pepper)
    pepper.set(obstacles=[[1.0, 0.0, 0.2]])
    with pytest.raises(Blocked, match=r"Something is 0\.[01] m in front of me\. Clear the way"):
        call(driver, "move", metres=2)
    assert pepper.pose[0] == pytest.approx(0.5, abs=0.03)
    call(driver, "move", metres=-0.4)  # backwards it still can
    with pytest.raises(Blocked, match="in front of me"):
        call(driver, "drive", linear=0.5, angular=0, seconds=3)


def test_something_stands_on_its_way_to_a_place(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in()
    driver = drive(pepper)
    pepper.set(obstacles=[[1.5, 1.0, 0.2]])
    with pytest.raises(Blocked, match=r"stopped 2\.\d m before the goal \(NAOqi says 4\)"):
        call(driver, "goto", place="pharmacy")


def test_a_navigation_that_claims_to_have_arrived_is_not_believed(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in()
    driver = drive(pepper)
    pepper.set(code=0)
    with pytest.raises(Blocked, match=r"stopped 3\.6 m before the goal\. I could not go on"):
        call(driver, "goto", place="pharmacy")


def test_the_charging_flap_is_open(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in(flap=True)
    driver = drive(pepper)
    for method, arguments in (
        ("move", {"metres": 1}),
        ("turn", {"degrees": 90}),
        ("drive", {"linear": 0.2, "angular": 0, "seconds": 1}),
        ("goto", {"place": "pharmacy"}),
    ):
        with pytest.raises(NotPossible, match="charging flap is open"):
            call(driver, method, **arguments)
    call(driver, "gesture", name="wave")  # arms it may move
    pepper.set(flap=False)
    call(driver, "move", metres=0.2)


def test_the_flap_is_opened_on_the_way(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in(hurry=1.0)
    driver = drive(pepper)
    driving = Call(driver, "move", metres=3)
    assert until(lambda: pepper.speed > 0.1)
    pepper.set(flap=True, obstacles=[[pepper.pose[0] + 0.3, 0, 0.1]])
    assert driving.over()
    assert isinstance(driving.error, Blocked)
    assert "charging flap" in str(driving.error)


def test_somebody_switches_autonomous_life_on(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in()
    driver = drive(pepper)
    call(driver, "say", text="Hello.")
    pepper.set(life="interactive")
    with pytest.raises(NotPossible, match="autonomous life"):
        call(driver, "move", metres=1)
    assert pepper.pose == [0, 0, 0]


def test_autonomous_life_is_off_while_it_is_driven_and_on_again_afterwards(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in(life="interactive")
    driver = drive(pepper)
    call(driver, "battery")
    call(driver, "location")
    assert pepper.life == "interactive"  # who only asks moves nothing
    call(driver, "say", text="Hello.")
    assert pepper.life == "disabled"
    assert pepper.awake  # switching life off puts it to sleep
    call(driver, "move", metres=0.2)
    driver.close()
    assert pepper.life == "solitary"


def test_autonomous_life_is_left_alone_where_the_robot_file_says_so(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in(life="solitary")
    driver = drive(pepper, settings=PepperSettings(autonomous_life="keep"))
    call(driver, "say", text="Hello.")
    assert pepper.life == "solitary"
    driver.close()
    assert not any(deed.startswith("life") for deed in pepper.done)


def test_a_sleeping_pepper_is_woken_and_sleeps_again(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in(awake=False)
    driver = drive(pepper)
    assert not pepper.awake
    call(driver, "gesture", name="wave")
    assert pepper.awake
    pepper.set(awake=False)  # somebody has put it to rest meanwhile
    call(driver, "move", metres=0.2)
    assert pepper.awake
    driver.close()
    assert not pepper.awake


# --- where it must not, and how fast -------------------------------------------------------------


def test_it_keeps_out_of_where_it_must_not_be(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    """Pepper knows nothing of such an area: its way is watched."""
    from robot_api.robots.places import Places

    area = [(1.0, -1.0), (2.0, -1.0), (2.0, 4.0), (1.0, 4.0)]
    pepper = standing_in(hurry=1.0)
    driver = drive(pepper, places=Places(named=PLACES.named, keep_out=[area]))
    with pytest.raises(NotPossible, match="must not drive"):
        call(driver, "goto", x=1.5, y=0)
    with pytest.raises(Blocked, match="must not drive"):
        call(driver, "goto", place="pharmacy")
    assert until(lambda: pepper.speed == 0)
    assert pepper.pose[0] < 1.3
    call(driver, "goto", place="lobby")  # it may leave


def test_no_faster_than_its_file_allows(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in(hurry=1.0)
    file = RobotFile(limits=Limits(speed=0.15, turn_rate=20, acceleration=0.5))
    driver = drive(pepper, file=file)
    limits = driver.capabilities().limits
    assert limits == {"speed": 0.15, "turn_rate": 20, "acceleration": 0.5}
    driving = Call(driver, "move", metres=0.4)
    fastest = 0.0
    while not driving.over(0.01):
        fastest = max(fastest, pepper.speed)
    assert driving.error is None
    assert 0.1 < fastest <= 0.151


def test_its_own_navigation_may_be_faster_than_its_file_allows(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    """NAOqi takes no speed for it; so it is watched, and stopped."""
    pepper = standing_in(hurry=1.0)
    driver = drive(pepper, file=RobotFile(limits=Limits(speed=0.15)))
    with pytest.raises(NotPossible, match=r"may drive at 0\.15 at most"):
        call(driver, "goto", place="pharmacy")
    assert until(lambda: pepper.speed == 0)


def test_a_limit_below_what_pepper_can_keep_to(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in(life="solitary")
    with pytest.raises(NotSupported, match=r"its least is 0\.1"):
        drive(pepper, file=RobotFile(limits=Limits(speed=0.05)))
    assert (pepper.life, pepper.done) == ("solitary", [])


# --- places --------------------------------------------------------------------------------------


def test_places_it_cannot_go_to(standing_in: Callable[..., Any], drive: Callable[..., Any]) -> None:
    driver = drive(standing_in())
    with pytest.raises(UnknownPlace, match=r"Did you mean the pharmacy\?"):
        call(driver, "goto", place="farmacy")
    with pytest.raises(UnknownPlace, match="Nobody has said where the cellar is"):
        call(driver, "goto", place="cellar")
    with pytest.raises(InvalidCall):
        call(driver, "goto", place={"theta": 0})


def test_without_a_map_no_place_is_gone_to(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    driver = drive(standing_in(), settings=PepperSettings())
    assert not {"goto", "location", "localize", "guide"} & set(driver.capabilities().methods)
    assert "move" in driver.capabilities().methods
    with pytest.raises(NotSupported, match="cannot find its way on a map"):
        call(driver, "goto", place="pharmacy")


def test_a_map_that_is_not_there(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    with pytest.raises(NotSupported, match=r"no map /home/nao/other\.explo"):
        drive(standing_in(), settings=PepperSettings(map="/home/nao/other.explo"))
    with pytest.raises(NotSupported, match="no ALNavigation"):
        drive(standing_in(without=["ALNavigation"]), settings=PepperSettings(map=MAP))
