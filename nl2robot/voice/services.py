"""A client's microphone over the wire: `voice.ready`, `voice.open`, `voice.push`, `voice.close`.

A browser, or any other client, opens an ear, pushes blocks of sound as they come, and is told in
the answer to each push what has happened by then: that somebody speaks, the words so far, and at
the end of the speech what was said and the program that it means. Where a language model thinks
about that, it hears on meanwhile, and a later push is told. Nothing is published to others, nothing
is kept, and nothing moves.
"""

from __future__ import annotations

import base64
import binascii
import itertools
import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final, Literal, NotRequired, TypedDict

import msgspec

from grammar.planning.planner import Interrupted
from nl2robot.knowledge import Knowledge
from nl2robot.models.catalogue import need
from nl2robot.schedule.schedule import Schedule
from nl2robot.speech.audio import Converter
from nl2robot.speech.hear.listening import (
    COMMANDS,
    HELD,
    NothingHeard,
    PartialText,
    SpeechBegan,
    SpeechEnded,
    TooLong,
)
from nl2robot.translate.outcome import Translation
from nl2robot.translate.talk import Talk
from nl2robot.translate.thinking import Thought, published
from nl2robot.wire import LANGUAGE, service, service_of_call
from nl2robot.work import Do, here
from robot_api.capabilities.sound import SILENT
from robot_api.driver import StopFlag
from robot_api.errors import InvalidCall
from robot_api.server import Service

if TYPE_CHECKING:
    from nl2robot.speech.audio import Samples
    from nl2robot.speech.hear.listening import Event, Listener
    from nl2robot.speech.hear.recogniser import Heard
    from nl2robot.speech.hotword.detector import Detector
    from nl2robot.voice.hearing import Ear
    from robot_api.server import Publish

MOST_OPEN: Final = 8
"""Microphones at a time; the one unused longest is closed for another."""
FORGOTTEN_AFTER: Final = 60.0
"""Seconds without a push."""
LARGEST_BLOCK: Final = 200_000
"""Characters of a block, in base64: some seconds of sound."""

AT_ONCE: Final = 0.5
"""Seconds that a push waits for a program, unless it is known before that it will take longer."""

TalkOf = Callable[[str | None], Talk]
"""The conversation of this name."""


class Happened(TypedDict):
    """What there was to tell of a microphone; `translation` is what was heard as a program."""

    what: Literal[
        "began", "partial", "thinking", "heard", "given up", "too long", "nothing", "stop"
    ]
    text: NotRequired[str]
    stop: NotRequired[bool]
    doubtful: NotRequired[bool]
    perhaps: NotRequired[str | None]
    translation: NotRequired[Translation]


@dataclass(frozen=True, eq=False)
class _Spoken:
    """Something that was said, and what is thought about it."""

    heard: Heard
    stop: bool
    """Whether it is a cry to stop."""
    thought: Thought[Translation]
    talk: Talk
    """What was said before it, and what it made of that."""
    connection: str


@dataclass
class _Open:
    """One microphone."""

    ear: Ear
    listener: Listener
    converter: Converter
    talk: str | None
    interrupts: bool
    """Whether the robot is to be silent when somebody begins to speak here."""
    connection: str
    """Whose it is."""
    number: int
    cries: Detector | None
    """Hears "stop", where that is to be told at once."""
    behind: list[Samples] = field(default_factory=list)
    """What was heard and is still to be recognised: a cry is told first."""
    spoken: list[_Spoken] = field(default_factory=list)
    """What was said and is still thought about."""
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
        publish: Publish | None = None,
        think: Do = here,
        schedule: Schedule | None = None,
    ) -> None:
        """`give_way` ends what the robot is saying. `publish` tells a microphone's client how far a
        language model is with what they said. `schedule` knows the appointments."""
        self._schedule = schedule
        self._think = think
        self._give_way = give_way
        self._publish = publish
        self._knowledge = knowledge
        self._talk_of = talk_of
        self._numbers = itertools.count(1)
        self._open: OrderedDict[int, _Open] = OrderedDict()
        self._ears: dict[str, Ear] = {}
        self._lock = threading.Lock()
        # What is thought about, of all microphones. Has a lock of its own, that is never held for
        # long: whoever stops the robot gives it up.
        self._thinking: list[_Spoken] = []
        self._thinking_lock = threading.Lock()

    def open(
        self,
        rate: int,
        channels: int,
        language: str,
        talk: str | None,
        *,
        interrupts: bool = False,
        held: bool = False,
        connection: str = "",
    ) -> int:
        """Listen to a microphone; returns its number. `interrupts`: whoever speaks there makes the
        robot silent, as the microphone does not hear the robot itself. `held`: it hears while a
        button is held; all that is said until it is closed is one command, and a cry of "stop" is
        told at once. `connection` is the client's. Raises `UserError` without a speech model, or
        for a rate that no voice has."""
        from nl2robot.speech.hotword.detector import stop_word

        ear = self._ear(language)
        listener = ear.listener(HELD if held else COMMANDS)
        cries = stop_word(language) if held else None
        converter, number = Converter(rate, channels), next(self._numbers)
        opened = _Open(ear, listener, converter, talk, interrupts, connection, number, cries)
        with self._lock:
            self._open[number] = opened
            forgotten = self._forgotten()
        for each in forgotten:
            self._drop(each)
        return number

    def get_ready(self, language: str) -> None:
        """Load what hears this language, so that the first command is heard as fast as the next.
        Raises `UserError` without a speech model."""
        self._ear(language).get_ready()

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
            samples = opened.converter.convert(block)
            opened.behind.append(samples)
            if opened.cries is not None and opened.cries.feed(samples):
                self._drop(opened)
                return [{"what": "stop"}, *self._thought(opened)]
            events = self._recognised(opened)
            return events + self._thought(opened)

    def close(self, number: int, stop: StopFlag | None = None) -> list[dict[str, Any]]:
        """No more sound comes: whoever still speaks has ended. Waits until all that was said is
        thought about, or given up with `stop`. Raises `InvalidCall`."""
        opened = self._known(number)
        with opened.lock:
            with self._lock:
                self._open.pop(number, None)
            opened.behind.append(opened.converter.finish())
            events = self._recognised(opened)
            events += [self._told(opened, event) for event in opened.listener.finish()]
            if stop is not None:
                stop.on_set(lambda: self._drop(opened))
            events += self._thought(opened, wait=True)
            return [event for event in events if event["what"] != "thinking"]

    def give_up(self, connection: str | None = None) -> None:
        """Nobody waits any more for what is thought about: the robot was stopped, or the client of
        this connection is gone. Returns at once."""
        with self._thinking_lock:
            given_up = [each for each in self._thinking if connection in (None, each.connection)]
        for each in given_up:
            each.thought.give_up()

    @staticmethod
    def _drop(opened: _Open) -> None:
        """What is thought about of one microphone is not wanted any more."""
        for each in tuple(opened.spoken):
            each.thought.give_up()

    def _recognised(self, opened: _Open) -> list[dict[str, Any]]:
        samples, opened.behind = opened.behind, []
        return [
            self._told(opened, event) for block in samples for event in opened.listener.feed(block)
        ]

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

    def _forgotten(self) -> list[_Open]:
        """Those that were not used for long are closed."""
        now = time.monotonic()
        return [
            self._open.pop(number)
            for number, opened in list(self._open.items())
            if now - opened.used > FORGOTTEN_AFTER or len(self._open) > MOST_OPEN
        ]

    def _ear(self, language: str) -> Ear:
        from nl2robot.voice.hearing import Ear

        need(language)
        with self._lock:
            if language not in self._ears:  # its phrases are those of the world
                self._ears[language] = Ear(self._knowledge(), language, self._think)
            return self._ears[language]

    def _told(self, opened: _Open, event: Event) -> dict[str, Any]:
        match event:
            case SpeechBegan():
                if opened.interrupts:
                    self._give_way()
                return {"what": "began"}
            case PartialText(text):
                stop = opened.ear.is_stop(text)
                if stop:
                    self._drop(opened)
                return {"what": "partial", "text": text, "stop": stop}
            case SpeechEnded():
                assert event.heard is not None
                return self._understood(opened, opened.ear.understood(event.heard))
            case TooLong():
                return {"what": "too long"}
            case NothingHeard():
                return {"what": "nothing"}

    def _understood(self, opened: _Open, heard: Heard) -> dict[str, Any]:
        """What was said with its program, or that it takes thinking."""
        stop = opened.ear.is_stop(heard.text)
        if stop:
            self._drop(opened)
        about = {"talk": opened.talk, "utterance": heard.text, "microphone": opened.number}
        talk = self._talk_of(opened.talk).copy()
        thought = Thought(
            lambda watch: opened.ear.translate(
                heard, talk=talk, watch=watch, schedule=self._schedule
            ),
            published(lambda kind, data: self._tell(opened.connection, kind, data), about),
        )
        spoken = _Spoken(heard, stop, thought, talk, opened.connection)
        opened.spoken.append(spoken)
        with self._thinking_lock:
            self._thinking.append(spoken)
        if thought.wait_a_moment(AT_ONCE):
            return self._heard(opened, spoken)
        return {"what": "thinking", "text": heard.text}

    def _thought(self, opened: _Open, *, wait: bool = False) -> list[dict[str, Any]]:
        """What came of what was thought about, as far as that is known by now."""
        return [
            self._heard(opened, spoken)
            for spoken in tuple(opened.spoken)
            if wait or spoken.thought.over
        ]

    def _heard(self, opened: _Open, spoken: _Spoken) -> dict[str, Any]:
        """What was said and the program that it means, once that is thought about."""
        try:
            translation = spoken.thought.result()
        except Interrupted:
            return {"what": "given up", "text": spoken.heard.text}
        finally:
            opened.spoken.remove(spoken)
            with self._thinking_lock:
                self._thinking.remove(spoken)
        if not spoken.heard.doubtful:
            self._talk_of(opened.talk).adopt(spoken.talk)
        return {
            "what": "heard",
            "text": spoken.heard.text,
            "stop": spoken.stop,
            "doubtful": spoken.heard.doubtful,
            "perhaps": spoken.heard.free_text,
            "translation": msgspec.to_builtins(translation),
        }

    def _tell(self, connection: str, kind: str, data: Mapping[str, Any]) -> None:
        if self._publish is not None:
            self._publish(kind, data, connection)


def voice_services(microphones: Microphones) -> dict[str, Service]:
    """The methods to register with a `robot_api.server.Server`."""
    number = {"type": "integer", "minimum": 1}
    return {
        "voice.open": service_of_call(
            lambda p, context: microphones.open(
                p["rate"],
                p.get("channels", 1),
                p.get("language", "en"),
                p.get("talk"),
                interrupts=p.get("interrupts", False),
                held=p.get("held", False),
                connection=context.connection,
            ),
            "Listen to a client's microphone; returns its number. With interrupts, whoever speaks"
            " there makes the robot silent: for one that does not hear the robot itself. With held,"
            " all until voice.close is one command, and stop is told at once.",
            {
                "rate": {"type": "integer"},
                "channels": {"type": "integer"},
                "language": LANGUAGE,
                "talk": {"type": ["string", "null"], "maxLength": 100},
                "interrupts": {"type": "boolean"},
                "held": {"type": "boolean"},
            },
            "rate",
            result=int,
        ),
        "voice.ready": service(
            lambda p: microphones.get_ready(p.get("language", "en")),
            "Load what hears a language: somebody is about to speak.",
            {"language": LANGUAGE},
            result=None,
        ),
        "voice.push": service(
            lambda p: microphones.push(p["microphone"], p["sound"]),
            "Hand over a block of sound (base64 of 16-bit samples); returns what happened: began,"
            " partial, heard with its program (where that takes a while: thinking, and in a later"
            " answer heard or given up), too long, and of a held microphone stop. To call"
            " robot.stop then is the client's.",
            {"microphone": number, "sound": {"type": "string", "maxLength": LARGEST_BLOCK}},
            "microphone sound",
            result=list[Happened],
        ),
        "voice.close": service_of_call(
            lambda p, context: microphones.close(p["microphone"], context.stop),
            "End listening; returns what was still to be told, once it is thought about.",
            {"microphone": number},
            "microphone",
            for_caller=True,
            result=list[Happened],
        ),
    }
