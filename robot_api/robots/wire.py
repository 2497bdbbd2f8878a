"""A robot at another server of ours, as a driver: `ws://host:port`.

Every call goes on over one connection, a stop over another that nothing else waits on. When the
connection breaks the robot is lost, and its server stops it; it is tried again until it is found.
"""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable
from dataclasses import replace
from typing import Any, Final

import msgspec

from robot_api.capabilities.base import Hub
from robot_api.client import DEFAULT_PORT, Robot
from robot_api.driver import EVENTS, Capabilities, Driver, Event, StopFlag
from robot_api.errors import LostConnection, RobotError, StopNotConfirmed
from robot_api.robots.link import Link
from robot_api.robots.registry import RobotKind, Setup

SILENT_FOR: Final = 3.0
"""Seconds without a sign of life after which the server counts as lost."""
ON_THE_WAY: Final = 0.5
"""Seconds that a stop and its confirmation may spend in the network, beside the robot's own."""
FIRST_PAUSE: Final = 0.1
"""Seconds between the first attempts to find the server again; each is twice the one before."""
LONGEST_PAUSE: Final = 5.0


class WireDriver:
    """Passes every call on. Raises `LostConnection` and `AccessDenied` where there is no robot's
    server at the address."""

    def __init__(self, address: str, token: str | None = None) -> None:
        self._address = address
        self._token = token
        self._hub = Hub()
        self._closed = threading.Event()
        self._searching = threading.Lock()
        self._begun = threading.Event()
        self.link = Link(self._hub, f"The robot's server at {address}")
        self._connected = self._connect()
        try:
            has = _capabilities_at(self._connected.calls, address)
            self._connected.listen(self._told)
        except RobotError:
            self._connected.close()
            raise
        self._capabilities = msgspec.structs.replace(has, stop_within=has.stop_within + ON_THE_WAY)
        self._begun.set()
        if self._connected.lost:  # already
            self._is_lost()

    # --- the interface of a driver ---------------------------------------------------------------

    def capabilities(self) -> Capabilities:
        return self._capabilities

    def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
        stop.check()
        if method == "stop":
            return self.stop("The robot was told to stop.")
        self.link.check()
        return self._connected.calls.perform(method, arguments, stop)

    def stop(self, because: str) -> None:
        failed: list[RobotError] = []

        def ask() -> None:
            try:
                self._connected.stops.stop()
            except RobotError as error:
                failed.append(error)

        asking = threading.Thread(target=ask, name="stop at the server", daemon=True)
        asking.start()
        asking.join(self._capabilities.stop_within)
        if not asking.is_alive() and not failed:
            return  # the server has told everybody
        if failed and isinstance(failed[0], StopNotConfirmed):
            raise failed[0]
        error = StopNotConfirmed()
        self._hub.publish("stopping", because=because)
        self._hub.publish("stop_not_confirmed", because=because, message=str(error))
        raise error

    def subscribe(self, listener: Callable[[str, Event], None]) -> Callable[[], None]:
        unsubscribe = self._hub.subscribe(listener)
        if self.link.state == "lost":
            listener("link", self.link.event())
        return unsubscribe

    def close(self) -> None:
        if not self._closed.is_set():
            if self.link.state == "connected":
                with contextlib.suppress(StopNotConfirmed):  # the event says it
                    self.stop("The robot was let go of.")
            self._closed.set()
            self._connected.close()

    # --- lost and found --------------------------------------------------------------------------

    def _connect(self) -> _Connected:
        return _Connected(self._address, self._token, self._is_lost)

    def _is_lost(self) -> None:
        """A connection has ended, in the thread that noticed."""
        if self._begun.is_set() and not self._closed.is_set():
            self.link.lost(f"The connection to the robot's server at {self._address} was lost.")
            threading.Thread(target=self._search, name="find the server", daemon=True).start()

    def _search(self) -> None:
        if not self._searching.acquire(blocking=False):
            return  # both connections end, and one search is enough
        try:
            self._connected.close()
            pause = FIRST_PAUSE
            while not self._closed.wait(pause):
                try:
                    self._connected = self._connect()
                    self._connected.listen(self._told)
                except RobotError:
                    self._connected.close()
                    pause = min(2 * pause, LONGEST_PAUSE)
                    continue
                self.link.found()
                return
        finally:
            self._searching.release()
            if self._connected.lost and self.link.state == "connected":
                self._is_lost()  # again, in the very moment in which it was found

    def _told(self, kind: str, data: Event) -> None:
        """Something has happened there."""
        if kind == "link" and data["state"] == "lost":
            self.link.lost(str(data["because"]))
        elif kind == "link":
            self.link.found()
        else:
            self._hub.forward(kind, data)


class _Connected:
    """The two connections to a server."""

    def __init__(self, address: str, token: str | None, on_lost: Callable[[], None]) -> None:
        self._over = False
        self._on_lost = on_lost
        self.calls = Robot(address, token=token, timeout=SILENT_FOR, on_lost=self._ended)
        try:
            self.stops = Robot(address, token=token, timeout=SILENT_FOR, on_lost=self._ended)
        except RobotError:
            self.calls.close()
            raise

    @property
    def lost(self) -> bool:
        return not (self.calls.connected and self.stops.connected)

    def listen(self, listener: Callable[[str, Event], None]) -> None:
        """Be told of all that the server tells of; an older one knows fewer kinds of events."""
        there = self.calls.request("rpc.discover").get("x-events", {})
        kinds = [kind for kind in EVENTS if f"event.{kind}" in there]
        self.stops.subscribe(kinds, listener)

    def close(self) -> None:
        self._over = True
        self.calls.close()
        self.stops.close()

    def _ended(self) -> None:
        if not self._over:
            self._on_lost()


def _capabilities_at(robot: Robot, address: str) -> Capabilities:
    patience = threading.Timer(SILENT_FOR, robot.close)  # what is no robot may never answer
    patience.daemon = True
    patience.start()
    try:
        return robot.capabilities()
    except (RobotError, msgspec.ValidationError) as error:
        raise LostConnection(
            f"There is a server at {address}, but it is no robot's. Check the address."
        ) from error
    finally:
        patience.cancel()


def _connect(setup: Setup) -> Driver:
    address = setup.address
    if address.port is None and address.scheme == SERVER.scheme:
        address = replace(address, port=DEFAULT_PORT)
    return WireDriver(str(address), setup.password)


SERVER = RobotKind(
    scheme="ws",
    title="A robot at another server of nl2robot",
    example=f"ws://HOST:{DEFAULT_PORT}",
    connect=_connect,
    port=DEFAULT_PORT,
    shared=True,
)
SECURE_SERVER = RobotKind(
    scheme="wss",
    title="The same, encrypted",
    example=f"wss://HOST:{DEFAULT_PORT}",
    connect=_connect,
    shared=True,
)
