"""Where people and things are when the simulation begins, if the world does not say exactly.

The choice is the same for every seed: a spot near the place's pose, on the right furniture.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from sim.physics.navigation import Chart, Spot
from sim.world.geometry import contains, rectangle
from sim.world.model import Furniture, Person, Place, Thing, World
from sim.world.words import words

_GOLDEN = 2.399963  # radians: each next spot is well apart from all before it
_APART = 0.7
"""Metres between the middles of two people."""


@dataclass
class Item:
    """A thing and where it is now."""

    number: int
    thing: Thing
    x: float
    y: float
    on: str | None = None
    """The furniture it is on or in."""
    holder: str | None = None
    """The person who has it; `ROBOT` for the robot."""
    present: bool = True
    """False if it is nowhere to be found."""

    def copy(self) -> Item:
        return replace(self)


ROBOT = "the robot"


@dataclass(frozen=True)
class Placing:
    x: float
    y: float
    theta: float
    posture: str
    """ "standing", "sitting" or "lying"."""


def people_at_start(world: World, chart: Chart) -> Iterator[tuple[Person, Placing]]:
    """Each person who is somewhere, with where and how."""
    taken: list[Spot] = []
    for person in world.people:
        posture = posture_of(person)
        placing = _place_person(world, chart, person, posture, taken)
        if placing is not None:
            taken.append((placing.x, placing.y))
            yield person, placing


def posture_of(person: Person) -> str:
    """How the world's file says that they are."""
    for attribute in person.is_:
        for posture in ("sitting", "lying"):
            if set(attribute.casefold().split()) & words().postures[posture]:
                return posture
    return "standing"


def _place_person(
    world: World, chart: Chart, person: Person, posture: str, taken: Sequence[Spot]
) -> Placing | None:
    if person.pose is not None:
        return Placing(person.pose.x, person.pose.y, person.pose.theta, posture)
    place = world.place(person.at) if person.at else None
    middle = middle_of(world, place)
    if place is None or middle is None:
        return None
    for piece in world.furniture_at(place.name):
        if piece.pose is None or piece.kind not in words().furniture_for[posture]:
            continue
        spot = (piece.pose.x, piece.pose.y)
        if all(math.dist(spot, other) >= _APART for other in taken):
            # Who lies has the head at one end; who sits looks to where a visitor would stand.
            facing = piece.pose.theta if posture == "lying" else _facing(spot, middle)
            return Placing(*spot, facing, posture)
    spot = free_spot(world, chart, middle, [*taken, middle], 0.9, 3.0) or middle
    return Placing(*spot, _facing(spot, middle), posture)


def things_at_start(world: World, chart: Chart) -> list[Item]:
    """Every thing of the world, in its order; those that are nowhere are not `present`."""
    items: list[Item] = []
    for number, thing in enumerate(world.objects):
        item = Item(number, thing, 0.0, 0.0, present=False)
        taken = [(other.x, other.y) for other in items if other.present]
        place = world.place(thing.at) if thing.at else None
        middle = middle_of(world, place)
        if thing.pose is not None:
            item = replace(item, x=thing.pose.x, y=thing.pose.y, on=thing.on, present=True)
        elif place is not None and middle is not None:
            piece = _furniture_for(world, thing, place)
            spot = (
                spot_on(piece, middle, taken)
                if piece is not None
                else free_spot(world, chart, middle, taken, 0.6, 2.0, apart=0.25) or middle
            )
            item = replace(
                item, x=spot[0], y=spot[1], on=piece.name if piece else None, present=True
            )
        items.append(item)
    return items


def _furniture_for(world: World, thing: Thing, place: Place) -> Furniture | None:
    pieces = [piece for piece in world.furniture_at(place.name) if piece.pose is not None]
    if thing.on is not None:
        named = [piece for piece in pieces if thing.on in (piece.name, piece.kind)]
        return named[0] if named else None
    surfaces = [piece for piece in pieces if piece.kind in words().furniture_for["things"]]
    return surfaces[0] if surfaces else None


def spot_on(piece: Furniture, towards: Spot, taken: Sequence[Spot]) -> Spot:
    """A spot on the furniture that is free of other things, near the edge that faces `towards`."""
    assert piece.pose is not None
    length, width = piece.size
    inner = rectangle(piece.pose, (length * 0.8, width * 0.7))
    (ax, ay), (bx, by), _, (dx, dy) = inner
    candidates = [
        (ax + (bx - ax) * u + (dx - ax) * v, ay + (by - ay) * u + (dy - ay) * v)
        for u in (0.5, 0.25, 0.75, 0.0, 1.0, 0.375, 0.625, 0.125, 0.875)
        for v in (0.0, 0.5, 1.0)
    ]
    free = [spot for spot in candidates if all(math.dist(spot, other) > 0.12 for other in taken)]
    return min(free or candidates, key=lambda spot: round(math.dist(spot, towards), 3))


def free_spot(
    world: World,
    chart: Chart,
    middle: Spot,
    taken: Sequence[Spot],
    nearest: float,
    farthest: float,
    apart: float = _APART,
) -> Spot | None:
    """A spot at some distance around the middle, in the same room, where somebody fits and that
    is `apart` from those taken; None if there is none."""
    # A charger's bay in the lobby is no room of its own: the widest area counts.
    areas = [place.area for place in world.places if place.area and contains(place.area, *middle)]
    for i in range(60):
        reach = nearest + (farthest - nearest) * i / 60
        x = middle[0] + reach * math.cos(i * _GOLDEN)
        y = middle[1] + reach * math.sin(i * _GOLDEN)
        if areas and not any(contains(area, x, y) for area in areas):
            continue
        if any(math.dist((x, y), other) < apart for other in taken):
            continue
        if chart.distance(x, y) >= chart.clearance and chart.in_sight(middle, (x, y)):
            return x, y
    return None


def middle_of(world: World, place: Place | None) -> Spot | None:
    """Where a place is: its pose, else the middle of its area, else where what it is in is."""
    while place is not None:
        if place.pose is not None:
            return place.pose.x, place.pose.y
        if place.area:
            count = len(place.area)
            return sum(x for x, _ in place.area) / count, sum(y for _, y in place.area) / count
        around = world.place(place.inside) if place.inside else None
        place = around if around is not place else None
    return None


def _facing(spot: Spot, towards: Spot) -> float:
    return math.degrees(math.atan2(towards[1] - spot[1], towards[0] - spot[0]))
