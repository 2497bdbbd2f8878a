"""Pepper's arms, head and eyes: `gesture`, `joint`, `emotion`."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from contextlib import suppress
from typing import Final

from robot_api.capabilities.arms import Gesture, Joints
from robot_api.capabilities.base import Hub
from robot_api.capabilities.face import Face
from robot_api.driver import StopFlag
from robot_api.errors import LostConnection, NotSupported, RobotError
from robot_api.robots.pepper.body import STOP_LIMBS, Body
from robot_api.robots.pepper.session import Wire

GESTURES: Final[Mapping[str, str]] = {
    "wave": "animations/Stand/Gestures/Hey_1",
    "nod": "animations/Stand/Gestures/Yes_1",
    "shake head": "animations/Stand/Gestures/No_1",
    "bow": "animations/Stand/Gestures/BowShort_1",
    "point": "animations/Stand/Gestures/Far_1",
    "raise arms": "animations/Stand/Emotions/Positive/Happy_4",
}
"""What programs call them, to the animations that Pepper comes with."""

EYES: Final[Mapping[str, str]] = {
    "neutral": "#ffffff",
    "happy": "#ffd000",
    "sad": "#0040ff",
    "confused": "#a000ff",
    "angry": "#ff0000",
    "surprised": "#00ffff",
}
"""What colour the eyes have for each emotion."""
_FADES_IN: Final = 0.3
"""Seconds."""
_COLOUR: Final = re.compile(r"#[0-9a-fA-F]{6}")
_NO_JOINTS: Final = re.compile(r"Wheel|Hand$")
"""What NAOqi lists among the joints and has no angle in degrees."""


class PepperGesture(Gesture):
    def __init__(self, wire: Wire, body: Body, hub: Hub, named: Mapping[str, str]) -> None:
        """`named` are the robot file's. Raises `NotSupported` for one that Pepper lacks."""
        super().__init__()
        self._wire = wire
        self._body = body
        self._hub = hub
        known = dict(GESTURES)
        if wire.has("ALBehaviorManager"):
            installed = frozenset(wire.call("ALBehaviorManager", "getInstalledBehaviors"))
            known = {name: what for name, what in known.items() if what in installed}
            for name, what in named.items():
                if what not in installed:
                    raise NotSupported(
                        f"The robot file's gesture {name!r} is {what}, which this Pepper lacks."
                        " Install it, or name another animation."
                    )
        self._animations = {**known, **named}
        self.gestures = tuple(self._animations)

    def make(self, stop: StopFlag, gesture: str) -> None:
        self._body.be_ready(stop, to_drive=False)
        self._hub.publish("gesture", name=gesture)
        animation = self._animations[gesture]
        self._wire.run(stop, "ALAnimationPlayer", "run", animation, ending=(STOP_LIMBS,))


class PepperJoints(Joints):
    def __init__(self, wire: Wire, body: Body, hub: Hub, speed: float) -> None:
        super().__init__()
        self._wire = wire
        self._body = body
        self._hub = hub
        self._speed = speed
        names = [
            name
            for name in wire.call("ALMotion", "getBodyNames", "Body")
            if not _NO_JOINTS.search(name)
        ]
        self.ranges = {name: self._range(name) for name in names}

    def set_joint(self, stop: StopFlag, joint: str, degrees: float) -> None:
        self._body.be_ready(stop, to_drive=False)
        try:
            self._wire.run(
                stop,
                "ALMotion",
                "angleInterpolationWithSpeed",
                joint,
                math.radians(degrees),
                self._speed,
                ending=(STOP_LIMBS,),
            )
        except LostConnection:  # it is asked nothing more
            raise
        except BaseException:  # one that was stopped on its way stands somewhere else
            self._tell(joint)
            raise
        self._tell(joint)

    def _tell(self, joint: str) -> None:
        """How it stands, as its sensor measures it; nothing where the robot does not say."""
        with suppress(RobotError, ValueError, TypeError):
            (angle,) = self._wire.call("ALMotion", "getAngles", joint, True)
            self._hub.publish("joint", name=joint, degrees=round(math.degrees(angle), 1))

    def _range(self, joint: str) -> tuple[float, float]:
        least, most, *_ = self._wire.call("ALMotion", "getLimits", joint)[0]
        # Inwards, so that no rounding leads beyond the robot's own end.
        return math.ceil(math.degrees(least) * 10) / 10, math.floor(math.degrees(most) * 10) / 10


class PepperEyes(Face):
    """Emotions as the colour of the lights in the eyes."""

    def __init__(self, wire: Wire, hub: Hub, named: Mapping[str, str]) -> None:
        """`named` are the robot file's colours. Raises `NotSupported` for one that is none."""
        super().__init__()
        self._wire = wire
        self._hub = hub
        for name, colour in named.items():
            if not _COLOUR.fullmatch(colour):
                raise NotSupported(
                    f"The robot file's emotion {name!r} is {colour}, but Pepper shows emotions by"
                    f" the colour of its eyes. Write one such as '#00ff00'."
                )
        self._colours = {**EYES, **named}
        self.emotions = tuple(self._colours)

    def express(self, stop: StopFlag, emotion: str) -> None:
        colour = int(self._colours[emotion][1:], 16)
        self._wire.call("ALLeds", "fadeRGB", "FaceLeds", colour, _FADES_IN)
        self._hub.publish("emotion", name=emotion)
