"""Pepper's voice."""

from __future__ import annotations

from typing import Any, Final

from robot_api.capabilities.base import Hub
from robot_api.capabilities.languages import known_languages, language_data
from robot_api.capabilities.sound import SILENT, Sound
from robot_api.capabilities.speech import Speech
from robot_api.driver import StopFlag
from robot_api.errors import NotSupported
from robot_api.robots.pepper.body import STOP_LIMBS, STOP_SPEAKING
from robot_api.robots.pepper.session import Wire

_SET_WITHIN: Final = 10.0
"""Seconds that changing the language may take: a voice is loaded."""
_MARKUP: Final = str.maketrans({"\\": " ", "^": " "})
"""Both begin commands to the voice in the middle of a text, to change its volume or to move."""


class PepperSpeech(Speech):
    def __init__(self, wire: Wire, hub: Hub, sound: Sound = SILENT, *, animated: bool) -> None:
        """What it says goes through `sound.spoken`. Raises `NotSupported` if it speaks none of
        our languages."""
        super().__init__()
        self._wire = wire
        self._spoken = sound.spoken
        self._hub = hub
        self._service = "ALAnimatedSpeech" if animated else "ALTextToSpeech"
        installed = wire.call("ALTextToSpeech", "getAvailableLanguages")
        self._names = {code: language_data(code).name for code in known_languages()}
        """What NAOqi calls them: by their English names."""
        self._codes = tuple(code for code, name in self._names.items() if name in installed)
        if not self._codes:
            raise NotSupported(
                "Pepper has no voice for English, German or French."
                " Install a language on it, or write 'speech: server' into the robot file."
            )
        speaks = str(wire.call("ALTextToSpeech", "getLanguage"))
        self._language = next(
            (code for code in self._codes if self._names[code] == speaks), self._codes[0]
        )

    @property
    def language(self) -> str:
        return self._language

    def languages(self) -> tuple[str, ...]:
        return self._codes

    def speak(self, stop: StopFlag, text: str, language: str) -> None:
        name = self._names[language]
        if self._wire.call("ALTextToSpeech", "getLanguage") != name:
            self._wire.call("ALTextToSpeech", "setLanguage", name, within=_SET_WITHIN)
        self._hub.publish("speech", text=text, language=language)
        plain = self._spoken(text, language).translate(_MARKUP)
        if self._service == "ALAnimatedSpeech":
            how: dict[str, Any] = {"bodyLanguageMode": "contextual"}
            ending = (STOP_SPEAKING, STOP_LIMBS)
            self._wire.run(stop, self._service, "say", plain, how, ending=ending)
        else:
            self._wire.run(stop, self._service, "say", plain, ending=(STOP_SPEAKING,))

    def set_volume(self, stop: StopFlag, percent: int) -> None:
        self._wire.call("ALAudioDevice", "setOutputVolume", percent)
        self._hub.publish("volume", percent=percent)

    def choose_language(self, code: str) -> None:
        self._language = code
        self._hub.publish("language", code=code)
