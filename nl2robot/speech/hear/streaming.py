"""Recognition while somebody speaks, so that the text is there when the speech ends.

    streaming = Streaming(recogniser, phrases)
    streaming.begin()
    for samples in blocks:
        partial = streaming.accept(samples)  # what it sounds like so far
    streaming.pause()                        # they have stopped, perhaps for good
    heard = streaming.end()

The model wants speech of a certain loudness, and of live speech it is not known beforehand. The
first words, and what was said before, tell it well enough; where they were far out, all is decoded
again. So it is where somebody goes on after a pause, for in the pause the decoders were ended, so
that what they had found is there when the pause turns out to be the end.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from nl2robot.speech.audio import RATE, Audio, Samples
from nl2robot.speech.hear.levels import gain_for
from nl2robot.speech.hear.recogniser import Decoding, Heard, Recogniser

FIRST = 0.6  # seconds of sound that tell the loudness of the rest; some of it is before the speech
MEMORY = 0.5  # what the loudness of the last speech counts for that of the next
QUIETEST = 0.25  # of the loudness it should have been given; what was quieter is decoded again


class Streaming:
    """Hears one utterance after the other; for one thread."""

    def __init__(
        self,
        recogniser: Recogniser,
        phrases: Sequence[str] | None = None,
        *,
        worst_fit: float | None = None,
    ) -> None:
        """`phrases` and `worst_fit` as for `Recogniser.recognise`."""
        self._recogniser = recogniser
        self._loudness = _Loudness()
        self._sound: list[Samples] = []  # since `begin`
        self._decoding: Decoding | None = None
        self._heard: Heard | None = None
        self.expect(phrases, worst_fit=worst_fit)

    def expect(self, phrases: Sequence[str] | None, *, worst_fit: float | None = None) -> None:
        """What may be said from the next `begin` on."""
        self._phrases = phrases
        self._worst_fit = worst_fit

    def begin(self) -> None:
        """Somebody begins to speak; speech that was not ended is forgotten."""
        self._sound = []
        self._decoding = self._heard = None
        self._loudness.begin()

    def accept(self, samples: Samples) -> str:
        """Goes on with a block of any length; returns the words so far. Raises SpeechError if the
        model knows none of the phrases."""
        self._heard = None
        self._sound.append(samples)
        if self._decoding is None:
            if sum(map(len, self._sound)) < FIRST * RATE:
                return ""
            samples = np.concatenate(self._sound)
            self._decoding = self._recogniser.open(
                self._phrases, worst_fit=self._worst_fit, gain=self._loudness.guess(samples)
            )
        self._decoding.feed(self._loudness.held_back(samples))
        return self._decoding.so_far

    def pause(self) -> None:
        """Makes ready what `end` will give if nothing more is accepted."""
        if self._heard is None:
            self._loudness.is_known()
            decoding, self._decoding = self._decoding, None
            if decoding is None or self._loudness.was_far_out:
                audio = Audio(np.concatenate([*self._sound, np.zeros(0, np.int16)]))
                self._loudness.guess(audio.samples)
                self._heard = self._recogniser.recognise(
                    audio, self._phrases, worst_fit=self._worst_fit
                )
            else:
                self._heard = decoding.finish()

    def end(self) -> Heard:
        """What was said in all that was accepted since `begin`."""
        self.pause()
        assert self._heard is not None
        return self._heard


class _Loudness:
    """How loud somebody speaks, guessed before it is known."""

    def __init__(self) -> None:
        self._before = 0  # the peak of the last speech
        self._peak = 0
        self._gain = 1.0

    def begin(self) -> None:
        self._before, self._peak = self._peak or self._before, 0

    def guess(self, first: Samples) -> float:
        """The gain for a speech that begins like this."""
        self._peak = max(self._peak, _peak(first))
        self._gain = _gain(max(self._peak, round(MEMORY * self._before)))
        return self._gain

    def is_known(self) -> None:
        """From what was said by now; the speech before tells nothing more."""
        self._before = 0

    def held_back(self, samples: Samples) -> Samples:
        """The next samples, which will be multiplied with the guessed gain; where the speech became
        so loud that they would be clipped, less loud from then on."""
        self._peak = max(self._peak, _peak(samples))
        highest = 32767 / self._gain
        if self._peak <= highest:
            return samples
        return (samples * np.float32(highest / self._peak)).astype(np.int16)

    @property
    def was_far_out(self) -> bool:
        """Whether the speech was much quieter than was guessed."""
        return self._gain < QUIETEST * _gain(self._peak)


def _peak(samples: Samples) -> int:
    return int(np.abs(samples.astype(np.int32)).max()) if len(samples) else 0


def _gain(peak: int) -> float:
    return gain_for(np.array([min(peak, 32767)], np.int16))
