"""The robot's voice: one text after the other, silent at once when it is told to be.

    speaker = Speaker(SoundCard())
    speaker.begin("Good morning.").wait()
    speaker.interrupt()                         # somebody speaks: let them
    speaker.hears_itself(12.1, 13.0, "good morning")

A thread of its own makes the sound of the next piece while one is played, so whoever stops it waits
for neither.
"""

from __future__ import annotations

import contextlib
import queue
import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from nl2robot.errors import UserError
from nl2robot.speech.kept import KeptSounds
from nl2robot.speech.loudspeaker import Nowhere, Output
from nl2robot.speech.voices import Sound, Voice, voice

ECHO: Final = 0.25
"""Seconds for which a room still sounds of what the robot said."""
MOSTLY: Final = 0.5
"""The share of what was heard that lies in the robot's own speech before it may be that."""
ALIKE: Final = 60.0
"""How much of what was heard (of 100) is found in what was spoken if it is that. In a furnished
room, 20 dB above a corridor's noise, 15 of 16 sentences came back to the robot as like as that; of
10 things that people said, 5 were as like as that to one of its 8. In worse rooms its own words
come back so garbled that they are like nothing."""
_REMEMBERED: Final = 100  # texts


@dataclass(frozen=True)
class Spoken:
    """Something the robot said; times of the speaker's clock in seconds."""

    text: str
    language: str
    began: float
    ended: float | None
    """None while it is being spoken."""


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
        self._record: deque[Spoken] = deque(maxlen=_REMEMBERED)
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

    # --- what was said ---------------------------------------------------------------------------

    def spoken_since(self, moment: float) -> list[Spoken]:
        """What has been said since then, or is being said."""
        with self._lock:
            return [said for said in self._record if said.ended is None or said.ended >= moment]

    def hears_itself(self, began: float, ended: float, heard: str = "") -> bool:
        """Whether what a microphone heard from `began` to `ended` is the robot itself: it was
        speaking most of that time and, if `heard` is given, those words are like its own.

        Give words only where they were understood, without doubt: an echo makes anything of the
        robot's own. A "stop" is to be obeyed whoever said it: do not ask here about that.
        """
        spoken = [said for said in self.spoken_since(began - ECHO) if said.began <= ended]
        within = sum(
            max(0.0, min(ended, (said.ended or ended) + ECHO) - max(began, said.began))
            for said in spoken
        )
        if within < MOSTLY * max(ended - began, 1e-3):
            return False
        words = _spelled(heard, spoken[0].language)
        return not words or any(
            _likeness(words, _spelled(said.text, said.language)) >= ALIKE for said in spoken
        )

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

    def _write(self, utterance: Utterance, sound: Sound) -> bool:
        """False if it has been cancelled: then nothing is written after the silence."""
        if utterance.gain != 1.0:
            samples = (sound.samples * np.float32(utterance.gain)).astype(np.int16)
            sound = Sound(samples, sound.rate)
        with self._lock:
            if utterance.cancelled.is_set():
                return False
            self._note(utterance)
            self._output.write(sound, utterance.at)
            return True

    def _note(self, utterance: Utterance) -> None:
        """It is heard from now on."""
        if utterance.text and not (self._record and self._record[-1].ended is None):
            began = self._clock()
            self._record.append(Spoken(utterance.text, utterance.language, began, None))

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
        if self._current is utterance and self._record and self._record[-1].ended is None:
            said = self._record.pop()
            ended = self._clock()
            self._record.append(Spoken(said.text, said.language, said.began, ended))

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


def _spelled(text: str, language: str) -> str:
    from nl2robot.speech.vocabulary import spell_numbers

    words = spell_numbers(text.lower(), language).replace("-", " ").split()
    return " ".join(filter(None, (word.strip('-–.,;:!?…"“”„«»()') for word in words)))


def _likeness(heard: str, spoken: str) -> float:
    """0 to 100: how much of what was heard is found in what was spoken, in its order."""
    from rapidfuzz import fuzz

    if len(heard) > len(spoken):  # more than was spoken: all of it must be like
        return fuzz.ratio(heard, spoken)
    return fuzz.partial_ratio(heard, spoken)
