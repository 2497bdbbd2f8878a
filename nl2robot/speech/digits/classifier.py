"""Which digit a short sound is, by the sound alone: an ear for digits beside the recogniser.

    shares = load("en").shares(audio)   # {"0": 0.01, ..., "9": 0.93, "": 0.02}

The recogniser was trained on sentences. Where one short word is all there is, with its edges cut
off and the high tones of its s and f lost on the way, it mistakes six for eight. This one was
trained on just such sounds (`nl2robot.training.digits`), said by people with many accents: a small
network on the speech embedding and, where the second ear's encoder is installed, one on that
(`encoder`). Where a language has none, there is no such ear, and the recogniser decides
alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from nl2robot.paths import PACKAGED
from nl2robot.speech.audio import RATE, Audio
from nl2robot.speech.digits.encoder import encoder
from nl2robot.speech.embeddings import WINDOW, embed_windows
from nl2robot.speech.hear.levels import Silence

DIGITS: Final = tuple("0123456789")
NONE: Final = ""
"""What is no digit."""
LONGEST: Final = 1.0
"""Seconds that a digit may last; a longer sound is none, or several."""
_FAINT: Final = 0.01
"""Of the loudest moment: what is fainter than that is not speech. More would cut an f or an s."""
_OVER_NOISE: Final = 1.5
"""Times the level of the noise: what is louder than that is speech."""
_PLACES: Final = (0.35, 0.5, 0.65)
"""Where in the window the sound may lie, as a share of the room left: the network's opinions on
all of these count."""
_EMBEDDED, _ENCODED, _ALONE, _MORE_NONE = 0.5, 0.9, 1.25, -1.5
"""Weights of both networks' opinions, and of the first alone; fitted to synthesised speakers that
they were not trained on (docs/voice.md)."""
LOUDNESS: Final = 0.6 * 32768  # the peak; the embedding takes samples as 16 bit integers
_FRAME: Final = RATE // 200
_SMOOTH: Final = 6  # frames
_GAP: Final = 24  # frames that may be quiet within a word: before the t of eight
_BEFORE, _AFTER = 8, 12  # frames around what is loud, of a word in noise

BY_EMBEDDING: Final = "embedding"
BY_ENCODER: Final = "encoder"
"""Kinds of networks, by what they listen to."""

Sound = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Network:
    """One hidden layer."""

    mean: NDArray[np.float64]
    scale: NDArray[np.float64]
    hidden: NDArray[np.float64]
    hidden_bias: NDArray[np.float64]
    out: NDArray[np.float64]
    out_bias: NDArray[np.float64]

    def log_shares(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        layer = np.maximum(0, (values - self.mean) / self.scale @ self.hidden + self.hidden_bias)
        scores = layer @ self.out + self.out_bias
        scores = scores - scores.max(axis=1, keepdims=True)
        return np.asarray(scores - np.log(np.exp(scores).sum(axis=1, keepdims=True)))


class DigitEar:
    """Tells the digits of one language apart. May be used from several threads."""

    def __init__(self, by_embedding: Network, by_encoder: Network | None, language: str) -> None:
        self._by_embedding, self._by_encoder = by_embedding, by_encoder
        self._language = language

    def shares(self, audio: Audio) -> dict[str, float] | None:
        """How likely each of `DIGITS` is, and `NONE` of them; None where the sound is too long for
        one digit, or silence."""
        silence = Silence()
        silence.feed(audio.samples)
        if silence:
            return None
        sound = word_in(audio.samples.astype(np.float32))
        if not 0 < len(sound) <= LONGEST * RATE:
            return None
        values = embed_windows([placed(sound, at) for at in _PLACES]).astype(float)
        opinion = self._by_embedding.log_shares(values).mean(axis=0)
        ear = encoder(self._language) if self._by_encoder else None
        if ear is not None and self._by_encoder is not None:
            other = self._by_encoder.log_shares(ear.values(sound)[np.newaxis])[0]
            opinion = _EMBEDDED * opinion + _ENCODED * other
        else:
            opinion = _ALONE * opinion
        opinion[-1] += _MORE_NONE
        shares = np.exp(opinion - opinion.max())
        return dict(zip((*DIGITS, NONE), (shares / shares.sum()).tolist(), strict=True))


def word_in(sound: Sound) -> Sound:
    """`speech_in`; where noise makes that too long for a digit, the one word in it that is clearly
    louder than all the rest, if there is one."""
    speech = speech_in(sound)
    if len(speech) <= LONGEST * RATE:
        return speech
    levels = np.convolve(_levels(sound), np.ones(_SMOOTH) / _SMOOTH, "same")
    most, noise = float(levels.max()), float(np.percentile(levels, 30))
    loud = np.flatnonzero(levels >= max(0.1 * most, (noise * most) ** 0.5))
    words = np.split(loud, np.flatnonzero(np.diff(loud) > _GAP) + 1)
    loudest = int(levels.argmax())
    word = next(word for word in words if word[0] <= loudest <= word[-1])
    first, last = max(0, int(word[0]) - _BEFORE), int(word[-1]) + _AFTER
    rest = np.concatenate([levels[: max(0, first)], levels[last + 1 :]])
    if len(rest) and rest.max() > 0.5 * most:
        return speech
    found = sound[first * _FRAME : (last + 1) * _FRAME]
    return found if len(found) <= LONGEST * RATE else speech


def speech_in(sound: Sound) -> Sound:
    """The part between the first and the last moment that stands out; a short sound is left as it
    is, for it may have no pause to tell the noise by."""
    if len(sound) <= WINDOW:
        return sound
    levels = _levels(sound)
    floor = max(_FAINT * float(levels.max()), _OVER_NOISE * float(np.percentile(levels, 10)))
    return _between(sound, levels >= min(floor, float(levels.max())))


def cut(sound: Sound, share: float) -> Sound:
    """Without the edges that are fainter than this share of the loudest moment."""
    levels = _levels(sound)
    return _between(sound, levels >= share * levels.max())


def _levels(sound: Sound) -> NDArray[np.float64]:
    whole = len(sound) // _FRAME * _FRAME
    return np.asarray(np.sqrt(np.square(sound[:whole].reshape(-1, _FRAME)).mean(axis=1)), float)


def _between(sound: Sound, loud: NDArray[np.bool_]) -> Sound:
    where = np.flatnonzero(loud)
    return sound[where[0] * _FRAME : (where[-1] + 1) * _FRAME]


def placed(sound: Sound, at: float) -> Sound:
    """A sound in a window, `at` this share of the room that it leaves; the middle of a longer."""
    sound = sound * np.float32(LOUDNESS / max(1e-6, float(np.abs(sound).max())))
    if len(sound) > WINDOW:
        first = (len(sound) - WINDOW) // 2
        return sound[first : first + WINDOW]
    window = np.zeros(WINDOW, np.float32)
    first = int(at * (WINDOW - len(sound)))
    window[first : first + len(sound)] = sound
    return window


def weights(language: str) -> Path:
    return PACKAGED / f"digits-{language}.npz"


@lru_cache(maxsize=3)
def load(language: str) -> DigitEar | None:
    """That of a language; None where there is none."""
    path = weights(language)
    if not path.is_file():
        return None
    with np.load(path) as values:
        networks = {
            kind: Network(
                **{
                    name.removeprefix(f"{kind}_"): values[name].astype(float)
                    for name in values
                    if name.startswith(f"{kind}_")
                }
            )
            for kind in (BY_EMBEDDING, BY_ENCODER)
            if f"{kind}_mean" in values
        }
    return DigitEar(networks[BY_EMBEDDING], networks.get(BY_ENCODER), language)
