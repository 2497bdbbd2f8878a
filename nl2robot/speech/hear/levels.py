"""How loud a sound is: too faint to be speech? What makes it as loud as the model is used to?"""

from __future__ import annotations

import numpy as np

from nl2robot.speech.audio import RATE, Samples

LOUDNESS = 0.6  # the peak that a recording is brought to; the model was trained on full ones
MOST_GAIN = 30.0
# Below this loudest moment (root mean square of 30 ms, 1 = full scale) there is nothing to hear.
SILENCE = 0.001


def gain_for(samples: Samples) -> float:
    """What makes this sound as loud as the model is used to."""
    peak = max(1.0, float(np.abs(samples.astype(np.float32)).max())) if len(samples) else 1.0
    return min(MOST_GAIN, LOUDNESS * 32767 / peak)


class Silence:
    """True as long as nothing fed was loud enough to be speech; so is less than one frame."""

    def __init__(self) -> None:
        self._silent = True
        self._rest = np.zeros(0, np.float32)

    def __bool__(self) -> bool:
        return self._silent

    def feed(self, samples: Samples) -> None:
        if not self._silent:
            return
        frame = RATE * 30 // 1000
        sound = np.concatenate([self._rest, samples.astype(np.float32) / 32768])
        whole = len(sound) // frame * frame
        self._rest = sound[whole:]
        if whole:
            levels = np.sqrt(np.square(sound[:whole].reshape(-1, frame)).mean(axis=1))
            self._silent = float(levels.max()) < SILENCE
