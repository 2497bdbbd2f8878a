"""Synthesised speech to train the heads of hot words with, and to measure them.

The voices, the words and the noises of the two halves, TRAINING and EVALUATION, are never the same.
"""

from __future__ import annotations

import enum
import importlib.resources
import random
import re
import zlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np

from nl2robot.speech import scenes
from nl2robot.speech.audio import RATE
from nl2robot.speech.scenes import Signal
from nl2robot.speech.voices import Voice, espeak, joined, voices

# espeak-ng's dialects of a language, and its speakers that sound like people.
DIALECTS: Final = {
    "en": ("en-us", "en-gb-x-rp", "en-us", "en-gb-scotland", "en-029", "en-us-nyc"),
    "de": ("de",),
    "fr": ("fr", "fr-be", "fr-ch"),
}
SPEAKERS: Final = {
    "training": (
        "Alex Andrea Andy Annie Denis Gene Henrique Jacky Lee Marco Michael Nguyen Reed Storm adam"
        " anika aunty belinda benjamin boris david edward f1 f2 f4 gustave ian iven john klatt"
        " klatt3 linda m1 m3 m4 m6 m7 marcelo max miguel norbert paul pedro quincy rob sandro"
        " steph victor whisper zac"
    ),
    "evaluation": (
        "Alicia Diogo Hugo Mario antonio caleb ed f3 f5 m2 m5 m8 michel pablo robert shelby"
    ),
}
ONSETS: Final = "b bl br d dr f fl fr g gr h j k kl kr l m n p pl pr r s sch sp st t tr v w z"
VOWELS: Final = "a e i o u ai au ei ie oo ou ea er ar or an en in on"
CODAS: Final = "- - - l m n r s t k p nd st x"


class Half(enum.Enum):
    TRAINING = "training"
    EVALUATION = "evaluation"


NEURAL: Final = {Half.TRAINING: 0.1, Half.EVALUATION: 0.2}
"""The share of a neural voice where there is one."""
OTHER_THROATS: Final = ((0.86, 0.95), (1.06, 1.18))


@dataclass
class Speech:
    """People of one half who say things in a language."""

    language: str
    half: Half
    rng: np.random.Generator
    avoid: frozenset[str]
    """Words that nobody says by chance."""

    def say(self, text: str, *, neural: bool | None = None) -> Signal:
        """Somebody says this, without silence around it; `neural` asks for that kind of voice."""
        voice, warp = self._speaker(neural)
        speed, pitch = self.rng.uniform(0.75, 1.35), self.rng.uniform(0.6, 1.5)
        spoken = joined(voice.speak(text, speed=float(speed), pitch=float(pitch)))
        import soxr

        sound = soxr.resample(spoken.samples.astype(np.float32) / 32768, spoken.rate * warp, RATE)
        return trimmed(np.asarray(sound, np.float32))

    @property
    def has_neural_voice(self) -> bool:
        return bool(self._neural_voices())

    def _neural_voices(self) -> list[Voice]:
        return [each for each in voices(self.language) if each.name.startswith("piper")]

    def _speaker(self, neural: bool | None) -> tuple[Voice, float]:
        """A voice, and by what factor the whole of it is higher: another throat."""
        found = self._neural_voices()
        if found and (neural or (neural is None and self.rng.random() < NEURAL[self.half])):
            # There is one neural voice: those who train are higher or lower than those who test.
            return found[0], 1.0 if self.half is Half.EVALUATION else self._far_from_one()
        names = SPEAKERS[self.half.value].split()
        dialects = DIALECTS.get(self.language, (self.language,))
        voice = espeak(
            dialects[int(self.rng.integers(len(dialects)))],
            names[int(self.rng.integers(len(names)))],
        )
        warp = self.rng.uniform(0.87, 1.18) if self.half is Half.TRAINING else 1.0
        return voice, float(warp)

    def _far_from_one(self) -> float:
        low, high = OTHER_THROATS[int(self.rng.integers(len(OTHER_THROATS)))]
        return float(self.rng.uniform(low, high))

    def remark(self) -> str:
        """Something that says none of the words to avoid."""
        if self.half is Half.EVALUATION and self.language == "en":
            sentences = _prose()
            return next(
                text
                for text in iter(lambda: sentences[int(self.rng.integers(len(sentences)))], None)
                if not self.avoid & set(words_of(text))
            )
        if self.half is Half.TRAINING and self.rng.random() < 0.35:
            return " ".join(self._nonsense() for _ in range(int(self.rng.integers(3, 9))))
        words = _words(self.language, self.half)
        chosen = [words[int(self.rng.integers(len(words)))] for _ in range(40)]
        chosen = [word for word in chosen if word not in self.avoid]
        return " ".join(chosen[: int(self.rng.integers(3, 11))])

    def _nonsense(self) -> str:
        parts = [part.split() for part in (ONSETS, VOWELS, CODAS)] * int(self.rng.integers(1, 4))
        word = "".join(part[int(self.rng.integers(len(part)))] for part in parts)
        return word.replace("-", "")


def trimmed(sound: Signal) -> Signal:
    """Without what is quieter than a hundredth of the peak at both ends."""
    loud = np.flatnonzero(np.abs(sound) > 0.015 * max(float(np.abs(sound).max(initial=0)), 1e-9))
    return sound[loud[0] : loud[-1] + 1] if len(loud) else sound


def words_of(text: str) -> list[str]:
    return re.findall(r"[^\W\d_]+", text.lower())


@cache
def _words(language: str, half: Half) -> list[str]:
    """Half of the words that the grammar of a language knows."""
    folder = importlib.resources.files("grammar") / "languages" / language
    found: set[str] = set()
    for file in folder.iterdir():
        if file.name.endswith(".yaml"):
            found |= {word for word in words_of(file.read_text("utf-8")) if len(word) > 2}
    odd = half is Half.EVALUATION
    return sorted(word for word in found if zlib.crc32(word.encode()) % 2 == odd)


@cache
def _prose() -> list[str]:
    """English sentences that have nothing to do with robots: Python's own manual."""
    from pydoc_data.topics import topics

    sentences = re.split(r"(?<=[.:])\s+", " ".join(" ".join(topics.values()).split()))
    return [s for s in sentences if 20 < len(s) < 160 and re.fullmatch(r"[\w ,.;:()'-]+", s)]


@dataclass
class Places:
    """Where it is said: noises of one half, made once; and what others say there."""

    noises: dict[str, list[Signal]]
    remarks: list[Signal]
    rng: np.random.Generator

    def noise(self, kind: str) -> Signal:
        beds = self.noises[kind]
        return beds[int(self.rng.integers(len(beds)))]

    def remark(self) -> Signal:
        return self.remarks[int(self.rng.integers(len(self.remarks)))]

    def babble(self, seconds: float) -> Signal:
        """Three to eight people, each with some things to say."""
        count = int(self.rng.integers(3, 9))
        chosen = self.rng.choice(len(self.remarks), count * 4, replace=False)
        return scenes.babble([self.remarks[i] for i in chosen], seconds, self.rng)


def places(speech: Sequence[Speech], rng: np.random.Generator, minutes: int = 4) -> Places:
    """Babble of these people, corridors and plain noise."""
    remarks = [each.say(each.remark()) for each in speech for _ in range(300 // len(speech))]
    where = Places({}, remarks, rng)
    where.noises = {
        "babble": [where.babble(60) for _ in range(minutes)],
        "corridor": [scenes.corridor(60, rng) for _ in range(minutes)],
        "noise": [_plain(60, rng) for _ in range(minutes)],
    }
    return where


def _plain(seconds: float, rng: np.random.Generator) -> Signal:
    """Noise of some colour, now louder, now softer."""
    length = int(seconds * RATE)
    spectrum = np.fft.rfft(rng.standard_normal(length))
    slope = rng.uniform(-1.2, 0.3)
    spectrum *= np.maximum(np.fft.rfftfreq(length, 1 / RATE), 30) ** slope
    noise = np.fft.irfft(spectrum, length)
    swell = 1 + 0.6 * np.sin(2 * np.pi * rng.uniform(0.05, 0.6) * np.arange(length) / RATE)
    noise = noise * swell
    return np.asarray(0.5 * noise / np.abs(noise).max(), np.float32)


def silence(seconds: float) -> Signal:
    return np.zeros(int(seconds * RATE), np.float32)


def talk(speech: Speech, seconds: float, also: Callable[[], str | None]) -> Iterator[Signal]:
    """Somebody talks on and on; `also` may give a text to say next."""
    length = 0
    while length < seconds * RATE:
        said = speech.say(also() or speech.remark())
        pause = silence(float(speech.rng.exponential(0.35)))
        length += len(said) + len(pause)
        yield said
        yield pause


def seeded(seed: int, *names: str) -> np.random.Generator:
    """A generator of its own for each purpose, so that one more of one changes no other."""
    return np.random.default_rng([seed, *(zlib.crc32(name.encode()) for name in names)])


def shuffled(texts: Sequence[str], rng: np.random.Generator) -> Iterator[str]:
    """The texts over and over, each round in another order."""
    order = list(texts)
    while True:
        random.Random(int(rng.integers(2**31))).shuffle(order)
        yield from order
