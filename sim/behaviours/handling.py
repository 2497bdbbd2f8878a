"""Taking things, putting them down, handing them over."""

from __future__ import annotations

import math

from sim.behaviours.searching import approach
from sim.behaviours.wheel import wheel
from sim.errors import NotFound, NotPossible
from sim.hospital import Hospital
from sim.people.perception import fits, item_in_view, parse, person_in_view, spot_of
from sim.physics.placing import ROBOT, Item, spot_on
from sim.runner import Behaviour
from sim.world.model import Furniture

HANDS = 1
"""How many things the robot holds at most."""
STRENGTH = 5.0
"""Kilograms that it lifts at most."""
_GRASP = 2.0
"""Seconds."""
_ARM = 1.6
"""Metres that the arm reaches from the robot's middle."""


def grab(hospital: Hospital, thing: str) -> Behaviour[str]:
    """Drive up to the nearest such thing here and take it; returns its name."""
    robot = hospital.robot
    with wheel(hospital):
        if len(robot.holding) >= HANDS:
            held = hospital.items[robot.holding[0]].thing.name
            raise NotPossible(
                f"The robot already holds the {held}. Let it put that down or hand it over first."
            )
        item = item_in_view(hospital, thing)
        if (item.thing.weight or 0.0) > STRENGTH:
            raise NotPossible(
                f"The {item.thing.name} is too heavy for the robot. Ask somebody to carry it."
            )
        yield from approach(hospital, item)
        _check_reach(hospital, item.thing.name, (item.x, item.y))
        yield from hospital.wait(_GRASP)
        if item.holder is not None:
            raise NotPossible(
                f"The {item.thing.name} is gone: {item.holder} has it. Ask them for it."
            )
        item.holder, item.on = ROBOT, None
        robot.holding.append(item.number)
        hospital.note("grab", {"thing": item.thing.name})
        return item.thing.name


def put(hospital: Hospital, thing: str, where: str | None) -> Behaviour[None]:
    """Put what is held down: on furniture of this place, or beside the robot."""
    with wheel(hospital):
        item = _held(hospital, thing)
        if where is None:
            heading = math.radians(hospital.robot.theta)
            x, y = hospital.robot.position
            spot = (x + 0.45 * math.cos(heading), y + 0.45 * math.sin(heading))
            yield from hospital.wait(_GRASP)
            _let_go(hospital, item, spot)
            hospital.note("put", {"thing": item.thing.name, "where": None})
            return
        piece = _furniture_here(hospital, where)
        taken = [(i.x, i.y) for i in hospital.items if i.present and i.holder is None]
        spot = spot_on(piece, hospital.robot.position, taken)
        yield from approach(hospital, Item(-1, item.thing, *spot))
        _check_reach(hospital, piece.name, spot)
        yield from hospital.wait(_GRASP)
        _let_go(hospital, item, spot)
        item.on = piece.name
        hospital.note("put", {"thing": item.thing.name, "where": piece.name})


def give(hospital: Hospital, thing: str, person: str | None) -> Behaviour[str]:
    """Drive up to somebody who is here and hand it to them; returns their name."""
    with wheel(hospital):
        item = _held(hospital, thing)
        human = person_in_view(hospital, person or "person")
        hospital.partner = human.name
        yield from approach(hospital, human, 0.8)
        _check_reach(hospital, human.name, human.position)
        human.attend(hospital)
        yield from hospital.wait(_GRASP)
        _let_go(hospital, item, human.position)
        item.holder = human.name
        human.holding.append(item.number)
        hospital.note("give", {"thing": item.thing.name, "person": human.name})
        return human.name


def _held(hospital: Hospital, thing: str) -> Item:
    held = [hospital.items[number] for number in hospital.robot.holding]
    phrase = parse(thing)
    for item in held:
        if fits(hospital, item, phrase):
            return item
    now = f"It holds the {held[0].thing.name}." if held else "Its hand is empty."
    raise NotPossible(f'The robot does not hold "{thing}". {now}')


def _let_go(hospital: Hospital, item: Item, spot: tuple[float, float]) -> None:
    hospital.robot.holding.remove(item.number)
    item.holder = None
    item.x, item.y = spot


def _furniture_here(hospital: Hospital, where: str) -> Furniture:
    phrase = parse(where)
    here = [
        piece
        for piece in hospital.world.furniture
        if piece.pose is not None
        and hospital.here(*spot_of(piece))
        and fits(hospital, piece, phrase)
    ]
    if not here:
        raise NotFound(
            f'There is no "{where}" here to put it on. Name furniture that stands in this room.'
        )
    return min(here, key=lambda piece: math.dist(hospital.robot.position, spot_of(piece)))


def _check_reach(hospital: Hospital, name: str, spot: tuple[float, float]) -> None:
    if math.dist(hospital.robot.position, spot) > _ARM:
        raise NotPossible(
            f"The robot does not get near enough to {name} to reach it. "
            "Clear the way, or have it handed over."
        )
