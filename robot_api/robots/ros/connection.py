"""The connections to a robot, and whether it is there.

There is one for work, one for stopping alone, and one for each action: by default rosbridge reads
nothing more from a connection on which a goal was sent until that goal has been reached
(rosbridge_suite #909), and whatever was sent after it, a stop too, waits.

Every half second the robot is asked something on the stop's connection. When it has not answered
for `lost_after` seconds, or a connection has ended, it is lost: the connections are closed, and new
ones are tried until it is found again. The first thing that it hears then is a stop.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from robot_api.errors import LostConnection, RobotError
from robot_api.robots.link import Link
from robot_api.robots.ros.wire import Answer, Where, Wire

_BEAT = 0.2
"""Seconds between two heartbeats."""
_ASK_EVERY = 0.5
"""Seconds between two questions whether it is there."""
_TRY_EVERY = 1.0
"""Seconds between two attempts to find it again."""
_PULSE = "/rosapi/get_time"

Handler = Callable[[Mapping[str, Any]], None]


@dataclass
class Line:
    """A connection that is made anew after a loss, with what was advertised and subscribed."""

    where: Where
    advertised: dict[str, tuple[str, bool]] = field(default_factory=dict)
    subscribed: dict[str, tuple[str, Handler, float]] = field(default_factory=dict)
    wire: Wire | None = None

    def open(self) -> None:
        wire = Wire.open(self.where)
        for topic, (kind, latch) in self.advertised.items():
            wire.advertise(topic, kind, latch)
        for topic, (kind, handler, every) in self.subscribed.items():
            wire.subscribe(topic, kind, handler, every)
        self.wire = wire

    def close(self) -> None:
        if self.wire is not None:
            self.wire.close()

    @property
    def now(self) -> Wire:
        """The connection as it is. Raises `LostConnection` if there is none."""
        if self.wire is None or self.wire.over:
            raise LostConnection(
                "The connection to the robot has ended. Wait until it is found again."
            )
        return self.wire

    def advertise(self, topic: str, kind: str, latch: bool = False) -> None:
        if topic not in self.advertised:
            self.now.advertise(topic, kind, latch)
            self.advertised[topic] = kind, latch

    def publish(self, topic: str, message: Mapping[str, Any], repeated: bool = False) -> None:
        self.now.publish(topic, message, repeated)

    def subscribe(self, topic: str, kind: str, handler: Handler, every: float = 0.0) -> None:
        self.now.subscribe(topic, kind, handler, every)
        self.subscribed[topic] = kind, handler, every

    def unsubscribe(self, topic: str) -> None:
        if self.subscribed.pop(topic, None) is not None and self.wire is not None:
            self.wire.unsubscribe(topic)


class Connection:
    """All lines to one robot. `close` it, or it goes on looking for the robot.

    `heartbeat`: the topic and its type on which somebody on the robot's side can hear that we are
    there, and that it stops being watched when we leave it standing.
    """

    def __init__(self, where: Where, lost_after: float, robot: str = "The robot") -> None:
        """Raises as `Wire.open`."""
        self._where = where
        self._lost_after = lost_after
        self._robot = robot
        self.work = Line(where)
        self.halt = Line(where)
        self._more: dict[str, Line] = {}
        self._link: Link | None = None
        self._found: Callable[[], None] = lambda: None
        self._heartbeat: str | None = None
        self._closed = threading.Event()
        self._pulse: Answer | None = None
        self._asked = self._heard = time.monotonic()
        self._watcher = threading.Thread(target=self._watch, name="ros link", daemon=True)
        try:
            self._open()
        except BaseException:
            self._drop()
            raise

    def line(self, name: str) -> Line:
        """A further connection, of that name, for what may block one. Raises as `Wire.open`."""
        line = self._more.get(name)
        if line is None:
            line = Line(self._where)
            line.open()
            self._more[name] = line
            if self._link is not None:
                line.now.on_end(self._broken)
        return line

    def watch(self, link: Link, found: Callable[[], None], heartbeat: str | None) -> None:
        """Begin to tell `link` whether the robot is there. `found` is called when it has been found
        again, before the link says so."""
        self._link, self._found, self._heartbeat = link, found, heartbeat
        self._heard = time.monotonic()
        for line in self._lines():
            line.now.on_end(self._broken)
        self._watcher.start()

    def ask(self) -> Answer:
        """Ask it anything, on the connection for stopping."""
        return self.halt.now.ask(_PULSE)

    def close(self) -> None:
        """Say goodbye to whoever listens for the heartbeat, and let go."""
        if self._closed.is_set():
            return
        self._closed.set()
        if self._watcher.ident is not None:
            self._watcher.join()
        self._beat("bye")
        self._drop()

    # --- inside ----------------------------------------------------------------------------------

    def _lines(self) -> list[Line]:
        return [self.halt, self.work, *self._more.values()]

    def _open(self) -> None:
        for line in self._lines():
            line.open()

    def _drop(self) -> None:
        for line in self._lines():
            line.close()

    def _broken(self) -> None:
        """A connection has ended; in the thread of the connections."""
        if self._link is not None and not self._closed.is_set():
            self._link.lost(f"The connection to {self._robot} has ended.")

    def _watch(self) -> None:
        assert self._link is not None
        pause = _BEAT
        while not self._closed.wait(pause):
            if self._link.state == "lost":
                pause = _BEAT if self._find() else _TRY_EVERY
                continue
            try:
                self._beat("here")
                self._ask()
            except LostConnection:
                self._broken()
            silence = time.monotonic() - self._heard
            if silence > self._lost_after:
                self._link.lost(f"{self._robot} has not answered for {silence:.0f} seconds.")

    def _beat(self, word: str) -> None:
        if self._heartbeat is not None and self.halt.wire is not None and not self.halt.wire.over:
            self.halt.publish(self._heartbeat, {"data": word}, repeated=True)

    def _ask(self) -> None:
        """Whatever it answers, be it that it has no such service, it is there."""
        if self._pulse is not None and self._pulse.done.is_set():
            self._pulse, self._heard = None, time.monotonic()
        if self._pulse is None and time.monotonic() - self._asked >= _ASK_EVERY:
            self._asked = time.monotonic()
            self._pulse = self.ask()

    def _find(self) -> bool:
        assert self._link is not None
        self._drop()
        try:
            self._open()
            self._pulse = None
            self._heard = self._asked = time.monotonic()
            self._found()
        except RobotError:
            self._drop()
            return False
        self._link.found()
        for line in self._lines():
            if line.wire is not None:
                line.wire.on_end(self._broken)
        return True
