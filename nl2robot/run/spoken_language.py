"""In which language the robot speaks: the one that was chosen for it, by an order, at its face or
by another client; as long as nobody has chosen any, that of whoever approved the program at hand.
"""

from __future__ import annotations

import contextlib
from collections.abc import Collection
from typing import Final

from robot_api.client import Robot
from robot_api.errors import RobotError

AT_FIRST: Final = "en"
"""What robots speak before anybody has said a word about it."""


class SpokenLanguage:
    """Any thread may use it."""

    def __init__(self) -> None:
        self._chosen = False
        self._adopted = AT_FIRST
        """What it speaks where nobody has chosen."""
        self._is_sure = False
        """Whether it was told so, and not only taken to speak it."""

    def heard_of(self, code: str) -> None:
        """The robot speaks it from now on (the data of the event `language`)."""
        self._chosen = code != self._adopted  # a visitor who leaves gives it back

    def adopt(self, robot: Robot, code: str | None, spoken: Collection[str]) -> None:
        """Have the robot speak to people as whoever approved the program speaks, unless another
        language was chosen. `spoken`: those that it knows."""
        if code is None or self._chosen or code not in spoken:
            return
        if self._is_sure and code == self._adopted:
            return
        self._adopted, self._is_sure = code, True
        with contextlib.suppress(RobotError):  # one without a voice is read
            robot.set_language(code)
