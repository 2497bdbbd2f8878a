"""Programs are tried on a robot that is not there: it logs, remembers and answers."""

from __future__ import annotations

from datetime import datetime
from typing import Any

import pytest

from robot_api.driver import Driver, StopFlag
from robot_api.drivers import EmulatedDriver, emulated
from robot_api.errors import (
    Blocked,
    InvalidCall,
    NotPossible,
    NotSupported,
    Stopped,
    UnknownPerson,
    UnknownPlace,
)
from robot_api.methods import METHODS
from robot_api.values import Clock, Location

NIGHT_SHIFT = datetime(2026, 11, 20, 22, 30)


def do(driver: Driver, method: str, **arguments: Any) -> Any:
    return driver.call(method, arguments, StopFlag())


@pytest.fixture
def robot() -> EmulatedDriver:
    return emulated(start=NIGHT_SHIFT)


def test_it_has_every_method(robot: EmulatedDriver) -> None:
    assert robot.capabilities().methods == tuple(METHODS)


def test_a_round_at_night(robot: EmulatedDriver) -> None:
    desk = do(robot, "location")
    assert do(robot, "clock") == Clock("22:30", "Friday", "2026-11-20", "UTC")
    do(robot, "wait", seconds=3600)
    assert do(robot, "clock").time == "23:30"
    do(robot, "goto", place="Ward A")
    assert do(robot, "location").place == "Ward A"
    do(robot, "goto", place=desk)
    assert do(robot, "location") == Location(0.0, 0.0, 0.0, "lobby")
    assert "Ward A" in do(robot, "places")


def test_a_location_also_comes_as_data(robot: EmulatedDriver) -> None:
    do(robot, "goto", place={"x": 2, "y": 3, "theta": 90, "place": "sink"})
    assert do(robot, "location") == Location(2, 3, 90, "sink")
    do(robot, "localize", x=1, y=1, theta=0)
    assert do(robot, "location") == Location(1, 1, 0)
    with pytest.raises(InvalidCall):
        do(robot, "goto", place={"theta": 90})


def test_driving_by_hand_adds_up(robot: EmulatedDriver) -> None:
    do(robot, "turn", degrees=90)
    do(robot, "move", metres=2)
    do(robot, "drive", linear=-0.5, angular=0, seconds=2)
    here = do(robot, "location")
    assert (here.x, here.y, here.theta) == pytest.approx((0, 1, 90))
    assert here.place is None


def test_a_hand_holds_one_thing(robot: EmulatedDriver) -> None:
    do(robot, "grab", thing="cup")
    with pytest.raises(NotPossible, match="already hold the cup"):
        do(robot, "grab", thing="book")
    with pytest.raises(NotPossible, match="do not hold the book"):
        do(robot, "give", thing="book", person="Alice")
    do(robot, "put", thing="Cup", where="table")
    do(robot, "grab", thing="book")


def test_places_can_be_limited_to_those_there_are() -> None:
    robot = emulated(places={"pharmacy": "pharmacy", "alice's office": "office", "lab": "lab"})
    assert do(robot, "places", kind="offices") == ["alice's office"]
    with pytest.raises(UnknownPlace) as unknown:
        do(robot, "goto", place="farmacy")
    assert str(unknown.value) == ("I know no place called 'farmacy'. Did you mean the pharmacy?")
    with pytest.raises(UnknownPlace, match="Did you mean alice's office"):
        do(robot, "guide", person="visitor", place="alices ofice")
    with pytest.raises(NotPossible, match="no charging station"):
        do(robot, "dock")


def test_canned_results_take_turns_and_errors_are_raised() -> None:
    robot = emulated(
        results={"sees": [False, True], "battery": 9, "goto": Blocked("A bed is in the way.")}
    )
    assert [do(robot, "sees", thing="cup") for _ in range(3)] == [False, True, True]
    assert [do(robot, "battery") for _ in range(2)] == [9, 9]
    with pytest.raises(Blocked, match="A bed is in the way"):
        do(robot, "goto", place="lab")


def test_a_misspelt_canned_result_is_found_at_once() -> None:
    with pytest.raises(InvalidCall, match="batery"):
        emulated(results={"batery": 9})


def test_every_call_is_remembered_and_logged() -> None:
    lines: list[str] = []
    robot = emulated(["yes"], start=NIGHT_SHIFT, log=lines.append)
    do(robot, "ask", question="Well?", options=["yes", "no"])
    with pytest.raises(UnknownPerson):
        do(robot, "call", contact="the moon")
    assert [(call.method, call.result) for call in robot.calls] == [("ask", "yes"), ("call", None)]
    assert isinstance(robot.calls[1].error, UnknownPerson)
    assert lines[0] == "22:30:00 ask(question='Well?', options=['yes', 'no'])"
    assert lines[1].endswith("ask: 'yes'")
    assert "warning: call: UnknownPerson" in lines[-1]
    assert do(robot, "log", lines=2) == [lines[-3], "22:30:03 log(lines=2)"]


def test_long_pages_do_not_flood_the_log() -> None:
    robot = emulated()
    do(robot, "show", html="<p>blah</p>" * 5000)
    for _ in range(5):
        do(robot, "log", lines=1000)
    assert max(map(len, do(robot, "log", lines=1000))) < 300


def test_video_calls_one_at_a_time(robot: EmulatedDriver) -> None:
    states: list[str] = []
    robot.subscribe(
        lambda kind, data: (
            states.append(f"{data['contact']} {data['state']}") if kind == "call" else None
        )
    )
    do(robot, "call", contact="alice")
    do(robot, "call", contact="reception")
    do(robot, "hang_up")
    do(robot, "hang_up")
    assert states == [
        "Alice calling",
        "Alice connected",
        "Alice ended",
        "reception calling",
        "reception connected",
        "reception ended",
    ]


def test_what_it_cannot_do_it_says_kindly(robot: EmulatedDriver) -> None:
    with pytest.raises(NotSupported, match="I speak English, German and French"):
        do(robot, "set_language", code="it")
    with pytest.raises(NotSupported, match="I know wave, nod"):
        do(robot, "gesture", name="somersault")
    with pytest.raises(NotSupported, match="I have head_yaw"):
        do(robot, "joint", name="tail", degrees=3)
    with pytest.raises(InvalidCall, match="from -90 to 90"):
        do(robot, "joint", name="head_yaw", degrees=120)
    with pytest.raises(NotSupported, match="I know how to sit and dance"):
        do(robot, "do", skill="fly")
    assert do(emulated(skills={"sit": "sit down"}), "do", skill="sit", slowly=True) is None


def test_a_robot_that_lacks_something() -> None:
    robot = emulated(without=["manipulation"])
    assert "grab" not in robot.capabilities().methods
    with pytest.raises(NotSupported) as lacking:
        do(robot, "grab", thing="cup")
    assert str(lacking.value) == (
        "The emulated robot cannot do 'grab': it has no hands. "
        "Leave that step out, or use a robot that can."
    )


def test_calls_that_make_no_sense(robot: EmulatedDriver) -> None:
    with pytest.raises(InvalidCall, match="did you mean wait"):
        do(robot, "wiat", seconds=3)
    with pytest.raises(InvalidCall):
        do(robot, "wait", seconds=-1)
    with pytest.raises(InvalidCall):
        do(robot, "say")


def test_a_stop_that_came_before_ends_the_call(robot: EmulatedDriver) -> None:
    flag = StopFlag()
    flag.set("The nurse pressed stop.")
    with pytest.raises(Stopped, match="The nurse pressed stop"):
        robot.call("goto", {"place": "lab"}, flag)
    assert do(robot, "location").place == "lobby"


def test_scanning_and_touching_take_the_canned_answers_too() -> None:
    robot = emulated(["4001234", "tea"])
    assert do(robot, "scan", prompt="Please hold up the box.") == "4001234"
    assert do(robot, "touch", options=["coffee", "tea"]) == "tea"
    assert do(robot, "touch", options=["coffee", "tea"]) == "coffee"
    assert do(robot, "listen") == "yes"
