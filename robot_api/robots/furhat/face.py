"""A Furhat moves its head and its face: gestures, and emotions by those."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from robot_api.capabilities.arms import Gesture
from robot_api.capabilities.base import Hub, Turns
from robot_api.capabilities.face import Face
from robot_api.driver import StopFlag
from robot_api.errors import NotSupported
from robot_api.robots.furhat.robot import Furhat

_STARTS_WITHIN: Final = 3.0
_LASTS: Final = 10.0
"""Seconds in which any gesture is over."""
_START, _END = "response.gesture.start", "response.gesture.end"

GESTURES: Final[Mapping[str, str]] = {
    "nod": "Nod",
    "shake head": "Shake",
    "roll head": "Roll",
    "look away": "GazeAway",
    "smile": "Smile",
    "big smile": "BigSmile",
    "wink": "Wink",
    "blink": "Blink",
    "close eyes": "CloseEyes",
    "open eyes": "OpenEyes",
    "raise eyebrows": "BrowRaise",
    "frown": "BrowFrown",
    "say oh": "Oh",
    "think": "Thoughtful",
}
"""The gestures that come with a Furhat, by their names there."""

EMOTIONS: Final[Mapping[str, str]] = {
    "happy": "BigSmile",
    "sad": "ExpressSad",
    "confused": "Thoughtful",
    "angry": "ExpressAnger",
    "surprised": "Surprise",
}
"""The gestures that stand for emotions."""


class Gestures:
    """What makes gestures by the robot's own names, one after the other."""

    def __init__(self, furhat: Furhat) -> None:
        self._furhat = furhat
        self._turns = Turns()

    def make(self, stop: StopFlag, name: str, *, to_its_end: bool) -> None:
        """Make it, and wait until it has begun or ended. Raises `NotSupported`."""
        with (
            self._turns.mine(stop),
            self._furhat.motion(stop, speech=False, lasts=_LASTS) as made,
        ):
            self._furhat.send(
                "request.gesture.start",
                name=name,
                intensity=1.0,
                duration=1.0,
                monitor=True,
                request_id=made.number,
            )
            message = made.next(_STARTS_WITHIN, _START, _END)
            if message is None:
                self._furhat.never_began(made)
            elif message["type"] == _START and to_its_end:
                message = made.expect(_LASTS, _END)
        if message is None:
            raise NotSupported(
                f"The Furhat did not make its gesture '{name}'. See in the robot file whether "
                "it is called so."
            )


class FurhatGesture(Gesture):
    """Head and face. What gestures there are, it does not tell: these come with every Furhat, and
    the robot file names others."""

    def __init__(self, gestures: Gestures, hub: Hub, names: Mapping[str, str]) -> None:
        self._gestures = gestures
        self._hub = hub
        self._names = {**GESTURES, **names}
        self.gestures = tuple(self._names)

    def make(self, stop: StopFlag, gesture: str) -> None:
        self._hub.publish("gesture", name=gesture)
        self._gestures.make(stop, self._names[gesture], to_its_end=True)


class FurhatFace(Face):
    """Emotions are gestures of its face, and pass as those do."""

    def __init__(
        self, furhat: Furhat, gestures: Gestures, hub: Hub, names: Mapping[str, str]
    ) -> None:
        self._furhat = furhat
        self._gestures = gestures
        self._hub = hub
        self._names = {**EMOTIONS, **names}
        self.emotions = ("neutral", *self._names)

    def express(self, stop: StopFlag, emotion: str) -> None:
        if emotion in self._names:
            self._gestures.make(stop, self._names[emotion], to_its_end=False)
        else:
            self._furhat.tell(stop, "request.face.reset")
        self._hub.publish("emotion", name=emotion)
