"""Where a click on the map sends the robot: a spot where it has room, and what people call it.

    aimed = aim(backstage, 3.02, 7.66, None, "en")
    aimed.program   # 'robot.goto(3.02, 7.7)  # by the door of the pharmacy\\n'
    aimed.said      # 'Go to the spot by the door of the pharmacy.'

Nothing moves by this: the program is proposed, and reviewed like any other.
"""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any, Final

import msgspec

from grammar.language import load_language
from grammar.naming import joined_up, place_called
from nl2robot.console.visitor import LANGUAGES, texts
from nl2robot.errors import UserError
from nl2robot.station.part import Backstage, Part
from nl2robot.wire import service
from sim.hospital import chart_of
from sim.spots import is_reached, room_near, zone_around

if TYPE_CHECKING:
    from sim.world.model import World

FARTHEST: Final = 1000.0
"""Metres from the origin."""
ASIDE: Final = 2.0
"""Metres that a goal is put aside at most, to where the robot has room."""
AT_PLACE: Final = 0.6
"""Metres from where one stands at a place that mean the place."""
AT_DOOR: Final = 1.3
"""Metres from a door that count as by it."""
BY_PLACE: Final = 5.0
"""Metres from a place that count as near it."""
MOVED: Final = 0.05
"""Metres that nobody sees."""


class Aimed(msgspec.Struct, frozen=True):
    """What is meant by a spot on the map."""

    x: float
    y: float
    place: str | None
    """The place that it is, if it is one."""
    moved: float
    """Metres from the spot that was meant to where the robot has room."""
    program: str
    said: str
    """What somebody would say who wants it, in the visitor's language."""
    note: str
    """That it was put aside, as a sentence; empty if it was not."""


def part(backstage: Backstage) -> Part:
    """The goals on the wire."""
    return Part(
        services={
            "places.aim": service(
                lambda p: msgspec.to_builtins(
                    aim(backstage, p["x"], p["y"], p.get("place"), p.get("language", "en"))
                ),
                "Tell what a spot or a place on the map means as a goal: the nearest spot where the"
                " robot has room and blocks no door, by how many metres that was moved, what people"
                " call it, and the program that goes there. Moves nothing.",
                {
                    "x": {"type": "number"},
                    "y": {"type": "number"},
                    "place": {"type": ["string", "null"], "maxLength": 1000},
                    "language": {"enum": list(LANGUAGES)},
                },
                "x y",
                result=Aimed,
            )
        }
    )


def aim(backstage: Backstage, x: float, y: float, place: str | None, language: str) -> Aimed:
    """What the robot would be sent to. Raises `UserError` where it cannot go."""
    knowledge = backstage.runner.knowledge
    # What is drawn on the map of a simulated robot, its zones among it, the simulation knows.
    world = backstage.simulation.world if backstage.simulation else knowledge.world
    words = texts("map", language)
    spoken = load_language(language)

    def phrase(key: str, **values: str) -> str:
        named = {
            each: place_called(name, knowledge.lexicon(language), spoken)
            if each == "place"
            else name
            for each, name in values.items()
        }
        return joined_up(words[key].format(**named), spoken)

    named = place if place is not None and world.place(place) else _place_at(world, x, y)
    if named is not None:
        program = f"robot.goto({json.dumps(named, ensure_ascii=False)})\n"
        return Aimed(x, y, named, 0.0, program, phrase("goal_place", place=named), "")
    meant = x, y
    x, y, moved = free_spot(world, x, y, ASIDE)
    x, y = round(x, 2), round(y, 2)
    where = phrase("goal_at", x=_number(x, language), y=_number(y, language))
    landmark = _landmark(world, x, y)
    near = phrase(landmark[0], place=landmark[1]) if landmark is not None else where
    said = words["goal_spot"].format(where=near)
    if landmark is not None and landmark[0] != "goal_door":  # which does not say where in it
        said = words["goal_spot"].format(where=f"{near}, {where}")
    note = ""
    if moved > MOVED:
        key = "goal_doorway" if _has_room(world, *meant) else "goal_moved"
        note = words[key].format(metres=_number(round(moved, 1), language))
    program = f"robot.goto({x:g}, {y:g})  # {near}\n"
    return Aimed(x, y, None, round(moved, 2), program, said, note)


def free_spot(world: World, x: float, y: float, within: float) -> tuple[float, float, float]:
    """The nearest spot where the robot has room and blocks no door, and how many metres that is
    from there. Raises `UserError` if none is within so many metres."""
    if not (abs(x) <= FARTHEST and abs(y) <= FARTHEST):  # nor is NaN
        raise UserError("That is no spot on this map. Click on the map.")
    if not world.has_geometry:
        return x, y, 0.0  # a robot with a map of its own, of which nothing is known here

    spot = room_near(world, x, y, within)
    if spot is None:
        raise UserError(
            "There the robot has no room: it is a wall, or where the map shows no floor. Click"
            " on free floor."
        )
    if not is_reached(world, *spot):
        raise UserError("There is no way there for the robot. Click on floor that it can reach.")
    zone = zone_around(world, *spot)
    if zone is not None:
        raise UserError(
            f'There the robot may not go: it is in the keep-out zone "{zone}". Click outside'
            " of it, or remove the zone first."
        )
    return (*spot, math.dist(spot, (x, y)))


def _has_room(world: World, x: float, y: float) -> bool:
    """Whether the robot could stand right there, if only in people's way."""
    return chart_of(world).nearest_free(x, y) == (x, y)


def _place_at(world: World, x: float, y: float) -> str | None:
    """The place where one stands at that spot, the nearest if there are several."""
    away = {
        place.name: math.hypot(place.pose.x - x, place.pose.y - y)
        for place in world.places
        if place.pose is not None
    }
    nearest = min(away, key=away.__getitem__, default=None)
    return nearest if nearest is not None and away[nearest] <= AT_PLACE else None


def _landmark(world: World, x: float, y: float) -> tuple[str, str] | None:
    """What people would say a spot is at: the text's key, with the name of a place."""
    from shapely import LineString, Point

    here = Point(x, y)

    def away(ends: Any) -> float:
        x1, y1, x2, y2 = ends
        return float(LineString([(x1, y1), (x2, y2)]).distance(here))

    doors = [(away(door.ends), door.at) for door in world.doors if door.at]
    distance, leads_to = min(doors, default=(math.inf, None))
    if leads_to is not None and distance <= AT_DOOR:
        return "goal_door", leads_to
    around = world.place_at(x, y)
    if around is not None:
        return ("goal_in" if around.area else "goal_near"), around.name
    places = [
        (math.hypot(place.pose.x - x, place.pose.y - y), place.name)
        for place in world.places
        if place.pose is not None
    ]
    distance, name = min(places, default=(math.inf, ""))
    return ("goal_near", name) if distance <= BY_PLACE else None


def _number(metres: float, language: str) -> str:
    written = f"{metres:g}"
    return written if language == "en" else written.replace(".", ",")
