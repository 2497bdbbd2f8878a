"""Synthesised speech to train the heads of hot words with, and to measure them.

The voices, the words and the noises of the two halves, TRAINING and EVALUATION, are never the same.
"""

from __future__ import annotations

import importlib.resources
import random
import re
import zlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pydoc_data.topics import topics
from typing import Final

import numpy as np
import yaml

from nl2robot.bench.hotword_voices import Cast, Half, Takes
from nl2robot.paths import PACKAGED
from nl2robot.speech import scenes
from nl2robot.speech.audio import RATE
from nl2robot.speech.scenes import Signal

ONSETS: Final = "b bl br d dr f fl fr g gr h j k kl kr l m n p pl pr r s sch sp st t tr v w z"
VOWELS: Final = "a e i o u ai au ei ie oo ou ea er ar or an en in on"
CODAS: Final = "- - - l m n r s t k p nd st x"
EVERYDAY: Final = 0.4
"""The share of remarks that people make all day."""
PROSE: Final = 0.75
"""Up to where, in English, they come from a book."""
NONSENSE: Final = 0.35
_TALK: Final = PACKAGED / "hotwords-talk.yaml"


@dataclass
class Speech:
    """People of one half who say things in a language."""

    language: str
    half: Half
    rng: np.random.Generator
    avoid: frozenset[str]
    """Words that nobody says by chance."""
    takes: int = 70
    """Remarks in neural voices, each heard again and again: they take long to make."""

    def __post_init__(self) -> None:
        self.cast = Cast(self.language, self.half, self.rng)
        self.talked = self.saying(self.remark, self.takes)
        """Says something that none of the words to avoid is in."""

    def saying(self, text: Callable[[], str], takes: int) -> Callable[[], Signal]:
        """Says such texts, each time in some voice: in robotic ones always anew, in neural ones
        that of some takes, which are made when they are needed."""
        taken = Takes(lambda: self.cast.clip(text(), neural=True), takes)

        def said() -> Signal:
            if self.rng.random() < self.cast.neural_share:
                return taken.any(self.rng).heard(self.rng)
            return self.cast.clip(text(), neural=False).heard(self.rng)

        return said

    def remark(self) -> str:
        """Something that says none of the words to avoid."""
        while True:
            text = self._remark()
            if not self.avoid & set(words_of(text)):
                return text

    def _remark(self) -> str:
        kind = self.rng.random()
        if kind < EVERYDAY:
            return self._any(_everyday(self.language, self.half))
        if kind < PROSE and self.language == "en":
            return self._any(_prose(self.half))
        if self.half is Half.TRAINING and self.rng.random() < NONSENSE:
            return " ".join(self._nonsense() for _ in range(int(self.rng.integers(3, 9))))
        words = _words(self.language, self.half)
        return " ".join(self._any(words) for _ in range(int(self.rng.integers(3, 11))))

    def _any(self, texts: Sequence[str]) -> str:
        return texts[int(self.rng.integers(len(texts)))]

    def _nonsense(self) -> str:
        parts = [part.split() for part in (ONSETS, VOWELS, CODAS)] * int(self.rng.integers(1, 4))
        word = "".join(part[int(self.rng.integers(len(part)))] for part in parts)
        return word.replace("-", "")


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
    return _of(half, found)


@cache
def _everyday(language: str, half: Half) -> list[str]:
    """Half of what people say all day: data/hotwords-talk.yaml."""
    return _of(half, yaml.safe_load(_TALK.read_text("utf-8"))[language])


@cache
def _prose(half: Half) -> list[str]:
    """English sentences that have nothing to do with robots: Python's own manual."""
    sentences = re.split(r"(?<=[.:])\s+", " ".join(" ".join(topics.values()).split()))
    plain = (s for s in sentences if 20 < len(s) < 80 and re.fullmatch(r"[\w ,.;:()'-]+", s))
    return _of(half, plain)


def _of(half: Half, texts: Iterable[str]) -> list[str]:
    odd = half is Half.EVALUATION
    return sorted(text for text in set(texts) if zlib.crc32(text.encode()) % 2 == odd)


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
    remarks = [each.talked() for each in speech for _ in range(300 // len(speech))]
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


def talk(seconds: float, said: Callable[[], Signal], rng: np.random.Generator) -> Iterator[Signal]:
    """Somebody talks on and on: `said` gives what comes next."""
    length = 0
    while length < seconds * RATE:
        spoken, pause = said(), silence(float(rng.exponential(0.35)))
        length += len(spoken) + len(pause)
        yield spoken
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
