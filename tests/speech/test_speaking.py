"""The robot speaks one sentence after the other, and is silent at once when it has to be."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import miniaudio
import numpy as np
import pytest
import soundfile

from nl2robot.speech.hear.echo_cancelling import Played
from nl2robot.speech.speak import loudspeaker, speaking
from nl2robot.speech.speak.loudspeaker import (
    RATE,
    Handed,
    SoundCard,
    SoundError,
    WavFile,
)
from nl2robot.speech.speak.speaking import Speaker
from nl2robot.speech.speak.voices import Sound, VoiceError, never, voice

AT_ONCE = 0.1
SOON = 10.0


class Clock:
    """Time as the test has it."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


class Reader:
    """A voice that takes a second of sound for each word; it may be held up at each."""

    name = "reader"

    def __init__(self) -> None:
        self.may_go_on = threading.Event()
        self.may_go_on.set()
        self.asked = threading.Event()

    def speak(
        self,
        text: str,
        *,
        speed: float = 1.0,
        pitch: float = 1.0,
        stopped: Callable[[], bool] = never,
    ) -> Iterator[Sound]:
        for _ in text.split():
            self.asked.set()
            assert self.may_go_on.wait(SOON)
            yield Sound(np.full(RATE, 10_000, np.int16), RATE)


class Table(Handed):
    """Where sounds are laid; it may be held up until they count as heard."""

    def __init__(self, take: Callable[[Sound, float], None]) -> None:
        super().__init__(take)
        self.full = threading.Event()
        self.may_end = threading.Event()
        self.may_end.set()

    def drain(self, stopped: Callable[[], bool]) -> None:
        self.full.set()
        assert self.may_end.wait(SOON)


class Desk:
    """A speaker whose sounds are laid on a desk instead of being played."""

    def __init__(self) -> None:
        self.reader = Reader()
        self.clock = Clock()
        self.heard: list[tuple[float, float, int]] = []
        self.told: list[str] = []
        self.table = Table(self.take)
        self.speaker = Speaker(
            self.table,
            voice_for=lambda language: self.reader,
            clock=self.clock,
            tell=self.told.append,
        )

    def take(self, sound: Sound, at: float) -> None:
        self.heard.append((at, sound.seconds, int(sound.samples.max(initial=0))))


@pytest.fixture
def desk() -> Iterator[Desk]:
    desk = Desk()
    yield desk
    desk.reader.may_go_on.set()
    desk.speaker.close()


def test_one_text_is_spoken_after_the_other(desk: Desk) -> None:
    desk.reader.may_go_on.clear()
    first = desk.speaker.begin("One. Two. Three.")
    second = desk.speaker.begin("Four.")
    assert desk.speaker.is_speaking and not second.wait(0)
    desk.reader.may_go_on.set()
    assert second.wait(SOON) and first.whole
    assert [seconds for _, seconds, _ in desk.heard] == [1, 1, 1, 1]
    assert not desk.speaker.is_speaking


@pytest.mark.parametrize(
    ("volume", "loudest"), [(100, 10_000), (50, 2500), (0, 0), (900, 10_000), (-1, 0)]
)
def test_it_is_as_loud_as_it_was_told_to_be(desk: Desk, volume: int, loudest: int) -> None:
    desk.speaker.begin("Hello.", volume=volume).wait(SOON)
    assert desk.heard[-1][2] == loudest


def test_somebody_speaks_and_the_robot_lets_them(desk: Desk) -> None:
    desk.reader.may_go_on.clear()
    long, next_one = desk.speaker.begin("A long story."), desk.speaker.begin("Well.")
    assert desk.reader.asked.wait(SOON)
    desk.speaker.interrupt()
    assert not long.wait(0)  # at once, though the voice is still at work
    assert long.over.is_set()
    desk.reader.may_go_on.set()
    assert next_one.wait(SOON)
    assert len(desk.heard) == 1


def test_what_is_next_waits_until_somebody_else_has_ended(desk: Desk) -> None:
    desk.speaker.hold()
    text = desk.speaker.begin("Well.")
    assert not text.over.wait(0.05) and not desk.heard
    desk.speaker.go_on()
    assert text.wait(SOON)


def test_nobody_is_waited_for_for_ever(desk: Desk, monkeypatch) -> None:
    monkeypatch.setattr(speaking, "HELD", 0.0)
    desk.speaker.hold()
    assert desk.speaker.begin("Well.").wait(SOON)


def test_a_stop_drops_what_waits_for_somebody_else(desk: Desk) -> None:
    desk.speaker.hold()
    text = desk.speaker.begin("Well.")
    desk.speaker.stop()
    assert text.over.is_set() and not desk.speaker.is_speaking
    desk.speaker.go_on()
    assert desk.speaker.begin("Ready.").wait(SOON)
    assert len(desk.heard) == 1


def test_a_stop_drops_what_was_still_to_be_said(desk: Desk) -> None:
    desk.reader.may_go_on.clear()
    texts = [desk.speaker.begin(f"Text {number}.") for number in range(3)]
    assert desk.reader.asked.wait(SOON)
    desk.speaker.stop()
    assert [text.over.is_set() for text in texts] == [True] * 3
    assert not desk.speaker.is_speaking
    desk.reader.may_go_on.set()
    assert desk.speaker.begin("Ready.").wait(SOON)
    assert len(desk.heard) == 1


def test_stopping_twice_and_stopping_nothing(desk: Desk) -> None:
    desk.speaker.interrupt()
    desk.speaker.stop()
    text = desk.speaker.begin("Hello.")
    assert text.wait(SOON)
    text.cancel()
    assert text.whole


def test_a_voice_that_fails_is_told_of_once_and_the_robot_goes_on(desk: Desk) -> None:
    def no_voice(language: str) -> Reader:
        raise VoiceError("There is no voice on this machine.")

    speaker = Speaker(Handed(desk.take), voice_for=no_voice, tell=desk.told.append)
    assert not speaker.begin("Hello.").wait(SOON)
    assert desk.told == ["There is no voice on this machine."]
    speaker.close()


# --- a sound card --------------------------------------------------------------------------------


@pytest.fixture
def card() -> Iterator[SoundCard]:
    """One that takes sound in real time, but is not heard."""
    card = SoundCard([miniaudio.Backend.NULL])
    yield card
    card.close()


def test_a_greeting_is_played(card: SoundCard) -> None:
    speaker = Speaker(card, voice_for=lambda language: voice(language, "espeak"))
    began = time.perf_counter()
    assert speaker.begin("Hi.").wait(SOON)
    assert card.heard > 0.2 * RATE
    assert time.perf_counter() - began > card.heard / RATE
    speaker.close()


def test_it_is_silent_within_a_tenth_of_a_second(card: SoundCard) -> None:
    reader = Reader()
    speaker = Speaker(card, voice_for=lambda language: reader)
    text = speaker.begin("A long story.")
    while not card.heard:
        text.over.wait(0.005)
    began = time.perf_counter()
    speaker.interrupt()
    taken = time.perf_counter() - began
    heard = card.heard
    assert taken + loudspeaker.LATENCY < AT_ONCE
    assert not text.wait(SOON)
    assert speaker.begin("").wait(SOON) and card.heard == heard
    speaker.close()


def test_who_cancels_echoes_is_told_what_is_played_and_when(monkeypatch) -> None:
    played = Played()
    card = SoundCard([miniaudio.Backend.NULL], played)
    began = time.monotonic()
    card.write(tone(0.1), 0.0)
    card.drain(never)
    assert played.sounds(time.monotonic())
    ended = time.monotonic()
    heard = played.between(int(began * 16_000), int(ended * 16_000))
    assert 0.05 * 16_000 < np.count_nonzero(heard > 500) < 0.15 * 16_000
    card.close()


def test_the_loudspeaker_is_unplugged(card: SoundCard, monkeypatch) -> None:
    monkeypatch.setattr(loudspeaker, "_PATIENCE", 0.05)
    monkeypatch.setattr(card._device, "start", lambda feeding: None)
    told: list[str] = []
    speaker = Speaker(card, voice_for=lambda language: Reader(), tell=told.append)
    assert not speaker.begin("Hello.").wait(SOON)
    assert speaker.begin("Hello again.").wait(SOON)
    assert told == [
        "The loudspeaker takes no more sound, so nothing will be heard. Plug it in and start again."
    ]
    speaker.close()


def test_there_is_no_loudspeaker(monkeypatch) -> None:
    def none(*_: object, **__: object) -> None:
        raise miniaudio.MiniaudioError("failed to init device", -401)

    monkeypatch.setattr(miniaudio, "PlaybackDevice", none)
    with pytest.raises(SoundError, match=r"no loudspeaker .* --speak FILE\.wav"):
        SoundCard()


# --- a file --------------------------------------------------------------------------------------


def tone(seconds: float, rate: int = RATE) -> Sound:
    return Sound(np.full(int(seconds * rate), 1000, np.int16), rate)


def loud_parts(path: Path) -> list[tuple[float, float]]:
    """When something is heard: begin and end in seconds."""
    samples, rate = soundfile.read(path)
    loud = np.flatnonzero(np.diff(np.concatenate([[0], np.abs(samples) > 1e-3, [0]])))
    return [(round(a / rate, 2), round(b / rate, 2)) for a, b in loud.reshape(-1, 2)]


def test_a_file_has_each_sound_at_its_time(tmp_path: Path) -> None:
    clock = Clock()
    file = tmp_path / "folder" / "run.wav"
    speaker = Speaker(WavFile(file), voice_for=lambda language: Reader(), clock=clock)
    clock.now = 1.0
    speaker.begin("One. Two.").wait(SOON)
    clock.now = 2.0  # the robot in the simulation speaks faster than its voice
    speaker.begin("Three.").wait(SOON)
    speaker.play(tone(0.5, 16_000), at=6.0).wait(SOON)
    speaker.close()
    assert loud_parts(file) == [(1.0, 4.0), (6.0, 6.5)]


def test_a_file_that_is_cut_off_by_a_stop(tmp_path: Path) -> None:
    out = WavFile(tmp_path / "run.wav")
    out.write(tone(3), 1.0)
    out.silence(1.5)
    out.write(tone(1), 4.0)
    out.close()
    assert loud_parts(tmp_path / "run.wav") == [(1.0, 1.5), (4.0, 5.0)]


def test_a_robot_that_says_nothing_for_hours_fills_no_disk(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(loudspeaker, "LONGEST_PAUSE", 2.0)
    out = WavFile(tmp_path / "run.wav")
    for at in (0.0, 9000.0, 9002.0):
        out.write(tone(1), at)
        out.drain(never)
    out.close()
    assert loud_parts(tmp_path / "run.wav") == [(0.0, 1.0), (3.0, 4.0), (5.0, 6.0)]


@pytest.mark.parametrize("name", ["run.mp3", "run", "folder.wav"])
def test_a_file_that_cannot_be_written(tmp_path: Path, name: str) -> None:
    (tmp_path / "folder.wav").mkdir()
    with pytest.raises(SoundError, match="Choose a"):
        WavFile(tmp_path / name)


def test_a_full_disk_is_told_of_once(tmp_path: Path, monkeypatch) -> None:
    out = WavFile(tmp_path / "run.wav")

    def full(samples: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(out, "_file", type("Full", (), {"write": full, "close": lambda: None}))
    told: list[str] = []
    speaker = Speaker(out, voice_for=lambda language: Reader(), tell=told.append)
    for _ in range(3):
        speaker.begin("Hello.").wait(SOON)
    speaker.close()
    assert len(told) == 1 and "perhaps the disk is full" in told[0]
