"""The conformance suite on a robot at an address, as a table of capabilities."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from typing import Any, Literal

from nl2robot.robots import Chosen, reached
from robot_api.checker import Problem, check_driver
from robot_api.composed import INTERFACES
from robot_api.driver import Driver
from robot_api.methods import METHODS
from sim.world import World

State = Literal["works", "lacks", "problems"]


@dataclass(frozen=True)
class Row:
    """What was found of one capability, or of the driver as a whole."""

    part: str
    state: State
    remarks: str = ""


@dataclass(frozen=True)
class Report:
    robot: str
    rows: Sequence[Row]
    problems: Sequence[Problem]

    def table(self) -> str:
        """A table in Markdown, which a terminal and a page of the docs take as it is."""
        cells = [("", self.robot, "remarks"), *((r.part, r.state, r.remarks) for r in self.rows)]
        first, second = (max(len(line[column]) for line in cells) for column in range(2))
        lines = [f"| {one:{first}} | {two:{second}} | {three} |" for one, two, three in cells]
        rule = f"|{'-' * (first + 2)}|{'-' * (second + 2)}|---|"
        return "\n".join([lines[0], rule, *lines[1:]]) + "\n"

    def to_json(self) -> dict[str, Any]:
        return {"robot": self.robot, "rows": [asdict(row) for row in self.rows]}


def checked(robot: Chosen, world: World, password: str | None, *, move: bool) -> Report:
    """Reach a robot and look at all that it declares. Raises `UserError`, `LostConnection`."""
    with _driver(robot, world, password) as driver:
        problems = check_driver(driver, move=move)
        has = driver.capabilities()
    return Report(has.name, tuple(_rows(has.methods, problems)), problems)


@contextmanager
def _driver(robot: Chosen, world: World, password: str | None) -> Iterator[Driver]:
    if not robot.simulated:
        with reached(robot, world, password=password) as driver:
            yield driver
        return
    from robot_api.drivers import simulated
    from robot_api.robots.opening import hold
    from sim.simulation import Simulation

    pretended = simulated(Simulation(world))
    try:
        hold(pretended, robot.read)
        yield pretended
    finally:
        pretended.close()


def _rows(methods: Sequence[str], problems: Sequence[Problem]) -> Iterator[Row]:
    for name, interface in INTERFACES.items():
        own = [method.name for method in METHODS.values() if method.capability == name]
        found = [str(problem) for problem in problems if problem.method in own]
        without = [method for method in own if method not in methods]
        if found:
            yield Row(name, "problems", "; ".join(found))
        elif len(without) == len(own):
            yield Row(name, "lacks", interface.lacking)
        else:
            yield Row(name, "works", f"without {', '.join(without)}" if without else "")
    about_all = [str(problem) for problem in problems if problem.method is None]
    if about_all:
        yield Row("driver", "problems", "; ".join(about_all))
