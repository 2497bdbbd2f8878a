"""What Moonshine's encoder makes of a short sound: numbers that tell what was said in its parts.

    values = encoder("en").values(sound)       # None where that model is not installed

The encoder has heard very many people speak; what it makes of them is much the same for all of
them, accents and noise included. Its decoder, though, expects sentences, and writes "a" or "thank"
where a digit lost its edges. `digits` decides between digits alone.
"""

from __future__ import annotations

import logging
from functools import cache
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from nl2robot.models.catalogue import find
from nl2robot.speech.audio import RATE

_log = logging.getLogger(__name__)

PARTS: Final = 2
"""Of a sound, of the same length; three, four or six tell no more."""
_PADDING: Final = int(0.15 * RATE)  # samples of silence around it
_LOUDNESS: Final = 0.6  # the peak, as the model is used to
_SHORTEST: Final = RATE // 4  # samples that it needs


class Encoder:
    """May be used from several threads at once."""

    def __init__(self, model: Path) -> None:
        import onnxruntime

        how = onnxruntime.SessionOptions()
        how.add_session_config_entry("session.intra_op.allow_spinning", "0")
        self._session = onnxruntime.InferenceSession(model, how)

    def values(self, sound: NDArray[np.float32]) -> NDArray[np.float64]:
        """What was said in each of `PARTS`, in one row."""
        loud = sound * np.float32(_LOUDNESS / max(1e-6, float(np.abs(sound).max())))
        padded = np.pad(loud, _PADDING)
        padded = np.pad(padded, (0, max(0, _SHORTEST - len(padded))))[np.newaxis]
        mask = np.ones(padded.shape, np.int64)
        given = {"input_values": padded, "attention_mask": mask}
        ((states, *_), *_) = self._session.run(None, given)
        parts = np.array_split(states.astype(float), PARTS)
        return np.concatenate([part.mean(axis=0) for part in parts])


@cache
def encoder(language: str) -> Encoder | None:
    """That of a language, loaded once; None where there is none that can be used."""
    folder = find(f"{language}-moonshine")
    if folder is None:
        return None
    try:
        return Encoder(folder / "encoder_model.ort")
    except Exception as error:  # noqa: BLE001 - onnxruntime raises many kinds
        _log.warning("Digits are heard less well without a part of %s: %s", folder, error)
        return None
