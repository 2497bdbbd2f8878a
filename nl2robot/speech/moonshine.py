"""Moonshine, a small neural recogniser of English (Jeffries et al. 2024): sound -> texts with their
likelihood, and how likely given texts are.

    moonshine = Moonshine(folder)
    sound = moonshine.listen(audio.samples)
    sound.texts()                                # what is said, the likeliest first
    sound.texts(expectation)                     # the same, where some things are likely to be said
    sound.likelihoods(["go to the pharmacy"])    # of these words, with any punctuation

It hears all of an utterance at once, after its end, and writes it as people write: "Go to the
pharmacy, then say hello."
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from nl2robot.models import ModelError, find
from nl2robot.speech.audio import RATE, Samples
from nl2robot.speech.expectation import Expectation
from nl2robot.speech.subwords import BEGIN, END, Subwords

_log = logging.getLogger(__name__)

WIDTH: Final = 6  # texts that are followed side by side
EXPECTED: Final = 0.25  # weight of what is likely to be said next to the sound
HOPELESS: Final = 2.0  # a text that is so far behind a finished one (log likelihood) will not win
QUICKEST: Final = 6.5  # subwords in a second: who writes more repeats themselves
_MORE: Final = 8  # than that, whatever the length
_LONGEST_ROUND: Final = 8  # subwords
_SHORTEST: Final = RATE // 4  # samples the encoder needs
_HEADS, _PER_HEAD = 8, 36
_OF_SOUND: Final = ".encoder."  # in the names of what is remembered
_PUNCTUATION: Final = ".?!,"


@dataclass(frozen=True)
class Text:
    """One way to write down a sound."""

    text: str
    likelihood: float  # log, of the text given the sound


class Moonshine:
    """A loaded model. May be used from several threads at once."""

    def __init__(self, folder: Path) -> None:
        """`folder` holds encoder, decoder and subwords. Raises ModelError if they are no good."""
        import onnxruntime

        how = onnxruntime.SessionOptions()
        # Threads that wait for each other by spinning take several times as long on a busy machine.
        how.add_session_config_entry("session.intra_op.allow_spinning", "0")
        try:
            self._encoder = onnxruntime.InferenceSession(folder / "encoder_model.ort", how)
            self._decoder = onnxruntime.InferenceSession(folder / "decoder_model_merged.ort", how)
            self.subwords = Subwords.load(folder / "tokenizer.bin")
        except Exception as error:  # onnxruntime raises many kinds
            raise ModelError(
                f"The speech model in {folder} cannot be used. "
                "Run `nl2robot models get en --again` to fetch it again."
            ) from error
        self._outputs = [output.name for output in self._decoder.get_outputs()]
        self._memory = [i.name for i in self._decoder.get_inputs() if i.name.startswith("past_")]
        self._ends = [END, *(self.subwords.of("a" + mark)[-1] for mark in _PUNCTUATION)]

    def expectation(self, sentences: Sequence[str]) -> Expectation:
        """What is likely to be said, from sentences as they are written."""
        return Expectation(map(self.subwords.of, sentences), len(self.subwords))

    def listen(self, samples: Samples) -> Sound:
        """One utterance, at most about half a minute."""
        enough = np.pad(samples, (0, max(0, _SHORTEST - len(samples))))
        values = (enough.astype(np.float32) / 32768)[np.newaxis]
        mask = np.ones(values.shape, np.int64)
        (states,) = self._encoder.run(None, {"input_values": values, "attention_mask": mask})
        return Sound(self, states, int(len(samples) / RATE * QUICKEST) + _MORE)

    def _decode(
        self, states: NDArray[np.float32], numbers: NDArray[np.int64], memory: Memory | None
    ) -> tuple[NDArray[np.float32], Memory]:
        """Log probabilities of what follows each of these subwords, and what to remember."""
        states = np.repeat(states, len(numbers), 0)
        empty = np.zeros((len(numbers), _HEADS, 0, _PER_HEAD), np.float32)
        before = memory or dict.fromkeys(self._memory, empty)
        given = {
            # One for all of the sound: the decoder itself thins out a mask of samples.
            "encoder_attention_mask": np.ones((len(numbers), 1), np.int64),
            "encoder_hidden_states": states,
            "input_ids": numbers,
            "use_cache_branch": np.array([memory is not None]),
            **before,
        }
        found: dict[str, Any] = dict(
            zip(self._outputs, self._decoder.run(None, given), strict=True)
        )
        after = {
            # What is remembered of the sound never changes and is not given again.
            name: before[name]
            if memory is not None and _OF_SOUND in name
            else found[name.replace("past_key_values", "present")]
            for name in self._memory
        }
        scores = found["logits"]
        scores -= scores.max(-1, keepdims=True)
        scores -= np.log(np.exp(scores).sum(-1, keepdims=True))
        return scores, after


Memory = dict[str, Any]


class Sound:
    """An utterance that was listened to."""

    def __init__(self, model: Moonshine, states: NDArray[np.float32], longest: int) -> None:
        self._model = model
        self._states = states
        self._longest = longest  # in subwords

    def texts(self, expectation: Expectation | None = None, width: int = WIDTH) -> list[Text]:
        """The likeliest texts, of sound and expectation together; at least one."""
        open_ = [_Path((BEGIN,), 0.0, 0.0)]
        done: list[_Path] = []
        memory: Memory | None = None
        for _ in range(self._longest):
            last = np.array([[path.numbers[-1]] for path in open_], np.int64)
            sounds, memory = self._model._decode(self._states, last, memory)
            ways = [
                (
                    path.score + float(score),
                    at,
                    number,
                    path.likelihood + float(sounds[at, 0, number]),
                )
                for at, path in enumerate(open_)
                for number, score in _best(sounds[at, 0], expectation, path.numbers, width)
            ]
            going_on: list[tuple[int, _Path]] = []
            for score, at, number, likelihood in sorted(ways, key=lambda way: -way[0]):
                path = _Path((*open_[at].numbers, number), score, likelihood)
                if number == END:
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
            kept = [at for at, _ in going_on]
            memory = {name: _rows(name, values, kept) for name, values in memory.items()}
        write = self._model.subwords.text
        return [Text(write(path.numbers), path.likelihood) for path in (done or open_)[: 2 * width]]

    def likelihoods(self, texts: Sequence[str]) -> list[float]:
        """The log likelihood of each text, whatever punctuation it ends with."""
        written = [[BEGIN, *self._model.subwords.of(text.rstrip(_PUNCTUATION))] for text in texts]
        if not written:
            return []
        numbers = np.full((len(written), max(map(len, written))), END, np.int64)
        for row, text in zip(numbers, written, strict=True):
            row[: len(text)] = text
        sounds, _ = self._model._decode(self._states, numbers, None)
        return [
            float(rows[np.arange(len(text) - 1), text[1:]].sum())
            + float(np.logaddexp.reduce(rows[len(text) - 1, self._model._ends]))
            for rows, text in zip(sounds, written, strict=True)
        ]


def load(language: str) -> Moonshine | None:
    """That of a language, loaded once; None where there is none that can be used."""
    folder = find(f"{language}-moonshine")
    return _loaded(folder) if folder else None


@cache
def _loaded(folder: Path) -> Moonshine | None:
    try:
        return Moonshine(folder)
    except ModelError as error:  # without it one hears less well, but one hears
        _log.warning("%s", error)
        return None


@dataclass(frozen=True)
class _Path:
    """A text that is being written."""

    numbers: tuple[int, ...]
    score: float  # of sound and expectation together
    likelihood: float  # of the sound alone


def _rows(name: str, values: NDArray[np.float32], kept: Sequence[int]) -> NDArray[np.float32]:
    """What is remembered of these paths. Of the sound it is the same for all of them."""
    if _OF_SOUND in name and len(values) == len(kept):
        return values
    return values[list(kept)]


def _goes_round(numbers: tuple[int, ...]) -> bool:
    """Whether a text says the same again and again, as the model does of mere noise."""
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
    best = np.argpartition(-scores, width + 1)[: width + 1]
    return [(int(number), float(scores[number])) for number in best]
