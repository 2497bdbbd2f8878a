"""What the simulated capabilities share: running behaviours in a `sim.simulation.Simulation`."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TypeVar

from robot_api.capabilities.base import Capability
from robot_api.capabilities.names import unknown_place
from robot_api.driver import StopFlag
from robot_api.errors import Stopped, error_named
from sim.errors import Interrupted, SimError

if TYPE_CHECKING:
    from sim.simulation import Behaviour, Simulation

T = TypeVar("T")


class InSimulation(Capability):
    """A capability of the simulated robot; goes before the interface among the base classes."""

    def __init__(self, simulation: Simulation, *others: Any) -> None:
        super().__init__(*others)
        self.simulation = simulation

    def run(self, behaviour: Behaviour[T], stop: StopFlag) -> T:
        """Let the simulation run the behaviour to its end; raises `RobotError`s, and `Stopped`."""
        with robot_errors(stop):
            return self.simulation.run(behaviour, stop)

    def place(self, name: str) -> str:
        """The place of that name or alias. Raises `UnknownPlace`, which names the nearest."""
        world = self.simulation.world
        place = world.place(name)
        if place is not None:
            return place.name
        aliases = {
            alias: place.name
            for place in world.places
            for others in place.aliases.values()
            for alias in others
        }
        raise unknown_place(name, aliases | {place.name: place.name for place in world.places})


@contextmanager
def robot_errors(stop: StopFlag | None = None) -> Iterator[None]:
    """Raise the simulator's errors as the robot's errors of the same name."""
    try:
        yield
    except Interrupted:
        if stop is not None:
            stop.check()
        raise Stopped from None
    except SimError as error:
        raise error_named(type(error).__name__)(str(error)) from None
