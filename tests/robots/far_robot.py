"""A robot that is far away: it can be lost and found, and confirm a stop late, never, or badly.

It is also the kind `far`, for a server in a process of its own: `FarPackage` installs it there, and
tells it from outside what to do.
"""

from __future__ import annotations

import contextlib
import os
import select
import socket
import threading
from datetime import datetime
from pathlib import Path
from typing import Any, Final

from robot_api.capabilities.core import EmulatedCore, LogBook
from robot_api.capabilities.driving import Motion
from robot_api.capabilities.emulation import Emulation
from robot_api.capabilities.speech import EmulatedSpeech
from robot_api.composed import ComposedDriver
from robot_api.driver import Driver, StopFlag
from robot_api.errors import AccessDenied, LostConnection, StopNotConfirmed
from robot_api.robots.link import Link
from robot_api.robots.registry import RobotKind, Setup
from tests.robots.packages import install

SOON: Final = 20.0
"""Seconds; what is waited for comes within milliseconds."""


class FarCore(EmulatedCore):
    """Comes to rest when `confirms` says so."""

    def __init__(self, emulation: Emulation, book: LogBook) -> None:
        super().__init__(emulation, book)
        self.confirms = True
        self.raises: Exception | None = None
        self.asked = threading.Semaphore(0)
        """Released each time it is told to stop."""
        self.held: threading.Event | None = None
        """A stop is not confirmed before this is set."""

    def rest(self) -> None:
        self.asked.release()
        if self.raises is not None:
            raise self.raises
        if self.held is not None and not self.held.wait(SOON):
            raise AssertionError("nobody let it confirm")
        if not self.confirms:
            raise StopNotConfirmed

    def declares(self) -> dict[str, Any]:
        return {"stop_within": 0.3}


class FarWheels(Motion):
    """Roll until they are stopped."""

    def __init__(self) -> None:
        self.under_way = threading.Semaphore(0)
        self.breaks: Exception | None = None
        """What the robot's own software says when a movement is broken off."""

    def drive(self, stop: StopFlag, linear: float, angular: float, seconds: float) -> None:
        self._roll(stop)

    def move(self, stop: StopFlag, metres: float) -> None:
        self._roll(stop)

    def turn(self, stop: StopFlag, degrees: float) -> None:
        self._roll(stop)

    def _roll(self, stop: StopFlag) -> None:
        self.under_way.release()
        stop.wait(SOON)
        if self.breaks is not None:
            raise self.breaks
        stop.check()

    def declares(self) -> dict[str, Any]:
        return {"limits": {"speed": 0.7, "turn_rate": 90}}


class FarRobot(ComposedDriver):
    def __init__(self) -> None:
        emulation = Emulation(start=datetime(2026, 11, 20, 8, 0), speed=1.0)
        book = LogBook(emulation.now, emulation.hub)
        self.link = Link(emulation.hub, "The far robot")
        self.core = FarCore(emulation, book)
        self.wheels = FarWheels()
        self.emulation = emulation
        super().__init__(
            name="The far robot",
            kind="far",
            parts=[self.core, EmulatedSpeech(emulation), self.wheels],
            hub=emulation.hub,
            book=book,
            link=self.link,
        )

    def is_lost(self) -> None:
        self.link.lost("The far robot does not answer any more.")


# --- as a kind of robot ----------------------------------------------------------------------

CONTROL: Final = "FAR_ROBOT"
"""The environment variable with the port at which somebody tells the robot what to do."""
ROOT: Final = Path(__file__).parents[2]


def connect(setup: Setup) -> Driver:
    if setup.address.host == "nowhere":
        raise LostConnection("The far robot does not answer. See that it is switched on.")
    if setup.address.host == "locked" and setup.password != "sesame":
        raise AccessDenied("The far robot wants a password.")
    robot = FarRobot()
    robot.core.confirms = setup.address.host != "deaf"
    if CONTROL in os.environ:
        told = socket.create_connection(("127.0.0.1", int(os.environ[CONTROL])))
        threading.Thread(target=_obey, args=(robot, told), daemon=True).start()
    return robot


def _obey(robot: FarRobot, told: socket.socket) -> None:
    with contextlib.suppress(OSError), told.makefile("rw") as lines:
        for line in lines:
            match line.strip():
                case "be lost":
                    robot.is_lost()
                case "be found":
                    robot.link.found()
                case "confirm nothing":
                    robot.core.confirms = False
                case "confirm":
                    robot.core.confirms = True
            lines.write("done\n")
            lines.flush()


FAR: Final = RobotKind(
    scheme="far", title="A far robot", example="far://HOST", connect=connect, port=7
)


class FarPackage:
    """The far robot, installed for other processes."""

    def __init__(self, folder: Path) -> None:
        self._listening = socket.create_server(("127.0.0.1", 0))
        self._robot: socket.socket | None = None
        self.site = install(folder / "site", "far-robot", "far = tests.robots.far_robot:FAR")
        before = os.environ.get("PYTHONPATH", "")
        self.environment = {
            "PYTHONPATH": os.pathsep.join(filter(None, (str(self.site), str(ROOT), before))),
            CONTROL: str(self._listening.getsockname()[1]),
        }

    def tell(self, words: str) -> None:
        """Tell the newest robot; returns when it has obeyed."""
        self._listening.settimeout(SOON)
        while self._robot is None or select.select([self._listening], [], [], 0)[0]:
            self._robot = self._listening.accept()[0]
        self._robot.settimeout(SOON)
        self._robot.sendall(f"{words}\n".encode())
        assert self._robot.recv(100) == b"done\n"

    def close(self) -> None:
        self._listening.close()
        if self._robot is not None:
            self._robot.close()
