"""Places that people name on the map: kept, told to whoever looks, known at once to translation and
to the robot.

Where they are kept `nl2robot.station.named_places` says. Those of the world's own file stay as they
are.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Collection, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, Final, NotRequired, TypedDict

import msgspec

from nl2robot.console.floor.goals import free_spot
from nl2robot.console.floor.plan import place_plan
from nl2robot.errors import UserError
from nl2robot.paths import data_file
from nl2robot.station.drawn_zones import DrawnZones
from nl2robot.station.named_places import NamedByHand, NamedPlaces, not_in, with_places
from nl2robot.station.part import Backstage, Part
from nl2robot.station.world_file import exported
from nl2robot.wire import service
from robot_api.capabilities.driving import Goal
from robot_api.robots.places import NamedPlace
from sim.world.checks import kind_of
from sim.world.loading import load_world
from sim.world.model import Aliases, Place, World, WorldError, key

MOST_PLACES: Final = 200
"""Named on one map."""
MOST_ALIASES: Final = 10
"""Of a place, in one language."""
LONGEST_NAME: Final = 60
ASIDE: Final = 1.0
"""Metres that a place is put aside at most, to where the robot has room and blocks no door."""

_NUMBER = {"type": "number"}
_NAME = {"type": "string", "maxLength": 1000}
_ALIASES = {
    "type": "object",
    "propertyNames": {"pattern": "^[a-z]{2}$"},
    "additionalProperties": {"type": "array", "items": _NAME, "maxItems": MOST_ALIASES},
}


class PlaceShown(TypedDict):
    """A place as the map shows it: `pose` is x, y (metres) and the way to face (degrees)."""

    name: str
    names: dict[str, str]
    kind: str
    pose: list[float] | None
    area: list[list[float]] | None
    part: bool
    removable: bool
    aliases: NotRequired[dict[str, list[str]]]


class PlacesNow(TypedDict):
    """All places, and by how many metres the one that was named was put aside."""

    places: list[PlaceShown]
    moved: float


class File(TypedDict):
    """A file to keep, by its name."""

    file: str
    text: str


def part(backstage: Backstage) -> Part:
    """The places on the wire; those that are kept are known from now on."""
    naming = Naming(backstage)
    return Part(
        services={
            "places.list": service(
                lambda p: naming.listed(),
                "List the places as the map shows them, each with whether it was named by hand:"
                " then it is removable, and has its aliases.",
                observes=True,
                result=list[PlaceShown],
            ),
            "places.set": service(
                naming.set,
                "Name a place, or change the one that `was` called so. Returns the places, and by"
                " how many metres it was `moved` to where the robot has room and blocks no door.",
                {
                    "name": _NAME,
                    "kind": _NAME,
                    "was": _NAME,
                    "aliases": _ALIASES,
                    "x": _NUMBER,
                    "y": _NUMBER,
                    "theta": _NUMBER,
                },
                "name x y",
                result=PlacesNow,
            ),
            "places.remove": service(
                naming.remove,
                "Remove a place that was named by hand; returns the places as places.set does.",
                {"name": _NAME},
                "name",
                result=PlacesNow,
            ),
            "places.export": service(
                lambda p: naming.exported(),
                "Give the world's file with the places and zones in it that were drawn by hand.",
                observes=True,
                result=File,
            ),
        },
        events={"places": "places, as places.list tells them, whenever one was named or removed"},
    )


class Naming:
    """The places of the world's file, and those named by hand."""

    def __init__(self, backstage: Backstage) -> None:
        self._backstage = backstage
        self._knowledge = backstage.runner.knowledge
        self._kept = NamedPlaces()
        self._changing = threading.Lock()
        world = self._knowledge.world
        named: tuple[NamedByHand, ...] = ()
        with suppress(UserError):  # who names a place is told why
            named = self._kept.of(world)
        self._bare = _as_its_file_has_it(world, named)
        self._named = tuple(not_in(self._bare, named))
        self._hold()

    def listed(self) -> list[dict[str, Any]]:
        by_hand = {key(each.name): each for each in self._named}

        def told(place: Place) -> dict[str, Any]:
            named = by_hand.get(key(place.name))
            about = {"removable": named is not None}
            if named is not None:
                about["aliases"] = msgspec.to_builtins(named.aliases)
            return {**place_plan(self._knowledge.world, place), **about}

        return [told(place) for place in self._knowledge.world.places]

    def set(self, p: Mapping[str, Any]) -> dict[str, Any]:
        name = _sound(p["name"], "The place")
        kind = _sound(p["kind"], "The kind").lower() if p.get("kind", "").strip() else kind_of(name)
        with self._changing:
            before = self._by_hand(p["was"]) if "was" in p else None
            others = tuple(each for each in self._kept.of(self._bare) if each != before)
            if len(others) >= MOST_PLACES:
                raise UserError(
                    f"{MOST_PLACES} places were named already. Remove one of them first."
                )
            aliases = _aliases(p.get("aliases", before.aliases if before else {}), name)
            _check_free(name, aliases, with_places(self._bare, others))
            x, y, moved = self._where(p["x"], p["y"])
            theta = p.get("theta", before.pose[2] if before else 0.0)
            if not math.isfinite(theta):
                raise UserError("The way to face is no number. Give degrees.")
            pose = (round(x, 3), round(y, 3), round(theta % 360, 1))
            self._keep((*others, NamedByHand(name, kind, pose, aliases)))
        return {"places": self.listed(), "moved": round(moved, 2)}

    def remove(self, p: Mapping[str, Any]) -> dict[str, Any]:
        with self._changing:
            gone = self._by_hand(p["name"])
            self._keep(tuple(each for each in self._kept.of(self._bare) if each != gone))
        return {"places": self.listed(), "moved": 0.0}

    def exported(self) -> dict[str, str]:
        zones = DrawnZones(data_file("zones.yaml")).of(self._bare)
        text = exported(self._bare, self._named, zones)
        return {"file": f"{key(self._bare.name).replace(' ', '-')}.yaml", "text": text}

    def _by_hand(self, name: str) -> NamedByHand:
        """The place that was named so by hand. Raises `UserError`."""
        for each in self._kept.of(self._bare):
            if key(each.name) == key(name):
                return each
        if self._bare.place(name) is not None:
            raise UserError(f'The place "{name}" is in the world\'s file. Change it there.')
        raise UserError(f'Nobody named a place "{name}" here. It may be removed already.')

    def _keep(self, named: tuple[NamedByHand, ...]) -> None:
        self._kept.keep(self._bare, named)
        self._named = tuple(not_in(self._bare, named))
        self._hold()
        self._backstage.publish("places", {"places": self.listed()})

    def _hold(self) -> None:
        """Let everybody know the places as they are now."""
        world = with_places(self._bare, self._named)
        if self._backstage.simulation is not None:
            self._backstage.simulation.set_places(world.places)
        self._knowledge.see(world)
        if self._backstage.places is not None:
            _tell_driver(self._backstage.places.named, world)

    def _where(self, x: float, y: float) -> tuple[float, float, float]:
        """Where the robot has room, and how many metres that is from there. Raises `UserError`."""
        simulation = self._backstage.simulation
        return free_spot(simulation.world if simulation else self._bare, x, y, ASIDE)


def _as_its_file_has_it(world: World, named: tuple[NamedByHand, ...]) -> World:
    """The world without the places that were named by hand. One that somebody has put into the
    world's file since is in both."""
    own: Collection[str] = ()
    with suppress(WorldError):
        own = {place.name for place in load_world(Path(world.file), names_only=True).places}
    by_hand = [each.place for each in named if each.name not in own]
    places = tuple(place for place in world.places if place not in by_hand)
    return msgspec.structs.replace(world, places=places)


def _tell_driver(named: dict[str, Any], world: World) -> None:
    """Let the driver of a real robot know the places."""
    for place in world.places:
        pose = place.pose
        named[place.name] = NamedPlace(
            name=place.name,
            kind=place.kind,
            goal=Goal(pose.x, pose.y, pose.theta, place.name) if pose is not None else None,
            aliases=tuple(alias for texts in place.aliases.values() for alias in texts),
        )
    for name in set(named) - {place.name for place in world.places}:
        del named[name]


def _sound(name: str, what: str) -> str:
    """A name as it is kept. Raises `UserError`."""
    name = " ".join(name.split())
    if not name or not name.isprintable() or len(name) > LONGEST_NAME:
        raise UserError(f"{what} needs a name of at most {LONGEST_NAME} letters. Give it one.")
    return name


def _aliases(given: Mapping[str, Any], name: str) -> Aliases:
    """The other names by language, without repeats and empty ones. Raises `UserError`."""
    found: Aliases = {}
    for language, texts in given.items():
        others = {key(text): _sound(text, "Another name") for text in texts if text.strip()}
        others.pop(key(name), None)
        if others:
            found[language] = tuple(others.values())
    return found


def _check_free(name: str, aliases: Aliases, world: World) -> None:
    """Raise `UserError` if another place goes by one of these names."""
    for text in (name, *(alias for texts in aliases.values() for alias in texts)):
        other = world.place(text)
        if other is not None:
            called = "" if key(other.name) == key(text) else f', the place "{other.name}"'
            raise UserError(
                f'There is a place that goes by "{text}" already{called}. Choose another name.'
            )
