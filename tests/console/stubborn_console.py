"""A console whose simulated robot refuses things, as a real one may: to be louder than 50 percent,
to speak French, to look angry. `python stubborn_console.py [what nl2robot serve takes]`.
"""

from __future__ import annotations

import sys
from typing import Any

from nl2robot.cli.main import main
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


def part(kind: type, stubborn: type) -> None:
    """The simulated robot has this part instead."""
    from robot_api import drivers

    assert getattr(drivers, kind.__name__) is kind
    setattr(drivers, kind.__name__, stubborn)


if __name__ == "__main__":
    changes: dict[Any, Any] = {SimulatedSpeech: Voice, SimulatedFace: Face}
    for kind, stubborn in changes.items():
        part(kind, stubborn)
    sys.exit(main(["serve", *sys.argv[1:]]))
