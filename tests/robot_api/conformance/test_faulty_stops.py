"""Stops that come late, are swallowed, are not told of, or stop nothing: each is found."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

import msgspec
import pytest

from robot_api.checker import check_driver
from robot_api.driver import Capabilities, StopFlag
from robot_api.errors import RobotError, StopNotConfirmed
from robot_api.values import Location
from tests.robot_api.conformance.faulty import Faulty, problems


class Waiting(Faulty):
    """Nothing takes time but a long wait."""

    def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
        if method == "wait" and arguments["seconds"] > 1:
            return self.wait(stop)
        return super().call(method, arguments, stop)

    def wait(self, stop: StopFlag) -> None:
        stop.wait(60)
        stop.check()


def test_a_wait_that_is_stopped_as_it_should_be() -> None:
    assert problems(Waiting()) == []


def test_a_call_that_no_stop_brings_back() -> None:
    class Robot(Faulty):
        def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
            return super().call(method, arguments, StopFlag() if method == "say" else stop)

        def stop(self, because: str) -> None:
            """Does nothing."""

    robot = Robot(speed=300)  # the long text takes almost half a second
    found = check_driver(robot)
    assert any(p.method == "say" and "ms after a stop" in p.message for p in found)


def test_a_stop_that_a_program_could_swallow() -> None:
    class Robot(Faulty):
        def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
            if method == "wait" and arguments["seconds"] > 0.1:
                stop.wait(60)
                raise RobotError("The robot was stopped.")
            return super().call(method, arguments, stop)

    assert "wait: raised RobotError at a stop, not Stopped" in problems(Robot())


def test_a_call_that_comes_back_late() -> None:
    class Robot(Waiting):
        def wait(self, stop: StopFlag) -> None:
            stop.wait(60)
            time.sleep(0.2)  # it looks at its flag a little late
            stop.check()

    found = problems(Robot())
    assert len(found) == 2
    assert "ms after a stop" in found[0] and "ms after a cancel" in found[1]


def test_a_robot_that_states_to_stand_later_may_come_back_later() -> None:
    class Robot(Waiting):
        def capabilities(self) -> Capabilities:
            return msgspec.structs.replace(super().capabilities(), stop_within=0.5)

        def wait(self, stop: StopFlag) -> None:
            stop.wait(60)
            time.sleep(0.2)
            stop.check()

    assert problems(Robot()) == []


def test_a_call_that_swallows_the_stop() -> None:
    class Robot(Waiting):
        def wait(self, stop: StopFlag) -> None:
            stop.wait(60)

    assert problems(Robot()) == [
        "wait: returned after a stop as if nothing had been, and raised no Stopped",
        "wait: returned after a cancel as if nothing had been, and raised no Stopped",
    ]


def test_a_call_that_fails_by_itself_in_the_moment_of_the_stop() -> None:
    class Robot(Waiting):
        failed = False

        def wait(self, stop: StopFlag) -> None:
            stop.wait(60)
            if not self.failed:
                self.failed = True
                raise RobotError("Just then I lost my balance. Look after me.")
            stop.check()

    assert problems(Robot()) == []


def test_a_call_that_is_stopped_but_not_cancelled() -> None:
    class Robot(Waiting):
        stopped = False

        def wait(self, stop: StopFlag) -> None:
            self.stopped = False
            while not self.stopped:
                time.sleep(0.01)
            stop.check()

        def stop(self, because: str) -> None:
            self.stopped = True
            super().stop(because)

    # Nothing but the next stop ends it, which is that of the end of the check.
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("robot_api.conformance.subject.GIVE_UP", 0.3)
        assert problems(Robot()) == ["wait: did not come back after a cancel"]


def test_a_call_that_never_comes_back() -> None:
    class Robot(Faulty):
        def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
            if method == "gesture" and "no such" in arguments["name"]:
                stop.wait(60)
            return super().call(method, arguments, stop)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("robot_api.conformance.subject.GIVE_UP", 0.3)
        found = problems(Robot())
    assert len(found) == 1
    assert found[0].startswith("gesture: raised DidNotReturn")


def test_a_robot_that_moves_on_after_it_was_stopped() -> None:
    class Robot(Waiting):
        """It rolls for ever, and calls it a walk."""

        def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
            if method == "location":
                return Location(time.monotonic(), 0.0, 0.0, None)
            if method == "turn" and arguments["degrees"] == 36000:
                return self.wait(stop)
            return super().call(method, arguments, stop)

    found = [line for line in problems(Robot()) if line.startswith("turn: ")]
    assert len(found) == 2
    assert found[0].startswith("turn: moved on by 0.2") and found[0].endswith("after a stop")
    assert found[1].endswith("after a cancel")


def test_a_robot_without_a_map_that_rolls_on() -> None:
    class Robot(Waiting):
        def capabilities(self) -> Capabilities:
            has = super().capabilities()
            mapless = tuple(name for name in has.methods if name not in ("location", "goto"))
            return msgspec.structs.replace(has, methods=mapless)

        def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
            if method == "turn" and arguments["degrees"] == 36000:
                return self.wait(stop)
            return super().call(method, arguments, stop)

        def subscribe(self, listener: Any) -> Callable[[], None]:
            over = threading.Event()
            pose = {"x": 0, "y": 0, "theta": 0, "place": None, "speed": 0.4, "time": 0}

            def odometry() -> None:
                while not over.wait(0.02):
                    listener("pose", pose)

            threading.Thread(target=odometry, daemon=True).start()
            unsubscribe = super().subscribe(listener)
            return lambda: (over.set(), unsubscribe())[1]

    assert "turn: moved on at 0.40 m/s after a stop" in problems(Robot())


def test_a_stop_that_nobody_is_told_of() -> None:
    class Robot(Waiting):
        def subscribe(self, listener: Any) -> Any:
            return super().subscribe(
                lambda kind, data: listener(kind, data) if kind != "stopped" else None
            )

    found = problems(Robot())
    assert "wait: a stop sent the events stopping, not stopping, stopped" in found
    assert "a stop sent the events stopping, not stopping, stopped" in found


def test_a_stop_that_is_said_to_be_confirmed_before_it_is_told() -> None:
    class Robot(Waiting):
        def subscribe(self, listener: Any) -> Any:
            swapped = {"stopping": "stopped", "stopped": "stopping"}
            return super().subscribe(lambda kind, data: listener(swapped.get(kind, kind), data))

    assert "a stop sent the events stopped, stopping, not stopping, stopped" in problems(Robot())


def test_a_robot_that_never_confirms_that_it_stands() -> None:
    class Robot(Waiting):
        def stop(self, because: str) -> None:
            super().stop(because)
            raise StopNotConfirmed("Nobody knows. Use the robot's own button.")

    assert "a stop was not confirmed: Nobody knows. Use the robot's own button." in problems(
        Robot()
    )


def test_a_stop_that_fails_in_a_strange_way() -> None:
    class Robot(Waiting):
        def stop(self, because: str) -> None:
            super().stop(because)
            raise RuntimeError("Session closed")

    assert "a stop raised RuntimeError, not StopNotConfirmed" in problems(Robot())


def test_a_robot_that_states_no_time_to_stand_within() -> None:
    class Robot(Waiting):
        def capabilities(self) -> Capabilities:
            return msgspec.structs.replace(super().capabilities(), stop_within=0.0)

    assert problems(Robot()) == ["it states to stand within 0.0 s"]
