"""What somebody has the robot do without a program: with the joystick, or by a script on the wire.
It is in the log as what programs do, or it is not done."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping
from typing import Any, Final

import msgspec

from nl2robot.run.runlog import LogError, RunLog
from nl2robot.station.harmless import ONLY_LOOKS
from robot_api.errors import NotPossible

BUSY: Final = "A program is running, and drives the robot. Wait for its end, or stop it first."
"""Why nothing is done by hand meanwhile: what it does was approved, this was not."""
ONE_DRIVE: Final = 2.0
"""Seconds between two movements of the joystick that are one drive: there are ten each second."""
SOMEBODY: Final = "somebody"
"""Who calls over a connection that tells no name."""


class ByHand:
    """Notes it. Any thread may call it."""

    def __init__(self, log: RunLog, passed: Callable[[], float] = time.monotonic) -> None:
        self._log = log
        self._passed = passed
        self._lock = threading.Lock()
        self._drives: dict[str, float] = {}

    def note(self, who: str | None, method: str, arguments: Mapping[str, Any]) -> None:
        """Before it is done. Raises `NotPossible` if it cannot be logged."""
        name = who or SOMEBODY
        if method in ONLY_LOOKS or (method == "drive" and self._goes_on(name)):
            return
        given = {key: value for key, value in arguments.items() if value is not None}
        try:
            self._log.by_hand(name, method, msgspec.json.encode(given).decode())
        except LogError as error:
            raise NotPossible(str(error)) from error

    def _goes_on(self, who: str) -> bool:
        """Whether they drive already."""
        with self._lock:
            before, now = self._drives.get(who), self._passed()
            self._drives = {**self._drives, who: now}
        return before is not None and now - before < ONE_DRIVE
