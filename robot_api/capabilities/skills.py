"""Skills of a robot's own: `do`."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from typing import Any

from robot_api.capabilities.base import Capability
from robot_api.capabilities.emulation import Emulation, InEmulation
from robot_api.capabilities.names import listed, one_of
from robot_api.capabilities.simulation import InSimulation
from robot_api.driver import StopFlag
from robot_api.errors import InvalidCall, NotSupported


class Skills(Capability):
    """What only this robot can do: a robotic dog sits."""

    name = "skills"
    lacking = "has no skills of its own"

    @property
    @abstractmethod
    def skills(self) -> Mapping[str, str]:
        """Each skill with a line that says what it does."""

    @abstractmethod
    def use(self, stop: StopFlag, skill: str, parameters: dict[str, Any]) -> Any:
        """Use it, one of `skills`; returns JSON data."""

    def do(self, stop: StopFlag, /, skill: str, **parameters: Any) -> Any:
        known = one_of(skill, self.skills)
        if known is None:
            raise NotSupported(
                f"I do not know how to '{skill}'. I know how to {listed(tuple(self.skills))}."
            )
        return self.use(stop, known, parameters)

    def declares(self) -> dict[str, Any]:
        return {"skills": dict(self.skills)}


class EmulatedSkills(InEmulation, Skills):
    """Takes any parameters and does nothing."""

    def __init__(self, emulation: Emulation, skills: Mapping[str, str]) -> None:
        super().__init__(emulation)
        self._skills = skills

    @property
    def skills(self) -> Mapping[str, str]:
        return self._skills

    def use(self, stop: StopFlag, skill: str, parameters: dict[str, Any]) -> Any:
        self.emulation.pass_time(3.0, stop)
        return None


class SimulatedSkills(InSimulation, Skills):
    @property
    def skills(self) -> Mapping[str, str]:
        return {
            "spin": "turn round on the spot; times: how often, 1 to 10",
            "look around": "turn left, right and back to where it looked",
        }

    def use(self, stop: StopFlag, skill: str, parameters: dict[str, Any]) -> Any:
        turns = [45.0, -90.0, 45.0]
        if skill == "spin":
            turns = [360.0] * self._times(parameters)
        elif parameters:
            raise InvalidCall(f"The skill '{skill}' takes nothing besides. Leave the rest out.")
        for degrees in turns:
            self.run(self.simulation.turn(degrees), stop)

    def _times(self, parameters: dict[str, Any]) -> int:
        times = parameters.get("times", 1)
        if set(parameters) - {"times"} or not isinstance(times, int) or not 1 <= times <= 10:
            raise InvalidCall("The skill 'spin' takes how many times to turn. Say 1 to 10 times.")
        return times
