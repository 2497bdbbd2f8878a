"""That one server drives a Pepper, and not two: who does is a service of its own on the robot,
which is gone when its connection is."""

from __future__ import annotations

import uuid
from typing import Final

import qi

from robot_api.errors import AccessDenied, RobotError
from robot_api.robots.pepper.line import Line

SERVICE: Final = "NL2RobotDriver"
_ANSWERS_WITHIN: Final = 1.0
"""Seconds; one that does not answer is no longer there, though the robot has not noticed."""


class _Presence:
    def __init__(self, name: str) -> None:
        self._name = name

    def who(self) -> str:
        return self._name


class Driving:
    """This driver's claim to the robot."""

    def __init__(self) -> None:
        self._name = uuid.uuid4().hex

    def claim(self, line: Line) -> None:
        """Drive the robot from now on, as long as that connection lasts. Raises `AccessDenied` if
        somebody else does."""
        try:
            line.register(SERVICE, qi.multiThreaded()(_Presence)(self._name))
        except RobotError:
            if self._somebody_else(line):
                raise AccessDenied(
                    "Another nl2robot already drives this Pepper. End that one first, or work"
                    " through it: pass its own address, ws://HOST:9090."
                ) from None

    def _somebody_else(self, line: Line) -> bool:
        try:
            return bool(line.call(SERVICE, "who", within=_ANSWERS_WITHIN) != self._name)
        except RobotError:
            return False
