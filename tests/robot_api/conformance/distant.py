"""A robot somewhere else, and a driver for it that does all right: what faults are made of."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import msgspec

from robot_api import EVENTS, Robot, Server
from robot_api.capabilities.base import Hub
from robot_api.conformance.subject import Attempt
from robot_api.driver import Capabilities, Event, StopFlag
from robot_api.drivers import simulated
from robot_api.errors import LostConnection, RobotError, StopNotConfirmed, Stopped
from robot_api.robots.address import Address
from robot_api.robots.link import Link
from sim.simulation import Simulation
from sim.world.loading import load_world

_STOPS = ("stopping", "stopped", "stop_not_confirmed")


class DistantDriver:
    """Watches the link by asking for a sign of life, and stops on a connection of its own."""

    silence = 1.0
    """Seconds of it after which the robot is lost."""

    def __init__(self, address: Address) -> None:
        at = f"{address.host}:{address.port}"
        self.hub = Hub()
        self.link = Link(self.hub, "The robot")
        self.robot = Robot(at, timeout=self.silence)
        self._pulse = Robot(at, timeout=self.silence)
        self._has = msgspec.structs.replace(self.robot.capabilities(), stop_within=0.15)
        self._closed = threading.Event()
        self.robot.subscribe([kind for kind in EVENTS if kind not in _STOPS], self.hub.forward)
        threading.Thread(target=self._watch, daemon=True).start()

    def _watch(self) -> None:
        while not self._closed.wait(0.05):
            try:
                self._pulse.capabilities()
                self.robot.capabilities()
            except LostConnection:
                self.lost()
            except Stopped:
                continue  # an answer as good as any
            else:
                self.found()

    def lost(self) -> None:
        self.link.lost("The robot does not answer.")

    def found(self) -> None:
        self.link.found()

    def capabilities(self) -> Capabilities:
        return self._has

    def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
        stop.check()
        self.link.check()
        stop.on_set(self.robot.cancel)
        try:
            return getattr(self.robot, method)(**arguments)
        except LostConnection:
            self.lost()  # who hears of the error has heard of the loss, whatever the watch does
            raise

    def stop(self, because: str) -> None:
        self.hub.publish("stopping", because=because)
        if self.stands():
            self.hub.publish("stopped", because=because)
            return
        error = StopNotConfirmed("It has not confirmed that it stands. Use the robot's own button.")
        self.hub.publish("stop_not_confirmed", because=because, message=str(error))
        raise error

    def stands(self) -> bool:
        stop = Attempt(lambda flag: self._pulse.stop())
        return stop.returned(self._has.stop_within) and stop.error is None

    def subscribe(self, listener: Callable[[str, Event], None]) -> Callable[[], None]:
        return self.hub.subscribe(listener)

    def close(self) -> None:
        self._closed.set()
        with contextlib.suppress(RobotError):
            self.stop("The robot was let go of.")
        self.robot.close()
        self._pulse.close()


@contextmanager
def ward(speed: float = 3, ping_seconds: float = 0.8) -> Iterator[Address]:
    """The address of a simulated robot on a ward, as many times faster than a real one."""
    driver = simulated(Simulation(load_world("ward"), seed=1, speed=speed))
    with Server(driver, port=0, ping_seconds=ping_seconds) as server:
        host, port = server.address.rsplit(":", 1)
        yield Address("ws", host, int(port))
    driver.close()
