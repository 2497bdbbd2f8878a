"""Kokoro, a neural voice of 82 million weights with many speakers (hexgrad, Apache-2.0): the people
of trainings and benchmarks.

    speakers()                                  # ["af_alloy", ...]; none where it is not installed
    joined(Kokoro("am_adam", "en-us").speak("Hey robot!"))

`nl2robot models get kokoro` fetches it. A speaker's first letter tells where they are from (a
American, b British, f French, j Japanese, z Chinese, ...), the second whether they are f or m. Each
can be given the sounds of any language that espeak-ng knows, and then has an accent.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from functools import cache, lru_cache
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from nl2robot.models.catalogue import ModelError, find
from nl2robot.speech.speak.voices import Sound, VoiceError, never, phonemes, piecewise

RATE: Final = 24_000
_MOST: Final = 500  # sounds of a language that it takes at a time
_NEAREST: Final = str.maketrans("ʏ", "y")  # for sounds that it does not know
_SIZE: Final = 256  # numbers that tell how a speaker sounds, for each length of a text


def speakers() -> list[str]:
    """The names of those that are installed, sorted."""
    folder = find("kokoro")
    return sorted(file.stem for file in (folder / "voices").glob("*.bin")) if folder else []


class Kokoro:
    """One speaker in one language; a `voices.Voice`. May be used from several threads."""

    def __init__(self, speaker: str, language: str) -> None:
        """`language` is one of espeak-ng, such as "en-us". Raises `VoiceError`."""
        self.name = f"kokoro-{speaker}"
        self._language = language
        self._model = _model()
        self._style = self._model.style(speaker)

    def speak(
        self,
        text: str,
        *,
        speed: float = 1.0,
        pitch: float = 1.0,
        stopped: Callable[[], bool] = never,
    ) -> Iterator[Sound]:
        """As `voices.Voice`; it has one pitch only."""
        return piecewise(text, lambda piece: self._sound(piece, speed), stopped)

    def _sound(self, text: str, speed: float) -> Sound:
        sounds = phonemes(text, self._language).translate(_NEAREST)
        samples = self._model.spoken(sounds, self._style, speed)
        return Sound((np.clip(samples, -1, 1) * 32767).astype(np.int16), RATE)


class _Model:
    def __init__(self, folder: Path) -> None:
        import onnxruntime

        how = onnxruntime.SessionOptions()
        how.add_session_config_entry("session.intra_op.allow_spinning", "0")
        self._folder = folder
        self._session = onnxruntime.InferenceSession(folder / "model.onnx", how)
        described = json.loads((folder / "vocab.json").read_text("utf-8"))
        self._numbers: dict[str, int] = described["vocab"]

    @lru_cache(maxsize=64)  # noqa: B019 - there is one model
    def style(self, speaker: str) -> NDArray[np.float32]:
        file = self._folder / "voices" / f"{speaker}.bin"
        if not file.is_file():
            raise VoiceError(
                f"Kokoro has no speaker {speaker!r}. There are: {', '.join(speakers())}."
            )
        return np.fromfile(file, np.float32).reshape(-1, _SIZE)

    def spoken(self, sounds: str, style: NDArray[np.float32], speed: float) -> NDArray[np.float32]:
        numbers = [self._numbers[sound] for sound in sounds if sound in self._numbers][:_MOST]
        if not numbers:
            return np.zeros(0, np.float32)
        given = {
            "tokens": np.array([[0, *numbers, 0]], np.int64),
            "style": style[min(len(numbers), len(style)) - 1][np.newaxis],
            "speed": np.array([speed], np.float32),
        }
        (samples,) = self._session.run(None, given)
        return np.asarray(samples, np.float32).ravel()


@cache
def _model() -> _Model:
    folder = find("kokoro")
    if folder is None:
        raise VoiceError("Kokoro is not installed. Run `nl2robot models get kokoro` to fetch it.")
    try:
        return _Model(folder)
    except Exception as error:  # onnxruntime raises many kinds
        raise ModelError(
            f"The voice in {folder} cannot be used. "
            "Run `nl2robot models get kokoro --again` to fetch it again."
        ) from error
