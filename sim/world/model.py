"""A world: the named places, people and things of a hospital floor, and its geometry.

`sim.world.loading` reads the YAML (docs/worlds.md says how to write one) into the immutable structs
of this module. Whatever the unit of the file, lengths here are metres and angles degrees (0 along
x, left is +). Translating a sentence needs only the names; the geometry may be missing.

This module is imported by commands that must start at once: it needs only PyYAML and msgspec.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from datetime import UTC, datetime, tzinfo
from zoneinfo import ZoneInfo

import msgspec

from sim.world.geometry import (
    GridMap,
    Polygon,
    Pose,
    Segment,
    contains,
    map_corners,
    polygon_area,
    rectangle,
)
from sim.world.maps import roomiest_pose, trace_walls
from sim.world.yaml_nodes import FileProblems
from sim.world.yaml_nodes import Problem as Problem
from sim.world.yaml_nodes import key as key

Aliases = dict[str, tuple[str, ...]]
"""Other names by language code: {"de": ("Apotheke",)}."""

WITHIN_REACH = 1.0
"""A place without an area is where its pose is and this many metres around."""
MOST_REMEMBERED = 10_000
"""Spots whose areas a world remembers."""


class WorldError(FileProblems):
    """A world cannot be loaded."""


class Place(msgspec.Struct, frozen=True, kw_only=True):
    """Somewhere to go."""

    name: str
    kind: str
    """ "office", "ward", ...; the end of its name where the file does not say."""
    pose: Pose | None = None
    """Where the robot stands when it is there."""
    area: Polygon = ()
    """Its floor; empty if the file does not say."""
    inside: str | None = None
    """The place it is a part of, or a floor or building that is no place itself."""
    aliases: Aliases = {}


class Person(msgspec.Struct, frozen=True, kw_only=True):
    """Somebody. Where they are is the simulator's truth, not the robot's knowledge."""

    name: str
    kind: str = "person"
    """ "nurse", "doctor", "patient", "visitor", ..."""
    at: str | None = None
    """The name of a place; None if they are not to be met."""
    pose: Pose | None = None
    is_: tuple[str, ...] = ()
    """ "sitting", "standing", "lying", "waving", "tall", "wearing a blue coat", ..."""
    answers: tuple[str, ...] = ()
    """What they reply, in order."""
    gender: str | None = None
    walks: tuple[str, ...] = ()
    """Names of places they walk to and fro between."""
    aliases: Aliases = {}


class Thing(msgspec.Struct, frozen=True, kw_only=True):
    """An object. Names may repeat; where it is, is the simulator's truth."""

    name: str
    kind: str = "object"
    """ "cup", "tool", "medicine", ...; its name's last word where the file does not say."""
    at: str | None = None
    """The name of a place; None if it is nowhere to be found."""
    on: str | None = None
    """The name of furniture at that place that it lies on or in."""
    pose: Pose | None = None
    is_: tuple[str, ...] = ()
    """ "red", "small", "empty", ..."""
    code: str | None = None
    """What its bar code says."""
    size: tuple[float, float, float] | None = None
    """Length, width and height in metres."""
    weight: float | None = None
    """Kilograms."""
    aliases: Aliases = {}


class Furniture(msgspec.Struct, frozen=True, kw_only=True):
    """An obstacle with a name, on or in which things are put. Names may repeat."""

    name: str
    kind: str
    """ "bed", "table", "chair", ...; its name's last word where the file does not say."""
    pose: Pose | None = None
    """The middle, and how far its length is turned from the x axis."""
    size: tuple[float, float] = (1.0, 0.6)
    """Length and width in metres."""
    at: str | None = None
    """The place it stands in."""
    aliases: Aliases = {}

    @property
    def outline(self) -> Polygon:
        """Its four corners, anticlockwise; empty without a pose."""
        if self.pose is None:
            return ()
        return rectangle(self.pose, self.size)


class Door(msgspec.Struct, frozen=True, kw_only=True):
    """An opening in a wall: the loader has cut it out of `World.walls`."""

    ends: Segment
    open: bool = True
    """Nobody can pass a door that is not."""
    at: str | None = None
    """The place it leads to."""
    name: str | None = None


class Contact(msgspec.Struct, frozen=True, kw_only=True):
    """Somebody who can be called."""

    name: str
    kind: str | None = None
    aliases: Aliases = {}


class Question(msgspec.Struct, frozen=True, kw_only=True):
    """A question that the robot knows the answer to."""

    ask: Aliases
    """By language, the ways of asking it."""
    answer: dict[str, str]
    """By language."""


class Zone(msgspec.Struct, frozen=True):
    """Where the robot must not drive though it is free: a keep-out zone."""

    name: str
    polygon: Polygon


class Robot(msgspec.Struct, frozen=True, kw_only=True):
    """How the robot starts."""

    name: str = "robot"
    start: str | Pose | None = None
    """A place's name, or a pose; None: `World.start` chooses."""
    radius: float = 0.25
    battery: float = 100.0
    """Percent."""


class Clock(msgspec.Struct, frozen=True, kw_only=True):
    """What clocks there show."""

    start: datetime | None = None
    """When a simulation starts, without a zone; only its time of day counts if it is `daily`."""
    daily: bool = False
    zone: str | None = None
    """The time zone, "Europe/Zurich"; None: that of whoever simulates it."""

    @property
    def zone_info(self) -> tzinfo:
        return ZoneInfo(self.zone) if self.zone is not None else UTC

    def starts(self, otherwise: datetime) -> datetime:
        """When a simulation starts: at `otherwise` if nothing is said, and on that day if only a
        time of day is."""
        if self.start is None:
            return otherwise
        if self.daily:
            return datetime.combine(otherwise, self.start.time(), otherwise.tzinfo)
        return self.start


class World(msgspec.Struct, frozen=True, kw_only=True, dict=True):
    """A hospital floor: immutable."""

    name: str
    units: str = "m"
    """ "m" or "cm": the unit of the file, which the paper's message style counts in. All
    lengths here are metres all the same."""
    robot: Robot = Robot()
    clock: Clock = Clock()
    places: tuple[Place, ...] = ()
    people: tuple[Person, ...] = ()
    objects: tuple[Thing, ...] = ()
    furniture: tuple[Furniture, ...] = ()
    contacts: tuple[Contact, ...] = ()
    questions: tuple[Question, ...] = ()
    doors: tuple[Door, ...] = ()
    drawn_walls: tuple[Segment, ...] = ()
    """The walls written in the file, the doors cut out; `walls` has those of the map as well."""
    wall_thickness: float = 0.1
    zones: tuple[Zone, ...] = ()
    """Where the robot must not drive. `sim.simulation.Simulation.set_zones` draws others."""
    map: GridMap | None = None
    file: str = ""

    @functools.cached_property
    def walls(self) -> tuple[Segment, ...]:
        """All walls, the doors cut out. Reads the map's image if there is one."""
        if self.map is None:
            return self.drawn_walls

        return self.drawn_walls + trace_walls(self.map)

    @property
    def keep_out(self) -> tuple[Polygon, ...]:
        """The outlines of the zones."""
        return tuple(zone.polygon for zone in self.zones)

    @property
    def has_geometry(self) -> bool:
        """Whether a robot can be simulated in it: some place has a pose, or there is a map."""
        return self.map is not None or any(place.pose for place in self.places)

    @functools.cached_property
    def bounds(self) -> tuple[float, float, float, float]:
        """The least x and y and the greatest x and y of all there is; zeros without geometry."""
        points = [(x, y) for x1, y1, x2, y2 in self.drawn_walls for x, y in ((x1, y1), (x2, y2))]
        if self.map is not None:
            points += map_corners(self.map)
        if not points:
            points += [corner for place in self.places for corner in place.area]
            points += [(place.pose.x, place.pose.y) for place in self.places if place.pose]
        if not points:
            return (0.0, 0.0, 0.0, 0.0)
        xs, ys = zip(*points, strict=True)
        return (min(xs), min(ys), max(xs), max(ys))

    @functools.cached_property
    def start(self) -> Pose | None:
        """Where the robot starts: as the file says, else at the charger, else at the first place
        that has a pose, else where there is most room on the map."""
        if isinstance(self.robot.start, Pose):
            return self.robot.start
        named = self.place(self.robot.start) if self.robot.start else None
        if named is not None and named.pose is not None:
            return named.pose
        charger = self.charger
        if charger is not None:
            return charger.pose
        for place in self.places:
            if place.pose is not None:
                return place.pose
        if self.map is not None:
            return roomiest_pose(self.map)
        return None

    @functools.cached_property
    def charger(self) -> Place | None:
        """The charging station: the place of kind "charger" that has a pose."""
        for place in self.places:
            if place.kind == "charger" and place.pose is not None:
                return place
        return None

    @functools.cached_property
    def _places_by_key(self) -> Mapping[str, Place]:
        table: dict[str, Place] = {}
        for place in self.places:
            for alias in (alias for aliases in place.aliases.values() for alias in aliases):
                table.setdefault(key(alias), place)
        table.update((key(place.name), place) for place in self.places)
        return table

    def place(self, name: str) -> Place | None:
        """The place of that name, or of that alias in any language; None if there is none."""
        return self._places_by_key.get(key(name))

    @functools.cached_property
    def _people_by_key(self) -> Mapping[str, Person]:
        table: dict[str, Person] = {}
        for person in self.people:
            for alias in (alias for aliases in person.aliases.values() for alias in aliases):
                table.setdefault(key(alias), person)
        table.update((key(person.name), person) for person in self.people)
        return table

    def person(self, name: str) -> Person | None:
        """The person of that name, or of that alias in any language; None if there is none."""
        return self._people_by_key.get(key(name))

    def place_at(self, x: float, y: float) -> Place | None:
        """The place that the point is in: of several areas the smallest; else the nearest place
        without an area whose pose is within reach; else None."""
        best: Place | None = None
        best_size = math.inf
        for place in self.places:
            if place.area:
                if contains(place.area, x, y) and (size := polygon_area(place.area)) < best_size:
                    best, best_size = place, size
            elif place.pose is not None:
                distance = math.hypot(place.pose.x - x, place.pose.y - y)
                if distance <= WITHIN_REACH and math.pi * distance**2 < best_size:
                    best, best_size = place, math.pi * distance**2
        return best

    @functools.cached_property
    def _areas(self) -> dict[tuple[float, float], tuple[str, ...]]:
        """What `areas_at` has found: most people and things stay where they are."""
        return {}

    def areas_at(self, x: float, y: float) -> tuple[str, ...]:
        """The names of the places with an area that the point is in, the innermost first."""
        found = self._areas.get((x, y))
        if found is None:
            inner = self.place_at(x, y)
            around = [each for each in self.places if each.area and contains(each.area, x, y)]
            around.sort(key=lambda place: place is not inner)
            found = tuple(place.name for place in around)
            if len(self._areas) >= MOST_REMEMBERED:
                self._areas.clear()
            self._areas[x, y] = found
        return found

    def zone_at(self, x: float, y: float) -> Zone | None:
        """The zone that the point is in; None if it is in none."""
        return next((zone for zone in self.zones if contains(zone.polygon, x, y)), None)

    def furniture_at(self, place: str | None) -> tuple[Furniture, ...]:
        """The furniture that stands in the place."""
        return tuple(piece for piece in self.furniture if piece.at == place)


# --- names and shapes ----------------------------------------------------------------------------


def name_in(named: Place | Person | Thing | Furniture | Contact, language: str) -> str:
    """What it is called in a language: its first alias there, else the name, which is English."""
    aliases = named.aliases.get(language, ())
    return aliases[0] if aliases and language != "en" else named.name
