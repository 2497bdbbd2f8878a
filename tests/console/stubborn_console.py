"""A console whose simulated robot refuses things, as a real one may: to be louder than 50 percent,
to speak French, to look angry. `python stubborn_console.py [what nl2robot serve takes]`.
"""

from __future__ import annotations

import sys
from typing import Any

from nl2robot.cli.main import main
from robot_api import drivers
from robot_api.capabilities.face import SimulatedFace
from robot_api.capabilities.speech import SimulatedSpeech
from robot_api.driver import StopFlag
from robot_api.errors import NotPossible


class Voice(SimulatedSpeech):
    def set_volume(self, stop: StopFlag, percent: int) -> None:
        if percent > 50:
            raise NotPossible("My loudspeaker is too hot. Wait until it has cooled down.")
        super().set_volume(stop, percent)

    def choose_language(self, code: str) -> None:
        if code == "fr":
            raise NotPossible("My French voice cannot be loaded. Choose another.")
        super().choose_language(code)


class Face(SimulatedFace):
    def express(self, stop: StopFlag, emotion: str) -> None:
        if emotion == "angry":
            raise NotPossible("I am never angry. Choose another look.")
        super().express(stop, emotion)


def stubborn() -> None:
    """The simulated robot has these parts instead."""
    changed: Any = drivers
    known = changed.implementations
    changed.SimulatedSpeech = Voice
    changed.implementations = lambda kind: {**known(kind), Face.name: Face}


if __name__ == "__main__":
    stubborn()
    sys.exit(main(["serve", *sys.argv[1:]]))
