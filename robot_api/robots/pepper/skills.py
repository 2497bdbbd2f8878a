"""Behaviours that are installed on Pepper, as its skills: `do`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from robot_api.capabilities.skills import Skills
from robot_api.driver import StopFlag
from robot_api.errors import InvalidCall, NotSupported
from robot_api.robots.pepper.body import STOP_LIMBS, STOP_MOVING, STOP_SPEAKING, Body
from robot_api.robots.pepper.session import Wire

_MANAGER = "ALBehaviorManager"


class PepperSkills(Skills):
    def __init__(self, wire: Wire, body: Body, named: Mapping[str, str]) -> None:
        """`named` are the robot file's: behaviours by the robot's own names, each with a line that
        says what it does. Raises `NotSupported` for one that is not installed."""
        super().__init__()
        self._wire = wire
        self._body = body
        self._named = named
        installed = wire.call(_MANAGER, "getInstalledBehaviors") if wire.has(_MANAGER) else ()
        for name in named:
            if name not in installed:
                raise NotSupported(
                    f"The robot file's skill {name!r} is no behaviour of this Pepper."
                    " Install it, or take it out of the file."
                )

    @property
    def skills(self) -> Mapping[str, str]:
        return self._named

    def use(self, stop: StopFlag, skill: str, parameters: dict[str, Any]) -> Any:
        if parameters:
            raise InvalidCall(f"The skill '{skill}' takes nothing besides. Leave the rest out.")
        self._body.be_ready(stop, to_drive=False)
        ending = ((_MANAGER, "stopBehavior", skill), STOP_MOVING, STOP_LIMBS, STOP_SPEAKING)
        self._wire.run(stop, _MANAGER, "runBehavior", skill, ending=ending)
