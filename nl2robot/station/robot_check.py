"""The conformance suite on the robot at an address."""

from __future__ import annotations

from dataclasses import replace

from nl2robot.station.robots import (
    Chosen,
    alone,
    opener,
    order_of,
    places_of,
    trouble_reaching,
    zones_of,
)
from robot_api.checker import Report, check_driver, check_robot
from robot_api.drivers import simulated
from robot_api.robots.opening import hold
from sim.simulation import Simulation
from sim.world.model import World


def checked(robot: Chosen, world: World, password: str | None, *, move: bool) -> Report:
    """Reach a robot and look at all that it declares, and at what becomes of it when its link
    fails. Raises `UserError`, `LostConnection`."""
    if robot.simulated:
        return _simulated(robot, world, move)
    address = robot.address
    if address.host and address.port is None:
        address = replace(address, port=robot.kind.port)
    with alone(robot), trouble_reaching():
        places = places_of(world, zones_of(world))
        return check_robot(
            opener(robot, world, password=password, places=places),
            address,
            move=move,
            order=order_of(replace(robot, address=address), password, places),
        )


def _simulated(robot: Chosen, world: World, move: bool) -> Report:

    driver = simulated(Simulation(world))
    try:
        hold(driver, robot.read)
        return check_driver(driver, move=move)
    finally:
        driver.close()
