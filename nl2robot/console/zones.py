"""Keep-out zones drawn on the map: kept for each world, and told to the simulated robot.

They are in `zones.yaml` in the data folder, beside those that a world's own file has, which hold
for good. The file may be edited by hand while nothing is served; it is read at the start.

    worlds:
      city-hospital:
        - {name: wet floor, polygon: [[4, 1.5], [8, 1.5], [8, 6]]}
"""

from __future__ import annotations

import logging
import threading
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final

import msgspec

from nl2robot.console.part import Backstage, Part
from nl2robot.errors import UserError
from nl2robot.paths import data_file, made
from nl2robot.wire import service
from sim.simulation import Simulation
from sim.world import BUILTIN, World, Zone, key
from sim.zones import trouble_with

MOST_ZONES: Final = 50
"""Drawn on one map."""
LONGEST_NAME: Final = 60
LONGEST_OUTLINE: Final = 1000
"""Corners of an outline that is looked at; `sim.zones` allows fewer, and says so in words."""

_log = logging.getLogger("nl2robot.console.zones")
_NUMBER = {"type": "number"}
_NAME = {"type": "string", "maxLength": 1000}
_POLYGON = {
    "type": "array",
    "items": {"type": "array", "items": _NUMBER, "minItems": 2, "maxItems": 2},
    "maxItems": LONGEST_OUTLINE,
}


class _File(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    worlds: dict[str, tuple[Zone, ...]] = {}


msgspec.json.Decoder(_File)  # learned before there are threads, see `robot_api.schema`


class DrawnZones:
    """The zones of a file, by world. Raises `UserError` where the file cannot be used."""

    def __init__(self, file: Path) -> None:
        self.file = file

    def of(self, world: World) -> tuple[Zone, ...]:
        """Those drawn on the map of this world."""
        return self._read().worlds.get(_whose(world), ())

    def keep(self, world: World, zones: tuple[Zone, ...]) -> None:
        """From now on those of this world are these; on disk when this returns."""
        worlds = {**self._read().worlds, _whose(world): zones}
        kept = _File({name: drawn for name, drawn in worlds.items() if drawn})
        import yaml

        text = yaml.safe_dump(msgspec.to_builtins(kept), allow_unicode=True, sort_keys=False)
        new = made(self.file.parent) / f".{self.file.name}.new"
        try:
            new.write_text(text, encoding="utf-8")
            new.replace(self.file)  # whoever reads sees the old file or the new one
        except OSError as error:
            raise UserError(
                f"The keep-out zones cannot be kept in {self.file} ({error.strerror})."
                " Check its place, its rights and the disk."
            ) from error

    def _read(self) -> _File:
        import yaml

        try:
            data = yaml.safe_load(self.file.read_text(encoding="utf-8"))
            file = msgspec.convert(data or {}, _File)
        except FileNotFoundError:
            return _File()
        except (OSError, ValueError, RecursionError, yaml.YAMLError) as error:
            raise self._damaged(" ".join(str(error).split())) from error
        for zone in (zone for zones in file.worlds.values() for zone in zones):
            trouble = trouble_with(zone.polygon)
            if trouble:
                raise self._damaged(f'the zone "{zone.name}" {trouble.split(".")[0]}')
        return file

    def _damaged(self, why: str) -> UserError:
        return UserError(
            f"The keep-out zones that were drawn cannot be read from {self.file} ({why})."
            " Mend the file or move it away, then start again."
        )


def part(backstage: Backstage) -> Part:
    """The zones on the wire; those of the file hold from now on."""
    drawn = DrawnZones(data_file("zones.yaml"))
    simulation = backstage.simulation
    fixed = backstage.runner.knowledge.world.zones
    changing = threading.Lock()

    def listed() -> list[dict[str, Any]]:
        zones = simulation.world.zones if simulation is not None else fixed
        return [
            {
                "name": zone.name,
                "polygon": [list(corner) for corner in zone.polygon],
                "removable": zone not in fixed,
            }
            for zone in zones
        ]

    def hold(robot: Simulation, zones: tuple[Zone, ...]) -> list[dict[str, Any]]:
        robot.set_zones((*fixed, *zones))
        told = listed()
        backstage.publish("zones", {"zones": told})
        return told

    def added(p: Mapping[str, Any]) -> list[dict[str, Any]]:
        robot = _simulated(simulation)
        zone = _sound(p["name"], p["polygon"])
        _check_free(zone.name, fixed)
        with changing:
            others = tuple(_others(drawn.of(robot.world), zone.name))
            if len(others) >= MOST_ZONES:
                raise UserError(
                    f"There are {MOST_ZONES} keep-out zones already. Remove one of them first."
                )
            drawn.keep(robot.world, (*others, zone))
            return hold(robot, (*others, zone))

    def removed(p: Mapping[str, Any]) -> list[dict[str, Any]]:
        robot, name = _simulated(simulation), p["name"]
        _check_free(name, fixed)
        with changing:
            zones = drawn.of(robot.world)
            others = tuple(_others(zones, name))
            if len(others) == len(zones):
                raise UserError(f'There is no keep-out zone "{name}". It may be removed already.')
            drawn.keep(robot.world, others)
            return hold(robot, others)

    if simulation is not None:
        try:
            simulation.set_zones((*fixed, *drawn.of(simulation.world)))
        except UserError as error:  # the robot is served without them, and who draws is told why
            _log.warning("%s", error)
    return Part(
        services={
            "zones.list": service(
                lambda p: listed(),
                "List the keep-out zones: name, polygon, and whether it can be removed.",
                observes=True,
            ),
            "zones.set": service(
                added,
                "Keep the robot out of an area from now on; returns the zones as zones.list does.",
                {"name": _NAME, "polygon": _POLYGON},
                "name polygon",
            ),
            "zones.remove": service(
                removed,
                "Remove a keep-out zone that was drawn; returns the zones as zones.list does.",
                {"name": _NAME},
                "name",
            ),
        },
        events={"zones": "zones, as zones.list tells them, whenever they were drawn anew"},
    )


def _simulated(simulation: Simulation | None) -> Simulation:
    if simulation is None:
        raise UserError(
            "Only a simulated robot can be kept out of zones from here. Draw them in the software"
            " that drives this robot."
        )
    return simulation


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


def _others(zones: tuple[Zone, ...], name: str) -> Iterator[Zone]:
    return (zone for zone in zones if key(zone.name) != key(name))


def _whose(world: World) -> str:
    """What tells worlds apart, wherever the program is called and installed."""
    file = Path(world.file)
    return file.stem if file.parent == BUILTIN else str(file.absolute())
