"""The robot's voice: one text after the other, silent at once when it is told to be.

    speaker = Speaker(SoundCard())
    speaker.begin("Good morning.").wait()
    speaker.interrupt()                         # somebody speaks: let them

A thread of its own makes the sound of the next piece while one is played, so whoever stops it waits
for neither.
"""

from __future__ import annotations

import contextlib
import queue
import threading
import time
from collections.abc import Callable
from typing import Final

import numpy as np

from nl2robot.errors import UserError
from nl2robot.speech.speak.loudspeaker import Nowhere, Output
from nl2robot.speech.speak.sound_cache import KeptSounds
from nl2robot.speech.speak.voices import Sound, Voice, voice

HELD: Final = 12.0
"""Seconds after which it goes on, even if nobody has told it to."""
_POLL: Final = 0.02


class Utterance:
    """Something to be said, from the wish to the last sound of it."""

    def __init__(
        self, text: str, language: str, gain: float, at: float, cancel: Callable[[Utterance], None]
    ) -> None:
        self.text = text
        self.language = language
        self.gain = gain
        self.at = at
        self.sound: Sound | None = None
        """Ready made, instead of a text."""
        self.whole = False
        """Whether all of it was heard."""
        self._cancel = cancel
        self.cancelled = threading.Event()
        self.over = threading.Event()

    def cancel(self) -> None:
        """Be silent at once; from any thread, any number of times."""
        self._cancel(self)

    def wait(self, seconds: float | None = None) -> bool:
        """Until it has been said or was cancelled; tells whether all of it was heard."""
        self.over.wait(seconds)
        return self.whole


class Speaker:
    """Any thread may use it."""

    def __init__(
        self,
        output: Output,
        *,
        voice_for: Callable[[str], Voice] = voice,
        kept: KeptSounds | None = None,
        clock: Callable[[], float] = time.monotonic,
        tell: Callable[[str], None] = lambda message: None,
    ) -> None:
        """`voice_for` a language's code. `clock` in seconds: what is recorded goes by it. `tell`
        gets a sentence when nothing can be heard any more; the robot goes on silently."""
        self._output = output
        self._voice_for = voice_for
        self._kept = kept if kept is not None else KeptSounds(None)
        self._clock = clock
        self._tell = tell
        self._waiting: queue.SimpleQueue[Utterance | None] = queue.SimpleQueue()
        self._lock = threading.Lock()  # for what follows, and for writing to the output
        self._current: Utterance | None = None
        self._pending: list[Utterance] = []
        self._free = threading.Event()  # to begin with the next text
        self._free.set()
        self._thread = threading.Thread(target=self._work, name="voice", daemon=True)
        self._thread.start()

    # --- speaking --------------------------------------------------------------------------------

    def begin(self, text: str, language: str = "en", volume: int = 100) -> Utterance:
        """Say it after what is to be said already; `volume` is 0 to 100. Does not wait."""
        return self._begin(text, language, volume, None, None)

    def play(self, sound: Sound, at: float | None = None) -> Utterance:
        """Let a ready made sound be heard in its turn: somebody else's voice."""
        return self._begin("", "", 100, sound, at)

    def _begin(
        self, text: str, language: str, volume: int, sound: Sound | None, at: float | None
    ) -> Utterance:
        # Loudness is felt by the square: half the volume sounds half as loud.
        gain = (min(100, max(0, volume)) / 100) ** 2
        now = self._clock() if at is None else at
        utterance = Utterance(text, language, gain, now, self._cancel)
        utterance.sound = sound
        with self._lock:
            self._pending.append(utterance)
        self._waiting.put(utterance)
        return utterance

    @property
    def is_speaking(self) -> bool:
        """Whether anything is being said or waits for its turn."""
        with self._lock:
            return bool(self._pending)

    def interrupt(self) -> None:
        """Let somebody else speak: what is being said ends, what waits is said after it."""
        with self._lock:
            current = self._current
        if current is not None:
            current.cancel()

    def hold(self) -> None:
        """Begin with nothing new before `go_on`: somebody else is speaking."""
        self._free.clear()

    def go_on(self) -> None:
        """They have ended."""
        self._free.set()

    def stop(self) -> None:
        """Be silent, and forget what was still to be said."""
        with self._lock:
            pending = tuple(self._pending)
        for utterance in reversed(pending):
            utterance.cancel()

    def close(self) -> None:
        """Stop, and let go of the output."""
        self.stop()
        self._waiting.put(None)
        self._thread.join(_LAST_PIECE)
        with self._lock:
            self._output.close()
            self._output = Nowhere()

    # --- inside ----------------------------------------------------------------------------------

    def _work(self) -> None:
        while (utterance := self._waiting.get()) is not None:
            try:
                if not utterance.cancelled.is_set():
                    self._say(utterance)
            except UserError as error:
                self._fall_silent(str(error))
            except Exception:  # noqa: BLE001 - the robot's voice must outlive a fault of it
                self._fall_silent(
                    "The robot's voice failed, so nothing more will be heard. Start it again."
                )
            finally:
                self._end(utterance)

    def _say(self, utterance: Utterance) -> None:
        stopped = utterance.cancelled.is_set
        self._wait_for_quiet(stopped)
        with self._lock:
            self._current = utterance
        if utterance.sound is not None:
            self._write(utterance, utterance.sound)
        else:
            speaks = self._voice_for(utterance.language)
            for piece in self._kept.speak(speaks, utterance.text, stopped):
                if not self._write(utterance, piece):
                    return
        self._output.drain(stopped)
        utterance.whole = not stopped()

    def _wait_for_quiet(self, stopped: Callable[[], bool]) -> None:
        patience = time.monotonic() + HELD
        while not stopped() and not self._free.wait(_POLL):
            if time.monotonic() > patience:
                self._free.set()

    def _write(self, utterance: Utterance, sound: Sound) -> bool:
        """False if it has been cancelled: then nothing is written after the silence."""
        if utterance.gain != 1.0:
            samples = (sound.samples * np.float32(utterance.gain)).astype(np.int16)
            sound = Sound(samples, sound.rate)
        with self._lock:
            if utterance.cancelled.is_set():
                return False
            self._output.write(sound, utterance.at)
            return True

    def _end(self, utterance: Utterance) -> None:
        with self._lock:
            self._finish(utterance)
            if self._current is utterance:
                self._current = None
        utterance.over.set()

    def _finish(self, utterance: Utterance) -> None:
        """It is heard no more; needs the lock."""
        if utterance in self._pending:
            self._pending.remove(utterance)

    def _cancel(self, utterance: Utterance) -> None:
        with self._lock:
            if utterance.over.is_set() or utterance.cancelled.is_set():
                return
            utterance.cancelled.set()
            if self._current is utterance:
                # Whoever stops is not to be told of a full disk; the next text will be.
                with contextlib.suppress(UserError):
                    self._output.silence(self._clock())
            self._finish(utterance)
        utterance.over.set()

    def _fall_silent(self, because: str) -> None:
        with self._lock:
            output, self._output = self._output, Nowhere()
        self._tell(because)
        try:
            output.close()
        except (UserError, OSError):
            return


_LAST_PIECE: Final = 2.0
"""Seconds that a voice may take to finish the piece it is at."""
