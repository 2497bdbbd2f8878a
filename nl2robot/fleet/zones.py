"""Keep-out zones that robots of one map have in common. Without I/O but for the book.

Each name has one entry, the last that was done to it anywhere: of two the one with the higher count
holds, and of two with the same count that of the higher robot's id. So in whatever order entries
come, all robots end up with the same zones; what was removed stays known as removed.
"""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Mapping

import msgspec

from nl2robot.fleet.book import FleetBook
from nl2robot.fleet.messages import ZoneEntry, Zones
from sim.world.geometry import Polygon


class SharedZones:
    """As one robot knows them."""

    def __init__(self, book: FleetBook, robot: str, floor: str) -> None:
        self._book = book
        self._robot = robot
        self.floor = floor
        self._digest: str | None = None
        self._entries = {each.name: each for each in book.zones(floor)}

    @property
    def message(self) -> Zones:
        return Zones(self.floor, tuple(self._entries.values()))

    @property
    def digest(self) -> str:
        """The same at all who know the same."""
        if self._digest is None:
            known = sorted(self._entries.values(), key=lambda each: each.name)
            self._digest = hashlib.sha256(msgspec.json.encode(known)).hexdigest()[:8]
        return self._digest

    def drawn(self, zones: Mapping[str, Polygon], undrawn: Collection[str] = ()) -> bool:
        """These are the zones that are drawn here now; whether the others have to be told. Those
        of the others that could not be drawn here are `undrawn`: nobody removed them."""
        changed = False
        gone = {name for name, entry in self._entries.items() if entry.polygon is not None}
        for name in (gone - zones.keys() - set(undrawn)) | zones.keys():
            kept, polygon = self._entries.get(name), zones.get(name)
            if kept is not None and _same(kept.polygon, polygon):
                continue
            count = kept.count + 1 if kept is not None else 1
            self._keep(
                ZoneEntry(
                    name=name,
                    count=count,
                    robot=self._robot,
                    polygon=polygon,
                )
            )
            changed = True
        return changed

    def heard(self, zones: Zones) -> list[ZoneEntry]:
        """What another robot knows; what is to be drawn or removed here for it."""
        if zones.map != self.floor:
            return []
        newer = [each for each in zones.entries if self._is_newer(each)]
        for each in newer:
            self._keep(each)
        return newer

    def _is_newer(self, entry: ZoneEntry) -> bool:
        kept = self._entries.get(entry.name)
        return kept is None or (entry.count, entry.robot) > (kept.count, kept.robot)

    def _keep(self, entry: ZoneEntry) -> None:
        self._book.keep_zone(self.floor, entry)
        self._entries[entry.name] = entry
        self._digest = None


def _same(one: Polygon | None, other: Polygon | None) -> bool:
    if one is None or other is None:
        return one is other
    return [tuple(corner) for corner in one] == [tuple(corner) for corner in other]
