"""Who speaks in trainings and measurements of hot words: many neural speakers where Kokoro is
installed (`nl2robot models get kokoro`), a piper voice where there is one, and espeak-ng's robotic
ones. Nobody speaks in both halves.

    cast = Cast("en", Half.TRAINING, rng)
    cast.clip("Hey robot!").heard(rng)
"""

from __future__ import annotations

import enum
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from nl2robot.bench.kokoro import Kokoro, speakers
from nl2robot.speech.audio import RATE
from nl2robot.speech.scenes import Signal
from nl2robot.speech.speak.voices import Sound, Voice, espeak, joined, voices


class Half(enum.Enum):
    TRAINING = "training"
    EVALUATION = "evaluation"


def _names(listed: str) -> list[str]:
    return listed.split()


# espeak-ng's dialects of a language, and its speakers that sound like people.
DIALECTS: Final = {
    "en": ("en-us", "en-gb-x-rp", "en-us", "en-gb-scotland", "en-029", "en-us-nyc"),
    "de": ("de",),
    "fr": ("fr", "fr-be", "fr-ch"),
}
ROBOTIC: Final = {
    Half.TRAINING: _names(
        "Alex Andrea Andy Annie Denis Gene Henrique Jacky Lee Marco Michael Nguyen Reed Storm adam"
        " anika aunty belinda benjamin boris david edward f1 f2 f4 gustave ian iven john klatt"
        " klatt3 linda m1 m3 m4 m6 m7 marcelo max miguel norbert paul pedro quincy rob sandro"
        " steph victor whisper zac"
    ),
    Half.EVALUATION: _names(
        "Alicia Diogo Hugo Mario antonio caleb ed f3 f5 m2 m5 m8 michel pablo robert shelby"
    ),
}

# Kokoro's speakers that are never learned from; all others are. Of both sexes, and those whose
# "stop" and "hey robot" another network (Moonshine) understood best: what nobody understands
# measures nothing.
UNSEEN: Final = _names(
    "af_bella af_heart af_jessica am_adam am_eric am_michael am_onyx bf_emma bf_lily bm_lewis"
    " ef_dora ff_siwis hm_omega im_nicola jf_alpha pm_santa zf_xiaoni"
)
AT_HOME: Final = {"en": "ab", "fr": "f"}
"""The first letters of Kokoro's speakers without an accent."""
FOREIGN: Final = 0.2
"""The share of the others, where enough speakers are at home."""

NEURAL: Final = 0.6
"""The share of neural voices where Kokoro is installed."""
PIPER: Final = {Half.TRAINING: 0.1, Half.EVALUATION: 0.2}
"""The share of piper where it is not; of the neural voices where it is."""
OTHER_THROATS: Final = ((0.86, 0.95), (1.06, 1.18))


@dataclass(frozen=True, eq=False)
class Clip:
    """What somebody said, without silence around it."""

    sound: Sound
    throats: tuple[tuple[float, float], ...]
    """Ranges of factors by which all of it may be higher: as if others had said it."""

    def heard(self, rng: np.random.Generator) -> Signal:
        import soxr

        low, high = self.throats[int(rng.integers(len(self.throats)))]
        rate = self.sound.rate * float(rng.uniform(low, high))
        samples = self.sound.samples.astype(np.float32) / 32768
        return trimmed(np.asarray(soxr.resample(samples, rate, RATE), np.float32))


class Takes:
    """Clips that are made when they are asked for first, and then heard again and again: neural
    voices need half as long to speak as their speech lasts."""

    def __init__(self, make: Callable[[], Clip], most: int) -> None:
        self._make, self._most = make, most
        self._made: dict[int, Clip] = {}

    def any(self, rng: np.random.Generator) -> Clip:
        number = int(rng.integers(self._most))
        if number not in self._made:
            self._made[number] = self._make()
        return self._made[number]


class Cast:
    """The people of one half who speak a language."""

    def __init__(self, language: str, half: Half, rng: np.random.Generator) -> None:
        self._language, self._half, self._rng = language, half, rng
        learned = half is Half.TRAINING
        kokoro = [name for name in speakers() if (name in UNSEEN) is not learned]
        homes = AT_HOME.get(language, "")
        self._natives = [name for name in kokoro if name[0] in homes]
        self._kokoro = kokoro
        self._piper = [each for each in voices(language) if each.name.startswith("piper")]

    @property
    def has_neural(self) -> bool:
        return bool(self._kokoro or self._piper)

    @property
    def neural_share(self) -> float:
        return NEURAL if self._kokoro else PIPER[self._half] if self._piper else 0.0

    def clip(self, text: str, *, neural: bool) -> Clip:
        """Somebody says this, in such a voice if there is one."""
        voice, throats = self._neural() if neural and self.has_neural else self._robotic()
        slowest, fastest, pitch = 0.75, 1.35, self._rng.uniform(0.6, 1.5)
        if isinstance(voice, Kokoro):
            slowest, fastest = 0.8, 1.3
        speed = round(float(self._rng.uniform(slowest, fastest)), 3)
        return Clip(joined(voice.speak(text, speed=speed, pitch=float(pitch))), throats)

    def _neural(self) -> tuple[Voice, tuple[tuple[float, float], ...]]:
        learned = self._half is Half.TRAINING
        if self._piper and (not self._kokoro or self._rng.random() < PIPER[self._half]):
            # There is one such voice: those who train are higher or lower than those who test.
            return self._piper[0], OTHER_THROATS if learned else ((1.0, 1.0),)
        names = self._kokoro
        if len(self._natives) > len(UNSEEN) // 2 and self._rng.random() > FOREIGN:
            names = self._natives
        name = self._one(names)
        dialect = "en-gb-x-rp" if name[0] == "b" else DIALECTS[self._language][0]
        voice = Kokoro(name, dialect if self._language == "en" else self._language)
        return voice, ((0.87, 1.18),) if learned else ((1.0, 1.0),)

    def _robotic(self) -> tuple[Voice, tuple[tuple[float, float], ...]]:
        dialect = self._one(DIALECTS.get(self._language, (self._language,)))
        voice = espeak(dialect, self._one(ROBOTIC[self._half]))
        return voice, ((0.87, 1.18) if self._half is Half.TRAINING else (1.0, 1.0),)

    def _one(self, names: Sequence[str]) -> str:
        return names[int(self._rng.integers(len(names)))]


def trimmed(sound: Signal) -> Signal:
    """Without what is quieter than a thirtieth of the peak at both ends."""
    loud = np.flatnonzero(np.abs(sound) > 0.03 * max(float(np.abs(sound).max(initial=0)), 1e-9))
    return sound[loud[0] : loud[-1] + 1] if len(loud) else sound
