"""What a robot may not do is refused at the call, and what it may is done."""

from __future__ import annotations

import re
from functools import partial
from typing import Any

import msgspec

from robot_api.checker import check_driver
from robot_api.composed import ComposedDriver
from robot_api.driver import Capabilities, StopFlag
from robot_api.drivers import simulated
from robot_api.errors import InvalidCall
from robot_api.robots.robot_file import Limits, RobotFile
from sim.simulation import Simulation
from sim.world.loading import load_world
from tests.robot_api.conformance.faulty import Faulty, problems

LIMITS = {"speed": 0.5, "turn_rate": 45.0, "volume": 80.0}


class Porter(Faulty):
    """A robot that keeps to its limits."""

    def capabilities(self) -> Capabilities:
        return msgspec.structs.replace(super().capabilities(), limits=LIMITS)

    def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
        self.hold(method, arguments)
        return super().call(method, arguments, stop)

    def hold(self, method: str, arguments: dict[str, Any]) -> None:
        if method == "drive":
            self.hold_to("speed", arguments["linear"])
            self.hold_to("turn_rate", arguments["angular"])
        if method == "set_volume":
            self.hold_to("volume", arguments["percent"])

    def hold_to(self, limit: str, value: float) -> None:
        if abs(value) > LIMITS[limit]:
            raise InvalidCall(f"That is beyond my {limit}. Ask for less.")


def test_a_porter_that_keeps_to_its_limits() -> None:
    assert problems(Porter()) == []


def test_a_porter_that_may_be_as_loud_as_it_is_allowed_and_no_louder() -> None:
    class TurnsDown(Porter):
        """Too loud is done more softly, which is as good."""

        def hold_to(self, limit: str, value: float) -> None:
            if limit != "volume":
                super().hold_to(limit, value)

    assert problems(TurnsDown()) == []


def test_a_porter_that_forgets_its_limits() -> None:
    class Forgetful(Porter):
        def hold_to(self, limit: str, value: float) -> None:
            if limit != "speed":
                super().hold_to(limit, value)

    found = problems(Forgetful())
    assert found == [
        f"drive: returned None for {{'linear': {speed}, 'angular': 0, 'seconds': 0.2}}"
        " and raised no InvalidCall"
        for speed in (0.55, -0.55)
    ]


def test_a_porter_that_is_overcautious() -> None:
    class Cautious(Porter):
        def hold_to(self, limit: str, value: float) -> None:
            super().hold_to(limit, 2 * value)

    assert "set_volume: refused {'percent': 80}, which is not beyond its limit" in problems(
        Cautious()
    )


def test_a_joint_that_turns_too_far() -> None:
    class Supple(Faulty):
        def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
            try:
                return super().call(method, arguments, stop)
            except InvalidCall:
                if method == "joint" and arguments["name"] == "left_elbow":
                    return None
                raise

    assert problems(Supple()) == [
        f"joint: returned None for {{'name': 'left_elbow', 'degrees': {angle}}}"
        " and raised no InvalidCall"
        for angle in (-1.0, 111.0)
    ]


def test_a_robot_that_takes_what_is_no_number() -> None:
    class Trusting(Faulty):
        def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
            if method == "move" and arguments["metres"] != arguments["metres"]:
                return None
            return super().call(method, arguments, stop)

    assert problems(Trusting()) == [
        "move: returned None for {'metres': nan} and raised no InvalidCall"
    ]


def test_a_robot_that_is_measured_to_be_too_fast() -> None:
    class Racing(Porter):
        def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
            result = super().call(method, arguments, stop)
            if method == "goto":
                self._sound.emulation.publish(
                    "pose", x=0, y=0, theta=0, place=None, speed=1.2, time=0
                )
            return result

    assert problems(Racing()) == ["drove at 1.20 m/s, faster than its limit of 0.5"]


def simulated_porter(limits: Limits, keeps: bool = True) -> list[str]:
    """What is wrong with a simulated robot with these limits that drives as they say, or not."""
    with Simulation(load_world("ward")) as simulation:
        driver = simulated(simulation)
        hold = driver.hold if keeps else partial(ComposedDriver.hold, driver)
        hold(RobotFile(limits=limits))
        return [str(each) for each in check_driver(driver) if each.part == "limits"]


def test_a_simulated_robot_gets_no_faster_than_its_file_says() -> None:
    assert simulated_porter(Limits(speed=0.4, acceleration=0.2)) == []


def test_a_robot_that_is_measured_to_accelerate_too_fast() -> None:
    [found] = simulated_porter(Limits(acceleration=0.2), keeps=False)
    assert re.fullmatch(
        r"accelerated by 0\.\d+ m/s², more than its limit of 0\.2", found.removeprefix("None: ")
    )
