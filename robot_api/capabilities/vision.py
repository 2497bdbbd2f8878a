"""Vision: `sees`, `count`, `objects`, `people`, `describe`, `find`, `wait_for`."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING

from robot_api.capabilities.base import Capability
from robot_api.capabilities.emulation import Emulation, InEmulation
from robot_api.capabilities.simulation import InSimulation, robot_errors
from robot_api.driver import StopFlag

if TYPE_CHECKING:
    from robot_api.capabilities.driving import Navigation


class Vision(Capability):
    """Eyes that know things and people by noun phrases: "red cup", "person waving"."""

    name = "vision"
    lacking = "cannot see"

    @abstractmethod
    def sees(self, stop: StopFlag, thing: str) -> bool: ...

    @abstractmethod
    def count(self, stop: StopFlag, thing: str) -> int: ...

    @abstractmethod
    def objects(self, stop: StopFlag) -> list[str]: ...

    @abstractmethod
    def people(self, stop: StopFlag) -> list[str]: ...

    @abstractmethod
    def describe(self, stop: StopFlag, thing: str) -> str: ...

    @abstractmethod
    def find(self, stop: StopFlag, thing: str, place: str | None) -> bool: ...

    @abstractmethod
    def wait_for(self, stop: StopFlag, thing: str, timeout: float | None) -> bool: ...


class EmulatedVision(InEmulation, Vision):
    """Sees whatever it is asked for, once."""

    def __init__(self, emulation: Emulation, navigation: Navigation) -> None:
        super().__init__(emulation)
        self._navigation = navigation

    def sees(self, stop: StopFlag, thing: str) -> bool:
        return True

    def count(self, stop: StopFlag, thing: str) -> int:
        return 1

    def objects(self, stop: StopFlag) -> list[str]:
        return ["cup", "book"]

    def people(self, stop: StopFlag) -> list[str]:
        return ["Alice"]

    def describe(self, stop: StopFlag, thing: str) -> str:
        return f"I see the {thing}."

    def find(self, stop: StopFlag, thing: str, place: str | None) -> bool:
        if place is not None:
            self._navigation.goto(stop, place)
        return True

    def wait_for(self, stop: StopFlag, thing: str, timeout: float | None) -> bool:
        self.emulation.pass_time(5.0 if timeout is None else min(5.0, timeout), stop)
        return True


class SimulatedVision(InSimulation, Vision):
    def sees(self, stop: StopFlag, thing: str) -> bool:
        return bool(self.simulation.visible(thing))

    def count(self, stop: StopFlag, thing: str) -> int:
        return len(self.simulation.visible(thing))

    def objects(self, stop: StopFlag) -> list[str]:
        return [seen.name for seen in self.simulation.visible("objects")]

    def people(self, stop: StopFlag) -> list[str]:
        return [seen.name for seen in self.simulation.visible("people")]

    def describe(self, stop: StopFlag, thing: str) -> str:
        with robot_errors():
            return self.simulation.describe(thing)

    def find(self, stop: StopFlag, thing: str, place: str | None) -> bool:
        where = None if place is None else self.place(place)
        return self.run(self.simulation.find(thing, where), stop)

    def wait_for(self, stop: StopFlag, thing: str, timeout: float | None) -> bool:
        return self.run(self.simulation.wait_for(thing, timeout), stop)
