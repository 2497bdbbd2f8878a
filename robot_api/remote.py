"""A robot at another server, as a driver: so that a runner here can drive it.

For a server that knows the robot methods and nothing of programs.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from typing import Any

from robot_api.client import Robot
from robot_api.driver import EVENTS, Capabilities, Event, StopFlag
from robot_api.errors import RobotError


class RemoteDriver:
    """Passes every call on. The connection stays the caller's."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._capabilities = robot.capabilities()

    def capabilities(self) -> Capabilities:
        return self._capabilities

    def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
        stop.check()
        # One connection carries calls of several threads; only this one is to be broken off, but
        # whatever stops a call here means the robot to stand.
        stop.on_set(lambda: self.stop("The robot was stopped."))
        return getattr(self._robot, method)(**arguments)

    def stop(self, because: str) -> None:
        # A robot that cannot be reached stops by itself: its server lost the connection, too.
        if self._robot.connected:
            with contextlib.suppress(RobotError):
                self._robot.stop()

    def subscribe(self, listener: Callable[[str, Event], None]) -> Callable[[], None]:
        return self._robot.subscribe(EVENTS, listener)

    def close(self) -> None:
        self.stop("The robot was let go of.")
