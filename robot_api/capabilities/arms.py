"""Arms and head: `gesture`, and `joint` for single joints."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from typing import Any

from robot_api.capabilities.base import Capability
from robot_api.capabilities.emulation import InEmulation
from robot_api.capabilities.names import listed, one_of
from robot_api.capabilities.simulation import InSimulation
from robot_api.driver import StopFlag
from robot_api.errors import InvalidCall, NotSupported
from robot_api.methods import SUGGESTED_GESTURES

JOINTS: Mapping[str, tuple[float, float]] = {
    "head_yaw": (-90.0, 90.0),
    "head_pitch": (-30.0, 30.0),
    "left_shoulder": (-120.0, 120.0),
    "left_elbow": (0.0, 110.0),
    "right_shoulder": (-120.0, 120.0),
    "right_elbow": (0.0, 110.0),
}
"""The joints of the emulated and the simulated robot, with their angles in degrees."""

_SECONDS = 2.0
"""How long a gesture takes."""
_JOINT_RATE = 60.0
"""Degrees per second at which a joint turns."""


class Gesture(Capability):
    """Movements that mean something."""

    name = "gesture"
    lacking = "has no arms and no head to move"
    gestures: tuple[str, ...] = SUGGESTED_GESTURES

    @abstractmethod
    def make(self, stop: StopFlag, gesture: str) -> None:
        """Make it, one of `gestures`."""

    def gesture(self, stop: StopFlag, name: str) -> None:
        known = one_of(name, self.gestures)
        if known is None:
            raise NotSupported(
                f"I do not know the gesture '{name}'. I know {listed(self.gestures)}."
            )
        self.make(stop, known)

    def declares(self) -> dict[str, Any]:
        return {"gestures": self.gestures}


class Joints(Capability):
    """Single joints that can be set."""

    name = "joints"
    lacking = "has no joints that can be set one by one"
    ranges: Mapping[str, tuple[float, float]] = JOINTS

    @abstractmethod
    def set_joint(self, stop: StopFlag, joint: str, degrees: float) -> None:
        """Turn it, one of `ranges`, to that angle and hold it there; tell how it stands then to
        those who subscribed."""

    def joint(self, stop: StopFlag, name: str, degrees: float) -> None:
        known = one_of(name, self.ranges)
        if known is None:
            raise NotSupported(f"I have no joint '{name}'. I have {listed(tuple(self.ranges))}.")
        least, most = self.ranges[known]
        if not least <= degrees <= most:
            raise InvalidCall(
                f"My joint {known} cannot turn to {degrees:g} degrees. "
                f"Give an angle from {least:g} to {most:g}."
            )
        self.set_joint(stop, known, degrees)

    def declares(self) -> dict[str, Any]:
        return {"joints": dict(self.ranges)}


class EmulatedGesture(InEmulation, Gesture):
    def make(self, stop: StopFlag, gesture: str) -> None:
        self.emulation.publish("gesture", name=gesture)
        self.emulation.pass_time(_SECONDS, stop)


class EmulatedJoints(InEmulation, Joints):
    def set_joint(self, stop: StopFlag, joint: str, degrees: float) -> None:
        turn = abs(degrees - self.emulation.joints.get(joint, 0.0))
        self.emulation.pass_time(turn / _JOINT_RATE, stop)
        self.emulation.joints[joint] = degrees
        self.emulation.publish("joint", name=joint, degrees=degrees)


class SimulatedGesture(InSimulation, Gesture):
    def make(self, stop: StopFlag, gesture: str) -> None:
        self.run(self.simulation.gesture(gesture), stop)


class SimulatedJoints(InSimulation, Joints):
    def set_joint(self, stop: StopFlag, joint: str, degrees: float) -> None:
        turn = abs(degrees - self.simulation.robot.joints.get(joint, 0.0))
        self.run(self.simulation.wait(turn / _JOINT_RATE), stop)
        self.simulation.set_joint(joint, degrees)
