"""How well hot words and stop words are heard: misses, false alarms an hour, delay, cost.

    nl2robot bench hotword                           # a few minutes: a first impression
    NL2ROBOT_BENCH_HOURS=10 nl2robot bench hotword   # hours of noise: the tables of docs/hotword.md
    NL2ROBOT_BENCH_LANGUAGE=en                       # with it: of one language only

On synthesised speech in voices that no head was trained with, in babble of such voices and in a
corridor. Where there is a second stage, the heads alone hear the same sounds beside it.
"""

from __future__ import annotations

import os
import statistics
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Final, NamedTuple

import numpy as np

from nl2robot.bench.figures import megabytes
from nl2robot.bench.hotword_corpus import Speech, seeded, silence, talk, words_of
from nl2robot.bench.hotword_voices import Clip, Half, Takes
from nl2robot.errors import UserError
from nl2robot.models.catalogue import find
from nl2robot.speech import scenes
from nl2robot.speech.audio import RATE, Samples
from nl2robot.speech.embeddings import STEP, Embeddings, embed
from nl2robot.speech.hear.recogniser import load
from nl2robot.speech.hotword.detection import Detection
from nl2robot.speech.hotword.detector import (
    SMOOTH,
    STOP_SMOOTH,
    Detector,
    Heads,
    HotWord,
    StopWord,
    judges,
)
from nl2robot.speech.hotword.head import Head, load_head
from nl2robot.speech.hotword.judge import Judge
from nl2robot.speech.hotword.spotting import Spotter
from nl2robot.speech.hotword.words import WORDS, Words
from nl2robot.speech.scenes import Signal


@dataclass(eq=False)
class Sound:
    """Something to be heard, in one way or several."""

    samples: Samples

    @cached_property
    def embeddings(self) -> Embeddings:
        return embed(self.samples)


Hear = Callable[[Sound], list[Detection]]
"""All that is heard in a sound."""

SNRS: Final = (None, 20, 10, 5, 0)  # dB; None: no noise
KINDS: Final = {"babble": 0.7, "talk": 0.15, "corridor": 0.05, "corridor with talk": 0.1}
"""Noises, and how much of the time each is listened to."""
STOP_SHARE: Final = 0.1
"""Of it also for stop: its false alarms are many, and soon counted."""
SAYINGS: Final = 200  # of which the babble is mixed
TAKES: Final = 50
FEW_TAKES: Final = 25  # for a first impression: neural voices take long
MARKS: Final = ("", "!", ".")  # with which a word is called
IN_TIME: Final = (-0.35, 1.2)
"""Seconds from a word's end within which its detection counts."""


@dataclass(eq=False)
class Said(Sound):
    """A word that was said."""

    end: float  # seconds


class Stage:
    """The people, words and noises of an evaluation."""

    def __init__(
        self, words: Words, seed: int = 1, half: Half = Half.EVALUATION, takes: int = TAKES
    ) -> None:
        """`takes`: how many remarks there are in neural voices, and callings of a word."""
        self.words, self._takes = words, takes
        self._rng = seeded(seed, words.language, half.value)
        avoid = frozenset(w for word in (*words.stop, words.hot) for w in words_of(word))
        self._speech = Speech(words.language, half, self._rng, avoid, takes)
        self._called: dict[tuple[str, bool], Takes] = {}

    @cached_property
    def _sayings(self) -> list[Signal]:
        return [self._speech.talked() for _ in range(SAYINGS)]

    def said(self, word: str, snr: float | None, noise: Signal, *, neural: bool) -> Said:
        rng = self._rng
        spoken = self._call(word, neural).heard(rng)
        sound = np.concatenate([silence(1.6), spoken, silence(1.2)])
        if rng.random() < 0.5:
            sound = scenes.echoing(sound, scenes.echo(rng, 0.4))[: len(sound)]
        if snr is not None:
            sound = scenes.at_snr(sound, noise, snr, rng)
        peak = max(float(np.abs(sound).max()), 1e-6)
        sound = np.asarray(sound * (rng.uniform(0.1, 0.7) / peak), np.float32)
        return Said(scenes.audio(sound).samples, 1.6 + len(spoken) / RATE)

    def _call(self, word: str, neural: bool) -> Clip:
        def called() -> Clip:
            return self._speech.cast.clip(word + self._rng.choice(list(MARKS)), neural=neural)

        if (word, neural) not in self._called:
            self._called[word, neural] = Takes(called, self._takes)
        return self._called[word, neural].any(self._rng)

    def noise(self, kind: str, seconds: float) -> Signal:
        """In which nobody says the words."""
        if kind == "corridor":
            return scenes.corridor(seconds, self._rng)
        if kind == "babble":
            voices = self._rng.choice(SAYINGS, int(self._rng.integers(12, 33)), replace=False)
            return scenes.babble([self._sayings[i] for i in voices], seconds, self._rng)
        spoken = np.concatenate(list(talk(seconds, self._speech.talked, self._rng)))
        if kind == "corridor with talk":
            length = min(len(spoken), int(seconds * RATE))
            noise = scenes.corridor(length / RATE, self._rng)
            snr = float(self._rng.uniform(0, 15))
            return scenes.at_snr(spoken[:length], noise, snr, self._rng)
        return spoken

    @property
    def neural(self) -> tuple[bool, ...]:
        """Which kinds of voices there are, what is most like people first."""
        return (True, False) if self._speech.cast.has_neural else (False,)

    def noises(self, kind: str, hours: float) -> Iterator[Sound]:
        """Minutes of it, loud and soft."""
        left = int(hours * 3600)  # of a second's part there is no end: it has no whole samples
        while left > 0:
            sound = self.noise(kind, min(60, left))
            left -= max(1, len(sound) // RATE)
            loudness = np.float32(self._rng.uniform(0.1, 1.0))
            yield Sound(scenes.audio(sound * loudness).samples)


def all_said(stage: Stage, word: str, snr: float | None, count: int, *, neural: bool) -> list[Said]:
    beds = [stage.noise(kind, 40) for kind in ("babble", "corridor")]
    return [stage.said(word, snr, beds[i % 2], neural=neural) for i in range(count)]


def missed(hear: Hear, said: Iterable[Said]) -> tuple[float, list[float]]:
    """The share of the words that is not heard, and the delays of the others, in seconds."""
    delays, count = [], 0
    for each in said:
        count += 1
        early, late = IN_TIME
        times = [d.time - each.end for d in hear(each)]
        delays += [t for t in times if early < t < late][:1]
    return 1 - len(delays) / max(1, count), delays


def at_once(heads: Sequence[Head], judges: Sequence[Judge | None], smooth: int) -> Hear:
    """What `Heads` would hear of a sound block by block, several times as fast."""

    def hear(sound: Sound) -> list[Detection]:
        return Heads(heads, judges, smooth=smooth).hear(sound.embeddings, sound.samples)

    return hear


def ways(language: str, words: Sequence[str], smooth: int) -> dict[str, Hear]:
    """With the second stage, if there is one, and without."""
    heads = [head for word in words if (head := load_head(language, word))]
    second = judges(language, heads)
    found = {"": at_once(heads, [None] * len(heads), smooth)}
    if any(second):
        found = {
            " (two stages)": at_once(heads, second, smooth),
            " (head alone)": found[""],
        }
    return found


def block_by_block(make: Callable[[], Detector]) -> Hear:
    """What a new detector hears of a sound as from a microphone."""

    def hear(sound: Sound) -> list[Detection]:
        detector, found = make(), []
        for start in range(0, len(sound.samples), STEP):
            found += detector.feed(sound.samples[start : start + STEP])
        return found

    return hear


class Measured(NamedTuple):
    what: str
    value: float
    unit: str
    aim: str = ""


def measure(hours: float | None = None, language: str | None = None) -> Iterator[Measured]:
    """In English a first impression; with `hours` of noise, every language (or one) and every way
    of hearing. The environment may say both. Raises UserError where there are no voices."""
    given = os.environ.get("NL2ROBOT_BENCH_HOURS")
    if hours is None and given:
        try:
            hours = float(given)
        except ValueError as error:
            raise UserError(
                f"NL2ROBOT_BENCH_HOURS is {given!r}, which is no number of hours. Set it to 3, say."
            ) from error
    language = language or os.environ.get("NL2ROBOT_BENCH_LANGUAGE")
    if language not in (None, *WORDS):
        raise UserError(f"NL2ROBOT_BENCH_LANGUAGE is {language!r}. There are: {', '.join(WORDS)}.")
    count = 100 if hours else 10
    for code in [language] if language else WORDS if hours else ["en"]:
        stage = Stage(WORDS[code], takes=TAKES if hours else FEW_TAKES)
        hot, stop = WORDS[code].hot, WORDS[code].stop
        hot_ways, stop_ways = ways(code, [hot], SMOOTH), ways(code, stop, STOP_SMOOTH)
        yield from _heard(stage, hot, hot_ways, count, hot, aim="3", soon="100")
        for word in stop:
            name = f"{word} ({code})"
            yield from _heard(stage, name, stop_ways, count, word, soon="300")
        every = hours or 0.12
        yield from _alarms(stage, hot, hot_ways, every)
        yield from _alarms(stage, f"stop ({code})", stop_ways, every * STOP_SHARE)
        if hours and find(code):
            yield from _spotted(stage, count, hours / 40)
    yield from _cost(Stage(WORDS["en"], takes=FEW_TAKES))


def _heard(
    stage: Stage,
    name: str,
    ways: Mapping[str, Hear],
    count: int,
    word: str,
    *,
    aim: str = "",
    soon: str = "",
) -> Iterator[Measured]:
    delays: dict[str, list[float]] = {way: [] for way in ways}
    for neural in stage.neural:
        for snr in SNRS:
            said = all_said(stage, word, snr, count, neural=neural)
            where = "no noise" if snr is None else f"{snr} dB"
            where += ", neural voices" if neural else ", robotic voices"
            for way, hear in ways.items():
                share, times = missed(hear, said)
                delays[way] += times
                goal = aim if snr == 10 else ""
                yield Measured(f"{name}{way}: missed, {where}", share * 100, "%", goal)
    for way, times in delays.items():
        if times:
            median, late = statistics.median(times), float(np.quantile(times, 0.95))
            yield Measured(f"{name}{way}: delay, median", median * 1000, "ms", soon)
            yield Measured(f"{name}{way}: delay, 95th of 100", late * 1000, "ms")


def _alarms(stage: Stage, name: str, ways: Mapping[str, Hear], hours: float) -> Iterator[Measured]:
    """Alarms an hour; where there was none, below what it is with 95 % certainty."""
    total = dict.fromkeys(ways, 0)
    for kind, share in KINDS.items():
        counts = dict.fromkeys(ways, 0)
        listened = 0.0
        for sound in stage.noises(kind, hours * share):
            listened += len(sound.samples) / RATE / 3600
            for way, hear in ways.items():
                counts[way] += len(hear(sound))
        for way, count in counts.items():
            total[way] += count
            yield _an_hour(f"{name}{way}: false alarms, {kind}", count, listened)
    for way, count in total.items():
        yield _an_hour(f"{name}{way}: false alarms, all", count, hours)


def _an_hour(what: str, count: int, listened: float) -> Measured:
    if count == 0:
        return Measured(f"{what}, none in {listened:.2g} h: below", 3 / listened, "/h", "0.1")
    return Measured(f"{what}, {count} in {listened:.2g} h", count / listened, "/h", "0.1")


def _spotted(stage: Stage, count: int, hours: float) -> Iterator[Measured]:
    """The same word without a head, by the speech model: its first stage alone, and both."""
    language, word = stage.words.language, stage.words.hot
    recogniser = load(language)
    ways = {
        f" by {name}": block_by_block(partial(Spotter, recogniser, word, second_stage=second))
        for name, second in (("keyword list", False), ("two stages", True))
    }
    yield from _heard(stage, word, ways, count, word, aim="3")
    yield from _alarms(stage, word, ways, hours)


def _cost(stage: Stage) -> Iterator[Measured]:
    """What it costs to listen to somebody who talks on and on."""
    sound = Sound(np.concatenate([n.samples for n in stage.noises("babble", 30 / 3600)]))
    detectors: dict[str, Callable[[], Detector]] = {
        "hot word": lambda: HotWord("en"),
        "stop": lambda: StopWord("en"),
    }
    if find("en"):
        detectors["any word, by the speech model"] = lambda: Spotter(load("en"), "hey robot")
    for name, make in detectors.items():
        before = megabytes(os.getpid())
        hear = block_by_block(make)
        wall, used = time.perf_counter(), time.process_time()
        hear(sound)
        seconds = len(sound.samples) / RATE
        yield Measured(f"{name}: real-time factor", (time.perf_counter() - wall) / seconds, "")
        yield Measured(f"{name}: of a core", (time.process_time() - used) / seconds * 100, "%")
        yield Measured(f"{name}: memory more", megabytes(os.getpid()) - before, "MB")
