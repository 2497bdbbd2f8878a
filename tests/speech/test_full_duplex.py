"""Somebody speaks while the robot does: it lets them, and listens."""

from __future__ import annotations

import argparse
import itertools
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager

import miniaudio
import numpy as np
import pytest

from nl2robot.cli.commands import chat
from nl2robot.cli.options.robot import robot_of
from nl2robot.speech.audio import RATE, AudioError, Samples
from nl2robot.speech.hear import full_duplex as module
from nl2robot.speech.hear.echo_cancelling import Played
from nl2robot.speech.hear.full_duplex import BargeIn, FullDuplex, Over, full_duplex
from nl2robot.speech.hear.listening import FRAME
from nl2robot.speech.hear.open_microphone import BEFORE, OpenMicrophone
from nl2robot.speech.speak import aloud as aloud_module
from nl2robot.speech.speak.aloud import RobotVoice, aloud
from nl2robot.speech.speak.loudspeaker import Nowhere, SoundCard
from nl2robot.speech.speak.speaking import Speaker
from nl2robot.speech.speak.voices import Sound
from nl2robot.speech.speak.wishes import Wishes
from robot_api.driver import StopFlag
from sim.world.loading import load_world

SOON = 10.0
SECOND = RATE // FRAME
QUIET, VOICE = np.zeros(FRAME, np.int16), np.full(FRAME, 9000, np.int16)


def is_loud(frame: Samples) -> float:
    return float(frame.max() > 5000)


def told(*frames: Samples, sounds: bool = True) -> list[Over]:
    barge_in = BargeIn(is_loud)
    return [over for frame in frames for over in barge_in.feed(frame, sounds)]


def test_who_speaks_over_the_robot_is_noticed_and_so_is_their_end() -> None:
    speech = [VOICE] * SECOND + [QUIET] * SECOND
    assert told(*[QUIET] * SECOND, *speech) == [Over.BEGAN, Over.ENDED]


def test_it_takes_four_tenths_of_a_second_at_most() -> None:
    barge_in = BargeIn(is_loud)
    frames = itertools.takewhile(lambda _: not barge_in.feed(VOICE, True), itertools.count())
    assert (len(list(frames)) + 1) * FRAME / RATE < 0.4


def test_a_cough_is_no_interruption() -> None:
    assert told(*[*[VOICE] * 5, *[QUIET] * 20] * 3) == []


def test_who_speaks_while_the_robot_is_silent_interrupts_nothing() -> None:
    assert told(*[VOICE] * 3 * SECOND, sounds=False) == []


def test_who_goes_on_is_followed_when_the_robot_is_silent() -> None:
    barge_in = BargeIn(is_loud)
    events = [over for n in range(40) for over in barge_in.feed(VOICE, n < 15)]
    assert events == [Over.BEGAN]
    assert [over for _ in range(SECOND) for over in barge_in.feed(QUIET, False)] == [Over.ENDED]


def test_a_word_without_a_voice_was_a_scrap_of_the_robots_own() -> None:
    barge_in = BargeIn(is_loud)
    barge_in.feed(QUIET, True)
    assert barge_in.nobody
    barge_in.feed(VOICE, True)
    assert not barge_in.nobody


def test_a_cry_just_before_the_robot_speaks_is_somebodys() -> None:
    barge_in = BargeIn(is_loud)
    barge_in.feed(VOICE, False)
    barge_in.feed(QUIET, True)
    assert not barge_in.nobody


def test_a_television_does_not_silence_the_robot_for_ever() -> None:
    assert told(*[VOICE] * 11 * SECOND)[:2] == [Over.BEGAN, Over.ENDED]


class Reader:
    """A voice that has a lot to say."""

    name = "reader"

    def speak(self, text: str, **_: object) -> Iterator[Sound]:
        yield Sound(np.full(RATE, 1000, np.int16), RATE)


class Loudspeaker(Nowhere):
    """Plays until it is silenced."""

    def __init__(self) -> None:
        self.playing = threading.Event()
        self.silenced = threading.Event()

    def write(self, sound: Sound, at: float) -> None:
        self.playing.set()

    def drain(self, stopped) -> None:
        assert self.silenced.wait(SOON)

    def silence(self, at: float) -> None:
        self.silenced.set()


class Room:
    """A robot that speaks, and a microphone that hears what the test wants."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(module, "voice_detector", lambda: is_loud)
        self.duplex = FullDuplex()
        monkeypatch.setattr(self.duplex._canceller, "clean", lambda samples, at: samples)
        self.loudspeaker = Loudspeaker()
        self.speaker = Speaker(self.loudspeaker, voice_for=lambda language: Reader())
        self.duplex.speaker = self.speaker

    def heard(self, *frames: Samples) -> Iterator[tuple[Samples, float]]:
        """While the robot's voice is in the room."""
        for number, frame in enumerate(frames):
            at = number * FRAME / RATE
            self.duplex.played.add(VOICE, RATE, at)
            yield frame, at


@pytest.fixture
def room(monkeypatch: pytest.MonkeyPatch) -> Iterator[Room]:
    room = Room(monkeypatch)
    yield room
    room.loudspeaker.silenced.set()
    room.speaker.close()


def test_the_robot_falls_silent_and_says_the_next_thing_when_they_have_ended(room: Room) -> None:
    story, next_one = room.speaker.begin("A long story."), room.speaker.begin("Well.")
    assert room.loudspeaker.playing.wait(SOON)
    blocks = room.duplex.hear(room.heard(*[VOICE] * SECOND, *[QUIET] * SECOND))
    for _ in range(SECOND):
        next(blocks)
    assert story.over.is_set() and not story.whole
    assert not next_one.over.wait(0.05)
    for _ in blocks:
        pass
    assert next_one.wait(SOON)


def test_a_program_goes_on_behind_an_interrupted_say(room: Room) -> None:
    stop = StopFlag()
    said = threading.Event()

    def program() -> None:
        with RobotVoice(room.speaker, room.duplex).speaking(stop, "A long story.", "en", 100):
            pass
        said.set()

    threading.Thread(target=program, daemon=True).start()
    assert room.loudspeaker.playing.wait(SOON)
    for _ in room.duplex.hear(room.heard(*[VOICE] * SECOND)):
        pass
    assert said.wait(SOON)


def test_an_unplugged_microphone_leaves_the_robot_its_voice(room: Room) -> None:
    def unplugged() -> Iterator[tuple[Samples, float]]:
        yield from room.heard(*[VOICE] * SECOND)
        raise AudioError("The microphone has stopped.")

    room.loudspeaker.silenced.set()
    with pytest.raises(AudioError):
        list(room.duplex.hear(unplugged()))
    assert room.speaker.begin("Well.").wait(SOON)


def test_without_the_library_the_robot_speaks_on_and_that_is_told(monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "livekit.rtc", None)
    messages: list[str] = []
    assert full_duplex(messages.append) is None
    assert len(messages) == 1


def test_the_simulated_robots_loudspeaker_tells_what_it_plays(room: Room, monkeypatch) -> None:
    class Card(SoundCard):
        def __init__(self, played: Played | None) -> None:
            super().__init__([miniaudio.Backend.NULL], played)

    monkeypatch.setattr(aloud_module, "SoundCard", Card)
    wishes = Wishes(speak=True, voice="espeak")
    with aloud(wishes, load_world("ward"), duplex=room.duplex) as sound_for:
        assert sound_for is not None
        loudspeaker = sound_for(lambda: 0.0).loudspeaker
        assert loudspeaker is not None and room.duplex.speaker is not room.speaker
        with loudspeaker.speaking(StopFlag(), "Hi.", "en", 100):
            pass
        assert room.duplex.played.sounds(time.monotonic())


@pytest.mark.parametrize(
    ("options", "here"),
    [
        (["--voice", "--speak"], True),
        (["--voice"], False),
        (["--speak"], False),
        (["--voice", "talk.wav", "--speak"], False),
        (["--voice", "--speak", "run.wav"], False),
        (["--voice", "--speak", "--robot", "ws://ward:9090"], False),
    ],
)
def test_it_takes_a_loudspeaker_and_a_microphone_that_are_both_here(
    options: list[str], here: bool
) -> None:
    parser = argparse.ArgumentParser()
    chat.add_arguments(parser)
    given = parser.parse_args(options)
    assert (chat._duplex(given, robot_of(given)) is not None) is here


# --- answers that begin before the question has ended --------------------------------------------


class Plugged:
    """A microphone that hears frame by frame, as the test goes on."""

    def __init__(self, room: Room, *frames: Samples) -> None:
        self._room, self._frames = room, frames
        self.heard = threading.Event()
        self.may_end = threading.Event()

    def timed_blocks(self) -> Iterator[tuple[Samples, float]]:
        yield from self._room.heard(*self._frames)
        self.heard.set()
        assert self.may_end.wait(SOON)
        raise AudioError("The microphone has stopped.")


def what_counts(room: Room, *frames: Samples) -> float:
    """Seconds of voice in what is there for one who begins to listen behind these."""
    plugged = Plugged(room, *frames)

    @contextmanager
    def opened() -> Iterator[Plugged]:
        yield plugged

    microphone = OpenMicrophone(room.duplex, opened)  # type: ignore[arg-type]
    microphone.start()
    assert plugged.heard.wait(SOON)
    blocks: list[Samples] = []
    with microphone() as heard, pytest.raises(AudioError):
        plugged.may_end.set()
        blocks.extend(heard)
    return sum(is_loud(samples) for samples in blocks) / SECOND


def test_who_answers_into_the_question_is_heard_from_their_first_word(room: Room) -> None:
    assert what_counts(room, *[QUIET] * SECOND, *[VOICE] * 3 * SECOND) == pytest.approx(3, abs=0.1)


def test_what_was_said_before_the_question_is_no_answer(room: Room) -> None:
    long_ago = [VOICE] * 8 + [QUIET] * round(BEFORE * SECOND)
    assert what_counts(room, *long_ago, *[QUIET] * 3) == 0


def test_a_fault_while_listening_leaves_nobody_waiting(room: Room) -> None:
    def opened() -> AbstractContextManager[Plugged]:
        raise ZeroDivisionError

    microphone = OpenMicrophone(room.duplex, opened)  # type: ignore[arg-type]
    with microphone() as heard, pytest.raises(AudioError, match="Ask again"):
        next(heard)


def test_who_still_listens_when_the_robot_is_switched_off_hears_nothing_more(room: Room) -> None:
    plugged = Plugged(room)

    @contextmanager
    def opened() -> Iterator[Plugged]:
        yield plugged

    microphone = OpenMicrophone(room.duplex, opened)  # type: ignore[arg-type]
    with microphone() as heard:
        assert plugged.heard.wait(SOON)
        microphone.close()
        assert list(heard) == []
    plugged.may_end.set()


def test_a_new_question_forgets_what_interrupted_the_last_one(room: Room) -> None:
    room.duplex.gave_way = True
    room.loudspeaker.silenced.set()
    with RobotVoice(room.speaker, room.duplex).speaking(StopFlag(), "Tea?", "en", 100):
        assert not room.duplex.gave_way
