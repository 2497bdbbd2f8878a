"""What visitors leave at the robot's face is taken away again: what they typed and answered, what
was shown to them, whom they called.

    a program in which a visitor did something ends
        -> what was said and asked is gone at once, and so is a page into which they typed
        -> what else is shown is gone after `READ_FOR`, so that they can read it, or as soon as the
           next program begins
    somebody typed or answered while no program runs, and then did nothing for `IDLE`
        -> what is shown is shown afresh

What a program shows while nobody does anything, such as a sign, stays.
"""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Mapping
from typing import Any, Final

from nl2robot.run.state import GOING
from robot_api.driver import Driver, Event, StopFlag
from robot_api.errors import RobotError, Stopped

READ_FOR: Final = 10.0
"""Seconds after the end of a program in which a visitor can read what it has shown."""
IDLE: Final = 180.0
"""Seconds without a touch after which whoever typed is taken to have left."""
_PERSONAL: Final = frozenset({"ask", "listen", "touch", "read_text", "call", "scan"})
"""Methods of which something is learned of who stands there."""

_log = logging.getLogger(__name__)

Later = Callable[[float, Callable[[], None]], Callable[[], None]]
"""Does something after so many seconds, in a thread of its own; returns what calls it off."""


def later(seconds: float, act: Callable[[], None]) -> Callable[[], None]:
    """See `Later`."""
    timer = threading.Timer(seconds, act)
    timer.daemon = True
    timer.start()
    return timer.cancel


class Forgetting:
    """Knows whether a visitor left something at the faces, and takes it away.

    `hush` takes away what the robot said last; `typed` says whether somebody has done something to
    the page that is shown; `fresh` is what the robot showed before they did.
    """

    def __init__(
        self,
        driver: Driver,
        hush: Callable[[], None],
        typed: Callable[[], bool],
        fresh: Callable[[], Mapping[str, Any]],
        later: Later = later,
    ) -> None:
        self._driver = driver
        self._hush = hush
        self._typed = typed
        self._fresh = fresh
        self._later = later
        self._lock = threading.RLock()  # for what follows
        self._left = False
        """Whether a visitor left something."""
        self._run: int | None = None
        """The program that runs."""
        self._call_off: Callable[[], None] | None = None

    def noticed(self) -> None:
        """A visitor has touched, typed, answered or called."""
        with self._lock:
            self._left = True
            if self._run is None:
                self._wait(IDLE, self._idle)

    def on_event(self, data: Event) -> None:
        """What a program does (the data of the event "program")."""
        if data["what"] == "result" and data["method"] in _PERSONAL and not data.get("error"):
            self.noticed()
        if data["what"] != "state":
            return
        if data["state"] in GOING:
            self._begins(data["run"])
        else:
            self._ends()

    def close(self) -> None:
        """Nothing more is taken away."""
        with self._lock:
            self._wait(None)

    # --- inside

    def _begins(self, run: int) -> None:
        with self._lock:
            if self._run == run:  # it only goes on
                return
            self._run = run
            self._wait(None)
            left, self._left = self._left, False
        if left:  # before its first call: it finds nothing of who was there before
            self._take_away()

    def _ends(self) -> None:
        with self._lock:
            self._run = None
            if not self._left:
                return
            at_once = self._typed()
            self._wait(0.0 if at_once else READ_FOR, self._after_the_end)
        self._hush()

    def _after_the_end(self) -> None:
        with self._lock:
            if self._run is not None or not self._left:
                return
            self._left = False
        self._take_away()

    def _idle(self) -> None:
        with self._lock:
            if self._run is not None or not self._left:
                return
            self._left = False
            shown = dict(self._fresh())
        self._hush()
        self._show(shown)

    def _take_away(self) -> None:
        self._hush()
        self._show({"text": ""})

    def _show(self, content: Mapping[str, Any]) -> None:
        try:
            self._driver.call("show", dict(content), StopFlag())
        except (RobotError, Stopped) as error:  # it is lost; a face that is opened anew is empty
            _log.warning("What a visitor left is still on the screen: %s", error)

    def _wait(self, seconds: float | None, act: Callable[[], None] | None = None) -> None:
        if self._call_off is not None:
            self._call_off()
        self._call_off = None
        if seconds is not None and act is not None:
            self._call_off = self._later(seconds, act)
