"""A Furhat speaks and hears."""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import suppress
from typing import Any, Final

from robot_api.capabilities.base import Hub, Turns
from robot_api.capabilities.hearing import Hearing
from robot_api.capabilities.languages import known_languages, language_data
from robot_api.capabilities.screen import Screen
from robot_api.capabilities.sound import SILENT, Sound
from robot_api.capabilities.speech import Speech
from robot_api.driver import StopFlag
from robot_api.errors import LostConnection, NotSupported
from robot_api.robots.furhat.connection import Message
from robot_api.robots.furhat.robot import Exchange, Furhat
from robot_api.robots.furhat.settings import FurhatSettings

_STARTS_WITHIN: Final = 10.0
"""Seconds for it to begin to speak: voices out of the network take a while."""
_SECONDS_A_LETTER: Final = 0.25
"""The slowest speech there is, and then some."""
_HESITATES: Final = 3.0
"""Seconds more than it was told to wait, after which it counts as not listening any more."""
_LONGEST_ANSWER: Final = 60.0
"""Seconds that somebody who has begun to speak may go on."""
_LISTENS_AGAIN: Final = 0.25
"""Seconds after it was kept from listening."""

_LOCALES: Final = {"en": "en-US", "de": "de-DE", "fr": "fr-FR"}
_VOICES: Final = "response.voice.status"
_WHICH_VOICE: Final[dict[str, Any]] = {"voice_id": True, "voice_list": True}
_HEARD: Final = tuple(f"response.hear.{what}" for what in ("start", "partial", "end"))


class Voice:
    """Which of its voices the robot speaks with: it has one for a language or a few, and somebody
    may have chosen which."""

    def __init__(self, furhat: Furhat, settings: FurhatSettings) -> None:
        self._furhat = furhat
        self._settings = settings
        status = furhat.ask(StopFlag(), "request.voice.status", _VOICES, **_WHICH_VOICE)
        listed = status.get("voice_list")
        voices = listed if isinstance(listed, list) else []
        self._languages = {language for voice in voices if (language := _language_of(voice))}
        self._spoken: tuple[int | None, str] | None = None
        """In which connection the robot was told to speak what."""

    def languages(self) -> tuple[str, ...]:
        """Those of ours that it has a voice for; all, if it does not say."""
        known = known_languages()
        return tuple(code for code in known if code in self._languages) or known

    def take(self, stop: StopFlag, language: str) -> None:
        """Have it speak with a voice for that language. Raises `NotSupported`."""
        wanted = (self._furhat.session, language)
        if self._spoken == wanted:
            return
        named = self._settings.voices.get(language)
        if named is not None or not self._speaks(stop, language):
            constraint = ("name", named) if named else ("language", self.locale(language))
            chosen: dict[str, Any] = {constraint[0]: constraint[1], "input_language": False}
            self._furhat.ask(stop, "request.voice.config", _VOICES, **chosen)
        self._spoken = wanted

    def locale(self, language: str) -> str:
        return self._settings.locales.get(language, _LOCALES.get(language, language))

    def _speaks(self, stop: StopFlag, language: str) -> bool:
        """Whether the voice that it has speaks the language: somebody chose it."""
        status = self._furhat.ask(stop, "request.voice.status", _VOICES, **_WHICH_VOICE)
        chosen, listed = status.get("voice_id"), status.get("voice_list")
        return any(
            isinstance(voice, dict)
            and voice.get("voice_id") == chosen
            and _language_of(voice) == language
            for voice in (listed if isinstance(listed, list) else [])
        )


def _language_of(voice: Any) -> str | None:
    """The code of a listed voice's language, "en" of "en-GB"."""
    language = voice.get("language") if isinstance(voice, dict) else None
    return language[:2].lower() if isinstance(language, str) else None


class FurhatSpeech(Speech):
    """Its own voice. How loud that is, its interface does not let us say."""

    def __init__(self, furhat: Furhat, hub: Hub, voice: Voice, sound: Sound = SILENT) -> None:
        """What it says goes through `sound.spoken`."""
        super().__init__()
        self._spoken = sound.spoken
        self._furhat = furhat
        self._hub = hub
        self._voice = voice
        self._language = voice.languages()[0]

    def offers(self) -> tuple[str, ...]:
        return tuple(method for method in super().offers() if method != "set_volume")

    @property
    def language(self) -> str:
        return self._language

    def languages(self) -> tuple[str, ...]:
        return self._voice.languages()

    def choose_language(self, code: str) -> None:
        self._language = code
        self._hub.publish("language", code=code)

    def set_volume(self, stop: StopFlag, percent: int) -> None:
        raise NotSupported("The Furhat's volume is set on its own page. Set it there.")

    def speak(self, stop: StopFlag, text: str, language: str) -> None:
        self._voice.take(stop, language)
        aloud = self._spoken(text, language)
        lasts = _STARTS_WITHIN + _SECONDS_A_LETTER * len(aloud)
        start, end = "response.speak.start", "response.speak.end"
        with self._furhat.motion(stop, speech=True, lasts=_STARTS_WITHIN + lasts) as said:
            self._furhat.send(
                "request.speak.text",
                text=aloud,
                abort=False,
                monitor_words=False,
                request_id=said.number,
            )
            heard = said.expect(_STARTS_WITHIN, start, end)
            self._hub.publish("speech", text=text, language=language)
            if heard["type"] == start:
                heard = said.expect(lasts, end)
        if heard.get("failed") is True:
            called = language_data(language).name or language
            raise NotSupported(
                f"The Furhat's voice cannot speak this in {called}. "
                "Choose another voice for it in the robot file, or on the robot's own page."
            )


class FurhatHearing(Hearing):
    """Its own microphones, and its own recogniser."""

    def __init__(
        self,
        furhat: Furhat,
        hub: Hub,
        voice: Voice,
        speech: Speech,
        screen: Screen | None,
        settings: FurhatSettings,
    ) -> None:
        super().__init__(speech, screen)
        self._furhat = furhat
        self._hub = hub
        self._voice = voice
        self._voiced = speech
        self._end_of_speech = settings.end_of_speech
        self._turns = Turns()

    @property
    def language(self) -> str:
        return self._voiced.language

    def hear(
        self,
        stop: StopFlag,
        timeout: float,
        question: str | None = None,
        options: Sequence[str] | None = None,
        person: str | None = None,
    ) -> str | None:
        end = time.monotonic() + timeout
        with self._turns.mine(stop), self._furhat.exchange(stop) as exchange:
            self._furhat.send(
                "request.listen.config",
                languages=[self._voice.locale(self.language)],
                phrases=list(options or ()),
            )
            heard = self._listened(exchange, end)
            while heard is None and end - time.monotonic() > _LISTENS_AGAIN:
                stop.wait(_LISTENS_AGAIN)
                heard = self._listened(exchange, end)
        if heard is not None:
            self._hub.publish("heard", text=heard, person=person)
        return heard

    def _listened(self, exchange: Exchange, end: float) -> str | None:
        """What was said until it stopped listening, which it does before the time is up when it is
        made to speak, say."""
        left = max(0.1, end - time.monotonic())
        self._furhat.send(
            "request.listen.start",
            partial=True,
            concat=True,
            stop_no_speech=True,
            stop_robot_start=True,
            stop_user_end=True,
            resume_robot_end=False,
            no_speech_timeout=left,
            end_speech_timeout=self._end_of_speech,
            request_id=exchange.number,
        )
        try:
            exchange.expect(_HESITATES, "response.listen.start")
            return _words(exchange, left)
        finally:  # most times it has ended by itself
            with suppress(LostConnection):
                self._furhat.send("request.listen.stop")


def _words(exchange: Exchange, timeout: float) -> str | None:
    """The words of the first who speaks, or None when it stops listening before or is not heard
    of. Words of which no end is told are what was understood of them."""
    so_far, patience = None, timeout + _HESITATES
    while True:
        message = exchange.next(patience, *_HEARD, "response.listen.end")
        kind = message["type"] if message is not None else None
        if message is None or kind == "response.listen.end":
            return so_far
        text = _text_of(message)
        if kind == "response.hear.end" and text:
            return text
        so_far = text or so_far
        patience = _LONGEST_ANSWER


def _text_of(message: Message) -> str | None:
    text = message.get("text")
    return text.strip() or None if isinstance(text, str) else None
