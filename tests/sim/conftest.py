"""What the stories of the ward share: worlds of a few lines, and a stop that nobody presses."""

from __future__ import annotations

import textwrap
import threading
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import pytest

from sim.people.crowd import Human
from sim.runner import Behaviour
from sim.simulation import Simulation
from sim.world.loading import load_world
from sim.world.model import World

T = TypeVar("T")


class Ward:
    """A simulation, and `does` to let it run a behaviour that nobody stops."""

    def __init__(self, world: World, seed: int = 0) -> None:
        self.simulation = Simulation(world, seed)

    def does(self, behaviour: Behaviour[T]) -> T:
        return self.simulation.run(behaviour, threading.Event())

    def person(self, name: str) -> Human:
        """The simulator's truth about somebody."""
        return next(human for human in self.simulation._hospital.people if human.name == name)

    def goes_to(self, place: str) -> None:
        self.does(self.simulation.drive_to(*self.simulation.locate(place)))


@pytest.fixture(scope="session")
def living() -> type[Ward]:
    """Let a world come to life: `living(world, seed)`."""
    return Ward


@pytest.fixture(scope="session")
def hospital() -> World:
    return load_world("city-hospital")


@pytest.fixture(scope="session")
def small_ward() -> World:
    return load_world("ward")


@pytest.fixture
def world_of(tmp_path: Path) -> Callable[[str], World]:
    """Make a world of some lines of YAML."""

    def make(lines: str) -> World:
        file = tmp_path / "world.yaml"
        file.write_text(textwrap.dedent(lines), encoding="utf-8")
        return load_world(file)

    return make


@pytest.fixture
def corridor(world_of: Callable[[str], World]) -> Callable[[str], World]:
    """A corridor of twelve metres, two and a half wide, with the robot at its west end."""

    def make(more: str) -> World:
        return world_of(
            textwrap.dedent(
                """\
                name: corridor
                robot: {start: west end}
                walls: [[0, 0, 12, 0, 12, 2.5, 0, 2.5, 0, 0]]
                places:
                  - {name: west end, pose: [1, 1.25, 0]}
                  - {name: east end, pose: [11, 1.25, 0]}
                """
            )
            + textwrap.dedent(more)
        )

    return make
