"""The hot word at a client's microphone over the wire: `voice.attend`, `voice.notice`,
`voice.ignore`.

A page that nobody touches hands over its sound all the time, and is told when "hey robot" was said,
or "stop". Nothing of the sound is recognised or kept; what is said after the hot word is another
microphone's, `nl2robot.voice.services`.
"""

from __future__ import annotations

import base64
import binascii
import itertools
import threading
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final, Literal, TypedDict

from nl2robot.speech.audio import Converter
from nl2robot.wire import LANGUAGE, service_of_call
from robot_api.errors import InvalidCall, NotPossible
from robot_api.server import Context, Service

if TYPE_CHECKING:
    from nl2robot.speech.hotword.detector import Detector

MOST: Final = 4
"""Pages that listen at a time: each takes some of the processor all the time."""
FORGOTTEN_AFTER: Final = 20.0
"""Seconds without sound after which a page has left."""
LARGEST_BLOCK: Final = 200_000
"""Characters of a block, in base64: some seconds of sound."""


class Noticed(TypedDict):
    """A word that was heard; `time` is in seconds of sound."""

    what: Literal["hotword", "stop"]
    time: float


@dataclass(eq=False)
class _Attentive:
    connection: str
    converter: Converter
    hot_word: Detector
    stop_word: Detector | None
    lock: threading.Lock = field(default_factory=threading.Lock)
    used: float = field(default_factory=time.monotonic)


class Attention:
    """The pages that listen for the hot word. Any thread may use it."""

    def __init__(self) -> None:
        self._numbers = itertools.count(1)
        self._lock = threading.Lock()
        self._pages: dict[int, _Attentive] = {}

    def attend(self, connection: str, rate: int, language: str) -> int:
        """Begin to listen; returns a number. Raises `UserError` where the hot word of a language
        cannot be heard, `NotPossible` where too many listen."""
        from nl2robot.speech.hotword.detector import HotWord, stop_word

        converter, cries = Converter(rate, 1), stop_word(language)
        page = _Attentive(connection, converter, HotWord(language), cries)
        with self._lock:
            now = time.monotonic()
            self._pages = {
                number: each
                for number, each in self._pages.items()
                if now - each.used < FORGOTTEN_AFTER
            }
            if len(self._pages) >= MOST:
                raise NotPossible(
                    f"{MOST} pages listen for the hot word already. Switch it off on another."
                )
            number = next(self._numbers)
            self._pages[number] = page
        return number

    def notice(self, connection: str, number: int, sound: str) -> list[dict[str, Any]]:
        """A block of sound, base64 of 16-bit samples; returns what was heard in it, hotword or
        stop, and after how many seconds of sound in all. Raises `InvalidCall`."""
        try:
            block = base64.b64decode(sound, validate=True)
        except (binascii.Error, ValueError) as error:
            raise InvalidCall("The sound is not written in base64.") from error
        page = self._known(connection, number)
        with page.lock:
            page.used = time.monotonic()
            samples = page.converter.convert(block)
            ears = {"hotword": page.hot_word, "stop": page.stop_word}
            return [
                {"what": what, "time": detection.time}
                for what, detector in ears.items()
                if detector is not None
                for detection in detector.feed(samples)
            ]

    def ignore(self, connection: str, number: int) -> None:
        """Listen no more. Raises `InvalidCall`."""
        self._known(connection, number)
        with self._lock:
            self._pages.pop(number, None)

    def left(self, connection: str) -> None:
        """A connection is gone."""
        with self._lock:
            for number, page in list(self._pages.items()):
                if page.connection == connection:
                    del self._pages[number]

    def services(self) -> dict[str, Service]:
        number = {"type": "integer", "minimum": 1}

        def attend(p: Mapping[str, Any], context: Context) -> int:
            return self.attend(context.connection, p["rate"], p.get("language", "en"))

        return {
            "voice.attend": service_of_call(
                attend,
                "Listen for the hot word at a client's microphone; returns a number.",
                {
                    "rate": {"type": "integer"},
                    "language": LANGUAGE,
                },
                "rate",
                result=int,
            ),
            "voice.notice": service_of_call(
                lambda p, context: self.notice(context.connection, p["attention"], p["sound"]),
                "Hand over a block of sound (base64 of 16-bit samples); returns what was heard in"
                " it: what (hotword | stop), and the time in seconds of sound. To call robot.stop"
                " is the client's.",
                {"attention": number, "sound": {"type": "string", "maxLength": LARGEST_BLOCK}},
                "attention sound",
                result=list[Noticed],
            ),
            "voice.ignore": service_of_call(
                lambda p, context: self.ignore(context.connection, p["attention"]),
                "Listen for the hot word no more.",
                {"attention": number},
                "attention",
                result=None,
            ),
        }

    def _known(self, connection: str, number: int) -> _Attentive:
        with self._lock:
            page = self._pages.get(number)
        if page is None or page.connection != connection:
            raise InvalidCall(
                f"Nobody listens as {number}, or sent no sound for a while."
                " Begin with voice.attend."
            )
        return page
