"""Sound as Whisper looks at it: how loud each of 80 bands is, a hundred times a second."""

from __future__ import annotations

from functools import cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from nl2robot.speech.audio import RATE, Samples

BANDS: Final = 80
_WINDOW: Final = 400  # samples
_STEP: Final = 160
_QUIETEST: Final = 8.0  # powers of ten below the loudest; what is quieter counts as that


def log_mel(samples: Samples, seconds: float) -> NDArray[np.float32]:
    """Bands x moments of this many seconds, silence after the sound included."""
    length = int(seconds * RATE) // _STEP * _STEP
    sound = np.zeros(length, np.float32)
    sound[: len(samples)] = samples[:length] / np.float32(32768)
    around = np.pad(sound, _WINDOW // 2, mode="reflect")
    frames = np.lib.stride_tricks.sliding_window_view(around, _WINDOW)[::_STEP][:-1]
    spectrum = np.fft.rfft(frames * np.hanning(_WINDOW + 1)[:-1].astype(np.float32))
    power = np.square(np.abs(spectrum)).T.astype(np.float32)
    logs = np.log10(np.maximum(_bands() @ power, 1e-10))
    logs = np.maximum(logs, logs.max() - _QUIETEST)
    return np.ascontiguousarray((logs + 4) / 4, np.float32)


@cache
def _bands() -> NDArray[np.float32]:
    """Slaney's triangles of one area (Auditory Toolbox 1998): linear to 1 kHz, then logarithmic."""
    edges = _hertz(np.linspace(0, _mel(RATE / 2), BANDS + 2))
    tones = np.fft.rfftfreq(_WINDOW, 1 / RATE)
    rising = (tones - edges[:-2, None]) / np.diff(edges)[:-1, None]
    falling = (edges[2:, None] - tones) / np.diff(edges)[1:, None]
    triangles = np.maximum(0, np.minimum(rising, falling))
    return np.asarray(triangles * (2 / (edges[2:] - edges[:-2]))[:, None], np.float32)


_LINEAR: Final = 200 / 3  # hertz a mel, up to ...
_KNEE: Final = 1000.0
_GROWTH: Final = np.log(6.4) / 27


def _mel(hertz: float) -> float:
    return float(_KNEE / _LINEAR + np.log(hertz / _KNEE) / _GROWTH)


def _hertz(mel: NDArray[np.float64]) -> NDArray[np.float64]:
    above = np.maximum(0, mel - _KNEE / _LINEAR)
    return np.where(above > 0, _KNEE * np.exp(_GROWTH * above), mel * _LINEAR)
