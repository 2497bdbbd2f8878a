"""Keep-out zones of a fleet at this station: drawn and removed through its own wire, as anybody's
client would."""

from __future__ import annotations

import logging
import queue
from contextlib import AbstractContextManager
from typing import Any

import msgspec

from nl2robot.fleet.hub import Hub
from nl2robot.fleet.messages import ZoneEntry
from robot_api.client import Robot
from robot_api.errors import RobotError

_log = logging.getLogger(__name__)


class Drawing:
    """What the fleet says is drawn here, and what is drawn here is told to the fleet."""

    def __init__(self, hub: Hub, lock: AbstractContextManager[object]) -> None:
        self._hub = hub
        self._lock = lock
        self._told: queue.SimpleQueue[list[ZoneEntry] | None] = queue.SimpleQueue()

    def put(self, entries: list[ZoneEntry] | None) -> None:
        """What others have drawn or removed; nothing to look at what is drawn here; None at the
        end. Any thread may say so."""
        self._told.put(entries)

    def keep(self, robot: Robot) -> None:
        """Until the end, or until this station ends; at once if it has no map to draw on."""
        try:
            zones = robot.request("zones.list", {})
        except RobotError:
            return
        robot.subscribe("zones", lambda kind, data: self.put([]))
        undrawn: set[str] = set()
        while True:
            # Asked for after all that was heard is drawn: what is not there was removed.
            self._drawn(zones, undrawn)
            entries = self._told.get()
            if entries is None:
                return
            for entry in entries:
                (undrawn.discard if _draw(robot, entry) else undrawn.add)(entry.name)
            try:
                zones = robot.request("zones.list", {})
            except RobotError:  # this station ends
                return

    def _drawn(self, zones: list[dict[str, Any]], undrawn: set[str]) -> None:
        drawn = {
            each["name"]: tuple((x, y) for x, y in each["polygon"])
            for each in zones
            if each["removable"]
        }
        with self._lock:
            if self._hub.zones.drawn(drawn, undrawn):
                self._hub.tell_zones()


def _draw(robot: Robot, entry: ZoneEntry) -> bool:
    """Whether it is so here now."""
    who = f"fleet, {entry.robot}"
    try:
        if entry.polygon is None:
            robot.request("zones.remove", {"name": entry.name, "who": who})
        else:
            about = {"name": entry.name, "polygon": entry.polygon, "who": who}
            robot.request("zones.set", msgspec.to_builtins(about))
    except RobotError as error:
        _log.warning("The zone %r of the fleet is not drawn here: %s", entry.name, error)
        return entry.polygon is None  # it was not there
    return True
