"""The style of the paper: messages that are made first and sent then.

    import re                                   # the paper's listing uses it and forgot it
    from robot_api.messages import Robot

    robot = Robot()
    robot.connect("10.0.0.1:9090")
    robot.send_message(robot.say("I'm coming"))
    robot.send_message(robot.goto(-605, -1027, -1.3))
    response = robot.send_message(robot.listen(prompt="Where to?"))
    speech = response.get('data', {}).get('speech')
    pharmacy = re.compile("pharmacy").search(speech)

As there, coordinates count in the map's own unit (`Capabilities.units`, often centimetres) and
angles in radians; names are those of the paper's Listing 1 and others like them. New programs are
better off with `robot_api.Robot`, which has more methods and raises what goes wrong at the call.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Final, TypedDict

from robot_api import client
from robot_api.errors import LostConnection, TimedOut

METRES_PER_UNIT: Final = {"m": 1.0, "cm": 0.01}
_LENGTHS: Final = frozenset({"x", "y", "metres", "linear"})
_ANGLES: Final = frozenset({"theta", "degrees", "angular"})

_ANSWER: Final = {
    "listen": "speech",
    "scan": "code",
    "touch": "option",
    "read_text": "text",
    "log": "lines",
    "location": "location",
    "battery": "percent",
}
"""Under which key of a response's data the result of a method stands."""


class Message(TypedDict):
    """What to tell the robot; made by the methods of `Robot`, in the map's unit and radians."""

    method: str
    params: dict[str, Any]


class Response(TypedDict):
    """What the robot answered."""

    status: str
    """"ok", or "timeout" if nobody spoke, touched or showed anything in time."""
    data: dict[str, Any]
    """Empty, or with one entry: "speech", "code", "option" and "text" are texts, "" at a timeout;
    "lines" is a list of texts, "percent" a number, "location" has x, y, theta and place."""


class Robot:
    """Connects to a robot and sends it messages; its other methods make messages."""

    def __init__(self) -> None:
        self._robot: client.Robot | None = None
        self._metres_per_unit = 1.0

    def connect(self, address: str, token: str | None = None) -> None:
        """Connect to "host:port". Raises LostConnection or AccessDenied."""
        self.disconnect()
        self._robot = client.Robot(address, token=token)
        self._metres_per_unit = METRES_PER_UNIT[self._robot.capabilities().units]

    def disconnect(self) -> None:
        """Let go of the robot."""
        if self._robot is not None:
            self._robot.close()
            self._robot = None

    def send_message(self, message: Message) -> Response:
        """Send a message and wait until the robot has done it.

        Raises a `robot_api.errors.RobotError` if it could not, and `Stopped` if it was stopped.
        """
        if self._robot is None:
            raise LostConnection('Not connected. Call robot.connect("host:9090") first.')
        method, key = message["method"], _ANSWER.get(message["method"])
        try:
            result = self._robot.request(f"robot.{method}", self._to_robot(message["params"]))
        except TimedOut:
            return {"status": "timeout", "data": {key: ""} if key else {}}
        if method == "location":
            result = self._from_robot(result)
        return {"status": "ok", "data": {key: result} if key else {}}

    # --- the messages, by the functions of the paper's Table 1

    def say(self, text: str, language: str | None = None) -> Message:
        """1: say it aloud."""
        return _message("say", text=text, language=language)

    def setVolume(self, volume: int) -> Message:
        """2: how loud to speak, 0 to 100."""
        return _message("set_volume", percent=volume)

    def drive(self, linear: float, angular: float, seconds: float) -> Message:
        """3: as with a joystick, in units and radians (left is +) per second."""
        return _message("drive", linear=linear, angular=angular, seconds=seconds)

    def move(self, distance: float) -> Message:
        """3: straight ahead."""
        return _message("move", metres=distance)

    def turn(self, angle: float) -> Message:
        """3: on the spot; left is +."""
        return _message("turn", degrees=angle)

    def goto(self, x: float | str, y: float | None = None, theta: float | None = None) -> Message:
        """4: to a point, `goto(-605, -1027, -1.3)`, or to a place, `goto("pharmacy")`."""
        return _message("goto", **_target(x, y, theta))

    def dock(self) -> Message:
        """5: back to the charging station."""
        return _message("dock")

    def getLocation(self) -> Message:
        """6: where it is; data: location."""
        return _message("location")

    def localize(
        self, x: float | str, y: float | None = None, theta: float | None = None
    ) -> Message:
        """7: tell it where it is."""
        return _message("localize", **_target(x, y, theta))

    def showEmotion(self, emotion: str) -> Message:
        """8: "happy", "sad" ..."""
        return _message("emotion", name=emotion)

    def performGesture(self, gesture: str) -> Message:
        """9: "wave", "nod" ..."""
        return _message("gesture", name=gesture)

    def moveJoint(self, joint: str, angle: float) -> Message:
        """10: move a joint and hold it there."""
        return _message("joint", name=joint, degrees=angle)

    def getLog(self, lines: int = 20) -> Message:
        """11: the last lines of its log; data: lines."""
        return _message("log", lines=lines)

    def startCall(self, contact: str) -> Message:
        """12: a video call."""
        return _message("call", contact=contact)

    def endCall(self) -> Message:
        """12: end the video call."""
        return _message("hang_up")

    def scanCode(self, prompt: str | None = None, timeout: float = 30) -> Message:
        """13: a QR or bar code; data: code."""
        return _message("scan", prompt=prompt, timeout=timeout)

    def displayHTML(self, html: str) -> Message:
        """14: a page of HTML on the screen."""
        return _message("show", html=html)

    def displayURL(self, url: str) -> Message:
        """14: a web page on the screen."""
        return _message("show", url=url)

    def displayText(self, text: str) -> Message:
        """14: a text on the screen."""
        return _message("show", text=text)

    def click(self, selector: str) -> Message:
        """15: click on an element of the page."""
        return _message("click", selector=selector)

    def typeText(self, selector: str, text: str) -> Message:
        """15: type into a field of the page."""
        return _message("type_text", selector=selector, text=text)

    def readText(self, selector: str) -> Message:
        """15: read an element of the page; data: text."""
        return _message("read_text", selector=selector)

    def waitForTouch(self, options: list[str], prompt: str | None = None) -> Message:
        """15: show buttons and wait for one to be touched; data: option."""
        return _message("touch", options=options, prompt=prompt)

    def listen(self, prompt: str | None = None, timeout: float = 10) -> Message:
        """16: say the prompt and listen; data: speech, "" if nobody spoke."""
        return _message("listen", prompt=prompt, timeout=timeout)

    def getBattery(self) -> Message:
        """The battery's charge; data: percent."""
        return _message("battery")

    def stop(self) -> Message:
        """Stop everything at once."""
        return _message("stop")

    # --- units

    def _to_robot(self, params: Mapping[str, Any]) -> dict[str, Any]:
        return {name: self._metric(name, value) for name, value in params.items()}

    def _metric(self, name: str, value: Any) -> Any:
        if isinstance(value, int | float) and name in _LENGTHS:
            return value * self._metres_per_unit
        if isinstance(value, int | float) and name in _ANGLES:
            return math.degrees(value)
        return value

    def _from_robot(self, location: Mapping[str, Any]) -> dict[str, Any]:
        return {
            "x": location["x"] / self._metres_per_unit,
            "y": location["y"] / self._metres_per_unit,
            "theta": math.radians(location.get("theta", 0.0)),
            "place": location.get("place"),
        }


def _message(method: str, **params: Any) -> Message:
    given = {name: value for name, value in params.items() if value is not None}
    return {"method": method, "params": given}


def _target(x: float | str, y: float | None, theta: float | None) -> dict[str, Any]:
    return {"place": x} if isinstance(x, str) else {"x": x, "y": y, "theta": theta}
