"""The checker finds what is wrong with somebody's driver, and nothing where nothing is."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import msgspec
import pytest

from robot_api.checker import check_driver
from robot_api.conformance.behaviour import missing_fields
from robot_api.driver import EVENTS, Capabilities, Event, StopFlag
from robot_api.drivers import emulated
from robot_api.errors import RobotError
from tests.robot_api.conformance.faulty import Faulty, problems


@pytest.mark.parametrize(
    "without", [(), ("face",), ("face", "screen"), ("navigation", "motion"), ("speech",)]
)
def test_the_emulator_conforms_whatever_it_lacks(without: tuple[str, ...]) -> None:
    assert check_driver(emulated(without=without)) == []


def test_the_emulator_conforms_when_its_calls_take_time() -> None:
    assert check_driver(emulated(speed=200)) == []


def test_nothing_moves_if_it_must_not() -> None:
    robot = emulated()
    assert check_driver(robot, move=False) == []
    called = {call.method for call in robot.calls}
    assert "say" in called
    assert not called & {"goto", "move", "turn", "drive", "grab", "gesture", "do"}


def test_a_result_of_the_wrong_kind() -> None:
    class Robot(Faulty):
        def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
            result = super().call(method, arguments, stop)
            return "two" if method == "count" else result

    assert problems(Robot()) == ["count: returned 'two': 'two' is not of type 'integer'"]


def test_errors_that_the_table_does_not_know() -> None:
    class Robot(Faulty):
        def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
            if method == "battery":
                raise RobotError("The battery is shy.")
            if method == "clock":
                raise KeyError("time")
            if method == "grab":
                raise RobotError("e42")
            return super().call(method, arguments, stop)

    found = problems(Robot())
    assert "battery: raised RobotError, which is none of its errors" in found
    assert "clock: raised KeyError, which is no RobotError: 'time'" in found
    assert "grab: the message of RobotError is no sentence: 'e42'" in found


def test_methods_declared_wrongly() -> None:
    class Robot(Faulty):
        def capabilities(self) -> Capabilities:
            return msgspec.structs.replace(
                super().capabilities(), methods=("stop", "wait", "emotion", "fly"), emotions=()
            )

    found = problems(Robot())
    assert "fly: is declared, but the method table has no such method" in found
    assert "clock: is not declared, but every robot has it" in found
    assert "emotion: is declared, but the capabilities name no emotions" in found


def test_a_method_that_works_without_being_declared() -> None:
    class Robot(Faulty):
        def capabilities(self) -> Capabilities:
            has = super().capabilities()
            return msgspec.structs.replace(
                has, methods=tuple(name for name in has.methods if name != "grab")
            )

    assert [line for line in problems(Robot()) if line.startswith("grab")] == [
        "grab: returned None for {'thing': 'cup'} and raised no NotSupported"
    ]


def test_a_robot_that_is_somewhere_else_than_it_says() -> None:
    class Robot(Faulty):
        def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
            if method == "goto" and arguments.get("place") == "lobby":
                return None
            return super().call(method, arguments, stop)

    assert any(line.startswith("goto: went to 'lobby', but") for line in problems(Robot()))


def test_two_movements_at_once() -> None:
    class Robot(Faulty):
        def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
            if method == "turn" and 360 < arguments["degrees"] < math.inf:
                stop.wait(60)
                return stop.check()
            return super().call(method, arguments, stop)

    assert "goto: was not refused while the robot turned: None" in problems(Robot())


def test_events_without_their_fields_or_not_at_all() -> None:
    class Robot(Faulty):
        def subscribe(self, listener: Callable[[str, Event], None]) -> Callable[[], None]:
            def garble(kind: str, data: Event) -> None:
                if kind == "speech":
                    listener(kind, {"text": data["text"]})
                elif kind == "gesture":
                    listener("gestrue", data)
                elif kind == "call":
                    listener(kind, {**data, "camera": object()})
                elif kind not in ("emotion", "volume", "joint", "language"):
                    listener(kind, data)

            return super().subscribe(garble)

    found = problems(Robot())
    assert "emotion: sends no event 'emotion'" in found
    assert "set_volume: sends no event 'volume'" in found
    assert "joint: sends no event 'joint'" in found
    assert "set_language: sends no event 'language'" in found
    assert "sent an event of the unknown kind 'gestrue'" in found
    assert any(line.startswith("sent the event 'speech' without language") for line in found)
    assert any(line.startswith("sent the event 'call' with what JSON cannot") for line in found)


def test_the_fields_of_an_event_are_read_from_its_documentation() -> None:
    assert missing_fields("pose", {"x": 0, "y": 0, "theta": 0, "place": None}) == "speed, time"
    assert missing_fields("screen", {"options": []}) == ""
    assert missing_fields("screen", {}) == "text or html or url or options"
    assert all(missing_fields(kind, {}) for kind in EVENTS)
