"""The second stage behind a head: speech models say how likely the word is, given the last moments.

    judge = judge_of("en", "hey robot")      # None without the models, and for other words
    judge.verdict(samples, score)            # above 0: it was said

Head and models mistake different sounds, so what counts is what all say together. In noise every
text is unlikely, and in quiet even a word that was not quite said is likely: so it counts as well
how far the word is ahead of what it is easily taken for. Who judges, windows, weights and limits
are data (`judged` in data/hotwords.yaml); `nl2robot.bench.hotword_limits` shows what follows from
them, on the voices of the training.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from typing import Final

import msgspec
import numpy as np

from nl2robot.speech.audio import RATE, Samples
from nl2robot.speech.hear import moonshine, whisper
from nl2robot.speech.hear.search import Network
from nl2robot.speech.hotword.words import WORDS, Judged, Opinion, Way

AROUND: Final = 0.3
"""Seconds of silence put before and after: the models know utterances, not cuttings."""
LOUD: Final = 0.3
"""The peak, of full scale, to which the sound is brought."""
_SURE: Final = 1e-5  # a score is never nearer to 0 or 1: its logit stays finite
_LOADERS: Final[dict[str, Callable[[str], Network | None]]] = {
    "moonshine": moonshine.load,
    "whisper": whisper.load,
}
_log = logging.getLogger(__name__)


class Judge:
    """May be used from several threads at once."""

    def __init__(
        self, models: Sequence[Network], judged: Judged, way: Way, threshold: float
    ) -> None:
        """`models` are those whose opinions the way wants, in this order. `threshold` is that of
        the head, for the case that a model fails."""
        self._models, self._judged, self._way = models, judged, way
        self._threshold = threshold
        self._failed = False
        self.limit = way.limit
        self.floor = way.floor
        """Scores of the head below it are not worth the work."""
        self.samples = int(max(opinion.seconds for opinion in way.opinions) * RATE)
        """How much of the sound, up to now, it looks at."""

    def limited(self, limit: float) -> Judge:
        """The same with another limit."""
        way = msgspec.structs.replace(self._way, limit=limit)
        return Judge(self._models, self._judged, way, self._threshold)

    def verdict(self, samples: Samples, score: float) -> float:
        """Above 0: the word was said, at the end of these samples. `score` is the head's."""
        certain = min(max(score, _SURE), 1 - _SURE)
        verdict = float(np.log(certain / (1 - certain))) - self.limit
        try:
            for model, opinion in zip(self._models, self._way.opinions, strict=True):
                if verdict <= 0 and not opinion.contrast:
                    break  # a likelihood can only speak against the word
                verdict += self._weighed(model, opinion, samples)
        except Exception:  # noqa: BLE001 - onnxruntime raises many; the head still hears
            if not self._failed:  # told once, not for every sound that is a little like the word
                _log.warning("A second speech model failed; the hot word is heard without it.")
            self._failed = True
            _log.debug("A second speech model failed", exc_info=True)
            return score - self._threshold
        return verdict

    def _weighed(self, model: Network, opinion: Opinion, samples: Samples) -> float:
        """What this model says of the word."""
        sound = samples[-int(opinion.seconds * RATE) :].astype(np.float32)
        sound *= LOUD * 32767 / max(float(np.abs(sound).max(initial=0)), 1.0)
        quiet = np.zeros(int(AROUND * RATE), np.int16)
        heard = model.listen(np.concatenate([quiet, sound.astype(np.int16), quiet]))
        written = self._judged.written
        rivals = self._judged.rivals if opinion.contrast else ()
        likelihoods = heard.likelihoods([*written, *rivals])
        word = float(np.logaddexp.reduce(likelihoods[: len(written)]))
        ahead = word - max(likelihoods[len(written) :]) if rivals else 0.0
        return opinion.weight * word + opinion.contrast * ahead


def judge_of(language: str, word: str, threshold: float) -> Judge | None:
    """The second stage of a word; None where it is heard by its head alone."""
    judged = WORDS[language].judged.get(word)
    for way in judged.ways if judged else ():
        models = [_LOADERS[opinion.by](language) for opinion in way.opinions]
        found = [model for model in models if model is not None]
        if judged and len(found) == len(models):
            return Judge(found, judged, way, threshold)
    return None
