"""The robot is heard in browsers: what it says goes out as events, and pages play it.

    browsers = Browsers()
    browsers.subscribe(lambda kind, data: server.publish(kind, data))
    Speaker(browsers).begin("Good morning.").wait()

A tablet on the robot's head is its loudspeaker then, and so is every laptop that shows its face.
`console/static/voice.js` is the other end. What is said lasts as long as it would on a loudspeaker,
whether or not anybody plays it, so a program runs the same with and without a page.
"""

from __future__ import annotations

import base64
import io
import threading
import time
import wave
from collections.abc import Callable
from typing import TYPE_CHECKING, Final

from nl2robot.speech.speak.voices import Sound
from robot_api.capabilities.base import Hub

if TYPE_CHECKING:
    from robot_api.capabilities.base import Listener

PIECE: Final = 2.0
"""Seconds of sound in an event: well below what a frame may hold."""
ON_THE_WAY: Final = 0.15
"""Seconds from here to a listener's ear, in a house's network."""
_POLL: Final = 0.02


class Browsers:
    """An `Output`. A WAV file can be played by every browser, needs no encoder, and loses nothing
    of a voice; in a house's network its size does not matter."""

    def __init__(self) -> None:
        self._hub = Hub()
        self._changed = threading.Condition()
        self._ends = 0.0  # when what was sent so far has been heard

    def subscribe(self, listener: Listener) -> Callable[[], None]:
        """Tell it of `sound` and `silence`; returns what ends it."""
        return self._hub.subscribe(listener)

    def write(self, sound: Sound, at: float) -> None:
        step = int(PIECE * sound.rate)
        for start in range(0, len(sound.samples), step):
            piece = Sound(sound.samples[start : start + step], sound.rate)
            self._hub.publish(
                "sound",
                audio=base64.b64encode(wav(piece)).decode("ascii"),
                seconds=round(piece.seconds, 3),
            )
        with self._changed:
            self._ends = max(self._ends, time.monotonic() + ON_THE_WAY) + sound.seconds

    def drain(self, stopped: Callable[[], bool]) -> None:
        with self._changed:
            while (left := self._ends - time.monotonic()) > 0 and not stopped():
                self._changed.wait(min(left, _POLL))

    def silence(self, at: float) -> None:
        with self._changed:
            self._ends = 0.0
            self._changed.notify_all()
        self._hub.publish("silence", because="The robot was told to be silent.")

    def close(self) -> None: ...


def wav(sound: Sound) -> bytes:
    """A sound as a WAV file."""
    file = io.BytesIO()
    with wave.open(file, "wb") as writer:
        writer.setnchannels(1)
        writer.setsampwidth(2)
        writer.setframerate(sound.rate)
        writer.writeframes(sound.samples.astype("<i2").tobytes())
    return file.getvalue()
