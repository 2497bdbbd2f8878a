"""In which language the robot speaks: the one that was chosen for it, by an order, at its face or
by another client; as long as nobody has chosen any, that of whoever approved the program at hand.
"""

from __future__ import annotations

import contextlib
from collections.abc import Collection

from robot_api.client import Robot
from robot_api.errors import RobotError


class SpokenLanguage:
    """Any thread may use it."""

    def __init__(self) -> None:
        self._chosen = False
        self._adopted: str | None = None

    def heard_of(self, code: str) -> None:
        """The robot speaks it from now on (the data of the event `language`)."""
        self._chosen = code != self._adopted

    def adopt(self, robot: Robot, code: str | None, spoken: Collection[str]) -> None:
        """Have the robot speak to people as whoever approved the program speaks, unless another
        language was chosen. `spoken`: those that it knows."""
        if code is None or self._chosen or code == self._adopted or code not in spoken:
            return
        self._adopted = code
        with contextlib.suppress(RobotError):  # one without a voice is read
            robot.set_language(code)
