"""Telling the robot where it stands, so that it can be undone: who did it, and when.

    location.set -> the robot believes that it is there; who said so is known until the server ends
    location.undo -> the correction is taken back, wherever the robot has driven since

A correction says by how much the robot was wrong: undone, the robot is put where it would believe
itself to be without it, which is where it was only if it has not moved.
"""

from __future__ import annotations

import math
import threading
import time
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final, TypedDict

from nl2robot.errors import UserError
from nl2robot.station.part import Backstage, Part
from nl2robot.wire import service_of_call
from robot_api.driver import Event, StopFlag
from robot_api.errors import RobotError
from robot_api.server import Context
from robot_api.values import Location

CORRECTIONS_KEPT: Final = 20
LOCALISED: Final = "localised"
"""What parts are told when somebody has corrected the robot's place: who, before, after."""


class Pose(TypedDict):
    """Metres, and degrees."""

    x: float
    y: float
    theta: float
    place: str | None


class Corrected(TypedDict):
    """A correction, as it is told on the wire."""

    number: int
    when: float
    who: str
    before: Pose
    after: Pose
    undoes: int | None
    undoable: bool


@dataclass(frozen=True)
class Correction:
    """Somebody told the robot where it is."""

    number: int
    when: float
    """Seconds since the epoch."""
    who: str
    """For people; empty if they did not say."""
    before: Location
    after: Location
    undoes: int | None = None


def localise(
    backstage: Backstage,
    where: Mapping[str, Any],
    who: str,
    stop: StopFlag,
    undoes: int | None = None,
) -> None:
    """Tell the robot where it is, as its method `localize` does, and everybody who did. Raises
    `RobotError`."""
    driver = backstage.driver
    before = _location(backstage)
    driver.call("localize", dict(where), stop)
    after = _location(backstage)
    if after is not None and "x" in where:  # a robot may take a while to believe it
        after = Location(where["x"], where["y"], where.get("theta") or 0.0, after.place)
    if before is not None and after is not None:  # one that was lost has nowhere to go back to
        about = {"who": who, "before": before, "after": after, "undoes": undoes}
        backstage.tell(LOCALISED, about)


def _location(backstage: Backstage) -> Location | None:
    try:
        where = backstage.driver.call("location", {}, StopFlag())
    except RobotError:
        return None
    return where if isinstance(where, Location) else Location(**where)


def part(backstage: Backstage) -> Part:
    """Where the robot is, corrected over the wire."""
    corrections = Corrections(backstage)
    who = {"type": "string", "maxLength": 100}
    number = {"type": "number"}
    return Part(
        services={
            "location.set": service_of_call(
                corrections.set,
                "Tell the robot where it is, as `robot.localize`, so that it can be undone; returns"
                " the history.",
                {
                    "x": number,
                    "y": number,
                    "theta": number,
                    "who": who,
                    "place": {"type": "string", "maxLength": 1000},
                },
                result=list[Corrected],
            ),
            "location.history": service_of_call(
                lambda p, context: corrections.history(),
                "List who told the robot where it is, the newest first: number, when (seconds since"
                " the epoch), who, before and after (x, y, theta, place), the correction that it"
                " undoes or null, and whether it can be undone.",
                observes=True,
                result=list[Corrected],
            ),
            "location.undo": service_of_call(
                corrections.undo,
                "Take back the last correction, wherever the robot has driven since; returns the"
                " history. That can be undone as well.",
                {"correction": {"type": "integer"}, "who": who},
                "correction",
                result=list[Corrected],
            ),
        },
        events={"location": "history, as location.history tells it, whenever it was corrected"},
        close=corrections.close,
    )


class Corrections:
    """Who told the robot where it is, on whichever page."""

    def __init__(self, backstage: Backstage) -> None:
        self._backstage = backstage
        self._kept: deque[Correction] = deque(maxlen=CORRECTIONS_KEPT)
        self._number = 0
        self._lock = threading.Lock()  # for the two above
        self.close = backstage.subscribe(self._hear)

    def history(self) -> list[dict[str, Any]]:
        with self._lock:
            kept = list(self._kept)
        return [
            {
                "number": each.number,
                "when": each.when,
                "who": each.who,
                "before": _plain(each.before),
                "after": _plain(each.after),
                "undoes": each.undoes,
                "undoable": each is kept[-1],
            }
            for each in reversed(kept)
        ]

    def set(self, p: Mapping[str, Any], context: Context) -> list[dict[str, Any]]:
        where = {name: value for name, value in p.items() if name != "who"}
        localise(self._backstage, where, p.get("who", ""), context.stop)
        return self.history()

    def undo(self, p: Mapping[str, Any], context: Context) -> list[dict[str, Any]]:
        with self._lock:
            last = self._kept[-1] if self._kept else None
        if last is None or last.number != p["correction"]:
            raise UserError(
                "The robot was told since where it is. Undo that first, or drag it to where it"
                " really stands."
            )
        now = _location(self._backstage)
        where = _without(last, now) if now is not None else _plain(last.before)
        pose = {name: where[name] for name in ("x", "y", "theta")}
        localise(self._backstage, pose, p.get("who", ""), context.stop, last.number)
        return self.history()

    def _hear(self, kind: str, data: Event) -> None:
        if kind != LOCALISED:
            return
        with self._lock:
            self._number += 1
            self._kept.append(Correction(self._number, time.time(), **data))
        self._backstage.publish("location", {"history": self.history()})


def _without(correction: Correction, now: Location) -> dict[str, Any]:
    """Where the robot would believe itself to be now if it had not been corrected."""
    before, after = correction.before, correction.after
    turned = math.radians(before.theta - after.theta)
    dx, dy = now.x - after.x, now.y - after.y
    return {
        "x": before.x + dx * math.cos(turned) - dy * math.sin(turned),
        "y": before.y + dx * math.sin(turned) + dy * math.cos(turned),
        "theta": (now.theta + before.theta - after.theta) % 360,
    }


def _plain(where: Location) -> dict[str, Any]:
    return {"x": where.x, "y": where.y, "theta": where.theta, "place": where.place}
