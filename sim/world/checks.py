"""What can be told only when a whole world is read: names that clash, names that nothing has, poses
beyond the map, doors in no wall. Makes the final `World`, in which every reference is the exact
name of what it refers to."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple, TypeVar

import msgspec

from sim.world.fields import NodeReader
from sim.world.geometry import Pose, Segment, contains, map_corners
from sim.world.model import Contact, Door, Furniture, Person, Place, Robot, Thing, World, Zone, key
from sim.world.yaml_nodes import did_you_mean

ON_THE_LINE = 0.02
"""How far in metres a door's ends may be off the wall it opens."""
SHORTEST_WALL = 0.01
"""What is left of a wall beside a door counts from this length in metres."""
_DESIGNATOR = 2
"""A last word of up to so many characters ("ward b", "room 12") says which one, not what kind."""

_T = TypeVar("_T")
_Named = TypeVar("_Named", Place, Person, Contact)
_Sited = TypeVar("_Sited", Person, Thing, Furniture, Door)
Lined = list[tuple[int, _T]]
"""Each with the line it stands on."""


class Entries(NamedTuple):
    """All that a world's file lists and that refers to something or is referred to."""

    places: Lined[Place]
    people: Lined[Person]
    objects: Lined[Thing]
    furniture: Lined[Furniture]
    doors: Lined[Door]
    contacts: Lined[Contact]
    robot: tuple[int, Robot]


def kind_of(name: str) -> str:
    """The kind that the end of a name tells: "alice's office" -> "office", "ward b" -> "ward"."""
    words = name.lower().split()
    while len(words) > 1 and (len(words[-1]) <= _DESIGNATOR or words[-1][0].isdigit()):
        words.pop()
    return words[-1]


def settle(reader: NodeReader, bare: World, walls: Sequence[Segment], entries: Entries) -> World:
    """The finished world; what is wrong is told to the reader. `walls` are the ones without
    doors."""
    check_names(reader, "place", entries.places)
    check_names(reader, "person", entries.people)
    check_names(reader, "contact", entries.contacts)
    check_poses(reader, bare)
    if walls and bare.map is None:
        check_doors(reader, walls, entries.doors)
    return _Settling(reader, bare).world(entries)


# --- checks --------------------------------------------------------------------------------------


def check_names(reader: NodeReader, what: str, entries: Lined[_Named]) -> None:
    """No two of the same name; no alias of one that is a name or alias of another."""
    names: dict[str, tuple[int, str]] = {}
    for line, entry in entries:
        first = names.setdefault(key(entry.name), (line, entry.name))
        if first[0] != line:
            reader.problem(
                line,
                f'The {what} "{entry.name}" is on line {first[0]} already. '
                "Give one of them another name.",
            )
    aliases: dict[tuple[str, str], str] = {}
    for line, entry in entries:
        for language, texts in entry.aliases.items():
            for alias in texts:
                owner = names.get(key(alias), (0, entry.name))[1]
                if owner == entry.name:
                    owner = aliases.setdefault((language, key(alias)), entry.name)
                if owner != entry.name:
                    reader.problem(
                        line,
                        f'"{alias}" of the {what} "{entry.name}" is also a name of '
                        f'the {what} "{owner}". Leave it to one of them.',
                    )


def check_zones(reader: NodeReader, zones: Lined[Zone]) -> None:
    """No two of the same name."""
    lines: dict[str, int] = {}
    for line, zone in zones:
        first = lines.setdefault(key(zone.name), line)
        if first != line:
            reader.problem(
                line,
                f'The zone "{zone.name}" is on line {first} already. '
                "Give one of them another name.",
            )


def check_poses(reader: NodeReader, world: World) -> None:
    """No pose lies beyond the walls and the map."""
    if not world.drawn_walls and world.map is None:
        return
    x1, y1, x2, y2 = world.bounds
    # A turned map does not fill its bounds.
    corners = tuple(map_corners(world.map)) if world.map and not world.drawn_walls else ()
    per_metre = 1 / reader.factor
    for line, what, pose in reader.poses:
        within = x1 <= pose.x <= x2 and y1 <= pose.y <= y2
        if not within or (corners and not contains(corners, pose.x, pose.y)):
            reader.problem(
                line,
                f"{what} is outside the map, which goes from ({x1 * per_metre:g}, "
                f"{y1 * per_metre:g}) to ({x2 * per_metre:g}, {y2 * per_metre:g}). "
                "Correct the coordinates, or the units.",
                floor=True,
            )


def check_doors(reader: NodeReader, walls: Sequence[Segment], doors: Lined[Door]) -> None:
    """Every door lies in a wall."""
    for line, door in doors:
        if not any(_opening(wall, door.ends) for wall in walls):
            reader.problem(
                line,
                "The door lies in no wall. Both its ends must be on the line of one wall.",
                floor=True,
            )


# --- references ----------------------------------------------------------------------------------


class _Settling:
    """Turns what entries refer to into exact names."""

    def __init__(self, reader: NodeReader, bare: World) -> None:
        self.reader = reader
        self.bare = bare

    def world(self, entries: Entries) -> World:
        furniture = tuple(self._site(line, piece) for line, piece in entries.furniture)
        start_line, robot = entries.robot
        if isinstance(robot.start, str):
            robot = msgspec.structs.replace(
                robot, start=self._place(start_line, robot.start, "The robot's start")
            )
        return msgspec.structs.replace(
            self.bare,
            robot=robot,
            places=tuple(self._enclose(line, place) for line, place in entries.places),
            people=tuple(self._person(line, person) for line, person in entries.people),
            objects=tuple(self._thing(line, thing, furniture) for line, thing in entries.objects),
            furniture=furniture,
            doors=tuple(self._site(line, door) for line, door in entries.doors),
        )

    def _place(self, line: int, name: str, what: str) -> str | None:
        """The exact name of the place, which may be given by an alias."""
        place = self.bare.place(name)
        if place is not None:
            return place.name
        hint = did_you_mean(name, (place.name for place in self.bare.places))
        self.reader.problem(
            line,
            f'{what} is "{name}", but there is no such place.'
            f"{hint or ' Add it to the places, or name one of them.'}",
            floor=True,
        )
        return None

    def _enclose(self, line: int, place: Place) -> Place:
        """`in` may name what is no place, such as a floor; but not by a slip of the pen."""
        if place.inside is None:
            return place
        around = self.bare.place(place.inside)
        if around is not None:
            if around.name == place.name:
                self.reader.problem(
                    line, f'"{place.name}" is said to be in itself. Name what it is a part of.'
                )
            return msgspec.structs.replace(place, inside=around.name)
        others = (other.name for other in self.bare.places if other.name != place.name)
        hint = did_you_mean(place.inside, others)
        if hint:
            self.reader.problem(
                line, f'"{place.name}" is in "{place.inside}", but there is no such place.{hint}'
            )
        return place

    def _site(self, line: int, entry: _Sited) -> _Sited:
        """With the exact name of the place it is at, or the one its pose is in."""
        if entry.at is not None:
            at = self._place(line, entry.at, f"{_called(entry)}: its place")
            return msgspec.structs.replace(entry, at=at)
        pose = _pose_of(entry)
        around = self.bare.place_at(pose.x, pose.y) if pose is not None else None
        return msgspec.structs.replace(entry, at=around.name) if around is not None else entry

    def _person(self, line: int, person: Person) -> Person:
        walks = [
            self._place(line, name, f'"{person.name}": a place to walk to') for name in person.walks
        ]
        person = msgspec.structs.replace(person, walks=tuple(name for name in walks if name))
        if person.at is None and person.pose is None and person.walks:
            return msgspec.structs.replace(person, at=person.walks[0])
        return self._site(line, person)

    def _thing(self, line: int, thing: Thing, furniture: Sequence[Furniture]) -> Thing:
        """`at` may also name furniture that there is only one of."""
        if thing.at is not None and self.bare.place(thing.at) is None:
            bearers = _bearing(thing.at, furniture)
            if len(bearers) == 1:
                return msgspec.structs.replace(thing, at=bearers[0].at, on=bearers[0].name)
        if thing.on is None:
            return self._site(line, thing)
        on = thing.on
        bearers = _bearing(on, furniture)
        if thing.at is None and len(bearers) == 1:
            return msgspec.structs.replace(thing, at=bearers[0].at, on=bearers[0].name)
        thing = self._site(line, thing)
        here = [piece for piece in bearers if piece.at == thing.at]
        if here:
            return msgspec.structs.replace(thing, on=here[0].name)
        pieces = (piece.name for piece in furniture if piece.at in (thing.at, None))
        self.reader.problem(
            line,
            f'"{thing.name}" is on "{thing.on}", but '
            + (
                f'there is no such furniture at "{thing.at}".'
                if thing.at
                else "it is not clear which one that is."
            )
            + (did_you_mean(on, pieces) or ' Say "at" which place, and list the furniture.'),
            floor=True,
        )
        return thing


def _called(entry: Person | Thing | Furniture | Door) -> str:
    return f'"{entry.name}"' if entry.name else "A door"


def _pose_of(entry: Person | Thing | Furniture | Door) -> Pose | None:
    return None if isinstance(entry, Door) else entry.pose


def _bearing(name: str, furniture: Iterable[Furniture]) -> list[Furniture]:
    return [
        piece
        for piece in furniture
        if key(name) in (key(piece.name), *(key(a) for t in piece.aliases.values() for a in t))
    ]


# --- doors in walls ------------------------------------------------------------------------------


def cut_doors(walls: Sequence[Segment], doors: Sequence[Segment]) -> tuple[Segment, ...]:
    """The walls with the openings of the doors cut out."""
    return tuple(piece for wall in walls for piece in _cut(wall, doors))


def _opening(wall: Segment, door: Segment) -> tuple[float, float] | None:
    """From where to where along the wall, in metres, the door opens it; None if it does not."""
    x1, y1, x2, y2 = wall
    length = math.hypot(x2 - x1, y2 - y1)
    u, v = (x2 - x1) / length, (y2 - y1) / length
    off = [abs((x - x1) * v - (y - y1) * u) for x, y in (door[:2], door[2:])]
    along = sorted((x - x1) * u + (y - y1) * v for x, y in (door[:2], door[2:]))
    low, high = max(along[0], 0.0), min(along[1], length)
    return (low, high) if max(off) <= ON_THE_LINE and high - low > SHORTEST_WALL else None


def _cut(wall: Segment, doors: Sequence[Segment]) -> Iterable[Segment]:
    x1, y1, x2, y2 = wall
    length = math.hypot(x2 - x1, y2 - y1)
    openings = sorted(opening for door in doors if (opening := _opening(wall, door)))
    if not openings:
        yield wall
        return
    at = 0.0
    for low, high in [*openings, (length, length)]:
        if low - at > SHORTEST_WALL:
            yield (
                round(x1 + (x2 - x1) * at / length, 9),
                round(y1 + (y2 - y1) * at / length, 9),
                round(x1 + (x2 - x1) * low / length, 9),
                round(y1 + (y2 - y1) * low / length, 9),
            )
        at = max(at, high)
