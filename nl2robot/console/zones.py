"""Keep-out zones drawn on the map: kept for each world, and told to the simulated robot.

They are in `zones.yaml` in the data folder (see `nl2robot.drawn`), beside those that a world's own
file has, which hold for good. The file is read at the start.
"""

from __future__ import annotations

import logging
import threading
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Final

from nl2robot.console.part import Backstage, Part
from nl2robot.drawn import Drawn
from nl2robot.errors import UserError
from nl2robot.paths import data_file
from nl2robot.wire import service
from sim.world import Zone, key
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


class DrawnZones(Drawn[Zone]):
    """The zones of a file, by world. Raises `UserError` where the file cannot be used."""

    def __init__(self, file: Path) -> None:
        super().__init__(file, Zone, "keep-out zones", _trouble_with)


def _trouble_with(zone: Zone) -> str | None:
    trouble = trouble_with(zone.polygon)
    return f'the zone "{zone.name}" {trouble.split(".")[0]}' if trouble else None


def part(backstage: Backstage) -> Part:
    """The zones on the wire; those of the file hold from now on."""
    drawn = DrawnZones(data_file("zones.yaml"))
    simulation = backstage.simulation
    fixed = backstage.runner.knowledge.world.zones
    changing = threading.Lock()
    known = backstage.places
    keeps = simulation is not None or (known is not None and known.keeps_out)

    world = backstage.runner.knowledge.world
    held = fixed
    """All of them, as they hold now."""

    def listed() -> list[dict[str, Any]]:
        return [
            {
                "name": zone.name,
                "polygon": [list(corner) for corner in zone.polygon],
                "removable": zone not in fixed,
            }
            for zone in held
        ]

    def hold(zones: tuple[Zone, ...]) -> None:
        nonlocal held
        held = (*fixed, *zones)
        if simulation is not None:
            simulation.set_zones(held)
        if known is not None:
            known.keep_out_of([zone.polygon for zone in held])

    def changed(zones: tuple[Zone, ...]) -> list[dict[str, Any]]:
        hold(zones)
        told = listed()
        backstage.publish("zones", {"zones": told})
        return told

    def check_driver() -> None:
        if not keeps:
            raise UserError(
                "This robot cannot be kept out of zones from here. Draw them in the software that"
                " drives it."
            )

    def added(p: Mapping[str, Any]) -> list[dict[str, Any]]:
        check_driver()
        zone = _sound(p["name"], p["polygon"])
        _check_free(zone.name, fixed)
        with changing:
            others = tuple(_others(drawn.of(world), zone.name))
            if len(others) >= MOST_ZONES:
                raise UserError(
                    f"There are {MOST_ZONES} keep-out zones already. Remove one of them first."
                )
            drawn.keep(world, (*others, zone))
            return changed((*others, zone))

    def removed(p: Mapping[str, Any]) -> list[dict[str, Any]]:
        check_driver()
        name = p["name"]
        _check_free(name, fixed)
        with changing:
            zones = drawn.of(world)
            others = tuple(_others(zones, name))
            if len(others) == len(zones):
                raise UserError(f'There is no keep-out zone "{name}". It may be removed already.')
            drawn.keep(world, others)
            return changed(others)

    if keeps:
        try:
            hold(drawn.of(world))
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
