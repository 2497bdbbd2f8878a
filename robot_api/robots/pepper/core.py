"""What every robot has, of Pepper."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime
from typing import Any

from robot_api.capabilities.core import Core, LogBook
from robot_api.driver import StopFlag
from robot_api.local_time import local_now
from robot_api.robots.pepper.body import STOP_WITHIN, Body
from robot_api.robots.pepper.session import Wire
from robot_api.robots.places import Places


class PepperCore(Core):
    def __init__(self, wire: Wire, body: Body, book: LogBook, places: Places) -> None:
        super().__init__(book)
        self._wire = wire
        self._body = body
        self._places = places

    def declares(self) -> dict[str, Any]:
        return {"stop_within": STOP_WITHIN}

    def wait(self, stop: StopFlag, seconds: float) -> None:
        stop.wait(seconds)
        stop.check()

    def place_kinds(self) -> Mapping[str, str]:
        return {place.name: place.kind for place in self._places.named.values()}

    def now(self) -> datetime:
        return local_now()

    def charge(self) -> float:
        return float(self._wire.call("ALBattery", "getBatteryCharge"))

    def rest(self) -> None:
        self._body.stand_still()
