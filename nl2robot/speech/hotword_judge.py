"""The second stage behind a head: Moonshine says how likely the word is, given the last second.

    judge = judge_of("en", "hey robot")      # None without the model, and for other words
    judge.verdict(samples, score)            # above 0: it was said

Head and model mistake different sounds, so what counts is what both say together. In noise every
text is unlikely, and in quiet even a word that was not quite said is likely: so it counts as well
how far the word is ahead of what it is easily taken for. Windows, weights and limits are data
(`judged` in data/hotwords.yaml); `nl2robot.speech.hotword_limits` shows what follows from them, on
the voices of the training.
"""

from __future__ import annotations

import logging
from typing import Final

import numpy as np

from nl2robot.speech import moonshine
from nl2robot.speech.audio import RATE, Samples
from nl2robot.speech.hotword_words import WORDS, Judged
from nl2robot.speech.moonshine import Moonshine

AROUND: Final = 0.3
"""Seconds of silence put before and after: the model knows utterances, not cuttings."""
LOUD: Final = 0.3
"""The peak, of full scale, to which the sound is brought."""
_SURE: Final = 1e-5  # a score is never nearer to 0 or 1: its logit stays finite
_log = logging.getLogger(__name__)


class Judge:
    """May be used from several threads at once."""

    def __init__(self, model: Moonshine, judged: Judged, threshold: float) -> None:
        """`threshold` is that of the head, for the case that the model fails."""
        self._model, self._judged, self._threshold = model, judged, threshold
        self._failed = False
        self.limit = judged.limit
        self.floor = judged.floor
        """Scores of the head below it are not worth the work."""
        self.samples = int(judged.seconds * RATE)
        """How much of the sound, up to now, it looks at."""

    def verdict(self, samples: Samples, score: float) -> float:
        """Above 0: the word was said, at the end of these samples. `score` is the head's."""
        try:
            likelihood, ahead = self._likelihood(samples[-self.samples :])
        except Exception:  # noqa: BLE001 - onnxruntime raises many; the head still hears
            if not self._failed:  # told once, not for every sound that is a little like the word
                _log.warning("The second speech model failed; the hot word is heard without it.")
            self._failed = True
            _log.debug("The second speech model failed", exc_info=True)
            return score - self._threshold
        certain = min(max(score, _SURE), 1 - _SURE)
        odds = float(np.log(certain / (1 - certain)))
        judged = self._judged
        return odds + judged.weight * likelihood + judged.contrast * ahead - self.limit

    def _likelihood(self, samples: Samples) -> tuple[float, float]:
        """The log likelihood of the word, and how far it is ahead of the likeliest rival."""
        sound = samples.astype(np.float32)
        sound *= LOUD * 32767 / max(float(np.abs(sound).max(initial=0)), 1.0)
        quiet = np.zeros(int(AROUND * RATE), np.int16)
        heard = self._model.listen(np.concatenate([quiet, sound.astype(np.int16), quiet]))
        written = self._judged.written
        likelihoods = heard.likelihoods([*written, *self._judged.rivals])
        word = float(np.logaddexp.reduce(likelihoods[: len(written)]))
        return word, word - max(likelihoods[len(written) :])


def judge_of(language: str, word: str, threshold: float) -> Judge | None:
    """The second stage of a word; None where it is heard by its head alone."""
    judged = WORDS[language].judged.get(word)
    model = moonshine.load(language) if judged else None
    return Judge(model, judged, threshold) if judged and model else None
