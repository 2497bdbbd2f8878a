"""All that there is in a hospital at one moment: what a copy of it begins with, in this process or
in another. It can be pickled."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import TYPE_CHECKING, Any, Final, cast

from sim.people.crowd import Human
from sim.physics.placing import Item
from sim.physics.robot import Robot
from sim.world.model import World

if TYPE_CHECKING:
    from sim.hospital import Hospital
    from sim.physics.bodies import Motion
    from sim.physics.navigation import Spot

_BODILESS: Final = cast(Any, None)
"""Bodies are of one physics only; how they moved is kept beside who had them."""


@dataclass(frozen=True)
class Snapshot:
    """Belongs to whoever made it: nothing in it changes with the hospital."""

    world: World
    start: datetime
    steps: int
    chance: Any
    """The state of its random numbers."""
    open_doors: list[bool]
    robot: Robot
    robot_moves: Motion
    people: list[Human]
    people_move: list[Motion]
    items: list[Item]
    known_closed: dict[str, float]
    last_seen: dict[str, str]
    trail: list[Spot]
    met: dict[str | None, set[str]]
    partner: str | None
    newcomers: int


def snapshot(hospital: Hospital) -> Snapshot:
    return Snapshot(
        world=hospital.world,
        start=hospital.start,
        steps=hospital.steps,
        chance=hospital.random.getstate(),
        open_doors=list(hospital.open_doors),
        robot=hospital.robot.copy(_BODILESS),
        robot_moves=hospital.robot.body.motion,
        people=[human.copy(_BODILESS) for human in hospital.people],
        people_move=[human.body.motion for human in hospital.people],
        items=[item.copy() for item in hospital.items],
        known_closed=dict(hospital.known_closed),
        last_seen=dict(hospital.last_seen),
        trail=list(hospital.trail),
        met={place: set(names) for place, names in hospital.met.items()},
        partner=hospital.partner,
        newcomers=hospital.newcomers,
    )
