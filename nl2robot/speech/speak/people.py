"""The simulated people, heard: each answers in a voice of their own, in a room that echoes, with
noise, and the robot makes of it what its recogniser makes of it.

Voice, speed and pitch are chosen by name, so Alice sounds the same in every run.
"""

from __future__ import annotations

import threading
import zlib
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, TypeVar

import numpy as np

from nl2robot.errors import UserError
from nl2robot.speech import scenes
from nl2robot.speech.audio import RATE, Audio
from nl2robot.speech.speak.loudspeaker import resampled
from nl2robot.speech.speak.voices import Sound, espeak, joined
from robot_api.capabilities.sound import Unsure
from robot_api.errors import NotPossible

if TYPE_CHECKING:
    from nl2robot.speech.hear.replies import Replies
    from nl2robot.speech.speak.speaking import Speaker
    from robot_api.capabilities.sound import Asked
    from robot_api.driver import StopFlag

T = TypeVar("T")

FEMALE: Final = ("f1", "f2", "f3", "f4", "f5")
MALE: Final = ("m1", "m2", "m3", "m4", "m5", "m6", "m7", "m8")
"""Speakers of espeak-ng that sound like people."""
SLOWEST, FASTEST = 0.85, 1.05
LOWEST, HIGHEST = 0.85, 1.15
ECHO: Final = 0.3
"""Seconds of reverberation: a furnished room."""
DIRECT: Final = 5.0
"""Decibels by which what comes straight is louder than its echo: from about a metre away."""
NOISE: Final = 20.0
"""Decibels by which a person nearby is louder than the corridor."""
_AROUND: Final = 0.3
"""Seconds of the room to hear before and after."""
_NOISE_SECONDS: Final = 10.0
_POLL: Final = 0.01


@dataclass(frozen=True)
class Person:
    """How somebody sounds."""

    variant: str
    speed: float
    pitch: float


def person_called(name: str, gender: str | None = None) -> Person:
    """The same for the same name, on every machine."""
    rng = np.random.default_rng(zlib.crc32(name.lower().encode()))
    variants = {"female": FEMALE, "male": MALE}.get(gender or "", FEMALE + MALE)
    return Person(
        str(rng.choice(variants)),
        float(rng.uniform(SLOWEST, FASTEST)),
        float(rng.uniform(LOWEST, HIGHEST)),
    )


class SimulatedVoices:
    """What the robot hears of the people in a simulation; `robot_api.capabilities.sound.Voices`."""

    def __init__(
        self,
        *,
        replies: Replies,
        genders: Mapping[str, str | None],
        speaker: Speaker,
        clock: Callable[[], float],
        seed: int = 0,
    ) -> None:
        """`replies` makes words of what is heard. `speaker` lets it be heard at the times of
        `clock`."""
        self.replies = replies
        self._genders = genders
        self._speaker = speaker
        self._clock = clock
        self._rng = np.random.default_rng(seed)
        self._room = _from_nearby(scenes.echo(self._rng, ECHO))
        self._noise = scenes.corridor(_NOISE_SECONDS, self._rng)
        self._lock = threading.Lock()  # for the random numbers

    def heard(self, stop: StopFlag, person: str, words: str, asked: Asked) -> str | None:
        """As `Voices.heard`. Raises `NotPossible` where the language cannot be heard here."""
        try:
            at_microphone = self.sound_of(person, words, asked.language)
            said = Sound(at_microphone.samples, RATE)
            playing = self._speaker.play(said, max(0.0, self._clock() - said.seconds))
            stop.on_set(playing.cancel)
            heard = _attended(lambda: self.replies.recognised(at_microphone, asked), stop)
        except UserError as error:
            raise NotPossible(str(error)) from error
        playing.wait()
        stop.check()
        # Whether that was it, nobody who is simulated would know to answer.
        return (heard.words if isinstance(heard, Unsure) else heard) or None

    def sound_of(self, person: str, words: str, language: str) -> Audio:
        """It at the robot's microphone."""
        who = person_called(person, self._genders.get(person))
        speech = espeak(language, who.variant).speak(words, speed=who.speed, pitch=who.pitch)
        clean = resampled(joined(speech), RATE)
        quiet = np.zeros(int(_AROUND * RATE), np.int16)
        signal = scenes.signal(Audio(np.concatenate([quiet, clean, quiet])))
        with self._lock:
            echoing = scenes.echoing(signal, self._room)
            return scenes.audio(scenes.at_snr(echoing, self._noise, NOISE, self._rng))


def _from_nearby(room: scenes.Signal) -> scenes.Signal:
    """The room's impulse response for somebody who stands close to the microphone."""
    echo = room[1:]
    wanted = abs(float(room[0])) / 10 ** (DIRECT / 20)
    near = echo * (wanted / max(float(np.linalg.norm(echo)), 1e-9))
    return np.concatenate([room[:1], near.astype(np.float32)])


def _attended(work: Callable[[], T], stop: StopFlag) -> T:
    """Its result, in a thread of its own: a stop waits for no recogniser."""
    done: Future[T] = Future()

    def run() -> None:
        try:
            done.set_result(work())
        except BaseException as error:  # noqa: BLE001 - raised by `result`
            done.set_exception(error)

    threading.Thread(target=run, name="recogniser", daemon=True).start()
    while True:
        stop.check()
        try:
            return done.result(_POLL)
        except TimeoutError:
            if done.done():  # it raised one of its own
                raise
