"""A world as a floor plan for the browser: JSON of metres, degrees and names."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from sim.view import ThingSeen
from sim.world.geometry import Point, Polygon
from sim.world.maps import outlines, painted
from sim.world.model import Door, Furniture, Person, Place, Thing, World

Names = dict[str, str]


def floor_plan(world: World, things: Sequence[ThingSeen] = ()) -> dict[str, Any]:
    """What does not change on a floor. `things` says where the world's objects were at first."""
    ground = [_polygon(outline) for outline in _ground(world)]
    return {
        "name": world.name,
        "robot": {"name": world.robot.name, "radius": world.robot.radius},
        "bounds": _bounds(world, ground),
        "wall": world.wall_thickness,
        "walls": world.drawn_walls,
        "ground": ground,
        "map": _map(world),
        "doors": [_door(world, door) for door in world.doors],
        "places": [place_plan(world, place) for place in world.places],
        "people": {person.name: names for person in world.people if (names := _names(person))},
        "furniture": [_furniture(piece) for piece in world.furniture if piece.pose],
        "things": [_thing(world.objects[seen.number], seen) for seen in things],
    }


def _ground(world: World) -> Iterable[Polygon]:
    """The outlines of the free floor of an image map."""
    if world.map is None:
        return ()

    return outlines(world.map)


def _map(world: World) -> list[tuple[str, list[Point]]]:
    """An image map as areas to paint one over the other: what is free, occupied, unknown."""
    if world.map is None:
        return []

    return [(what, _polygon(outline)) for what, outline in painted(world.map)]


def _bounds(world: World, ground: list[list[Point]]) -> tuple[float, float, float, float]:
    """What there is to see: of an image the floor, without the unknown around it."""
    if not ground or world.drawn_walls:
        return world.bounds
    xs, ys = zip(*(corner for outline in ground for corner in outline), strict=True)
    return (min(xs), min(ys), max(xs), max(ys))


def _polygon(polygon: Polygon) -> list[Point]:
    return [(round(x, 3), round(y, 3)) for x, y in polygon]


def _names(named: Place | Person | Furniture | Thing) -> Names:
    """What it is called in the other languages; its own name is the English one."""
    return {
        language: aliases[0]
        for language, aliases in named.aliases.items()
        if aliases and language != "en"
    }


def place_plan(world: World, place: Place) -> dict[str, Any]:
    """A place as the map shows it."""
    pose = place.pose
    return {
        "name": place.name,
        "names": _names(place),
        "kind": place.kind,
        "pose": [pose.x, pose.y, pose.theta] if pose else None,
        "area": _polygon(place.area),
        "part": bool(place.inside and world.place(place.inside)),
    }


def _furniture(piece: Furniture) -> dict[str, Any]:
    pose = piece.pose
    assert pose is not None
    return {
        "name": piece.name,
        "names": _names(piece),
        "kind": piece.kind,
        "pose": [pose.x, pose.y, pose.theta],
        "size": piece.size,
    }


def _thing(thing: Thing, seen: ThingSeen) -> dict[str, Any]:
    return {
        "number": seen.number,
        "name": thing.name,
        "names": _names(thing),
        "is": thing.is_,
        "x": seen.x,
        "y": seen.y,
    }


def _door(world: World, door: Door) -> dict[str, Any]:
    return {
        "ends": door.ends,
        "name": door.name,
        "at": door.at,
        "open": door.open,
        "side": _side(world, door),
    }


def _side(world: World, door: Door) -> int:
    """1 if the door opens to the left of its line, -1 if to the right: into its place."""
    place = world.place(door.at) if door.at else None
    if place is None or place.pose is None:
        return 1
    x1, y1, x2, y2 = door.ends
    cross = (x2 - x1) * (place.pose.y - y1) - (y2 - y1) * (place.pose.x - x1)
    return 1 if cross > 0 else -1
