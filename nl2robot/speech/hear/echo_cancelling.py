"""What a microphone hears, without what the loudspeaker beside it plays.

    played = Played()                     # the loudspeaker adds what it plays
    canceller = EchoCanceller(played)     # one for each microphone
    played.add(samples, rate=22_050, at=12.00)
    mine = canceller.clean(heard, at=12.02)

The canceller is WebRTC's AEC3, of the extra `nl2robot[echo]`: it finds out by itself how late and
through what room the sound comes back, in the first second of it. No input or output here; times
are seconds of one clock for both.
"""

from __future__ import annotations

import threading
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from nl2robot.errors import UserError
from nl2robot.speech.audio import RATE, Samples
from robot_api.errors import cause

STEP: Final = RATE // 100
"""Samples that the canceller takes at a time: 10 ms."""
SLIP: Final = 0.1
"""Seconds by which the count of the samples may be ahead of the clock or behind it. Blocks come
when they like; two sound cards count at slightly different speeds, and now and then lose some."""
KEPT: Final = 2.0
"""Seconds for which what was played is known: more than any microphone is late."""
LINGERS: Final = 0.5
"""Seconds after the last sound in which a room, and both devices, may still be at it."""


class EchoError(UserError):
    """Echoes cannot be cancelled as things are."""


class _Timeline:
    """Which sample of the clock's a block begins with, steadily: not as it happens to come."""

    def __init__(self) -> None:
        self.end: int | None = None

    def place(self, count: int, ends: float) -> int:
        """The first of so many samples that ended, by the clock, at this time."""
        expected = round(ends * RATE) - count
        if self.end is None or abs(expected - self.end) > SLIP * RATE:
            self.end = expected
        first = self.end
        self.end += count
        return first


class Played:
    """What a loudspeaker has been given to play, of late. Any thread may use it."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._samples: Samples = np.zeros(0, np.int16)
        self._first = 0  # which sample of the clock's they begin with
        self._timeline = _Timeline()
        self._sounds_until = -LINGERS
        self._resampler: tuple[int, Any] = (RATE, None)

    def add(self, samples: NDArray[np.int16], rate: int, at: float) -> None:
        """It begins to be heard at this time, or a little later; silence is added, too."""
        with self._lock:
            if samples.any():
                self._sounds_until = at + len(samples) / rate
            samples = self._resampled(samples, rate)
            first = self._timeline.place(len(samples), at + len(samples) / RATE)
            kept = self._between(first - int(KEPT * RATE), first)
            self._samples = np.concatenate([kept, samples])
            self._first = first - len(kept)

    def between(self, first: int, last: int) -> Samples:
        """By the clock's samples; silence where nothing is known."""
        with self._lock:
            return self._between(first, last)

    def sounds(self, at: float) -> bool:
        """Whether any of it may be heard at this time."""
        with self._lock:
            return at <= self._sounds_until + LINGERS

    def _between(self, first: int, last: int) -> Samples:
        wanted = np.zeros(last - first, np.int16)
        begin, end = max(first, self._first), min(last, self._first + len(self._samples))
        if begin < end:
            part = self._samples[begin - self._first : end - self._first]
            wanted[begin - first : end - first] = part
        return wanted

    def _resampled(self, samples: NDArray[np.int16], rate: int) -> Samples:
        if rate == RATE:
            return samples
        import soxr

        if self._resampler[0] != rate:
            self._resampler = rate, soxr.ResampleStream(rate, RATE, 1, "int16")
        resampled: Samples = self._resampler[1].resample_chunk(samples)
        return resampled


class EchoCanceller:
    """For one microphone, and one thread."""

    def __init__(self, played: Played) -> None:
        """Raises `EchoError` where the library is missing or does not work."""
        try:
            from livekit.rtc import AudioFrame  # takes 0.3 s: only who needs it waits for it
            from livekit.rtc.apm import AudioProcessingModule

            self._module = AudioProcessingModule(echo_cancellation=True)
        except (ImportError, OSError) as error:
            raise EchoError(
                f"The robot cannot tell its own voice from yours ({cause(error)}), so it goes on"
                " when you speak. Install what it needs with: pip install 'nl2robot[echo]'"
            ) from error
        self._frame = AudioFrame
        self._played = played
        self._timeline = _Timeline()
        self._rest: Samples = np.zeros(0, np.int16)  # less than a step

    def clean(self, samples: Samples, at: float) -> Samples:
        """What is heard in these samples besides what was played; `at` is when the last of them
        was there. What is less than 10 ms comes with the next block."""
        first = self._timeline.place(len(samples), at) - len(self._rest)
        samples = np.concatenate([self._rest, samples])
        whole = len(samples) // STEP * STEP
        self._rest = samples[whole:]
        played = self._played.between(first, first + whole)
        cleaned = [
            self._step(samples[at : at + STEP], played[at : at + STEP])
            for at in range(0, whole, STEP)
        ]
        return np.concatenate(cleaned) if cleaned else samples[:0]

    def _step(self, heard: Samples, played: Samples) -> Samples:
        self._module.process_reverse_stream(self._frame(played.tobytes(), RATE, 1, STEP))
        frame = self._frame(heard.tobytes(), RATE, 1, STEP)
        self._module.process_stream(frame)
        return np.frombuffer(frame.data, np.int16).copy()
