"""Where sound goes: a sound card, a file, a function.

What is written is played in its order; `write` does not wait, `drain` does. `at` is the time of the
speaker's clock at which something is said: a file keeps to it, a sound card plays at once.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Generator
from pathlib import Path
from typing import Any, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from nl2robot.errors import UserError
from nl2robot.speech.hear.echo_cancelling import Played
from nl2robot.speech.sound_cards import sound_cards
from nl2robot.speech.speak.voices import Sound

RATE: Final = 22_050
"""Samples a second of what is played: that of the voices."""
PERIOD: Final = 20  # milliseconds that a sound card asks for at a time
_PERIODS: Final = 3  # of these may lie in the sound card's buffer
LATENCY: Final = PERIOD * _PERIODS / 1000
"""Seconds until a sound card has played what it was given."""
_PATIENCE: Final = 2.0
"""Seconds without the sound card asking for more until it counts as unplugged."""
LONGEST_PAUSE: Final = 300.0
"""Seconds of silence in a file; a robot that serves for days says something now and then."""


class SoundError(UserError):
    """Nothing can be played as things are."""


class Output(Protocol):
    def write(self, sound: Sound, at: float) -> None:
        """Play it after what was written before; does not wait. Raises `SoundError`."""
        ...

    def drain(self, stopped: Callable[[], bool]) -> None:
        """Wait until all of it was heard, or `stopped`. Raises `SoundError`."""
        ...

    def silence(self, at: float) -> None:
        """Drop what was not heard yet at that time; from any thread."""
        ...

    def close(self) -> None: ...


class Nowhere:
    """For a robot without a loudspeaker."""

    def write(self, sound: Sound, at: float) -> None: ...

    def drain(self, stopped: Callable[[], bool]) -> None: ...

    def silence(self, at: float) -> None: ...

    def close(self) -> None: ...


class Handed(Nowhere):
    """To a function that takes each sound and the time at which it is said: a page, a test."""

    def __init__(self, take: Callable[[Sound, float], None]) -> None:
        self._take = take

    def write(self, sound: Sound, at: float) -> None:
        self._take(sound, at)


class SoundCard:
    """This machine's loudspeaker."""

    def __init__(self, backends: list[Any] | None = None, played: Played | None = None) -> None:
        """`backends` of miniaudio, for tests its null backend. `played` is told what is heard of
        it. Raises `SoundError`."""
        miniaudio = sound_cards(SoundError)
        # Never the null backend by itself: it would play, and nobody would hear anything.
        real = [each for each in miniaudio.Backend if each is not miniaudio.Backend.NULL]
        try:
            self._device: Any = miniaudio.PlaybackDevice(
                nchannels=1,
                sample_rate=RATE,
                buffersize_msec=PERIOD,
                callback_periods=_PERIODS,
                backends=backends or real,
                app_name="nl2robot",
            )
        except miniaudio.MiniaudioError as error:
            raise SoundError(
                "This machine has no loudspeaker that can be used, so nothing will be heard."
                " Connect one and start again, or write the sound into a file: --speak FILE.wav."
            ) from error
        self._played = played
        self._waiting: deque[NDArray[np.int16]] = deque()
        self._changed = threading.Condition()
        self._asked = 0.0  # when the sound card last asked for more
        self._playing = False
        self.heard = 0
        """Samples that went to the sound card and were not silence."""

    def write(self, sound: Sound, at: float) -> None:
        samples = resampled(sound, RATE)
        with self._changed:
            self._waiting.append(samples)
        if not self._playing:
            self._playing = True
            feeding = self._feed()
            next(feeding)
            self._asked = time.monotonic()
            self._device.start(feeding)

    def drain(self, stopped: Callable[[], bool]) -> None:
        with self._changed:
            while self._waiting and not stopped():
                self._changed.wait(PERIOD / 1000)
                if time.monotonic() - self._asked > _PATIENCE:
                    self._waiting.clear()
                    raise SoundError(
                        "The loudspeaker takes no more sound, so nothing will be heard."
                        " Plug it in and start again."
                    )
            end = time.monotonic() + LATENCY
            while (left := end - time.monotonic()) > 0 and not stopped():
                self._changed.wait(left)

    def silence(self, at: float) -> None:
        with self._changed:
            self._waiting.clear()
            self._changed.notify_all()

    def close(self) -> None:
        self.silence(0.0)
        self._device.close()

    def _feed(self) -> Generator[NDArray[np.int16], int, None]:
        """What the sound card asks for, period by period."""
        count = yield np.zeros((0, 1), np.int16)
        while True:
            with self._changed:
                self._asked = time.monotonic()
                block = self._take(count)
                if not self._waiting:
                    self._changed.notify_all()
            if self._played is not None:
                # A period before it, at the least, still lies in the sound card's buffer.
                self._played.add(block[:, 0], RATE, self._asked + PERIOD / 1000)
            count = yield block

    def _take(self, count: int) -> NDArray[np.int16]:
        block = np.zeros((count, 1), np.int16)
        filled = 0
        while filled < count and self._waiting:
            first = self._waiting[0]
            part = first[: count - filled]
            block[filled : filled + len(part), 0] = part
            filled += len(part)
            if len(part) == len(first):
                self._waiting.popleft()
            else:
                self._waiting[0] = first[len(part) :]
        self.heard += filled
        return block


class WavFile:
    """A recording of everything that is said, each at its time; what would overlap comes after
    what was said before it. Pauses longer than `LONGEST_PAUSE` are shortened."""

    def __init__(self, path: Path) -> None:
        """Raises `SoundError` if nothing can be written there."""
        import soundfile

        if path.suffix.lower() != ".wav":
            raise SoundError(f"{str(path)!r} is no .wav file. Choose a name that ends in .wav.")
        self._path = path
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file: Any = soundfile.SoundFile(path, "w", RATE, 1, "PCM_16", format="WAV")
        except (OSError, soundfile.LibsndfileError) as error:
            raise SoundError(
                f"The sound cannot be written to {path}. Choose another place for it."
            ) from error
        self._pending: list[NDArray[np.int16]] = []
        self._began = 0.0  # when the pending sound is said
        self._written = 0  # samples
        self._left_out = 0.0  # seconds of silence
        self._lock = threading.Lock()

    @property
    def seconds(self) -> float:
        """How long the recording is."""
        return self._written / RATE

    def write(self, sound: Sound, at: float) -> None:
        with self._lock:
            if not self._pending:
                self._began = at
            self._pending.append(resampled(sound, RATE))

    def drain(self, stopped: Callable[[], bool]) -> None:
        with self._lock:
            self._put_down(None)

    def silence(self, at: float) -> None:
        with self._lock:
            self._put_down(max(0, int((at - self._began) * RATE)))

    def close(self) -> None:
        with self._lock:
            self._put_down(None)
            self._file.close()

    def _put_down(self, most: int | None) -> None:
        if not self._pending:
            return
        samples = np.concatenate(self._pending)[:most]
        self._pending.clear()
        pause = self._began - self._left_out - self.seconds
        if pause > LONGEST_PAUSE:
            self._left_out += pause - LONGEST_PAUSE
            pause = LONGEST_PAUSE
        quiet = np.zeros(max(0, int(pause * RATE)), np.int16)
        import soundfile

        try:
            self._file.write(np.concatenate([quiet, samples]))
            self._file.flush()
        except (OSError, soundfile.LibsndfileError) as error:
            raise SoundError(
                f"The sound cannot be written to {self._path} any more: perhaps the disk is full."
                " What follows will be missing there."
            ) from error
        self._written += len(quiet) + len(samples)


def resampled(sound: Sound, rate: int) -> NDArray[np.int16]:
    if sound.rate == rate:
        return sound.samples
    import soxr

    return np.asarray(soxr.resample(sound.samples, sound.rate, rate), np.int16)
