"""Keep-out zones drawn on the map: kept for each world, and told to the simulated robot.

They are in `zones.yaml` in the data folder (see `nl2robot.station.drawn`), beside those that a
world's own file has, which hold for good. The file is read at the start. Who drew and removed what
is in `zone-changes.yaml`, so that it can be undone.
"""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, Final, Literal, TypedDict

import msgspec

from nl2robot.errors import UserError
from nl2robot.paths import data_file
from nl2robot.station.drawn import Drawn
from nl2robot.station.drawn_zones import DrawnZones
from nl2robot.station.part import Backstage, Part
from nl2robot.wire import service
from sim.world.geometry import Polygon
from sim.world.model import Zone, key
from sim.world.zones import trouble_with

MOST_ZONES: Final = 50
"""Drawn on one map."""
CHANGES_KEPT: Final = 30
"""Of one map, the newest."""
LONGEST_NAME: Final = 60
LONGEST_OUTLINE: Final = 1000
"""Corners of an outline that is looked at; `sim.world.zones` allows fewer, and says so in words."""

_log = logging.getLogger("nl2robot.console.floor.zones")
_NUMBER = {"type": "number"}
_NAME = {"type": "string", "maxLength": 1000}
_WHO = {"type": "string", "maxLength": 100}
_POLYGON = {
    "type": "array",
    "items": {"type": "array", "items": _NUMBER, "minItems": 2, "maxItems": 2},
    "maxItems": LONGEST_OUTLINE,
}


class ZoneShown(TypedDict):
    """A zone, its corners in metres."""

    name: str
    polygon: list[list[float]]
    removable: bool


class Changed(TypedDict):
    """A change, as it is told on the wire."""

    number: int
    when: float
    who: str
    what: Literal["drawn", "changed", "removed"]
    name: str
    undoes: int | None
    undoable: bool


class Change(msgspec.Struct, frozen=True):
    """One of the zones was drawn, drawn anew or removed."""

    number: int
    when: float
    """Seconds since the epoch."""
    who: str
    """Whoever did it, for people; empty if they did not say."""
    name: str
    before: Polygon | None
    """Its outline until then; None if there was no such zone."""
    after: Polygon | None
    undoes: int | None = None
    """The change that it took back."""

    @property
    def what(self) -> Literal["drawn", "changed", "removed"]:
        if self.after is None:
            return "removed"
        return "drawn" if self.before is None else "changed"


class Changes(Drawn[Change]):
    """The last changes of a file, by world, the oldest first. Raises `UserError` where the file
    cannot be used."""

    def __init__(self, file: Path) -> None:
        super().__init__(file, Change, "changes of keep-out zones", lambda change: None)


def part(backstage: Backstage) -> Part:
    """The zones on the wire; those of the file hold from now on."""
    zones = KeptOut(backstage)
    return Part(
        services={
            "zones.list": service(
                lambda p: zones.listed(),
                "List the keep-out zones: name, polygon, and whether it can be removed.",
                observes=True,
                result=list[ZoneShown],
            ),
            "zones.set": service(
                zones.set,
                "Keep the robot out of an area from now on; returns the zones as zones.list does."
                " `who` does it, for the history.",
                {"name": _NAME, "polygon": _POLYGON, "who": _WHO},
                "name polygon",
                result=list[ZoneShown],
            ),
            "zones.remove": service(
                zones.remove,
                "Remove a keep-out zone that was drawn; returns the zones as zones.list does.",
                {"name": _NAME, "who": _WHO},
                "name",
                result=list[ZoneShown],
            ),
            "zones.history": service(
                lambda p: zones.history(),
                "List the last changes of keep-out zones, the newest first: number, when (seconds"
                " since the epoch), who, what (drawn | changed | removed), name, the change that it"
                " undoes or null, and whether it can be undone.",
                observes=True,
                result=list[Changed],
            ),
            "zones.undo": service(
                zones.undo,
                "Take back the change of that number; returns the zones as zones.list does. That"
                " can be undone as well.",
                {"change": {"type": "integer"}, "who": _WHO},
                "change",
                result=list[ZoneShown],
            ),
        },
        events={
            "zones": "zones, as zones.list tells them, and history, as zones.history does, whenever"
            " they were drawn anew"
        },
    )


class KeptOut:
    """The zones of the world's file, those that were drawn, and who did what to those."""

    def __init__(self, backstage: Backstage) -> None:
        self._backstage = backstage
        self._world = backstage.runner.knowledge.world
        self._fixed = self._world.zones
        self._kept = DrawnZones(data_file("zones.yaml"))
        self._changes = Changes(data_file("zone-changes.yaml"))
        places = backstage.places
        self._keeps = backstage.simulation is not None or bool(places and places.keeps_out)
        self._changing = threading.Lock()
        self._held = self._fixed
        """All of them, as they hold now."""
        if self._keeps:
            try:
                self._hold(self._kept.of(self._world))
            except UserError as error:  # the robot is served without them, and who draws hears why
                _log.warning("%s", error)

    def listed(self) -> list[dict[str, Any]]:
        return [
            {
                "name": zone.name,
                "polygon": [list(corner) for corner in zone.polygon],
                "removable": zone not in self._fixed,
            }
            for zone in self._held
        ]

    def history(self) -> list[dict[str, Any]]:
        """The newest first. See `_undoable`."""
        with suppress(UserError):  # who draws is told why
            changes = self._changes.of(self._world)
            undoable = _undoable(changes)
            return [
                {
                    "number": change.number,
                    "when": change.when,
                    "who": change.who,
                    "what": change.what,
                    "name": change.name,
                    "undoes": change.undoes,
                    "undoable": change.number in undoable,
                }
                for change in reversed(changes)
            ]
        return []

    def set(self, p: Mapping[str, Any]) -> list[dict[str, Any]]:
        zone = _sound(p["name"], p["polygon"])
        return self._put(zone.name, zone, p.get("who", ""))

    def remove(self, p: Mapping[str, Any]) -> list[dict[str, Any]]:
        return self._put(p["name"], None, p.get("who", ""))

    def undo(self, p: Mapping[str, Any]) -> list[dict[str, Any]]:
        number = p["change"]
        changes = self._changes.of(self._world)
        change = next((each for each in changes if each.number == number), None)
        if change is None:
            raise UserError("That change is too long ago to be undone. Draw or remove the zone.")
        now = {key(zone.name): zone.polygon for zone in self._held}.get(key(change.name))
        if number not in _undoable(changes) or now != change.after:
            raise UserError(
                f'The keep-out zone "{change.name}" was changed again since. Undo that first.'
            )
        before = Zone(change.name, change.before) if change.before is not None else None
        return self._put(change.name, before, p.get("who", ""), undoes=number)

    def _put(
        self, name: str, zone: Zone | None, who: str, undoes: int | None = None
    ) -> list[dict[str, Any]]:
        """This is the zone of that name from now on; None: there is none."""
        if not self._keeps:
            raise UserError(
                "This robot cannot be kept out of zones from here. Draw them in the software that"
                " drives it."
            )
        _check_free(name, self._fixed)
        with self._changing:
            zones = self._kept.of(self._world)
            others = tuple(each for each in zones if key(each.name) != key(name))
            before = next((each for each in zones if key(each.name) == key(name)), None)
            if zone is None and before is None:
                raise UserError(f'There is no keep-out zone "{name}". It may be removed already.')
            if zone is not None and len(others) >= MOST_ZONES:
                raise UserError(
                    f"There are {MOST_ZONES} keep-out zones already. Remove one of them first."
                )
            named = zone or before
            assert named is not None
            changes = self._changes.of(self._world)
            change = Change(
                number=max((each.number for each in changes), default=0) + 1,
                when=time.time(),
                who=" ".join(who.split()),
                name=named.name,
                before=before.polygon if before else None,
                after=zone.polygon if zone else None,
                undoes=undoes,
            )
            left = (*others, zone) if zone is not None else others
            self._kept.keep(self._world, left)
            self._changes.keep(self._world, (*changes, change)[-CHANGES_KEPT:])
            self._hold(left)
            told = self.listed()
            self._backstage.publish("zones", {"zones": told, "history": self.history()})
            return told

    def _hold(self, zones: tuple[Zone, ...]) -> None:
        self._held = (*self._fixed, *zones)
        if self._backstage.simulation is not None:
            self._backstage.simulation.set_zones(self._held)
        if self._backstage.places is not None:
            self._backstage.places.keep_out_of([zone.polygon for zone in self._held])


def _undoable(changes: Iterable[Change]) -> set[int]:
    """The numbers of those that can be taken back: of each zone the last one, and the last that
    still holds where that took back the one after it."""
    standing: dict[str, list[Change]] = {}
    last: dict[str, Change] = {}
    for change in changes:
        name = key(change.name)
        stack = standing.setdefault(name, [])
        if stack and stack[-1].number == change.undoes:
            stack.pop()
        else:
            stack.append(change)
        last[name] = change
    tops = [stack[-1] for stack in standing.values() if stack]
    return {change.number for change in (*tops, *last.values())}


def _sound(name: str, polygon: list[list[float]]) -> Zone:
    """A zone that may be kept. Raises `UserError`."""
    name = " ".join(name.split())
    if not name or not name.isprintable() or len(name) > LONGEST_NAME:
        raise UserError(
            f"The keep-out zone needs a name of at most {LONGEST_NAME} letters. Give it one."
        )
    outline = tuple((float(x), float(y)) for x, y in polygon)
    trouble = trouble_with(outline)
    if trouble:
        raise UserError(f'The keep-out zone "{name}" {trouble}')
    return Zone(name, outline)


def _check_free(name: str, fixed: tuple[Zone, ...]) -> None:
    """Raise `UserError` if a zone of the world's own file has this name."""
    if any(key(zone.name) == key(name) for zone in fixed):
        raise UserError(
            f'The keep-out zone "{name}" is in the world\'s file. Change it there, or draw one of'
            " another name."
        )
