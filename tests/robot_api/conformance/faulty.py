"""The emulated robot, to be given one fault."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from robot_api.checker import check_driver
from robot_api.driver import Capabilities, Event, StopFlag
from robot_api.drivers import emulated


class Faulty:
    """The emulated robot with one fault."""

    def __init__(self, speed: float | None = None) -> None:
        self._sound = emulated(speed=speed)

    def capabilities(self) -> Capabilities:
        return self._sound.capabilities()

    def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
        return self._sound.call(method, arguments, stop)

    def stop(self, because: str) -> None:
        self._sound.stop(because)

    def subscribe(self, listener: Callable[[str, Event], None]) -> Callable[[], None]:
        return self._sound.subscribe(listener)

    def close(self) -> None:
        self._sound.close()


def problems(driver: Faulty) -> list[str]:
    return [str(problem) for problem in check_driver(driver)]
