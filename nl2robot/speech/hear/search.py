"""The texts that a neural recogniser may write down for a sound, and how likely each of them is.

    sound = Sound(network, states, longest=40)
    sound.texts()                                # what is said, the likeliest first
    sound.texts(expectation)                     # the same, where some things are likely to be said
    sound.likelihoods(["go to the pharmacy"])    # of these words, with any punctuation

What it asks of a recogniser is `Network`: it tells which subwords may follow some others, given the
sound. `moonshine` and `whisper` are such networks.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from nl2robot.speech.hear.expectation import Expectation

WIDTH: Final = 6  # texts that are followed side by side
EXPECTED: Final = 0.25  # weight of what is likely to be said next to the sound
FAR: Final = 10.0  # behind the best subword (log probability)
HOPELESS: Final = 2.0  # a text that is so far behind a finished one (log likelihood) will not win
_LONGEST_ROUND: Final = 8  # subwords
PUNCTUATION: Final = ".?!,"


class Memory(Protocol):
    """What a network remembers of the subwords before."""

    def rows(self, kept: Sequence[int]) -> Memory:
        """The same for some of the texts only, in this order; a text may come twice."""
        ...


class Tokenizer(Protocol):
    """Text <-> the subwords that a network writes."""

    @property
    def begin(self) -> tuple[int, ...]:
        """What stands before every text."""
        ...

    @property
    def end(self) -> int: ...

    def of(self, text: str) -> list[int]:
        """The subwords of a text, without the begin and the end."""
        ...

    def text(self, numbers: Sequence[int]) -> str:
        """What these subwords write; the begin and the end write nothing."""
        ...


class Network(Protocol):
    """A recogniser that hears an utterance as a whole and writes one subword after the other."""

    @property
    def subwords(self) -> Tokenizer: ...

    def listen(self, samples: NDArray[np.int16]) -> Sound:
        """One utterance, at most about half a minute."""
        ...

    def expectation(self, sentences: Sequence[str]) -> Expectation:
        """What is likely to be said, from sentences as they are written."""
        ...

    def decode(
        self, states: Any, numbers: NDArray[np.int64], memory: Any
    ) -> tuple[NDArray[np.float32], Memory]:
        """Log probabilities of what follows each of these subwords (texts x subwords x all there
        are), and what to remember. `states` is what was made of the sound; without a memory the
        numbers are the beginning."""
        ...


@dataclass(frozen=True)
class Text:
    """One way to write down a sound."""

    text: str
    likelihood: float  # log, of the text given the sound


class Sound:
    """An utterance that was listened to."""

    def __init__(self, network: Network, states: Any, longest: int) -> None:
        """`longest`: subwords that can have been said in it."""
        self._network = network
        self._states = states
        self._longest = longest
        subwords = network.subwords
        self._ends = [subwords.end, *(subwords.of("a" + mark)[-1] for mark in PUNCTUATION)]

    def texts(self, expectation: Expectation | None = None, width: int = WIDTH) -> list[Text]:
        """The likeliest texts, of sound and expectation together; at least one."""
        subwords = self._network.subwords
        open_ = [_Path(subwords.begin, 0.0, 0.0)]
        done: list[_Path] = []
        memory: Memory | None = None
        for _ in range(self._longest):
            # Of the beginning all, then only what has come.
            new = [path.numbers if memory is None else path.numbers[-1:] for path in open_]
            sounds, memory = self._network.decode(self._states, np.array(new, np.int64), memory)
            ways = [
                (
                    path.score + float(score),
                    at,
                    number,
                    path.likelihood + float(sounds[at, -1, number]),
                )
                for at, path in enumerate(open_)
                for number, score in _best(sounds[at, -1], expectation, path.numbers, width)
            ]
            going_on: list[tuple[int, _Path]] = []
            for score, at, number, likelihood in sorted(ways, key=lambda way: -way[0]):
                path = _Path((*open_[at].numbers, number), score, likelihood)
                if number == subwords.end:
                    done.append(path)
                    continue
                if _goes_round(path.numbers):
                    continue
                going_on.append((at, path))
                if len(going_on) == width:
                    break  # ends that are less likely than all these are not worth keeping
            done.sort(key=lambda path: -path.score)
            if not going_on:
                break
            if done and going_on[0][1].score < done[: max(1, width // 2)][-1].score - HOPELESS:
                break
            open_ = [path for _, path in going_on]
            memory = memory.rows([at for at, _ in going_on])
        return [
            Text(subwords.text(path.numbers), path.likelihood)
            for path in (done or open_)[: 2 * width]
        ]

    def likelihoods(self, texts: Sequence[str]) -> list[float]:
        """The log likelihood of each text, whatever punctuation it ends with."""
        subwords = self._network.subwords
        written = [subwords.of(text.rstrip(PUNCTUATION)) for text in texts]
        if not written:
            return []
        numbers = np.full((len(written), max(1, *map(len, written))), subwords.end, np.int64)
        for row, text in zip(numbers, written, strict=True):
            row[: len(text)] = text
        # What all texts begin with is the same for all of them.
        first, memory = self._network.decode(self._states, np.array([subwords.begin]), None)
        memory = memory.rows([0] * len(written))
        rest, _ = self._network.decode(self._states, numbers, memory)
        return [
            float(sum(first[0, -1, text[:1]]))
            + float(rows[np.arange(len(text) - 1), text[1:]].sum())
            + float(
                np.logaddexp.reduce((rows[len(text) - 1] if text else first[0, -1])[self._ends])
            )
            for rows, text in zip(rest, written, strict=True)
        ]


@dataclass(frozen=True)
class _Path:
    """A text that is being written."""

    numbers: tuple[int, ...]
    score: float  # of sound and expectation together
    likelihood: float  # of the sound alone


def _goes_round(numbers: tuple[int, ...]) -> bool:
    """Whether a text says the same again and again, as a network does of mere noise."""
    return any(
        numbers[-length:] == numbers[-2 * length : -length] == numbers[-3 * length : -2 * length]
        for length in range(1, _LONGEST_ROUND + 1)
        if len(numbers) >= 3 * length
    )


def _best(
    sounds: NDArray[np.float32],
    expectation: Expectation | None,
    numbers: tuple[int, ...],
    width: int,
) -> list[tuple[int, float]]:
    """The subwords that may follow these, with their scores."""
    scores = sounds
    if expectation is not None:
        scores = sounds + EXPECTED * expectation.after(numbers)
    # Almost all are far behind; to sort those out first takes a tenth of the time.
    near = np.flatnonzero(scores > scores.max() - FAR)
    if len(near) <= width:
        near = np.arange(len(scores))
    best = near[np.argpartition(-scores[near], width)[: width + 1]]
    return [(int(number), float(scores[number])) for number in best]
