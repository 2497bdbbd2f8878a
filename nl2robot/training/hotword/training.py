"""Trains the heads of hot words on synthesised speech: python -m nl2robot.training.hotword.training

    --lang en            the words of a language (default: of all)
    --word "hey pepper"  one word of your own, into your data folder
    --absent FOLDER      recordings of people who do not say the words: of your ward, say
    --seed 0             the same seed, the same heads; several: as many heads, joined to one

Needs the voices (`pip install 'nl2robot[voices]'`), and half an hour of two cores a
word. Nothing but numpy learns here: the embeddings are frozen, and a head is small.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from itertools import chain, islice
from multiprocessing import get_context
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from nl2robot.bench.hotword_corpus import (
    Places,
    Speech,
    places,
    seeded,
    shuffled,
    silence,
    talk,
    words_of,
)
from nl2robot.bench.hotword_voices import Half, trimmed
from nl2robot.errors import UserError
from nl2robot.paths import data_file, made
from nl2robot.speech import scenes
from nl2robot.speech.audio import RATE, read
from nl2robot.speech.embeddings import SIZE, STEP_SECONDS, Embeddings, embed
from nl2robot.speech.hotword.head import SHIPPED, Head, forward, probability
from nl2robot.speech.hotword.words import WORDS
from nl2robot.speech.scenes import Signal

SCENES: Final = 3000  # in which a word is said
SAYINGS: Final = 240  # of it in neural voices, each higher and lower in many scenes
REMARKS: Final = 120  # in neural voices, of which talk and babble are made
TALK: Final = 60  # minutes without any of the words, in each language
BABBLE: Final = 80  # minutes, with the people of each language
NEAR: Final = 30  # minutes, with what sounds like a word
NEAR_SAID: Final = 120  # of it in neural voices
ABSENT: Final = 2  # times that recordings without the words are heard, each time elsewhere
PIECE: Final = 20  # seconds of them at a time
HIDDEN: Final = 64
EPOCHS: Final = 14
FITS: Final = 3  # from other beginnings, joined to one head
BATCH: Final = 1024
RATE_OF_LEARNING: Final = 1.5e-3
DECAY: Final = 1e-4

# Embeddings a head looks at: 16 are 2 s, 6 are 1.2 s.
HOT_STEPS: Final = 9
STOP_STEPS: Final = 6
# Seconds from a word's end within which it has to be heard, and what is too near to it to be
# called its absence.
HOT_WINDOW: Final = 0.32
STOP_WINDOW: Final = 0.24
HOT_THRESHOLD: Final = 0.8
STOP_THRESHOLD: Final = 0.5
PROCESSES: Final = 2
RECORDINGS: Final = (".wav", ".ogg", ".flac", ".mp3", ".webm")
BLURRED: Final = (-0.3, 0.8)
NARROW: Final = 0.12
CLIPPED: Final = 0.06
"""The shares of sounds from a narrow band, and from a microphone that was too near."""


@dataclass(frozen=True, eq=False)
class Examples:
    """Embeddings of sounds in a row, and where in them a window may end."""

    embeddings: Embeddings
    ends: NDArray[np.int64]
    labels: NDArray[np.float32]


@dataclass
class Collector:
    """Gathers sounds as examples."""

    def __post_init__(self) -> None:
        self._embeddings: list[Embeddings] = []
        self._ends: list[NDArray[np.int64]] = []
        self._labels: list[NDArray[np.float32]] = []
        self._length = 0

    def add(self, sound: Signal, end: float | None = None, window: float = 0.0) -> None:
        """A sound, in which a word ends at `end` seconds or not at all."""
        embeddings = embed(scenes.audio(sound).samples)
        times = (np.arange(len(embeddings)) + 1) * STEP_SECONDS
        if end is None:
            said, use = np.zeros(len(times), bool), np.ones(len(times), bool)
        else:
            after = times - end
            said = (after >= 0) & (after < window)
            use = said | (after < BLURRED[0]) | (after > BLURRED[1])
        use[: _LONGEST - 1] = False  # what came before is not known there
        self._ends.append(np.flatnonzero(use) + self._length)
        self._labels.append(said[use].astype(np.float32))
        self._embeddings.append(embeddings)
        self._length += len(embeddings)

    def examples(self) -> Examples:
        return Examples(
            np.concatenate(self._embeddings),
            np.concatenate(self._ends),
            np.concatenate(self._labels),
        )


_LONGEST: Final = max(HOT_STEPS, STOP_STEPS)


def word_scene(said: Signal, where: Places, rng: np.random.Generator) -> tuple[Signal, float]:
    """The word, with something before and after it, somewhere. And where it ends, in seconds."""
    lead = silence(_LONGEST * STEP_SECONDS + float(rng.uniform(0.1, 0.6)))
    if rng.random() < 0.3:  # goes on from talk
        before = where.remark()[-int(1.2 * RATE) :]
        lead = np.concatenate([lead, before, silence(float(rng.uniform(0.08, 0.5)))])
    tail = silence(float(rng.uniform(0.6, 1.0)))
    if rng.random() < 0.4:  # and goes on at once with what is wanted
        after = where.remark()[: int(0.9 * RATE)]
        tail = np.concatenate([silence(float(rng.uniform(0.02, 0.4))), after])
    sound = np.concatenate([lead, said / max(scenes.level(said), 1e-6) * 0.1, tail])
    return somewhere(sound, where, rng), (len(lead) + len(said)) / RATE


def somewhere(sound: Signal, where: Places, rng: np.random.Generator) -> Signal:
    """The sound in a room, in noise, near or far."""
    if rng.random() < 0.5:
        echoing = scenes.echoing(sound, scenes.echo(rng, float(rng.uniform(0.15, 0.7))))
        sound = echoing[: len(sound)]
    kind = str(rng.choice(["babble", "corridor", "noise", "none"], p=[0.45, 0.25, 0.15, 0.15]))
    if kind != "none":
        sound = scenes.at_snr(sound, where.noise(kind), float(rng.uniform(-1, 22)), rng)
    return microphone(sound, rng)


def microphone(sound: Signal, rng: np.random.Generator) -> Signal:
    """As a microphone hears it: loud or from far away, sometimes too loud for it, sometimes no
    more of it than a telephone carries."""
    import soxr

    if rng.random() < NARROW:
        narrow = soxr.resample(sound, RATE, RATE // 2)
        sound = np.resize(soxr.resample(narrow, RATE // 2, RATE), len(sound))
    peak = max(float(np.abs(sound).max()), 1e-6)
    decibels = rng.uniform(1, 12) if rng.random() < CLIPPED else rng.uniform(-34, -0.5)
    return np.asarray(np.clip(sound * (10 ** (float(decibels) / 20) / peak), -1, 1), np.float32)


def talking(
    said: Callable[[], Signal], where: Places, minutes: float, rng: np.random.Generator
) -> Collector:
    """People who talk on and on, somewhere, and do not say the words."""
    collector = Collector()
    for _ in range(int(minutes * 2)):
        lead = silence(_LONGEST * STEP_SECONDS)
        sound = np.concatenate([lead, *talk(30, said, rng)])
        collector.add(somewhere(sound, where, rng))
    return collector


def noises(where: Places, minutes: int, rng: np.random.Generator) -> Collector:
    """Only noise: above all many people who talk at once, in whom anything may be heard."""
    collector = Collector()
    for kind in ("corridor", "noise"):
        for bed in where.noises[kind]:
            collector.add(bed * np.float32(rng.uniform(0.02, 1)))
    for _ in range(minutes):
        babble = where.babble(60)
        if rng.random() < 0.3:
            babble = scenes.echoing(babble, scenes.echo(rng, float(rng.uniform(0.15, 0.7))))
        collector.add(microphone(babble, rng))
    collector.add(silence(10))
    return collector


def fit(
    examples: Examples, steps: int, rng: np.random.Generator, epochs: int = EPOCHS
) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any], NDArray[Any]]:
    """Weights by Adam on the cross entropy; what is often mistaken is shown more often."""
    flat, offsets = examples.embeddings, np.arange(steps) - steps + 1
    mean, scale = flat.mean(0), flat.std(0) + 1e-3
    flat = ((flat - mean) / scale).astype(np.float32)
    size = steps * SIZE
    weights: list[NDArray[Any]] = [
        (rng.standard_normal((size, HIDDEN)) * np.sqrt(2 / size)).astype(np.float32),
        np.zeros(HIDDEN, np.float32),
        (rng.standard_normal((HIDDEN, 1)) * np.sqrt(1 / HIDDEN)).astype(np.float32),
        np.full(1, -2.0, np.float32),
    ]
    first = [np.zeros_like(w) for w in weights]
    second = [np.zeros_like(w) for w in weights]
    positive = np.flatnonzero(examples.labels > 0)
    negative = np.flatnonzero(examples.labels == 0)
    hard = negative
    step = 0
    for epoch in range(epochs):
        share = rng.permutation(negative)[: len(negative) // 3]
        order = np.concatenate([share, rng.choice(hard, len(share)), np.tile(positive, 4)])
        order = rng.permutation(order)
        speed = RATE_OF_LEARNING * 0.5 * (1 + np.cos(np.pi * epoch / epochs))
        for at in range(0, len(order), BATCH):
            chosen = order[at : at + BATCH]
            inputs = flat[examples.ends[chosen][:, None] + offsets].reshape(len(chosen), size)
            layer, scores = forward(tuple(weights), inputs)
            error = (probability(scores) - examples.labels[chosen])[:, None] / len(chosen)
            back = (error @ weights[2].T) * (layer > 0)
            gradients = [inputs.T @ back, back.sum(0), layer.T @ error, error.sum(0)]
            step += 1
            for i, gradient in enumerate(gradients):
                first[i] += 0.1 * (gradient - first[i])
                second[i] += 0.001 * (gradient**2 - second[i])
                ahead = first[i] / (1 - 0.9**step)
                weights[i] -= speed * (
                    ahead / (np.sqrt(second[i] / (1 - 0.999**step)) + 1e-8) + DECAY * weights[i]
                )
        if epoch % 3 == 2:
            scored = np.concatenate(
                [
                    forward(
                        tuple(weights),
                        flat[examples.ends[part][:, None] + offsets].reshape(len(part), size),
                    )[1]
                    for part in np.array_split(negative, len(negative) // 8192 + 1)
                ]
            )
            hard = negative[np.argsort(scored)[-max(200, len(negative) // 50) :]]
    # The scaling of the embeddings goes into the weights: one thing less to load.
    repeated = np.tile(scale, steps)[:, None]
    hidden = weights[0] / repeated
    return (hidden, weights[1] - np.tile(mean, steps) @ hidden, weights[2], weights[3])


def both(first: Examples, second: Examples) -> Examples:
    return Examples(
        np.concatenate([first.embeddings, second.embeddings]),
        np.concatenate([first.ends, second.ends + len(first.embeddings)]),
        np.concatenate([first.labels, second.labels]),
    )


def _corpus(code: str, seed: int) -> tuple[Places, Examples]:
    """What every head learns not to be its word, in one language."""
    rng = seeded(seed, code, "corpus")
    speech = Speech(code, Half.TRAINING, rng, everything(), REMARKS)
    where = places([speech], speech.rng)
    talked = talking(speech.talked, where, TALK, speech.rng).examples()
    return where, both(talked, noises(where, BABBLE, speech.rng).examples())


def everything() -> frozenset[str]:
    """All words of which any is listened for."""
    said = (word for each in WORDS.values() for word in (*each.stop, each.hot))
    return frozenset(part for word in said for part in words_of(word))


# What all heads share, and the processes that train them inherit.
_corpora: Final[dict[str, tuple[Places, Examples]]] = {}
_recordings: Final[list[Signal]] = []  # in which nobody says the words


def recorded(folder: Path) -> list[Signal]:
    """All recordings of a folder and those in it, equally loud, in pieces. Raises AudioError for
    one that cannot be read."""
    files = sorted(file for file in folder.rglob("*") if file.suffix.lower() in RECORDINGS)
    sounds = (trimmed(scenes.signal(read(file))) for file in files)
    pieces = (
        sound[at : at + PIECE * RATE]
        for sound in sounds
        for at in range(0, len(sound), PIECE * RATE)
    )
    return [piece / max(scenes.level(piece), 1e-6) * np.float32(0.1) for piece in pieces]


def absent(recordings: Sequence[Signal], where: Places, rng: np.random.Generator) -> Examples:
    """People who do not say the words, in other places than where they were recorded."""
    collector = Collector()
    for _ in range(ABSENT):
        order = iter([recordings[i] for i in rng.permutation(len(recordings))])
        while sounds := list(islice(order, int(rng.integers(4, 12)))):
            pauses = (silence(float(rng.exponential(0.35))) for _ in sounds)
            spoken = chain.from_iterable(zip(sounds, pauses, strict=True))
            lead = silence(_LONGEST * STEP_SECONDS)
            collector.add(somewhere(np.concatenate([lead, *spoken]), where, rng))
    return collector.examples()


@dataclass(frozen=True)
class Task:
    """A head to be trained."""

    language: str
    word: str
    stop: bool
    near: tuple[str, ...]
    folder: Path

    def examples(self, seed: int) -> Examples:
        rng = seeded(seed, self.language, self.word)
        avoid = everything() | set(words_of(self.word))
        speech = Speech(self.language, Half.TRAINING, rng, avoid)
        where, talked = _corpora[self.language]
        for code in sorted(_corpora.keys() - {self.language}):
            talked = both(talked, _corpora[code][1])
        called = speech.saying(lambda: _called(self.word, rng), SAYINGS)
        collector = Collector()
        for _ in range(SCENES):
            sound, end = word_scene(called(), where, rng)
            collector.add(sound, end, STOP_WINDOW if self.stop else HOT_WINDOW)
        texts = shuffled(self.near, rng) if self.near else None
        alike = speech.saying(lambda: next(texts), NEAR_SAID) if texts else where.remark

        def said() -> Signal:
            return alike() if rng.random() < 0.7 else where.remark()

        close = talking(said, where, NEAR, rng).examples()
        if _recordings:
            close = both(close, absent(_recordings, where, rng))
        return both(both(collector.examples(), close), talked)

    def done(self, seed: int) -> Head:
        examples, rng = self.examples(seed), seeded(seed, self.language, self.word, "fit")
        steps = STOP_STEPS if self.stop else HOT_STEPS
        threshold = STOP_THRESHOLD if self.stop else HOT_THRESHOLD
        return joined([Head(self.word, threshold, fit(examples, steps, rng)) for _ in range(FITS)])


def _called(word: str, rng: np.random.Generator) -> str:
    """The word as people call it: at once, or with a pause in it."""
    if rng.random() < 0.2:
        word = word.replace(" ", ", ", 1)
    return word + str(rng.choice(["", "", "!", "!", ".", ",", "?"]))


def tasks(code: str) -> list[Task]:
    words = WORDS[code]
    folder = SHIPPED / code
    near = {word: tuple(words.near.get(word, ())) for word in (words.hot, *words.stop)}
    return [
        Task(code, words.hot, False, (*near[words.hot], *words.hot.split()), folder),
        *(Task(code, word, True, near[word], folder) for word in words.stop),
    ]


def trained(todo: Sequence[Task], seed: int) -> list[Head]:
    """In processes, for espeak-ng keeps one voice at a time; the corpus is made once for all."""
    with ProcessPoolExecutor(PROCESSES, get_context("fork")) as pool:
        corpora = pool.map(_corpus, WORDS, [seed] * len(WORDS))
        _corpora.update(zip(WORDS, corpora, strict=True))
    with ProcessPoolExecutor(PROCESSES, get_context("fork")) as pool:
        return list(pool.map(Task.done, todo, [seed] * len(todo)))


def joined(heads: Sequence[Head]) -> Head:
    """One head whose score is the mean of theirs: they seldom mistake the same sounds."""
    hidden, hidden_bias, score, score_bias = zip(*(head.weights for head in heads), strict=True)
    weights = (
        np.concatenate(hidden, axis=1),
        np.concatenate(hidden_bias),
        np.concatenate(score) / len(heads),
        np.mean(score_bias, axis=0),
    )
    return replace(heads[0], weights=weights)


def _read_or_exit(folder: Path) -> list[Signal]:
    try:
        found = recorded(folder)
    except UserError as error:
        raise SystemExit(str(error)) from error
    if not found:
        raise SystemExit(
            f"There is no recording in {folder}. Give a folder of {', '.join(RECORDINGS)} files."
        )
    return found


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description="Train the heads of hot words.")
    parser.add_argument("--lang", choices=sorted(WORDS), help="of one language (default: all)")
    parser.add_argument("--word", help="one word of your own, into your data folder")
    parser.add_argument(
        "--seed", type=int, nargs="+", default=[0], help="several: as many heads, joined to one"
    )
    parser.add_argument("--absent", type=Path, metavar="FOLDER", help="recordings without the word")
    options = parser.parse_args(arguments)
    code = options.lang or "en"
    todo = [task for each in WORDS for task in tasks(each)]
    todo = [task for task in todo if options.lang in (None, task.language)]
    if options.word:
        near = tuple(options.word.split()) if " " in options.word.strip() else ()
        todo = [Task(code, options.word, False, near, data_file("hotwords") / code)]
    if options.absent:  # now, for what cannot be read should not be told after half an hour
        _recordings.extend(_read_or_exit(options.absent))
    rounds = [trained(todo, seed) for seed in options.seed]
    for task, *heads in zip(todo, *rounds, strict=True):
        print(joined(heads).save(made(task.folder)))


if __name__ == "__main__":
    main()
