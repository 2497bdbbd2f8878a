"""Manipulation: `grab`, `put`, `give`."""

from __future__ import annotations

from abc import abstractmethod
from typing import Any

from robot_api.capabilities.base import Capability
from robot_api.capabilities.emulation import InEmulation
from robot_api.capabilities.names import one_of
from robot_api.capabilities.simulation import InSimulation
from robot_api.driver import StopFlag
from robot_api.errors import NotPossible


class Manipulation(Capability):
    """Hands."""

    name = "manipulation"
    lacking = "has no hands"
    hands = 1

    @abstractmethod
    def grab(self, stop: StopFlag, thing: str) -> None: ...

    @abstractmethod
    def put(self, stop: StopFlag, thing: str, where: str | None) -> None: ...

    @abstractmethod
    def give(self, stop: StopFlag, thing: str, person: str | None) -> None: ...

    def declares(self) -> dict[str, Any]:
        return {"hands": self.hands}


class EmulatedManipulation(InEmulation, Manipulation):
    """Whatever is wanted is there, but a hand can be full or empty."""

    def grab(self, stop: StopFlag, thing: str) -> None:
        held = self.emulation.held
        if len(held) >= self.hands:
            raise NotPossible(
                f"I already hold the {held[0]}. Let me put it down or give it away first."
            )
        self.emulation.pass_time(4.0, stop)
        held.append(thing)

    def put(self, stop: StopFlag, thing: str, where: str | None) -> None:
        self._let_go(stop, thing)

    def give(self, stop: StopFlag, thing: str, person: str | None) -> None:
        self._let_go(stop, thing)

    def _let_go(self, stop: StopFlag, thing: str) -> None:
        held = one_of(thing, self.emulation.held)
        if held is None:
            raise NotPossible(f"I do not hold the {thing}. Let me grab it first.")
        self.emulation.pass_time(4.0, stop)
        self.emulation.held.remove(held)


class SimulatedManipulation(InSimulation, Manipulation):
    def grab(self, stop: StopFlag, thing: str) -> None:
        self.run(self.simulation.grab(thing), stop)

    def put(self, stop: StopFlag, thing: str, where: str | None) -> None:
        self.run(self.simulation.put(thing, where), stop)

    def give(self, stop: StopFlag, thing: str, person: str | None) -> None:
        self.run(self.simulation.give(thing, person), stop)
