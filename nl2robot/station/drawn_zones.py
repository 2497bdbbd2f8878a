"""Keep-out zones that were drawn on the map: kept for each world in `zones.yaml` of the data
folder."""

from __future__ import annotations

from pathlib import Path

from nl2robot.station.drawn import Drawn
from sim.world.model import Zone
from sim.world.zones import trouble_with


class DrawnZones(Drawn[Zone]):
    """The zones of a file, by world. Raises `UserError` where the file cannot be used."""

    def __init__(self, file: Path) -> None:
        super().__init__(file, Zone, "keep-out zones", _trouble_with)


def _trouble_with(zone: Zone) -> str | None:
    trouble = trouble_with(zone.polygon)
    return f'the zone "{zone.name}" {trouble.split(".")[0]}' if trouble else None
