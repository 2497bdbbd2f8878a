"""A client's microphone over the wire: `voice.open`, `voice.push`, `voice.close`.

A browser, or any other client, opens an ear, pushes blocks of sound as they come, and is told in
the answer to each push what has happened by then: that somebody speaks, the words so far, and at
the end of the speech what was said and the program that it means. Nothing is published to others,
nothing is kept, and nothing moves.
"""

from __future__ import annotations

import base64
import binascii
import itertools
import threading
import time
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

import msgspec

from nl2robot.knowledge import Knowledge
from nl2robot.models import need
from nl2robot.translation import Talk
from nl2robot.wire import service
from robot_api.capabilities.sound import SILENT
from robot_api.errors import InvalidCall
from robot_api.server import Service

if TYPE_CHECKING:
    from nl2robot.hearing import Ear
    from nl2robot.speech.audio import Converter
    from nl2robot.speech.listening import Event, Listener

MOST_OPEN: Final = 8
"""Microphones at a time; the one unused longest is closed for another."""
FORGOTTEN_AFTER: Final = 60.0
"""Seconds without a push."""
LARGEST_BLOCK: Final = 200_000
"""Characters of a block, in base64: some seconds of sound."""

TalkOf = Callable[[str | None], Talk]
"""The conversation of this name."""


@dataclass
class _Open:
    """One microphone."""

    ear: Ear
    listener: Listener
    converter: Converter
    talk: str | None
    interrupts: bool
    """Whether the robot is to be silent when somebody begins to speak here."""
    lock: threading.Lock = field(default_factory=threading.Lock)
    """Blocks of one microphone come one after the other."""
    used: float = field(default_factory=time.monotonic)


class Microphones:
    """Those of the clients of one server. Any thread may use it."""

    def __init__(
        self,
        knowledge: Callable[[], Knowledge],
        talk_of: TalkOf,
        give_way: Callable[[], None] = SILENT.give_way,
    ) -> None:
        """`give_way` ends what the robot is saying."""
        self._give_way = give_way
        self._knowledge = knowledge
        self._talk_of = talk_of
        self._numbers = itertools.count(1)
        self._open: OrderedDict[int, _Open] = OrderedDict()
        self._ears: dict[str, Ear] = {}
        self._lock = threading.Lock()

    def open(
        self,
        rate: int,
        channels: int,
        language: str,
        talk: str | None,
        *,
        interrupts: bool = False,
    ) -> int:
        """Listen to a microphone; returns its number. `interrupts`: whoever speaks there makes the
        robot silent, as the microphone does not hear the robot itself. Raises `UserError` without a
        speech model, or for a rate that no voice has."""
        from nl2robot.speech.audio import Converter

        ear = self._ear(language)
        opened = _Open(ear, ear.listener(), Converter(rate, channels), talk, interrupts)
        with self._lock:
            number = next(self._numbers)
            self._open[number] = opened
            self._close_forgotten()
        return number

    def push(self, number: int, sound: str) -> list[dict[str, Any]]:
        """A block of sound, base64 of 16-bit samples, the lower byte first; returns what happened.
        Raises `InvalidCall`."""
        try:
            block = base64.b64decode(sound, validate=True)
        except (binascii.Error, ValueError) as error:
            raise InvalidCall("The sound is not written in base64.") from error
        opened = self._known(number)
        with opened.lock:
            opened.used = time.monotonic()
            events = opened.listener.feed(opened.converter.convert(block))
            return [self._told(opened, event) for event in events]

    def close(self, number: int) -> list[dict[str, Any]]:
        """No more sound comes: whoever still speaks has ended. Raises `InvalidCall`."""
        opened = self._known(number)
        with opened.lock:
            with self._lock:
                self._open.pop(number, None)
            events = opened.listener.feed(opened.converter.finish())
            events += opened.listener.finish()
            return [self._told(opened, event) for event in events]

    def _known(self, number: int) -> _Open:
        with self._lock:
            opened = self._open.get(number)
            if opened is None:
                raise InvalidCall(
                    f"The microphone {number} is not open, or was not used for a minute."
                    " Open it with voice.open."
                )
            self._open.move_to_end(number)
            return opened

    def _close_forgotten(self) -> None:
        now = time.monotonic()
        for number, opened in list(self._open.items()):
            if now - opened.used > FORGOTTEN_AFTER or len(self._open) > MOST_OPEN:
                del self._open[number]

    def _ear(self, language: str) -> Ear:
        from nl2robot.hearing import Ear

        model = need(language)
        with self._lock:
            if language not in self._ears:  # its phrases are those of the world
                self._ears[language] = Ear(model, self._knowledge(), language)
            return self._ears[language]

    def _told(self, opened: _Open, event: Event) -> dict[str, Any]:
        from nl2robot.speech.listening import (
            NothingHeard,
            PartialText,
            SpeechBegan,
            SpeechEnded,
            TooLong,
        )

        match event:
            case SpeechBegan():
                if opened.interrupts:
                    self._give_way()
                return {"what": "began"}
            case PartialText(text):
                return {"what": "partial", "text": text}
            case SpeechEnded():
                assert event.heard is not None
                heard = opened.ear.understood(event.heard)
                translation = opened.ear.translate(heard, talk=self._talk_of(opened.talk))
                return {
                    "what": "heard",
                    "text": heard.text,
                    "doubtful": heard.doubtful,
                    "perhaps": heard.free_text,
                    "translation": msgspec.to_builtins(translation),
                }
            case TooLong():
                return {"what": "too long"}
            case NothingHeard():
                return {"what": "nothing"}


def voice_services(microphones: Microphones) -> dict[str, Service]:
    """The methods to register with a `robot_api.server.Server`."""
    number = {"type": "integer", "minimum": 1}
    return {
        "voice.open": service(
            lambda p: microphones.open(
                p["rate"],
                p.get("channels", 1),
                p.get("language", "en"),
                p.get("talk"),
                interrupts=p.get("interrupts", False),
            ),
            "Listen to a client's microphone; returns its number. With interrupts, whoever speaks"
            " there makes the robot silent: for one that does not hear the robot itself.",
            {
                "rate": {"type": "integer"},
                "channels": {"type": "integer"},
                "language": {"type": "string", "pattern": "^[a-z]{2}$"},
                "talk": {"type": ["string", "null"], "maxLength": 100},
                "interrupts": {"type": "boolean"},
            },
            "rate",
        ),
        "voice.push": service(
            lambda p: microphones.push(p["microphone"], p["sound"]),
            "Hand over a block of sound (base64 of 16-bit samples); returns what happened: began,"
            " partial, heard with its program, too long.",
            {"microphone": number, "sound": {"type": "string", "maxLength": LARGEST_BLOCK}},
            "microphone sound",
        ),
        "voice.close": service(
            lambda p: microphones.close(p["microphone"]),
            "End listening; returns what was still to be told.",
            {"microphone": number},
            "microphone",
        ),
    }
