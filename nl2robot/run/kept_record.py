"""What is kept of how the robot moved in a run, so that it can be watched again.

Made from the events of the robot, whichever it is: where it was, some five times a second, and what
it said, heard and showed. A record never grows beyond `MOST_POSES` and `MOST_HAPPENINGS`: of a long
run, poses are kept less often. It lies in the run log, packed; so do those of the newest
`RECORDS_KEPT` runs.
"""

from __future__ import annotations

import threading
import time
import zlib
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any, Final

import msgspec

from nl2robot.run.runlog import LogError, RunLog
from robot_api.driver import EVENTS_OF_METHODS

OFTEN: Final = 0.2
"""Seconds between two poses, at first."""
SLACK: Final = 0.02
"""Seconds that a pose may come too early."""
MOST_POSES: Final = 3000
MOST_HAPPENINGS: Final = 500
LONGEST_TEXT: Final = 300
"""Letters of what was said or heard."""
RECORDS_KEPT: Final = 2000
"""At most some 20 kB each, mostly 2."""
OVER: Final = ("done", "failed", "stopped", "limit")
TOLD: Final[Mapping[str, str]] = {
    "speech": "text",
    "heard": "text",
    "screen": "text",
    "emotion": "name",
    "gesture": "name",
    **{kind: fields[0] for kind, fields in EVENTS_OF_METHODS.items() if fields},
}
"""The kinds of events that are kept, each with the field that is."""


class Pose(msgspec.Struct, frozen=True, array_like=True):
    """Where the robot was. Seconds since the run began; metres; degrees."""

    time: float
    x: float
    y: float
    theta: float


class Happening(msgspec.Struct, frozen=True, array_like=True):
    """What happened beside: "speech", "heard" and so on, see `TOLD`."""

    time: float
    kind: str
    text: str


class Movement(msgspec.Struct, frozen=True, kw_only=True):
    """A run, to be watched again. It stands still where no pose came."""

    seconds: float
    poses: tuple[Pose, ...] = ()
    happenings: tuple[Happening, ...] = ()
    shortened: bool = False
    """More happened than is kept."""


msgspec.json.Decoder(Movement)  # learned before there are threads, see `robot_api.schema`


def packed(movement: Movement) -> bytes:
    return zlib.compress(msgspec.json.encode(movement), 6)


def unpacked(record: bytes) -> Movement | None:
    """The record of such bytes; None if they are none."""
    try:
        unpacking = zlib.decompressobj()
        return msgspec.json.decode(unpacking.decompress(record, 10_000_000), type=Movement)
    except (zlib.error, msgspec.MsgspecError):
        return None


class Recorder:
    """Listens to a robot and its runner, and keeps the movement of each run. Any thread."""

    def __init__(self, log: RunLog, clock: Callable[[], float] = time.monotonic) -> None:
        self._log = log
        self._clock = clock
        self._lock = threading.Lock()
        self._taken: _Taken | None = None
        self._pose: Mapping[str, Any] | None = None  # the last before the run

    def note(self, kind: str, data: Mapping[str, Any]) -> None:
        """The next event."""
        with self._lock:
            if kind == "pose":
                self._pose = data
            if kind == "program":
                self._program(data)
            elif self._taken is not None:
                self._taken.note(kind, data, self._clock())

    def _program(self, data: Mapping[str, Any]) -> None:
        if data["what"] != "state":
            return
        if data["state"] in OVER:
            taken, self._taken = self._taken, None
            if taken is not None:
                with suppress(LogError):  # the run is over and logged, only this is missing
                    record = packed(taken.movement(self._clock()))
                    self._log.keep_movement(taken.run, record, RECORDS_KEPT)
        elif self._taken is None or self._taken.run != data["run"]:
            self._taken = _Taken(data["run"], self._clock())
            if self._pose is not None:
                self._taken.note("pose", self._pose, self._clock())


class _Taken:
    """The movement of a run, while it goes on."""

    def __init__(self, run: int, began: float) -> None:
        self.run = run
        self._began = began
        self._every = OFTEN
        self._poses: list[Pose] = []
        self._last: Pose | None = None  # the newest; kept when the next one is far enough from it
        self._happenings: list[Happening] = []
        self._shortened = False

    def note(self, kind: str, data: Mapping[str, Any], now: float) -> None:
        at = round(now - self._began, 2)
        if kind == "pose":
            theta = round(data.get("theta", 0.0) % 360, 1)
            self._pose(Pose(at, round(data["x"], 3), round(data["y"], 3), theta))
        elif text := str(data.get(TOLD.get(kind, ""), "") or ""):
            if len(self._happenings) < MOST_HAPPENINGS:
                self._happenings.append(Happening(at, kind, text[:LONGEST_TEXT]))
            else:
                self._shortened = True

    def movement(self, now: float) -> Movement:
        self._keep_last()
        return Movement(
            seconds=round(now - self._began, 2),
            poses=tuple(self._poses),
            happenings=tuple(self._happenings),
            shortened=self._shortened,
        )

    def _pose(self, pose: Pose) -> None:
        if self._poses and pose.time - self._poses[-1].time < self._every - SLACK:
            self._last = pose
            return
        if self._last is not None and pose.time - self._last.time > self._every:
            self._keep_last()  # it stood there from then on
        self._keep(pose)

    def _keep_last(self) -> None:
        if self._last is not None:
            self._keep(self._last)

    def _keep(self, pose: Pose) -> None:
        self._last = None
        self._poses.append(pose)
        if len(self._poses) > MOST_POSES:
            del self._poses[1::2]
            self._every *= 2
