"""Moonshine, a small neural recogniser of English (Jeffries et al. 2024); a `search.Network`.

    moonshine = Moonshine(folder)
    moonshine.listen(audio.samples).texts()    # what is said, the likeliest first

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

from nl2robot.models.catalogue import ModelError, find
from nl2robot.speech.audio import RATE, Samples
from nl2robot.speech.hear.expectation import Expectation
from nl2robot.speech.hear.search import Sound
from nl2robot.speech.hear.subwords import Subwords

_log = logging.getLogger(__name__)

QUICKEST: Final = 6.5  # subwords in a second: who writes more repeats themselves
_MORE: Final = 8  # than that, whatever the length
_SHORTEST: Final = RATE // 4  # samples the encoder needs
_HEADS, _PER_HEAD = 8, 36
_OF_SOUND: Final = ".encoder."  # in the names of what is remembered


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

    def decode(
        self, states: NDArray[np.float32], numbers: NDArray[np.int64], memory: _Memory | None
    ) -> tuple[NDArray[np.float32], _Memory]:
        states = np.repeat(states, len(numbers), 0)
        empty = np.zeros((len(numbers), _HEADS, 0, _PER_HEAD), np.float32)
        before = memory.values if memory else dict.fromkeys(self._memory, empty)
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
        return scores, _Memory(after)


@dataclass(frozen=True)
class _Memory:
    """By the names of the decoder's inputs."""

    values: dict[str, Any]

    def rows(self, kept: Sequence[int]) -> _Memory:
        return _Memory({name: _rows(name, values, kept) for name, values in self.values.items()})


def _rows(name: str, values: NDArray[np.float32], kept: Sequence[int]) -> NDArray[np.float32]:
    """What is remembered of these texts. Of the sound it is the same for all of them."""
    if _OF_SOUND in name and len(values) == len(kept):
        return values
    return values[list(kept)]


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
