"""The ward that the robots of these tests know, and how they are reached."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any

from robot_api.capabilities.driving import Goal
from robot_api.capabilities.sound import SILENT, Sound
from robot_api.driver import Event, StopFlag
from robot_api.errors import StopNotConfirmed
from robot_api.robots.address import parse
from robot_api.robots.places import NamedPlace, Places
from robot_api.robots.registry import Setup
from robot_api.robots.robot_file import RobotFile
from robot_api.robots.ros import ROS1, ROS2
from robot_api.robots.ros.driver import RosDriver
from robot_api.robots.ros.settings import RosSettings
from tests.robots.ros.stand_in import StandIn

WARD = {
    "charger": NamedPlace("charger", "charger", Goal(0, 0, 0)),
    "pharmacy": NamedPlace("pharmacy", "room", Goal(4, 3, 90), ("drugstore",)),
    "far end": NamedPlace("far end", "room", Goal(30, 0, 0)),
    "attic": NamedPlace("attic", "room"),
}


@contextmanager
def connected(
    robot: StandIn,
    settings: RosSettings | None = None,
    file: RobotFile | None = None,
    *,
    keep_out: list[list[tuple[float, float]]] | None = None,
    places: dict[str, NamedPlace] | None = None,
    known: Places | None = None,
    sound: Sound = SILENT,
    user: str = "",
    password: str | None = None,
) -> Iterator[RosDriver]:
    kind = ROS1 if robot.version == 1 else ROS2
    driver = kind.connect(
        Setup(
            address=parse(f"{kind.scheme}://{user}127.0.0.1:{robot.port}"),
            file=file or RobotFile(),
            places=known or Places(places or WARD, list(keep_out or ())),
            settings=settings,
            sound=sound,
            password=password,
        )
    )
    assert isinstance(driver, RosDriver)
    try:
        yield driver
    finally:
        with suppress(StopNotConfirmed):  # what became of the robot, the test knows
            driver.close()


def call(driver: RosDriver, method: str, **arguments: Any) -> Any:
    return driver.call(method, arguments, StopFlag())


class Under:
    """A call in a thread of its own."""

    def __init__(self, driver: RosDriver, method: str, **arguments: Any) -> None:
        self.flag = StopFlag()
        self.error: BaseException | None = None
        self._call = driver, method, arguments
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self) -> None:
        driver, method, arguments = self._call
        try:
            driver.call(method, arguments, self.flag)
        except BaseException as error:  # noqa: BLE001 - looked at by who waits for it
            self.error = error

    def ended(self, within: float = 10.0) -> BaseException | None:
        """How it ended, which it has to within so many seconds."""
        self._thread.join(within)
        assert not self._thread.is_alive(), f"the call did not end within {within} s"
        return self.error


class Heard:
    """The events of a driver."""

    def __init__(self, driver: RosDriver) -> None:
        self._changed = threading.Condition()
        self.events: list[tuple[str, dict[str, Any]]] = []
        driver.subscribe(self._hear)

    def _hear(self, kind: str, data: Event) -> None:
        with self._changed:
            self.events.append((kind, dict(data)))
            self._changed.notify_all()

    def of(self, kind: str) -> list[dict[str, Any]]:
        return [data for of_kind, data in self.events if of_kind == kind]

    def wait(self, what: Callable[[], Any], within: float = 10.0) -> None:
        with self._changed:
            assert self._changed.wait_for(what, within), f"not within {within} s: {self.events}"
