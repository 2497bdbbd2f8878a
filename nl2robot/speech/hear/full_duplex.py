"""A loudspeaker and a microphone in one process: the robot hears while it speaks, but not itself,
and who speaks over it is let speak.

    duplex = FullDuplex()                         # raises EchoError without the library
    duplex.speaker = Speaker(SoundCard(duplex.played))
    with Microphone() as microphone:
        for samples in duplex.hear(microphone.timed_blocks()):
            ...                                   # all but the robot's own voice
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from enum import Enum
from typing import TYPE_CHECKING, Final

import numpy as np

from nl2robot.speech.audio import RATE, Samples
from nl2robot.speech.hear.echo_cancelling import EchoCanceller, EchoError, Played
from nl2robot.speech.hear.listening import COMMANDS, FRAME, voice_detector

if TYPE_CHECKING:
    from nl2robot.speech.speak.speaking import Speaker

WINDOW: Final = 0.5
"""Seconds of sound that are looked at for a voice."""
VOICED: Final = 0.32
"""Seconds of these in which a voice is, if somebody speaks over the robot. What is left of the
robot's own voice has less; so have a cough and a "mhm"."""
LATELY: Final = 0.8
"""Seconds in which there was a moment of a voice, if somebody has said a word."""
LONGEST: Final = 10.0
"""Seconds for which somebody who goes on and on is let speak."""


class Over(Enum):
    """Somebody speaks over the robot."""

    BEGAN = "began"
    ENDED = "ended"


class BargeIn:
    """Tells from the cleaned sound when somebody speaks over the robot. Without input or output;
    time is counted in samples."""

    def __init__(self, detector: Callable[[Samples], float] | None = None) -> None:
        """`detector` as that of `listening.Listener`."""
        self._detector = detector or voice_detector()
        self._rest: Samples = np.zeros(0, np.int16)
        self._robot_sounds = False
        self._voiced: deque[bool] = deque(maxlen=_frames(LATELY))
        self._spoken = 0  # frames since somebody began; 0: nobody speaks over it
        self._quiet = 0  # frames since their last voiced one

    @property
    def nobody(self) -> bool:
        """Whether all that can have been heard of late is the robot itself."""
        return self._robot_sounds and not any(self._voiced)

    def feed(self, samples: Samples, robot_sounds: bool) -> list[Over]:
        """The next block, and whether the robot may be heard in it."""
        self._robot_sounds = robot_sounds
        samples = np.concatenate([self._rest, samples])
        whole = len(samples) // FRAME * FRAME
        self._rest = samples[whole:]
        told = (self._frame(samples[at : at + FRAME]) for at in range(0, whole, FRAME))
        return [over for over in told if over is not None]

    def _frame(self, frame: Samples) -> Over | None:
        voice = self._detector(frame)
        self._voiced.append(voice >= COMMANDS.begins)
        if self._spoken:
            return self._follow(voice)
        window = list(self._voiced)[-_frames(WINDOW) :]
        if not self._robot_sounds or sum(window) < _frames(VOICED):
            return None
        self._spoken, self._quiet = 1, 0
        return Over.BEGAN

    def _follow(self, voice: float) -> Over | None:
        self._spoken += 1
        self._quiet = 0 if voice >= COMMANDS.goes_on else self._quiet + 1
        if self._quiet < _frames(COMMANDS.pause) and self._spoken < _frames(LONGEST):
            return None
        self._spoken = 0
        self._voiced.clear()
        return Over.ENDED


class FullDuplex:
    """What the two have in common. To be heard by one thread."""

    def __init__(self) -> None:
        """Raises `EchoError` where echoes cannot be cancelled, `AudioError` without the voice
        detector."""
        self.played = Played()
        self.speaker: Speaker | None = None
        self.gave_way = False
        """Whether the robot was interrupted in what it said last."""
        self._canceller = EchoCanceller(self.played)
        self._barge_in = BargeIn()

    def hears_nobody(self) -> bool:
        """Whether a word in the block that came last was a scrap of the robot's own."""
        return self._barge_in.nobody

    def hear(self, blocks: Iterable[tuple[Samples, float]]) -> Iterator[Samples]:
        """Blocks of a microphone, each with the time of its end, without the robot's voice. The
        robot falls silent where somebody speaks over it, and says nothing more before they have
        ended."""
        try:
            for samples, at in blocks:
                cleaned = self._canceller.clean(samples, at)
                for over in self._barge_in.feed(cleaned, self.played.sounds(at)):
                    self._give_way(over)
                yield cleaned
        finally:  # whoever was let speak is heard no more
            self._give_way(Over.ENDED)

    def _give_way(self, over: Over) -> None:
        if self.speaker is None:
            return
        if over is Over.BEGAN:
            self.gave_way = True
            self.speaker.hold()
            self.speaker.interrupt()
        else:
            self.speaker.go_on()


def full_duplex(tell: Callable[[str], None]) -> FullDuplex | None:
    """None where the library is missing, which is told: then the robot speaks on."""
    try:
        return FullDuplex()
    except EchoError as error:
        tell(str(error))
        return None


def _frames(seconds: float) -> int:
    return round(seconds * RATE / FRAME)
