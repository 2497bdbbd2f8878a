"""Stops a real robot when the server that drives it is killed, or frozen: a process of its own.

    guardian = Guardian(order)      # beside the driver, for as long as it drives
    ...
    guardian.close()                # the robot was left standing: nothing to do

The server's side sends a beat a few times a second through a pipe. When the pipe ends without a
goodbye, or stays silent, the guardian brings the robot to rest over a connection of its own
(`RobotKind.brake`). It cannot help where the whole machine, or the network, is gone: that is for
what runs on the robot itself.
"""

from __future__ import annotations

import contextlib
import logging
import os
import signal
import subprocess
import sys
import threading
import time
from typing import Any, Final

import msgspec

from robot_api.errors import LostConnection, RobotError
from robot_api.robots.address import parse
from robot_api.robots.places import NamedPlace, Places
from robot_api.robots.registry import Brake, RobotKind, Setup, kind_of
from robot_api.robots.robot_file import RobotFile

BEAT: Final = 0.2
"""Seconds between two beats."""
SILENT: Final = 1.0
"""Seconds of silence after which the server counts as frozen: a busy machine is late as well."""
TRIES_FOR: Final = 20.0
"""Seconds for which a robot is tried to be stopped that does not confirm it."""
REACHES_WITHIN: Final = 20.0
"""Seconds after which it is told that the guardian has not reached the robot."""
_AGAIN: Final = 0.5
"""Seconds between two such tries, and between two to reach the robot at the start."""
_ANEW: Final = 5.0
"""Seconds until a guardian that has died is started again."""
_ENDS_WITHIN: Final = 5.0
_WATCHING: Final = b"watching\n"
_ALIVE, _GOODBYE = b".", b"q"

_log = logging.getLogger("robot_api.robots")


class Order(msgspec.Struct, frozen=True, kw_only=True):
    """Which robot, in words that another process understands."""

    address: str
    file: RobotFile = RobotFile()
    settings: dict[str, Any] | None = None
    places: dict[str, NamedPlace] = {}
    password: str | None = None

    @classmethod
    def of(cls, setup: Setup) -> Order:
        return cls(
            address=str(setup.address),
            file=setup.file,
            settings=None if setup.settings is None else msgspec.to_builtins(setup.settings),
            places=dict(setup.places.named),
            password=setup.password,
        )

    def setup(self) -> tuple[RobotKind, Setup]:
        address = parse(self.address)
        kind = kind_of(address)
        settings = None
        if kind.settings is not None and self.settings is not None:
            settings = msgspec.convert(self.settings, kind.settings)
        return kind, Setup(
            address=address,
            file=self.file,
            places=Places(self.places),
            settings=settings,
            password=self.password,
        )


class Guardian:
    """The server's side. A guardian that dies is started again."""

    def __init__(self, order: Order) -> None:
        """Returns at once; `watches` tells when it has reached the robot."""
        self._order = msgspec.json.encode(order) + b"\n"
        self._over = threading.Event()
        self._watches = threading.Event()
        self._process = self._start()
        self._thread = threading.Thread(target=self._beat, name="guardian", daemon=True)
        self._thread.start()

    def watches(self, within: float) -> bool:
        """Whether it has reached the robot, waiting for that so many seconds at most."""
        return self._watches.wait(within)

    def close(self) -> None:
        """Say goodbye: the robot was left standing."""
        self._over.set()
        self._thread.join()
        self._say(_GOODBYE)
        with contextlib.suppress(OSError):
            self._pipe(self._process).close()
        try:
            self._process.wait(_ENDS_WITHIN)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def _start(self) -> subprocess.Popen[bytes]:
        process = subprocess.Popen(
            [sys.executable, "-m", "robot_api.robots.guardian"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            bufsize=0,
            start_new_session=True,  # Ctrl-C, and a terminal that is closed, are for the server
        )
        with contextlib.suppress(OSError):  # it has died: that is seen at the next beat
            self._pipe(process).write(self._order)
        threading.Thread(target=self._listen, args=(process,), daemon=True).start()
        return process

    def _listen(self, process: subprocess.Popen[bytes]) -> None:
        assert process.stdout is not None
        with process.stdout as output:
            if output.readline() == _WATCHING:
                self._watches.set()

    def _beat(self) -> None:
        started, is_told = time.monotonic(), False
        while not self._over.wait(BEAT):
            late = time.monotonic() - started > REACHES_WITHIN
            if late and not is_told and not self._watches.is_set():
                is_told = True
                _log.warning(
                    "the guardian does not reach the robot: nothing stops it yet if this server is"
                    " killed"
                )
            if self._say(_ALIVE) or time.monotonic() - started < _ANEW:
                continue
            _log.error("the robot's guardian has died: it is started again")
            self._process.kill()
            self._process.wait()
            self._watches.clear()
            self._process, started = self._start(), time.monotonic()

    def _say(self, word: bytes) -> bool:
        try:
            self._pipe(self._process).write(word)
        except (OSError, ValueError):
            return False
        return True

    @staticmethod
    def _pipe(process: subprocess.Popen[bytes]) -> Any:
        return process.stdin


# --- the other process ---------------------------------------------------------------------------


class _Server:
    """What is heard of the server."""

    def __init__(self) -> None:
        self.order = _read_line()
        self.gone = threading.Event()
        self.said_goodbye = False
        self._heard = threading.Event()
        threading.Thread(target=self._listen, daemon=True).start()

    def silent_for(self, seconds: float) -> bool:
        """Wait until it says something or is gone; whether it has done neither for so long. Counted
        by the waits: a guardian that was kept from running itself has heard nothing wrong."""
        waited = 0.0
        while waited < seconds:
            if self._heard.wait(BEAT) or self.gone.is_set():
                self._heard.clear()
                return False
            waited += BEAT
        return True

    def wait_for_a_sign(self) -> None:
        """Until it says something again, or is gone."""
        self._heard.wait()

    def _listen(self) -> None:
        while said := os.read(0, 4096):
            self.said_goodbye = said.endswith(_GOODBYE)
            self._heard.set()
        self.gone.set()
        self._heard.set()


def _read_line() -> bytes:
    line = b""
    while not line.endswith(b"\n"):
        more = os.read(0, 1)
        if not more:
            sys.exit(0)
        line += more
    return line


def _reach(kind: RobotKind, setup: Setup, server: _Server) -> Brake | None:
    """Beside the server's driver; None if that is gone before."""
    assert kind.brake is not None
    while not server.gone.is_set():
        try:
            return kind.brake(setup)
        except RobotError:
            server.gone.wait(_AGAIN)
    return None


def _stop(kind: RobotKind, setup: Setup, brake: Brake | None) -> Brake | None:
    """Bring it to rest, over a new connection if need be; returns the brake that can be used from
    now on. Raises `RobotError` if it has not confirmed that it stands."""
    assert kind.brake is not None
    end = time.monotonic() + TRIES_FOR
    while True:
        try:
            if brake is None:
                brake = kind.brake(setup)
            brake.halt()
            return brake
        except RobotError:
            if brake is not None:
                brake.close()
                brake = None
            if time.monotonic() > end:
                raise
            time.sleep(_AGAIN)


def main() -> int:
    """Watch over the robot of the order that stands on the first line of standard input."""
    for number in (signal.SIGINT, signal.SIGTERM):  # which end the server, and that says goodbye
        signal.signal(number, signal.SIG_IGN)
    server = _Server()
    kind, setup = msgspec.json.decode(server.order, type=Order).setup()
    brake = _reach(kind, setup, server)
    if brake is not None:
        with contextlib.suppress(OSError):
            os.write(1, _WATCHING)
    try:
        while not server.gone.is_set():
            if server.silent_for(SILENT):
                brake = _told(kind, setup, brake, "is silent")
                server.wait_for_a_sign()
        if not server.said_goodbye:
            brake = _told(kind, setup, brake, "has ended without a word")
    finally:
        if brake is not None:
            brake.close()
    return 0


def _told(kind: RobotKind, setup: Setup, brake: Brake | None, what: str) -> Brake | None:
    """Stop the robot, and say so where the server said what it had to say."""
    try:
        brake = _stop(kind, setup, brake)
    except RobotError as error:
        trouble = "" if isinstance(error, LostConnection) else f" ({error})"
        said = f"and the robot has not confirmed that it stands{trouble}. Use its own button."
        brake = None
    else:
        said = "so the robot was stopped."
    with contextlib.suppress(OSError):
        print(f"The robot's server {what}, {said}", file=sys.stderr, flush=True)
    return brake


if __name__ == "__main__":
    sys.exit(main())
