"""One errand for every robot: a visitor is asked where to, guided there, asked again, and the desk
is told. The same program, on the simulator and on each robot, and the same has to come of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from robot_api.capabilities.driving import Goal
from robot_api.capabilities.sound import Asked
from robot_api.driver import StopFlag
from robot_api.drivers import ComposedDriver, simulated
from robot_api.robots.places import NamedPlace
from robot_api.values import Location
from sandbox.execution import Execution, Outcome
from sim.simulation import Simulation
from sim.world.loading import load_world
from sim.world.model import World

ERRAND = """\
desk = robot.location()
place = robot.ask("Shall we go to radiology or to the pharmacy?", ["radiology", "pharmacy"])
robot.guide("person", place)
right = robot.ask("Is this where you wanted to go?", ["yes", "no"])
robot.goto(desk)
robot.say(f"A visitor is at the {place}. Was it right? The answer was {right}.")
"""
REPORT = "A visitor is at the pharmacy. Was it right? The answer was yes."

WARD = """\
name: ward
robot: {start: lobby}
walls: [[-6, -3, 6, -3], [6, -3, 6, 5], [6, 5, -6, 5], [-6, 5, -6, -3]]
places:
  - {name: lobby, pose: [0, 0, 0]}
  - {name: pharmacy, kind: room, pose: [3, 2, 90]}
  - {name: radiology, kind: room, pose: [-3, 2, 90]}
people:
  - {name: Ann, kind: visitor, at: lobby, answers: ["to the pharmacy please", "yes please"]}
"""
PLACES = {
    "lobby": NamedPlace("lobby", "room", Goal(0, 0, 0)),
    "pharmacy": NamedPlace("pharmacy", "room", Goal(3, 2, 90)),
    "radiology": NamedPlace("radiology", "room", Goal(-3, 2, 90)),
}
"""The ward as a driver of a real robot is told of it."""


class Visitor:
    """Ears that hear what a visitor says, one answer after the other."""

    def __init__(self, *words: str) -> None:
        self._words = list(words)

    def hear(self, stop: StopFlag, timeout: float, asked: Asked) -> str | None:
        return self._words.pop(0) if self._words else None


def ward_in(folder: Path) -> World:
    file = folder / "ward.yaml"
    file.write_text(WARD, encoding="utf-8")
    return load_world(str(file))


def execution_on(driver: ComposedDriver, program: str = ERRAND) -> Execution:
    def call(method: str, arguments: dict[str, Any], line: int) -> Any:
        return driver.call(method, arguments, StopFlag())

    return Execution(program, call)


Came = tuple[Outcome, list[tuple[str, Any]], str]


def outcome_on(driver: ComposedDriver) -> Came:
    """How it ended, what each call gave, and what was said last. Where the desk is on the robot's
    map is the robot's own affair."""
    outcome = execution_on(driver).run()
    results = [
        (made.method, None if isinstance(made.result, Location) else made.result)
        for made in driver.calls
    ]
    return outcome, results, str(driver.calls[-1].arguments["text"])


def in_the_simulator(folder: Path) -> Came:
    driver = simulated(Simulation(ward_in(folder)))
    try:
        return outcome_on(driver)
    finally:
        driver.close()
