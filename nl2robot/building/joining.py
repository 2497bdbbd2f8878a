"""A robot that has joined the broker of its house."""

from __future__ import annotations

import re
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from typing import Any, Protocol

from nl2robot import __version__
from nl2robot.building.broker import Broker, BrokerAddress
from nl2robot.building.reporter import Reporter
from robot_api.errors import RobotError

Heard = Callable[[str, str], None]


class Stage(Protocol):
    """What is needed of a station, `nl2robot.station.part.Backstage`."""

    @property
    def stop(self) -> Callable[[str], None]: ...

    def subscribe(
        self, listener: Callable[[str, Mapping[str, Any]], None]
    ) -> Callable[[], None]: ...


@contextmanager
def joined(
    address: BrokerAddress,
    robot: str,
    stage: Stage,
    heard: Heard = lambda topic, text: None,
    linked: Callable[[bool, str], None] = lambda connected, because: None,
) -> Iterator[Broker]:
    """Tell the broker of this robot, and stop it when it is told to there. What else is said where
    somebody listens (`Broker.listen`), `heard(topic, text)` is told, and of the link `linked`."""

    def on_message(topic: str, text: str) -> None:
        if not reporter.heard(topic, text):
            heard(topic, text)

    def on_link(connected: bool, because: str) -> None:
        if connected:
            reporter.connected()
        linked(connected, because)

    def stop(because: str) -> None:
        with suppress(RobotError):  # a stop that is not confirmed is a state, which all are told
            stage.stop(because)

    def stop_at_once(because: str) -> None:
        """Without keeping the broker until the robot stands."""
        threading.Thread(target=stop, args=(because,), name="stop by MQTT", daemon=True).start()

    name = re.sub(r"[^A-Za-z0-9]+", "-", address.prefix)
    broker = Broker(address, name, on_message, on_link)
    reporter = Reporter(address, robot, __version__, broker.publish, stop_at_once)
    for topic in reporter.topics:
        broker.listen(topic)
    unsubscribe = stage.subscribe(reporter.on_event)
    broker.open()
    try:
        yield broker
    finally:
        unsubscribe()
        broker.close()
