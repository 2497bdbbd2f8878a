"""Having the wheel: one behaviour at a time moves the robot, and leaves it at rest."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterator
from dataclasses import dataclass

from sim.errors import NotPossible
from sim.hospital import Hospital
from sim.physics.bodies import STEP
from sim.physics.robot import SLOW_DOWN, TURN_CHANGE, wrap
from sim.runner import Behaviour


@dataclass(frozen=True, eq=False)
class _Wheel:
    joystick: bool


@contextlib.contextmanager
def wheel(hospital: Hospital, joystick: bool = False) -> Iterator[object]:
    """Have the wheel; the robot rests afterwards. One behaviour has it at a time, but that a
    movement of the joystick takes over from the one before."""
    robot = hospital.robot
    holder = robot.driver
    if isinstance(holder, _Wheel) and not (joystick and holder.joystick):
        raise NotPossible("The robot is already driving. Stop it first, or wait until it is there.")
    check_battery(hospital)
    mine = robot.driver = _Wheel(joystick)
    try:
        yield mine
    finally:
        if robot.driver is mine:
            robot.driver = None
            robot.waits_for = None
            robot.way = ()
            robot.rest()


def check_battery(hospital: Hospital) -> None:
    if hospital.robot.battery <= 0:
        raise NotPossible("The battery is empty. Push the robot to its charging station.")


def come_to_rest(hospital: Hospital) -> Behaviour[None]:
    hospital.robot.aim(0.0, 0.0)
    while hospital.robot.moving:
        yield


def face(hospital: Hospital, theta: float) -> Behaviour[None]:
    """Turn on the spot, the shorter way round."""
    yield from turn_by(hospital, wrap(theta - hospital.robot.theta))
    hospital.robot.theta = wrap(theta)


def turn_by(hospital: Hospital, degrees: float) -> Behaviour[None]:
    robot = hospital.robot
    yield from come_to_rest(hospital)
    while abs(degrees) > 0.3:
        check_battery(hospital)
        arriving = math.sqrt(1.6 * TURN_CHANGE * abs(degrees))
        rate = min(robot.pace.turn_rate, arriving, abs(degrees) / STEP)
        robot.aim(0.0, math.copysign(rate, degrees))
        yield
        degrees -= robot.turning * STEP
    yield from come_to_rest(hospital)


def braking(distance: float) -> float:
    """The speed from which one can stop within the distance."""
    return math.sqrt(1.6 * SLOW_DOWN * distance) if distance > 0 else 0.0
