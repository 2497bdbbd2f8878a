"""Where a robot can stand: for who names a place by a click, and for who checks a world."""

from __future__ import annotations

import math
from collections.abc import Iterator

from sim.hospital import chart_of
from sim.physics.navigation import Chart, Spot
from sim.world.model import Place, World
from sim.world.zones import distance_to, distance_to_line

NEAR = 0.6
"""Metres that a spot is put aside at most, to where there is room."""
_STEP, _AROUND = 0.05, 24


def room_near(world: World, x: float, y: float, within: float = NEAR) -> Spot | None:
    """The spot, or the nearest within so many metres where the robot has room and leaves doorways
    free, as far as there is one; None if it has no room at all."""
    chart = chart_of(world)
    free = chart.nearest_free(x, y)
    if free is not None and math.dist(free, (x, y)) <= within:
        if not blocks_a_door(world, *free):
            return free
        # Not beyond a wall: people would look for it here.
        beside = (
            spot
            for spot in _around(chart, x, y, within)
            if not blocks_a_door(world, *spot) and chart.in_sight(free, spot)
        )
        return next(beside, free)
    # It is in a wall, or just beyond one.
    near = list(_around(chart, x, y, within))
    return next((spot for spot in near if not blocks_a_door(world, *spot)), next(iter(near), None))


def _around(chart: Chart, x: float, y: float, within: float) -> Iterator[Spot]:
    """Spots with room, the nearest first."""
    for ring in range(1, round(within / _STEP) + 1):
        for number in range(_AROUND):
            angle = math.tau * number / _AROUND
            spot = (x + ring * _STEP * math.cos(angle), y + ring * _STEP * math.sin(angle))
            if chart.fits(*spot) and chart.nearest_free(*spot) == spot:
                yield spot


def blocks_a_door(world: World, x: float, y: float) -> bool:
    """Whether a robot that stands there is in people's way through a door: in it, or so close
    before it that not even another robot came by."""
    width = 2 * world.robot.radius
    for x1, y1, x2, y2 in (door.ends for door in world.doors):
        body = distance_to_line((x1, y1), (x2, y2), (x, y)) - world.robot.radius
        if body < width:
            return True
    return False


def zone_around(world: World, x: float, y: float) -> str | None:
    """The name of the keep-out zone that a robot at that spot would be in."""
    for zone in world.zones:
        if distance_to(zone.polygon, x, y) < world.robot.radius:
            return zone.name
    return None


def is_reached(world: World, x: float, y: float) -> bool:
    """Whether there is a way to that spot from where the robot starts, were all doors open and no
    zones drawn."""
    start = world.start
    return start is not None and chart_of(world).route((start.x, start.y), (x, y)) is not None


def troubles_with_places(world: World) -> Iterator[tuple[Place, str]]:
    """The places that the robot could not go to, each with why, to be read after its name."""
    chart, start = chart_of(world), world.start
    closed = [f"zone {number}" for number in range(len(world.zones))]
    for place in world.places:
        pose = place.pose
        if pose is None or start is None:
            continue
        spot = (pose.x, pose.y)
        zone = zone_around(world, *spot)
        why = None
        if not chart.is_floor(*spot):
            why = "is where the map shows no floor"
        elif not chart.fits(*spot):
            why = "is so close to a wall or furniture that the robot has no room there"
        elif zone is not None:
            why = f'is in the keep-out zone "{zone}"'
        elif chart.route((start.x, start.y), spot, closed) is None:
            why = "cannot be reached from where the robot starts"
        if why is not None:
            yield place, why
