"""The floor from above at one moment: what a live map of it shows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import msgspec

from sim.physics.placing import ROBOT, Item
from sim.physics.robot import RobotState

if TYPE_CHECKING:
    from sim.hospital import Hospital

IN_ROBOT: Final = True
"""The holder of a thing that the robot holds; a person goes by their name."""


class PersonSeen(msgspec.Struct, frozen=True, array_like=True):
    """Somebody, where they are and how."""

    name: str
    kind: str
    x: float
    y: float
    theta: float
    posture: str
    """ "standing", "sitting" or "lying"."""


class ThingSeen(msgspec.Struct, frozen=True, array_like=True):
    """A thing by its number among the world's objects, and who holds it, if anybody does."""

    number: int
    x: float
    y: float
    holder: str | bool | None = None


class View(msgspec.Struct, frozen=True):
    """Metres, degrees, seconds; rounded to what a map can show."""

    time: float
    robot: RobotState
    way: tuple[tuple[float, float], ...]
    """Where the robot is about to drive; empty when it does not drive to a goal."""
    lidar: tuple[float, ...]
    people: tuple[PersonSeen, ...]
    things: tuple[ThingSeen, ...]
    """Those that are somewhere."""
    closed: tuple[int, ...]
    """The numbers of the doors that are closed."""


def view(hospital: Hospital) -> View:
    """Look at the hospital now; in the thread that has the turn."""
    return View(
        time=round(hospital.time, 2),
        robot=hospital.robot_state(),
        way=tuple((round(x, 2), round(y, 2)) for x, y in hospital.robot.way),
        lidar=tuple(hospital.lidar),
        people=tuple(
            PersonSeen(
                human.name,
                human.person.kind,
                round(human.position[0], 2),
                round(human.position[1], 2),
                round(human.theta),
                human.posture,
            )
            for human in hospital.people
        ),
        things=tuple(_thing(item) for item in hospital.items if item.present),
        closed=tuple(n for n, is_open in enumerate(hospital.open_doors) if not is_open),
    )


def _thing(item: Item) -> ThingSeen:
    holder = IN_ROBOT if item.holder == ROBOT else item.holder
    return ThingSeen(item.number, round(item.x, 2), round(item.y, 2), holder)
