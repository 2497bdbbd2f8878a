"""What only a Furhat does."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, Final

from robot_api.capabilities.skills import Skills
from robot_api.driver import StopFlag
from robot_api.errors import InvalidCall
from robot_api.robots.furhat.robot import Furhat

_COLOR: Final = re.compile(r"[A-Za-z]{3,20}|#[0-9A-Fa-f]{6}")


class FurhatSkills(Skills):
    """What only a Furhat does: it looks at people and places, and has a light."""

    def __init__(self, furhat: Furhat) -> None:
        self._furhat = furhat

    @property
    def skills(self) -> Mapping[str, str]:
        return {
            "look at person": "look at whoever is nearest",
            "look at point": "look at a point; x, y, z: metres from the robot, along its own axes",
            "light": "light up in a colour; color: a name such as red, or #ff0000",
        }

    def use(self, stop: StopFlag, skill: str, parameters: dict[str, Any]) -> None:
        if skill == "look at person":
            self._take(skill, parameters)
            self._furhat.tell(stop, "request.attend.user", user_id="closest")
        elif skill == "look at point":
            at = self._take(skill, parameters, "x", "y", "z")
            if not all(_is_near(value) for value in at.values()):
                raise InvalidCall("Give x, y and z in metres, each from -20 to 20.")
            self._furhat.tell(stop, "request.attend.location", **at)
        else:
            color = self._take(skill, parameters, "color")["color"]
            if not isinstance(color, str) or not _COLOR.fullmatch(color):
                raise InvalidCall("Give the color as a name such as red, or as #ff0000.")
            self._furhat.tell(stop, "request.led.set", color=color)

    def _take(self, skill: str, parameters: dict[str, Any], *names: str) -> dict[str, Any]:
        if set(parameters) != set(names):
            wanted = f"takes {', '.join(names)} and nothing besides" if names else "takes nothing"
            raise InvalidCall(f"The skill '{skill}' {wanted}. Write it so.")
        return parameters


def _is_near(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and -20 <= value <= 20
