"""The language that a visitor chose at the face: theirs until they have left.

It goes for the program that runs, or for the next one; a while after its end, or as soon as
another begins, the robot speaks as it did before, for somebody else stands there.
"""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Mapping
from typing import Any

from nl2robot.console.face.forgetting import IDLE, READ_FOR, Later, later
from nl2robot.run.state import GOING
from robot_api.errors import RobotError, Stopped


class VisitorLanguage:
    """`set_language(code, theirs)` has the robot speak it, a visitor's or again the one from
    before. Any thread may call any of it."""

    def __init__(self, set_language: Callable[[str, bool], None], later: Later = later) -> None:
        self._set_language = set_language
        self._later = later
        self._lock = threading.Lock()  # for what follows
        self._before: str | None = None
        """The language from before, while a visitor's holds."""
        self._run: int | None = None
        """The program that runs."""
        self._had_theirs = False
        """Whether the program that they chose it for is over."""
        self._call_off: Callable[[], None] | None = None

    def choose(self, code: str, before: str) -> None:
        """A visitor wants it, instead of the one from `before`. Raises what the robot does."""
        self._set_language(code, True)
        with self._lock:
            if self._before is None:
                self._before = before
            self._had_theirs = False
            self._wait(IDLE if self._run is None else None)

    def on_event(self, data: Mapping[str, Any]) -> None:
        """What a program does (the data of the event "program")."""
        if data["what"] != "state":
            return
        with self._lock:
            begins = data["state"] in GOING and data["run"] != self._run
            another = begins and self._had_theirs
            if data["state"] in GOING:
                self._run = data["run"]
                self._wait(None)
            else:
                self._run, self._had_theirs = None, self._before is not None
                self._wait(READ_FOR if self._before is not None else None)
        if another:
            self._give_back()

    def close(self) -> None:
        """Nothing more is changed."""
        with self._lock:
            self._wait(None)

    def _give_back(self) -> None:
        with self._lock:
            before, self._before, self._had_theirs = self._before, None, False
        if before is not None:
            with contextlib.suppress(RobotError, Stopped):  # it is lost, and speaks none
                self._set_language(before, False)

    def _wait(self, seconds: float | None) -> None:
        if self._call_off is not None:
            self._call_off()
        self._call_off = self._later(seconds, self._give_back) if seconds is not None else None
