"""What a robot is to the server: a driver.

A driver says what its robot can do (`capabilities`), does it (`call`), and stops (`stop`). The
server calls it from worker threads, one thread for each call in flight. `robot_api.capabilities`
holds, a file for each capability, the interface with the implementations side by side; a driver is
put together from those.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from typing import Any, Protocol

import msgspec

from robot_api.capabilities.languages import known_languages
from robot_api.errors import Stopped
from robot_api.methods import METHODS


class Capabilities(msgspec.Struct, frozen=True, kw_only=True):
    """What a robot can do; sent to every client that asks with `robot.capabilities`."""

    name: str
    """The robot's name, for people: "Simulated robot"."""
    kind: str
    """"simulator", "emulator", "pepper" ..."""
    methods: tuple[str, ...]
    """The names from the method table that it has, its own or through a shared implementation."""
    languages: tuple[str, ...] = msgspec.field(default_factory=known_languages)
    emotions: tuple[str, ...] = ()
    gestures: tuple[str, ...] = ()
    joints: dict[str, tuple[float, float]] = {}
    """Each joint's name with its least and greatest angle in degrees."""
    skills: dict[str, str] = {}
    """The robot's own extra skills for `do`, each with a line that says what it does."""
    contacts: tuple[str, ...] = ()
    hands: int = 1
    """How many things it can hold at once."""
    units: str = "m"
    """The unit of the map, "m" or "cm": what the paper's message style counts in."""
    stand_ins: dict[str, str] = {}
    """The capabilities that something else does in the robot's place, each with what does it, for
    people: {"face": "a face on the screen"}."""
    stop_within: float = 0.05
    """Seconds in which the robot confirms that it stands after a stop."""
    limits: dict[str, float] = {}
    """What it may do at most: speed (m/s), acceleration (m/s²), turn_rate (degrees/s), volume
    (percent)."""


msgspec.json.Decoder(Capabilities)  # learned before there are threads, see `schema`


class StopFlag:
    """Whether the call at hand was stopped; motion must look at it at least every 20 ms.

    `callback`s run once, in the thread that stops, so that a call that waits can be woken.
    """

    def __init__(self) -> None:
        self._event = threading.Event()
        self._because = "The robot was stopped."
        self._callbacks: list[Callable[[], None]] = []
        self._lock = threading.Lock()

    def set(self, because: str = "The robot was stopped.") -> None:
        with self._lock:
            if self._event.is_set():
                return
            self._because = because
            self._event.set()
            callbacks, self._callbacks = self._callbacks, []
        for callback in callbacks:
            callback()

    def is_set(self) -> bool:
        return self._event.is_set()

    def wait(self, seconds: float) -> bool:
        """Wait in real time; True as soon as it is stopped."""
        return self._event.wait(seconds)

    def check(self) -> None:
        """Raise `Stopped` if it is set."""
        if self._event.is_set():
            raise Stopped(self._because)

    def on_set(self, callback: Callable[[], None]) -> None:
        with self._lock:
            if not self._event.is_set():
                self._callbacks.append(callback)
                return
        callback()


Event = Mapping[str, Any]
"""Data of an event for those who subscribed; its kinds are the keys of `EVENTS`."""

_EVENTS: Mapping[str, str] = {
    "pose": "x, y (metres), theta (degrees), place, speed (m/s), time (s); 10 a second when moving",
    "lidar": "metres: distances to what is around it, evenly round it from straight ahead to the"
    " left, null where nothing is in reach; at most 5 a second",
    "speech": "text, language: the robot speaks",
    "heard": "text, person: somebody answered",
    "language": "code: the robot speaks and hears it from now on",
    "screen": "text | html | url | options: what the screen shows",
    "emotion": "name",
    "gesture": "name",
    "volume": "percent: how loud the robot is from now on",
    "joint": "name, degrees: how a joint stands from now on",
    "call": "contact, state: a video call",
    "battery": "percent, charging",
    "log": "level, message, time",
    "sound": "audio (a WAV file in base64), seconds: the next piece of what the robot says, for"
    " whoever plays it; played one after the other",
    "silence": "because: what was to be played is not to be heard any more",
    "searched": "thing, places: it has looked there for something, in the order of the places, and"
    " has not found it",
    "stopping": "because: it was told to stop, and everything that was in flight has ended",
    "stopped": "because: the robot has confirmed that it stands",
    "stop_not_confirmed": "because, message: it may still be moving, use its own button",
    "link": "state (connected, lost), since (seconds since the epoch), because: whether the robot"
    " can be reached",
}

EVENTS_OF_METHODS: Mapping[str, tuple[str, ...]] = {
    method.tells: tuple(parameter.name for parameter in method.forms[0])
    for method in METHODS.values()
    if method.tells is not None and method.tells not in _EVENTS
}
"""The kinds of which only the method table says what they tell: the parameters."""

EVENTS: Mapping[str, str] = {
    **_EVENTS,
    **{kind: ", ".join(fields) for kind, fields in EVENTS_OF_METHODS.items()},
}


class Driver(Protocol):
    """The interface between the server and a robot."""

    def capabilities(self) -> Capabilities: ...

    def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
        """Do what the method table says of `method` and return its result as JSON data, a
        `Location` or a `Clock`. `arguments` have been validated against the table. Blocks until
        the action is done; raises a `RobotError`, or `Stopped` once `stop` is set."""

    def stop(self, because: str) -> None:
        """Bring the body to rest at once, from any thread: what stops it goes out within 50 ms.
        Returns when the robot has confirmed that it stands, at most `Capabilities.stop_within`
        later; raises `StopNotConfirmed` if it has not by then. The calls in flight have their
        flags set before this is called."""

    def subscribe(self, listener: Callable[[str, Event], None]) -> Callable[[], None]:
        """Call `listener(kind, data)`, from any thread, for each event; returns what ends it."""

    def close(self) -> None:
        """Leave the robot standing and let go of it."""
