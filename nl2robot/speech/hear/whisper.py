"""Whisper, a neural recogniser of many languages (Radford et al. 2022), of 74 million weights; a
`search.Network`.

    whisper = Whisper(folder, "de")
    whisper.listen(audio.samples).texts()    # what is said, the likeliest first

CTranslate2 runs it. But its search cannot be told what is likely to be said, and so there is a
decoder of our own, which reads the same file.
"""

from __future__ import annotations

import json
import logging
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from nl2robot.models.catalogue import ModelError, find
from nl2robot.models.sources import load_registry
from nl2robot.speech.audio import RATE, Samples
from nl2robot.speech.hear.byte_pairs import BytePairs
from nl2robot.speech.hear.ct2_file import read
from nl2robot.speech.hear.expectation import Expectation
from nl2robot.speech.hear.log_mel import log_mel
from nl2robot.speech.hear.quantized import Floats, Product
from nl2robot.speech.hear.search import WIDTH, Sound, Text

_log = logging.getLogger(__name__)

QUICKEST: Final = 9.0  # subwords in a second: who writes more repeats themselves
_MORE: Final = 8  # than that, whatever the length
SHORTEST: Final = 8.0
"""Seconds of sound, or silence, that it is given at least. It was trained on half a minute always;
of much less it writes what was not said, and a whole one takes four times as long."""


class Whisper:
    """A loaded model. May be used from several threads at once."""

    def __init__(self, folder: Path, language: str) -> None:
        """`folder` holds a model that CTranslate2 has converted. Raises ModelError if it is no
        good."""
        try:
            self.subwords = BytePairs.load(folder / "tokenizer.json", language)
            described = json.loads((folder / "config.json").read_text("utf-8"))
            self._model, self._decoder = _weights(folder)
        except Exception as error:  # CTranslate2 raises RuntimeError only, json and numpy others
            raise ModelError(
                f"The speech model in {folder} cannot be used. "
                f"Run `nl2robot models get {folder.name} --again` to fetch it again."
            ) from error
        never = np.zeros(self._decoder.size, np.float32)
        never[described["suppress_ids"]] = -np.inf  # music, brackets and the like
        never[self.subwords.end + 1 :] = -np.inf  # times, languages, tasks
        never[self.subwords.end] = 0.0
        self._never = never

    def expectation(self, sentences: Sequence[str]) -> Expectation:
        """What is likely to be said, from sentences as they are written."""
        subwords = self.subwords
        return Expectation(
            map(subwords.of, sentences), self._decoder.size, subwords.begin[-1], subwords.end
        )

    def listen(self, samples: Samples) -> Sound:
        """One utterance, at most half a minute."""
        import ctranslate2

        seconds = max(SHORTEST, len(samples) / RATE)
        mel = log_mel(samples, seconds)[np.newaxis]
        encoded = self._model.encode(ctranslate2.StorageView.from_array(mel))
        return _Listened(self, encoded, int(len(samples) / RATE * QUICKEST) + _MORE)

    def freely(self, encoded: Any, longest: int, width: int) -> list[Text]:
        """The likeliest texts where anything may be said."""
        (found,) = self._model.generate(
            encoded,
            [list(self.subwords.begin)],
            beam_size=width,
            num_hypotheses=width,
            max_length=longest,
            length_penalty=0,
            return_scores=True,
        )
        return [
            Text(self.subwords.text(numbers), float(likelihood))
            for numbers, likelihood in zip(found.sequences_ids, found.scores, strict=True)
        ]

    def of_sound(self, encoded: Any) -> _OfSound:
        with _blas().limit(limits=1, user_api="blas"):
            return self._decoder.of_sound(np.array(encoded)[0])

    def decode(
        self, states: _OfSound, numbers: NDArray[np.int64], memory: _Memory | None
    ) -> tuple[Floats, _Memory]:
        # On a busy machine threads that wait for each other take ten times as long.
        with _blas().limit(limits=1, user_api="blas"):
            scores, after = self._decoder.scores(states, numbers, memory)
        scores += self._never
        scores -= scores.max(-1, keepdims=True)
        scores -= np.log(np.exp(scores).sum(-1, keepdims=True))
        return scores, after


class _Listened(Sound):
    """What is said freely CTranslate2 finds sooner; the rest is prepared if it is asked for."""

    def __init__(self, whisper: Whisper, encoded: Any, longest: int) -> None:
        super().__init__(whisper, None, longest)
        self._whisper, self._encoded = whisper, encoded

    def texts(self, expectation: Expectation | None = None, width: int = WIDTH) -> list[Text]:
        if expectation is None:
            return self._whisper.freely(self._encoded, self._longest, width)
        self._prepare()
        return super().texts(expectation, width)

    def likelihoods(self, texts: Sequence[str]) -> list[float]:
        self._prepare()
        return super().likelihoods(texts)

    def _prepare(self) -> None:
        if self._states is None:
            self._states = self._whisper.of_sound(self._encoded)


def load(language: str) -> Whisper | None:
    """That of a language, loaded once; None where there is none that can be used."""
    registry = load_registry()
    folder = find("whisper", registry) if language in registry["whisper"].beside else None
    return _loaded(folder, language) if folder else None


@cache
def _loaded(folder: Path, language: str) -> Whisper | None:
    try:
        return Whisper(folder, language)
    except ModelError as error:  # without it one hears less well, but one hears
        _log.warning("%s", error)
        return None


@cache
def _blas() -> Any:
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()


@cache
def _weights(folder: Path) -> tuple[Any, _Decoder]:
    """The same for every language: CTranslate2's model, and our decoder."""
    import ctranslate2

    model = ctranslate2.models.Whisper(str(folder), device="cpu", compute_type="int8")
    return model, _Decoder(read(folder / "model.bin"))


# ── the decoder ──────────────────────────────────────────────────────────────────────────────

_OfSound = list[tuple[Floats, Floats]]
"""Keys and values of the sound, for each layer: heads x size x moments, heads x moments x size."""


@dataclass(frozen=True)
class _Memory:
    """Keys and values of the subwords so far, for each layer: texts x heads x subwords x size."""

    layers: list[tuple[Floats, Floats]]

    @property
    def length(self) -> int:
        return int(self.layers[0][0].shape[2])

    def rows(self, kept: Sequence[int]) -> _Memory:
        rows = list(kept)
        return _Memory([(keys[rows], values[rows]) for keys, values in self.layers])


class _Decoder:
    """A transformer (Vaswani et al. 2017) with the normalisation before each step."""

    def __init__(self, values: Mapping[str, NDArray[Any]]) -> None:
        own = {
            name.removeprefix("decoder/"): value if value.ndim > 1 else value.astype(np.float32)
            for name, value in values.items()
            if name.startswith("decoder/") and value.ndim
        }
        self._heads = int(values["decoder/num_heads"])
        self._embeddings = own["embeddings/weight"].copy()  # without it the whole file would stay
        self._project = Product(self._embeddings)
        self._positions = own["position_encodings/encodings"].astype(np.float32)
        self._norm = _Norm(own, "layer_norm")
        count = len({name.split("/")[0] for name in own if name.startswith("layer_")})
        count -= "layer_norm" in {name.split("/")[0] for name in own}
        with ThreadPoolExecutor() as builders:  # of these, two take half the time of one
            layers = [builders.submit(_Layer, own, f"layer_{n}", self._heads) for n in range(count)]
            self._layers = [layer.result() for layer in layers]

    @property
    def size(self) -> int:
        """How many subwords there are."""
        return len(self._embeddings)

    def of_sound(self, encoded: Floats) -> _OfSound:
        return [layer.of_sound(encoded) for layer in self._layers]

    def scores(
        self, sound: _OfSound, numbers: NDArray[np.int64], memory: _Memory | None
    ) -> tuple[Floats, _Memory]:
        """Of every subword after each of these, before they are made probabilities."""
        start = memory.length if memory else 0
        count = numbers.shape[1]
        known = self._embeddings[numbers].astype(np.float32)
        x = known + self._positions[start : start + count]
        unseen = np.triu(np.full((count, start + count), -np.inf, np.float32), start + 1)
        after = []
        for n, layer in enumerate(self._layers):
            x, kept = layer(x, sound[n], memory.layers[n] if memory else None, unseen)
            after.append(kept)
        return self._project(self._norm(x)), _Memory(after)


class _Norm:
    def __init__(self, own: Mapping[str, NDArray[Any]], name: str) -> None:
        self._gamma, self._beta = own[f"{name}/gamma"], own[f"{name}/beta"]

    def __call__(self, x: Floats) -> Floats:
        x = x - x.mean(-1, keepdims=True)
        spread = np.sqrt(np.square(x).mean(-1, keepdims=True) + np.float32(1e-5))
        return np.asarray(x / spread * self._gamma + self._beta, np.float32)


def _linear(own: Mapping[str, NDArray[Any]], name: str) -> Product:
    return Product(own[f"{name}/weight"], own[f"{name}/bias"])


class _Layer:
    def __init__(self, own: Mapping[str, NDArray[Any]], name: str, heads: int) -> None:
        self._heads = heads
        self._own_norm = _Norm(own, f"{name}/self_attention/layer_norm")
        self._own_in = _linear(own, f"{name}/self_attention/linear_0")
        self._own_out = _linear(own, f"{name}/self_attention/linear_1")
        self._sound_norm = _Norm(own, f"{name}/attention/layer_norm")
        self._asked = _linear(own, f"{name}/attention/linear_0")
        self._offered = _linear(own, f"{name}/attention/linear_1")
        self._sound_out = _linear(own, f"{name}/attention/linear_2")
        self._last_norm = _Norm(own, f"{name}/ffn/layer_norm")
        self._wide = _linear(own, f"{name}/ffn/linear_0")
        self._narrow = _linear(own, f"{name}/ffn/linear_1")

    def of_sound(self, encoded: Floats) -> tuple[Floats, Floats]:
        keys, values = np.split(self._offered(encoded), 2, axis=-1)
        keys, values = (
            each.reshape(len(encoded), self._heads, -1).swapaxes(0, 1) for each in (keys, values)
        )
        return np.ascontiguousarray(keys.swapaxes(1, 2)), np.ascontiguousarray(values)

    def __call__(
        self,
        x: Floats,
        sound: tuple[Floats, Floats],
        before: tuple[Floats, Floats] | None,
        unseen: Floats,
    ) -> tuple[Floats, tuple[Floats, Floats]]:
        asked, keys, values = np.split(self._own_in(self._own_norm(x)), 3, axis=-1)
        asked, keys, values = (self._apart(each) for each in (asked, keys, values))
        if before is not None:
            keys = np.concatenate([before[0], keys], axis=2)
            values = np.concatenate([before[1], values], axis=2)
        x = x + self._own_out(
            self._together(self._attend(asked, keys.swapaxes(2, 3), values, unseen))
        )
        # All texts ask the same sound: in one row, as if they were one long text.
        texts, count, size = x.shape
        asked = self._apart(self._asked(self._sound_norm(x)).reshape(1, texts * count, size))
        found = self._together(self._attend(asked, *sound))
        x = x + self._sound_out(found.reshape(texts, count, size))
        return x + self._narrow(_gelu(self._wide(self._last_norm(x)))), (keys, values)

    def _attend(
        self, asked: Floats, keys: Floats, values: Floats, unseen: Floats | None = None
    ) -> Floats:
        scores = (asked @ keys) * np.float32(asked.shape[-1] ** -0.5)
        if unseen is not None:
            scores = scores + unseen
        scores -= scores.max(-1, keepdims=True)
        np.exp(scores, out=scores)
        scores /= scores.sum(-1, keepdims=True)
        return np.asarray(scores @ values, np.float32)

    def _apart(self, x: Floats) -> Floats:
        """By heads: texts x heads x subwords x size."""
        return x.reshape(*x.shape[:2], self._heads, -1).swapaxes(1, 2)

    def _together(self, x: Floats) -> Floats:
        return x.swapaxes(1, 2).reshape(x.shape[0], x.shape[2], -1)


def _gelu(x: Floats) -> Floats:
    from scipy.special import erf

    half = erf(x * np.float32(0.5**0.5)) + np.float32(1)
    return np.asarray(x * half * np.float32(0.5), np.float32)
