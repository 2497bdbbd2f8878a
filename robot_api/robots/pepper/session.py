"""What is said to one Pepper: over a connection for work, and over one for stops alone, which never
wait behind anything.

    wire = Wire(address, password)
    wire.open()
    wire.follow(link, stand_still)                        # from now on: lost and found
    wire.call("ALBattery", "getBatteryCharge")            # a light call, with a time limit
    wire.run(stop, "ALMotion", "moveTo", 1.0, 0.0, 0.0)   # until it is done, stopped or lost

The robot is lost when a connection ends, and when it answers no beat within `SILENT_AFTER`. It is
found again when both connections stand and the robot has confirmed that it does, too: what it was
still at while nobody could reach it is ended, and not resumed.
"""

from __future__ import annotations

import atexit
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from traceback import clear_frames
from typing import Any, Final

from robot_api.capabilities.base import POLL
from robot_api.driver import StopFlag
from robot_api.errors import LostConnection, NotPossible, NotSupported, RobotError
from robot_api.robots.address import Address
from robot_api.robots.link import Link
from robot_api.robots.pepper.line import (
    ANSWERS_WITHIN,
    CONNECTS_WITHIN,
    CUT,
    Future,
    Line,
    finished,
    login_of,
)
from robot_api.robots.pepper.presence import Driving

BEAT: Final = 0.5
"""Seconds between two looks whether the robot answers."""
SILENT_AFTER: Final = 1.5
"""Seconds without an answer after which it is lost."""
_TRIES_EVERY: Final = 1.0
"""Seconds between two attempts to find it again."""
_COME_BACK_WITHIN: Final = 1.0
"""Seconds in which calls come back whose connection was closed."""
_NEEDED: Final = ("ALMotion", "ALMemory")
"""What every Pepper has."""

Ending = tuple[str, ...]
"""What ends a long call: service, method, and its arguments."""


class Wire:
    """Any thread may use it, once it is open."""

    def __init__(self, address: Address, password: str | None = None) -> None:
        """Raises `AccessDenied` if a password is missing."""
        self._address = address
        self._login = login_of(address, password)
        self._driving = Driving()
        self._each_time: list[Callable[[Line], None]] = []
        self._link: Link | None = None
        self._stand_still: Callable[[], None] = _nothing
        self._watcher: threading.Thread | None = None
        self._look = threading.Event()  # something has happened: look at once
        self._closed = False
        self._calls = 0
        self._came_back = threading.Condition()
        self.services: frozenset[str] = frozenset()
        """The robot's, by name."""

    def open(self) -> None:
        """Reach the robot, and be the one who drives it. Raises `LostConnection`, `AccessDenied`,
        `NotSupported`."""
        self._work, self._stops = self._lines()
        # Whoever forgets to close: a session that outlives Python takes it down with it.
        atexit.register(self.close)

    def follow(self, link: Link, stand_still: Callable[[], None]) -> None:
        """Tell the link from now on whether the robot can be reached. `stand_still` brings it to
        rest when it is found again; raises a `RobotError` if that is not confirmed."""
        self._link, self._stand_still = link, stand_still
        self._watcher = threading.Thread(target=self._watch, name="pepper", daemon=True)
        self._watcher.start()

    def has(self, *services: str) -> bool:
        return self.services.issuperset(services)

    # --- work ------------------------------------------------------------------------------------

    def call(
        self, service: str, method: str, *arguments: Any, within: float = ANSWERS_WITHIN
    ) -> Any:
        """A light call. Raises `LostConnection` if it takes longer than `within` seconds."""
        self.check()
        with self._calling():
            return self._work.call(service, method, *arguments, within=within)

    def run(
        self,
        stop: StopFlag,
        service: str,
        method: str,
        *arguments: Any,
        ending: Sequence[Ending] = (),
        meanwhile: Callable[[], None] = lambda: None,
    ) -> Any:
        """A call that takes its time. Once it is stopped, or `meanwhile` raises something, the
        robot is told to end it by `ending`, since `qi` cannot take a plain call back. `meanwhile`
        is called again and again. Raises `Stopped`, `LostConnection`."""
        stop.check()
        self.check()
        with self._calling():
            line = self._work
            running = line.begin(service, method, *arguments)
            try:
                while not finished(running, POLL):
                    stop.check()
                    self.check()
                    meanwhile()
                stop.check()
            except LostConnection:
                raise
            except BaseException:
                with suppress(RuntimeError):
                    running.cancel()  # of use to those few calls that can be taken back
                for each in ending:
                    with suppress(RobotError):
                        self.begin_stop(*each)
                raise
            else:
                return line.answered(running, f"{service}.{method}", POLL)
            finally:
                del running

    def each_time(self, prepare: Callable[[Line], None]) -> None:
        """Do it now, and whenever the robot is reached anew, which may have been restarted
        meanwhile; it has to be content with what it finds then."""
        prepare(self._work)
        self._each_time.append(prepare)

    def register(self, name: str, service: object) -> int:
        """Give the robot a service of ours to call."""
        self.check()
        return self._work.register(name, service)

    def unregister(self, number: int) -> None:
        self._work.unregister(number)

    # --- stops -----------------------------------------------------------------------------------

    def begin_stop(self, service: str, method: str, *arguments: str) -> Future:
        """Over the connection of its own; also while the robot counts as lost."""
        return self._stops.begin(service, method, *arguments)

    def call_stop(self, service: str, method: str, within: float) -> Any:
        return self._stops.call(service, method, within=within)

    # --- the end ---------------------------------------------------------------------------------

    def close(self) -> None:
        """Let go of the robot."""
        atexit.unregister(self.close)
        self._closed = True
        self._look.set()
        if self._watcher is not None:
            self._watcher.join(CONNECTS_WITHIN + SILENT_AFTER)
        self._work.close()
        self._stops.close()
        # A call of `qi` that outlives Python takes it down as well.
        with self._came_back:
            self._came_back.wait_for(lambda: self._calls == 0, _COME_BACK_WITHIN)

    # --- lost and found --------------------------------------------------------------------------

    def check(self) -> None:
        """Raise `LostConnection` while the robot cannot be reached."""
        if self._closed:
            raise LostConnection("The connection to Pepper is closed. Start the server again.")
        if self._link is not None:
            self._link.check()

    @contextmanager
    def _calling(self) -> Iterator[None]:
        with self._came_back:
            self._calls += 1
        try:
            yield
        except BaseException as error:
            # What they hold of `qi` comes back with the call, not with whoever handles the error:
            # that may be a thread which Python has given up by then.
            each: BaseException | None = error
            while each is not None:
                clear_frames(each.__traceback__)
                each = each.__context__
            raise
        finally:
            with self._came_back:
                self._calls -= 1
                self._came_back.notify_all()

    def _lines(self) -> tuple[Line, Line]:
        """Both connections, ready."""
        work = Line(self._address, self._login)
        try:
            self.services = work.names()
            lacks = [name for name in _NEEDED if name not in self.services]
            if lacks:
                raise NotSupported(
                    f"What answers at {self._address.host} is no Pepper: it has no {lacks[0]}."
                    " Check the address."
                )
            self._driving.claim(work)
            stops = Line(self._address, self._login)
        except BaseException:
            work.close()
            raise
        for line in (work, stops):
            line.when_gone(self._look.set)
        for service in self.services & {"ALMotion", "ALTextToSpeech"}:
            stops.service(service)  # a stop must not have to look for it first
        return work, stops

    def _watch(self) -> None:
        link = self._link
        assert link is not None
        while not self._closed:
            lost = link.state == "lost"
            self._look.wait(_TRIES_EVERY if lost else BEAT)
            self._look.clear()
            if self._closed:
                return
            if not lost:
                because = self._silence()
                if because and not self._closed:
                    link.lost(because)
            elif self._reached():
                link.found()

    def _silence(self) -> str | None:
        """Why it counts as lost, as a sentence; None while it answers."""
        until = time.monotonic() + SILENT_AFTER
        try:
            beats = [(line, line.begin("ALMotion", "getRobotVelocity")) for line in self._both()]
            for line, beat in beats:
                if not finished(beat, until - time.monotonic()):
                    return f"Pepper has not answered for {SILENT_AFTER:g} seconds."
                line.answered(beat, "ALMotion")
        except LostConnection:
            return CUT
        except RobotError:
            return None  # it answers, if with a complaint
        return None

    def _reached(self) -> bool:
        """Whether it can be reached again, and stands."""
        try:
            if self._silence() is not None:
                self._renew()
            self._stand_still()
        except RobotError:
            return False
        return True

    def _renew(self) -> None:
        """Both connections anew."""
        lines = self._lines()
        old = lines if self._closed else self._both()
        if not self._closed:
            self._work, self._stops = lines
        for line in old:
            line.close()
        for prepare in self._each_time:
            with suppress(NotPossible, NotSupported):
                prepare(self._work)

    def _both(self) -> tuple[Line, Line]:
        return self._work, self._stops


def _nothing() -> None: ...
