"""Talking with the robot: sound in, lines out, as if they had been typed.

    asleep --"hey robot"--> awake --somebody speaks--> a line --> asleep, or awake for an answer

Asleep, nothing is recognised but the hot word and, while the robot is busy, the cry of "stop".
Awake, what is said until the next pause is one line. `VoiceInput` knows no microphone, thread or
clock: time is counted in samples. `SpokenLines` runs it beside the keyboard.
"""

from __future__ import annotations

import logging
import queue
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, Final

from nl2robot.errors import UserError
from nl2robot.speech.audio import Samples
from nl2robot.speech.hear.listening import (
    Listener,
    NothingHeard,
    PartialText,
    SpeechBegan,
    SpeechEnded,
    TooLong,
)
from nl2robot.speech.hear.recogniser import PUNCTUATION, Heard
from nl2robot.speech.hotword.detector import Detector

_log: Final = logging.getLogger(__name__)

PATIENCE: Final = 8.0
"""Seconds that somebody may think after the hot word, or after a question."""
TAIL: Final = 0.5
"""Seconds after the hot word was reported in which its end may still sound. What begins then may
begin with a syllable of it, which is heard as some word or other."""
SHORTEST: Final = 0.8
"""Seconds of what may be more than the end of the hot word."""


@dataclass(frozen=True)
class Woke:
    """The hot word was heard."""

    word: str


@dataclass(frozen=True)
class Hears:
    """What it sounds like so far."""

    text: str


@dataclass(frozen=True)
class Said:
    """One utterance; empty if nothing was made of it."""

    text: str
    doubtful: bool = False
    perhaps: str = ""
    """What it may have been instead, where it is doubtful."""


@dataclass(frozen=True)
class Slept:
    """Nobody said anything for a while: the hot word is needed again."""


@dataclass(frozen=True)
class Cried:
    """ "Stop", while the robot was busy."""

    word: str


@dataclass(frozen=True)
class Ended:
    """There is no more sound: a recording is over."""


Event = Woke | Hears | Said | Slept | Cried | Ended


class VoiceInput:
    """What is said to the robot. To be used from one thread, but for `wake` and `busy`."""

    def __init__(
        self,
        listener: Callable[[], Listener],
        choose: Callable[[Heard], Heard],
        hot_word: Detector,
        stop_word: Detector,
        *,
        hot_words: Iterable[str] = (),
        says_itself: Callable[[str], bool] = lambda word: False,
    ) -> None:
        """`listener` makes one that recognises what may be said. `choose` takes of all readings
        the one that is understood. `hot_words` are dropped where an utterance begins with them.
        `says_itself` tells whether the robot has just spoken a word: it does not obey itself."""
        self._make = listener
        self._choose = choose
        self._hot_word, self._stop_word = hot_word, stop_word
        self._called = [tuple(words.lower().split()) for words in hot_words]
        self._says_itself = says_itself
        self._listener: Listener | None = None
        self._asked = False  # it was woken by a question, not by the hot word
        self._called_just_now = False  # the speech began right behind the hot word
        self._wanted = threading.Event()
        self._busy = threading.Event()

    @property
    def awake(self) -> bool:
        return self._listener is not None or self._wanted.is_set()

    def wake(self) -> None:
        """What is said next needs no hot word: a question was asked."""
        self._wanted.set()

    def busy(self, busy: bool) -> None:
        """Whether the robot moves or speaks: then "stop" is obeyed at once."""
        if busy:
            self._busy.set()
        else:
            self._busy.clear()

    def feed(self, samples: Samples) -> Iterator[Event]:
        """The next block at 16 kHz, of any length."""
        if self._busy.is_set():
            for cry in self._stop_word.feed(samples):
                if not self._says_itself(cry.word):
                    self._sleep()
                    yield Cried(cry.word)
        if self._wanted.is_set():
            self._wanted.clear()
            self._asked = True
            self._listener = self._listener or self._make()
        if self._listener is None:
            for heard in self._hot_word.feed(samples):
                if self._listener is None and not self._says_itself(heard.word):
                    self._listener = self._make()
                    yield Woke(heard.word)
            return
        yield from self._listen(samples)

    def _listen(self, samples: Samples) -> Iterator[Event]:
        assert self._listener is not None
        for event in self._listener.feed(samples):
            match event:
                case SpeechBegan(at):
                    self._called_just_now = not self._asked and at < TAIL
                case PartialText(text):
                    yield Hears(self._without_hot_word(text))
                case SpeechEnded(heard=Heard() as heard):
                    said = self._said(heard)
                    if said is None:  # only the hot word: the command comes behind it
                        self._asked = True
                        continue
                    self._sleep()
                    yield said
                    return
                case NothingHeard() | TooLong():
                    self._sleep()
                    yield Slept()
                    return

    def _said(self, heard: Heard) -> Said | None:
        """None for no more than the end of the hot word."""
        if heard.text and not self._without_hot_word(heard.text):
            return None
        chosen = self._choose(_without_first_words(heard) if self._called_just_now else heard)
        if self._called_just_now and heard.seconds_of_audio < SHORTEST:
            return None
        text = self._without_hot_word(chosen.text)
        perhaps = self._without_hot_word(chosen.free_text or "")
        # Where both decoders hear the same, it is for the conversation to make sense of it: "no,
        # the pharmacy" is no command by itself.
        return Said(text, chosen.doubtful and perhaps.lower() != text.lower(), perhaps)

    def _without_hot_word(self, text: str) -> str:
        """Without what is left of the hot word at the beginning: all of it, or its last words."""
        words = text.split()
        plain = tuple(word.strip(PUNCTUATION).lower() for word in words)
        for called in self._called:
            for first in range(len(called)):
                if plain[: len(called) - first] == called[first:]:
                    return " ".join(words[len(called) - first :])
        return text

    def _sleep(self) -> None:
        self._listener = None
        self._asked = False
        self._wanted.clear()
        self._hot_word.reset()


def _without_first_words(heard: Heard) -> Heard:
    """With readings that leave the first word out, too, behind those that do not."""
    shorter = [
        replace(reading, text=reading.text.partition(" ")[2])
        for reading in heard.readings
        if " " in reading.text
    ]
    return replace(heard, readings=(*heard.readings, *shorter))


class OwnVoice:
    """What the robot is saying, as its events tell: it must not obey itself."""

    _ECHO: Final = 0.5
    """Seconds for which a room, and a detector, may still be at its last word."""
    _SLOWEST: Final = 8.0
    """Letters a second: a text that nobody tells the end of is over by then."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._text = ""
        self._ends = 0.0

    def note(self, kind: str, data: Mapping[str, Any]) -> None:
        """An event of the kinds `speech` and `program`."""
        if kind == "speech":
            self._text = str(data["text"]).lower()
            self._ends = self._clock() + 1.0 + len(self._text) / self._SLOWEST
        elif data["what"] in ("result", "state"):
            self._ends = min(self._ends, self._clock())

    def says(self, word: str) -> bool:
        """Whether the robot is saying a word itself."""
        return self._clock() <= self._ends + self._ECHO and word.lower() in self._text


_LAST_BLOCK: Final = 0.3
"""Seconds that the sound heard last may take. What it is heard with goes when the program ends."""


class SpokenLines:
    """Lines from a microphone, in a thread of its own."""

    def __init__(self, voice: VoiceInput, blocks: Iterable[Samples]) -> None:
        self._voice = voice
        self._blocks = blocks
        self._events: queue.SimpleQueue[Event | UserError] = queue.SimpleQueue()
        self._closed = threading.Event()
        self._thread = threading.Thread(target=self._run, name="voice", daemon=True)

    def start(self) -> None:
        self._thread.start()

    def close(self) -> None:
        """Listen no more."""
        self._closed.set()
        if self._thread.is_alive():
            self._thread.join(_LAST_BLOCK)

    def use(self, voice: VoiceInput) -> None:
        """Listen in another way from now on, in another language."""
        self._voice = voice

    def wake(self) -> None:
        self._voice.wake()

    def busy(self, busy: bool) -> None:
        self._voice.busy(busy)

    def next(self, seconds: float) -> Event | None:
        """What happens within so many seconds. Raises `UserError`, once, when nothing more can be
        heard: the microphone was unplugged."""
        try:
            event = self._events.get(timeout=seconds)
        except queue.Empty:
            return None
        if isinstance(event, UserError):
            raise event
        return event

    def _run(self) -> None:
        try:
            for block in self._blocks:
                if self._closed.is_set():
                    return
                for event in self._voice.feed(block):
                    self._events.put(event)
            self._events.put(Ended())
        except UserError as error:
            self._events.put(error)
        except Exception:  # noqa: BLE001 - a fault of ours must not leave somebody speaking to a deaf robot
            _log.debug("Listening failed", exc_info=True)
            told = "Listening failed, so nothing more is heard. Type instead, or start again."
            self._events.put(UserError(told))
