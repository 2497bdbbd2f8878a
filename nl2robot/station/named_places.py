"""Places that people named on the map: kept for each world in `places.yaml` of the data folder (see
`nl2robot.station.drawn`), beside those of the world's own file.

    worlds:
      city-hospital:
        - {name: kiosk, kind: shop, pose: [4, 1.5, 90], aliases: {de: [Kiosk]}}

Whatever the world's file says itself holds: a place of the same name is not taken from here.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Iterator
from pathlib import Path

import msgspec

from nl2robot.errors import UserError
from nl2robot.paths import data_file
from nl2robot.station.drawn import Drawn
from sim.world.geometry import Pose
from sim.world.model import Aliases, Place, World

_log = logging.getLogger("nl2robot.station.named_places")


class NamedByHand(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """A place as it is kept."""

    name: str
    kind: str
    pose: tuple[float, float, float]
    """Metres, metres, degrees."""
    aliases: Aliases = {}

    @property
    def place(self) -> Place:
        return Place(name=self.name, kind=self.kind, pose=Pose(*self.pose), aliases=self.aliases)


class NamedPlaces(Drawn[NamedByHand]):
    """Those of a file, by world. Raises `UserError` where the file cannot be used."""

    def __init__(self, file: Path | None = None) -> None:
        super().__init__(file or data_file("places.yaml"), NamedByHand, "places", _trouble_with)


def _trouble_with(place: NamedByHand) -> str | None:
    if not place.name.strip() or not place.name.isprintable():
        return "a place has no name"
    if not all(math.isfinite(number) for number in place.pose):
        return f'the place "{place.name}" has a pose that is no spot'
    return None


def with_places(world: World, named: tuple[NamedByHand, ...]) -> World:
    """The world with these places as well."""
    places = (*world.places, *(each.place for each in not_in(world, named)))
    return msgspec.structs.replace(world, places=places)


def not_in(world: World, named: tuple[NamedByHand, ...]) -> Iterator[NamedByHand]:
    """Those whose names the world does not have itself."""
    return (each for each in named if world.place(each.name) is None)


def with_named_places(world: World) -> World:
    """The world with the places that people named on its map. If they cannot be read, without
    them: who names another is told why."""
    try:
        return with_places(world, NamedPlaces().of(world))
    except UserError as error:
        _log.warning("%s", error)
        return world
