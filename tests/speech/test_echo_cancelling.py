"""The microphone beside the loudspeaker hears the people, and not the robot."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from nl2robot.bench.trials import Speaker
from nl2robot.speech import scenes
from nl2robot.speech.audio import RATE, Samples
from nl2robot.speech.hear.echo_cancelling import (
    KEPT,
    LINGERS,
    SLIP,
    EchoCanceller,
    EchoError,
    Played,
)
from nl2robot.speech.scenes import Signal
from nl2robot.speech.speak.voices import espeak

BLOCK = RATE // 50


def block(value: int) -> Samples:
    return np.full(BLOCK, value, np.int16)


# --- what is played ------------------------------------------------------------------------------


def test_what_was_played_is_found_at_its_time_and_silence_around_it() -> None:
    played = Played()
    played.add(block(5), RATE, at=1.0)
    assert (played.between(RATE, RATE + BLOCK) == 5).all()
    assert not played.between(RATE - BLOCK, RATE).any()
    assert not played.between(RATE + BLOCK, 2 * RATE).any()


def test_blocks_that_come_when_they_like_are_one_sound() -> None:
    played = Played()
    for number, at in enumerate((1.0, 1.035, 1.036, 1.061)):
        played.add(block(number + 1), RATE, at)
    found = played.between(RATE, RATE + 4 * BLOCK)
    assert found.tolist() == [number + 1 for number in range(4) for _ in range(BLOCK)]


def test_a_sound_card_that_has_stood_still_goes_by_the_clock_again() -> None:
    played = Played()
    played.add(block(1), RATE, at=1.0)
    played.add(block(2), RATE, at=1.0 + 2 * SLIP)
    first = round((1.0 + 2 * SLIP) * RATE)
    assert (played.between(first, first + BLOCK) == 2).all()
    assert not played.between(RATE + BLOCK, first).any()


def test_nothing_is_remembered_for_long() -> None:
    played = Played()
    for number in range(int(2 * KEPT / 0.02)):
        played.add(block(1), RATE, at=number * 0.02)
    assert not played.between(0, BLOCK).any()


def test_the_rate_of_the_sound_card_does_not_matter() -> None:
    played = Played()
    for number in range(20):
        played.add(np.full(441, 1000, np.int16), 22_050, at=1.0 + number * 0.02)
    assert np.median(played.between(int(1.1 * RATE), int(1.2 * RATE))) == pytest.approx(1000, abs=5)


def test_silence_is_not_heard_and_a_sound_lingers() -> None:
    played = Played()
    played.add(block(0), RATE, at=1.0)
    assert not played.sounds(1.0)
    played.add(block(1), RATE, at=1.02)
    assert played.sounds(1.03) and played.sounds(1.0 + LINGERS)
    assert not played.sounds(1.1 + LINGERS)


# --- what is heard -------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def robot() -> Signal:
    return Speaker(espeak("en", "")).say("The pharmacy is closed today. Please ring twice, Alice.")


def in_a_room(sound: Signal, late: float) -> Signal:
    from scipy.signal import fftconvolve

    room = scenes.echo(np.random.default_rng(1), 0.3)
    echo = np.concatenate([np.zeros(int(late * RATE)), fftconvolve(sound, room)])
    return np.asarray(echo[: len(sound)], np.float32)


def cleaned(robot: Signal, heard: Signal, start: float = 100.0) -> Signal:
    """By one whose robot has spoken the same twice before."""
    played = Played()
    canceller = EchoCanceller(played)
    robot, heard = (np.tile(sound[: len(sound) // BLOCK * BLOCK], 3) for sound in (robot, heard))
    clean = []
    for at in range(0, len(robot), BLOCK):
        now = start + at / RATE
        played.add(scenes.audio(robot[at : at + BLOCK]).samples, RATE, now)
        microphone = scenes.audio(heard[at : at + BLOCK]).samples
        clean.append(canceller.clean(microphone, now + BLOCK / RATE))
    sound = np.concatenate(clean) / np.float32(32768)
    return sound[-len(sound) // 3 :]


def decibels(sound: Signal) -> float:
    return 10 * float(np.log10(np.mean(np.square(sound)) + 1e-12))


@pytest.mark.parametrize("late", [0.02, 0.15])
def test_the_robot_does_not_hear_itself(robot: Signal, late: float) -> None:
    echo = in_a_room(robot, late)
    assert decibels(cleaned(robot, echo)) < decibels(echo) - 20


def test_who_speaks_alone_is_heard_as_they_are(robot: Signal) -> None:
    person = robot[::-1].copy()
    heard = cleaned(np.zeros_like(robot), person)
    assert abs(decibels(heard) - decibels(person)) < 1


def test_blocks_of_any_length_are_taken(robot: Signal) -> None:
    canceller = EchoCanceller(Played())
    samples = scenes.audio(robot[:RATE]).samples
    at, out = 0, []
    for length in (1, 159, 7, 1000, 333, 2500):
        out.append(canceller.clean(samples[at : at + length], (at + length) / RATE))
        at += length
    assert len(np.concatenate(out)) == at // 160 * 160


def test_who_lacks_the_library_is_told_what_to_install(monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "livekit.rtc", None)
    with pytest.raises(EchoError, match=r"goes on when you speak.*nl2robot\[echo\]"):
        EchoCanceller(Played())
