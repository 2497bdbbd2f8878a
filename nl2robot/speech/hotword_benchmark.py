"""How well hot words and stop words are heard: misses, false alarms an hour, delay, cost.

    nl2robot bench hotword                          # a minute or two: a first impression
    NL2ROBOT_BENCH_HOURS=3 nl2robot bench hotword   # the tables of docs/hotword.md

On synthesised speech in voices that no head was trained with, in babble of such voices and in a
corridor. The English ones are in part neural, and no head was trained with any neural voice.
"""

from __future__ import annotations

import os
import statistics
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Final, NamedTuple

import numpy as np

from nl2robot.benchmark import megabytes
from nl2robot.errors import UserError
from nl2robot.models import find
from nl2robot.speech import scenes
from nl2robot.speech.audio import RATE, Samples
from nl2robot.speech.embeddings import STEP, embed
from nl2robot.speech.hotword import SMOOTH, Detection, Detector, Heads, HotWord
from nl2robot.speech.hotword_corpus import Half, Speech, seeded, silence, talk, words_of
from nl2robot.speech.hotword_head import Head, load_head
from nl2robot.speech.hotword_words import WORDS, Words
from nl2robot.speech.recogniser import load
from nl2robot.speech.scenes import Signal
from nl2robot.speech.spotting import Spotter

Hear = Callable[[Samples], list[Detection]]
"""All that is heard in a sound."""

SNRS: Final = (None, 20, 10, 5, 0)  # dB; None: no noise
KINDS: Final = ("talk", "babble", "corridor", "corridor with talk")
SAYINGS: Final = 200  # of which the babble is mixed
IN_TIME: Final = (-0.35, 1.2)
"""Seconds from a word's end within which its detection counts."""


@dataclass(frozen=True, eq=False)
class Said:
    """A word that was said."""

    samples: Samples
    end: float  # seconds


class Stage:
    """The people, words and noises of an evaluation."""

    def __init__(self, words: Words, seed: int = 1) -> None:
        self.words = words
        self._rng = seeded(seed, words.language, "evaluation")
        avoid = frozenset(w for word in (*words.stop, words.hot) for w in words_of(word))
        self._speech = Speech(words.language, Half.EVALUATION, self._rng, avoid)

    @cached_property
    def _sayings(self) -> list[Signal]:
        return [self._speech.say(self._speech.remark()) for _ in range(SAYINGS)]

    def said(
        self, word: str, snr: float | None, noise: Signal, *, neural: bool | None = None
    ) -> Said:
        rng = self._rng
        spoken = self._speech.say(word, neural=neural)
        sound = np.concatenate([silence(1.6), spoken, silence(1.2)])
        if rng.random() < 0.5:
            sound = scenes.echoing(sound, scenes.echo(rng, 0.4))[: len(sound)]
        if snr is not None:
            sound = scenes.at_snr(sound, noise, snr, rng)
        peak = max(float(np.abs(sound).max()), 1e-6)
        sound = np.asarray(sound * (rng.uniform(0.1, 0.7) / peak), np.float32)
        return Said(scenes.audio(sound).samples, 1.6 + len(spoken) / RATE)

    def noise(self, kind: str, seconds: float) -> Signal:
        """In which nobody says the words."""
        if kind == "corridor":
            return scenes.corridor(seconds, self._rng)
        if kind == "babble":
            voices = self._rng.choice(SAYINGS, int(self._rng.integers(12, 33)), replace=False)
            return scenes.babble([self._sayings[i] for i in voices], seconds, self._rng)
        spoken = np.concatenate(list(talk(self._speech, seconds, lambda: None)))
        if kind == "corridor with talk":
            length = min(len(spoken), int(seconds * RATE))
            noise = scenes.corridor(length / RATE, self._rng)
            snr = float(self._rng.uniform(0, 15))
            return scenes.at_snr(spoken[:length], noise, snr, self._rng)
        return spoken

    def noises(self, kind: str, hours: float) -> Iterator[Samples]:
        """Minutes of it, loud and soft."""
        left = hours * 3600
        while left > 0:
            sound = self.noise(kind, min(60.0, left))
            left -= len(sound) / RATE
            yield scenes.audio(sound * np.float32(self._rng.uniform(0.1, 1.0))).samples


def all_said(
    stage: Stage, word: str, snr: float | None, count: int, *, neural: bool | None = None
) -> list[Said]:
    beds = [stage.noise(kind, 40) for kind in ("babble", "corridor")]
    return [stage.said(word, snr, beds[i % 2], neural=neural) for i in range(count)]


def missed(hear: Hear, said: Iterable[Said]) -> tuple[float, list[float]]:
    """The share of the words that is not heard, and the delays of the others, in seconds."""
    delays, count = [], 0
    for each in said:
        count += 1
        early, late = IN_TIME
        times = [d.time - each.end for d in hear(each.samples)]
        delays += [t for t in times if early < t < late][:1]
    return 1 - len(delays) / max(1, count), delays


def alarms(hear: Hear, noises: Iterable[Samples]) -> tuple[int, float]:
    """How often a word is heard that nobody said, and in how many hours."""
    count, seconds = 0, 0.0
    for samples in noises:
        count += len(hear(samples))
        seconds += len(samples) / RATE
    return count, seconds / 3600


def at_once(heads: Sequence[Head], smooth: int) -> Hear:
    """What `Heads` would hear of a sound block by block, several times as fast."""

    def hear(samples: Samples) -> list[Detection]:
        return Heads(heads, smooth=smooth).hear(embed(samples))

    return hear


def block_by_block(make: Callable[[], Detector]) -> Hear:
    """What a new detector hears of a sound as from a microphone."""

    def hear(samples: Samples) -> list[Detection]:
        detector, found = make(), []
        for start in range(0, len(samples), STEP):
            found += detector.feed(samples[start : start + STEP])
        return found

    return hear


class Measured(NamedTuple):
    what: str
    value: float
    unit: str
    aim: str = ""


def measure(hours: float | None = None) -> Iterator[Measured]:
    """In English a first impression; with `hours` of every noise, every language and every way of
    hearing. $NL2ROBOT_BENCH_HOURS says so too. Raises UserError where there are no voices."""
    given = os.environ.get("NL2ROBOT_BENCH_HOURS")
    if hours is None and given:
        try:
            hours = float(given)
        except ValueError as error:
            raise UserError(
                f"NL2ROBOT_BENCH_HOURS is {given!r}, which is no number of hours. Set it to 3, say."
            ) from error
    count = 200 if hours else 20
    for code in WORDS if hours else ["en"]:
        stage = Stage(WORDS[code])
        yield from _word(stage, WORDS[code].hot, SMOOTH, count, hours or 0.03)
        yield from _stop(stage, count, hours or 0.03)
        if hours and find(code):
            yield from _spotted(stage, count // 4, hours / 12)
    yield from _cost(Stage(WORDS["en"]))


def _word(stage: Stage, word: str, smooth: int, count: int, hours: float) -> Iterator[Measured]:
    head = load_head(stage.words.language, word)
    assert head is not None
    yield from _heard(stage, word, at_once([head], smooth), count, "3", "100")
    for kind in KINDS:
        yield _an_hour(f"{word}: false alarms, {kind}", at_once([head], smooth), stage, kind, hours)


def _stop(stage: Stage, count: int, hours: float) -> Iterator[Measured]:
    language = stage.words.language
    heads = [head for word in stage.words.stop if (head := load_head(language, word))]
    hear = at_once(heads, 1)
    for head in heads:
        yield from _heard(stage, f"{head.word} ({language})", hear, count, "", "300", head.word)
    for kind in KINDS:
        yield _an_hour(f"stop ({language}): false alarms, {kind}", hear, stage, kind, hours)


def _heard(
    stage: Stage, name: str, hear: Hear, count: int, aim: str, soon: str, word: str = ""
) -> Iterator[Measured]:
    delays: list[float] = []
    for snr in SNRS:
        share, times = missed(hear, all_said(stage, word or name, snr, count))
        delays += times
        where = "no noise" if snr is None else f"{snr} dB"
        yield Measured(f"{name}: missed, {where}", share * 100, "%", aim if snr == 10 else "")
    if delays:
        yield Measured(f"{name}: delay, median", statistics.median(delays) * 1000, "ms", soon)
        yield Measured(f"{name}: delay, 95th of 100", float(np.quantile(delays, 0.95)) * 1000, "ms")


def _an_hour(what: str, hear: Hear, stage: Stage, kind: str, hours: float) -> Measured:
    """Alarms an hour; where there was none, below what it is with 95 % certainty."""
    count, listened = alarms(hear, stage.noises(kind, hours))
    if count == 0:
        return Measured(f"{what}, none in {listened:.2g} h: below", 3 / listened, "/h", "0.1")
    return Measured(f"{what}, {count} in {listened:.2g} h", count / listened, "/h", "0.1")


def _spotted(stage: Stage, count: int, hours: float) -> Iterator[Measured]:
    """The same word without a head, by the speech model: its first stage alone, and both."""
    language, word = stage.words.language, stage.words.hot
    for name, second in (("keyword list", False), ("two stages", True)):
        recogniser = load(language)
        hear = block_by_block(partial(Spotter, recogniser, word, second_stage=second))
        yield from _heard(stage, f"{word} by {name}", hear, count, "3", "", word)
        for kind in KINDS:
            yield _an_hour(f"{word} by {name}: false alarms, {kind}", hear, stage, kind, hours)


def _cost(stage: Stage) -> Iterator[Measured]:
    """What it costs to listen to somebody who talks on and on."""
    samples = np.concatenate(list(stage.noises("babble", 30 / 3600)))
    detectors: dict[str, Callable[[], Detector]] = {"hot word": lambda: HotWord("en")}
    if find("en"):
        detectors["two stages"] = lambda: Spotter(load("en"), "hey robot")
    for name, make in detectors.items():
        before = megabytes(os.getpid())
        hear = block_by_block(make)
        wall, used = time.perf_counter(), time.process_time()
        hear(samples)
        seconds = len(samples) / RATE
        yield Measured(f"{name}: real-time factor", (time.perf_counter() - wall) / seconds, "")
        yield Measured(f"{name}: of a core", (time.process_time() - used) / seconds * 100, "%")
        yield Measured(f"{name}: memory more", megabytes(os.getpid()) - before, "MB")
