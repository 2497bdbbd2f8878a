"""Always listening, on this machine alone: for the hot word ("hey robot"), and for "stop".

    ears = HotWord("en")
    for block in blocks:                      # int16 at 16 kHz, of any length
        for detection in ears.feed(block):
            print(detection.word, detection.time)

No input or output here: samples in, detections out. Words with a trained head (those of
data/hotwords.yaml) are heard by it, in any language and without a speech model; where second
speech models are installed, they judge what the head is not sure of
(`nl2robot.speech.hotword.judge`). Any other word is heard by the speech model of its language
(`nl2robot.speech.hotword.spotting`). Which way hears how well: docs/hotword.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Final, Protocol

import numpy as np

from nl2robot.errors import UserError
from nl2robot.speech.audio import Samples
from nl2robot.speech.embeddings import STEP, STEP_SECONDS, Embeddings, EmbeddingStream
from nl2robot.speech.hear.recogniser import load
from nl2robot.speech.hotword.detection import HELD, Detection
from nl2robot.speech.hotword.head import Head, load_head, probability
from nl2robot.speech.hotword.judge import Judge, judge_of
from nl2robot.speech.hotword.spotting import Spotter
from nl2robot.speech.hotword.words import WORDS, Words

SMOOTH: Final = 3
"""Steps of 80 ms over which the score of a hot word is averaged: surer, and so much later."""
STOP_SMOOTH: Final = 2
"""The same for stop, which has to be heard sooner."""


class Detector(Protocol):
    """Hears words in sound as it comes. Not to be shared between threads."""

    def feed(self, samples: Samples) -> list[Detection]:
        """What was heard in these samples (one channel at 16 kHz, any number) and before."""
        ...

    def reset(self) -> None:
        """Forgets what was fed, as after a pause of listening; the time goes on."""
        ...


class Heads:
    """Hears each word by its head; the embeddings are made once for all of them."""

    def __init__(
        self, heads: Sequence[Head], judges: Sequence[Judge | None], *, smooth: int = 1
    ) -> None:
        """`judges` are the second stages of the heads. `smooth` is over how many steps of 80 ms a
        score is averaged: more are surer, later."""
        self._heads, self._judges, self._smooth = heads, judges, smooth
        self._judged = max((judge.samples for judge in judges if judge), default=0)
        self._reach = max(head.steps for head in heads) + smooth - 1
        self._stream = EmbeddingStream()
        self._heard = [-HELD] * len(heads)
        self._steps = 0
        self.reset()

    def reset(self) -> None:
        self._stream.reset()
        self._last: Embeddings = np.repeat(_silence(), self._reach - 1, axis=0)
        self._samples = np.zeros(self._judged, np.int16)
        self._fed = self._steps * STEP  # samples, the last of which are kept

    def feed(self, samples: Samples) -> list[Detection]:
        return self.hear(self._stream.feed(samples), samples)

    def hear(self, embeddings: Embeddings, samples: Samples) -> list[Detection]:
        """The same of embeddings that were made of these samples and some before, each of the next
        80 ms."""
        known = np.concatenate([self._last, embeddings])
        self._last = known[len(embeddings) :]
        sound = np.concatenate([self._samples, samples])
        self._fed += len(samples)
        # What has no embedding yet will be looked at with the next samples.
        self._samples = sound[max(0, len(sound) - self._judged - STEP) :]
        first = self._steps + 1
        self._steps += len(embeddings)
        if not len(embeddings):
            return []
        found = []
        for i, (head, judge) in enumerate(zip(self._heads, self._judges, strict=True)):
            scores = head.scores(known[self._reach - head.steps - self._smooth + 1 :])
            smoothed = np.convolve(scores, np.ones(self._smooth) / self._smooth, "valid")
            for at in np.flatnonzero(smoothed > (judge.floor if judge else head.threshold)):
                step, score = first + int(at), float(smoothed[at])
                time = step * STEP_SECONDS
                if time - self._heard[i] < HELD:
                    continue
                if judge:
                    until = len(sound) - (self._fed - step * STEP)
                    verdict = judge.verdict(sound[max(0, until - judge.samples) : until], score)
                    if verdict <= 0:
                        continue
                    score = float(probability(np.array(verdict)))
                self._heard[i] = time
                found.append(Detection(head.word, round(time, 3), score))
        return sorted(found, key=lambda each: each.time)


@cache
def _silence() -> Embeddings:
    return EmbeddingStream().feed(np.zeros(STEP, np.int16))


class HotWord:
    """Hears the word that the robot answers to."""

    def __init__(self, language: str, word: str | None = None) -> None:
        """`word` is any word or two of the language; None: its default, "hey robot".

        Raises UserError for a word without a trained head where the speech model of the language
        is not installed or does not know it.
        """
        self.word = " ".join((word if word is not None else default_word(language)).split())
        head = load_head(language, self.word)
        self._detector: Detector = (
            Heads([head], judges(language, [head]), smooth=SMOOTH)
            if head
            else _spotter(language, self.word)
        )

    def feed(self, samples: Samples) -> list[Detection]:
        """What was heard in these samples (one channel at 16 kHz, any number) and before."""
        return self._detector.feed(samples)

    def reset(self) -> None:
        """Forgets what was fed, as after a pause of listening; the time goes on."""
        self._detector.reset()


class StopWord:
    """Hears any of a language's words for stop, fast: what is heard by mistake only stops."""

    def __init__(self, language: str) -> None:
        """Raises UserError for a language that has none."""
        words = _words(language).stop
        heads = [head for word in words if (head := load_head(language, word))]
        self.words = tuple(head.word for head in heads)
        self._detector = Heads(heads, judges(language, heads), smooth=STOP_SMOOTH)

    def feed(self, samples: Samples) -> list[Detection]:
        """What was heard in these samples (one channel at 16 kHz, any number) and before."""
        return self._detector.feed(samples)

    def reset(self) -> None:
        """Forgets what was fed, as after a pause of listening; the time goes on."""
        self._detector.reset()


def stop_word(language: str) -> StopWord | None:
    """What hears the words for stop; None in a language that has none."""
    return StopWord(language) if language in WORDS else None


def judges(language: str, heads: Sequence[Head]) -> list[Judge | None]:
    """The second stages of these heads, where there are any."""
    return [judge_of(language, head.word, head.threshold) for head in heads]


def default_word(language: str) -> str:
    """What the robot answers to in a language. Raises UserError where there is no default."""
    return _words(language).hot


def _words(language: str) -> Words:
    if language not in WORDS:
        raise UserError(
            f"There is no hot word for the language {language!r}. There are: {', '.join(WORDS)}."
        )
    return WORDS[language]


def _spotter(language: str, word: str) -> Detector:
    _words(language)
    return Spotter(load(language), word)
