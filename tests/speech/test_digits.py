"""A second ear tells short digits apart."""

from __future__ import annotations

import numpy as np
import pytest

from nl2robot.speech import digits
from nl2robot.speech.audio import RATE, Audio, read
from nl2robot.speech.embeddings import WINDOW
from tests.speech.conftest import RECORDED


def tone(seconds: float, level: float) -> np.ndarray[tuple[int], np.dtype[np.float32]]:
    times = np.arange(int(seconds * RATE)) / RATE
    return np.asarray(level * np.sin(2 * np.pi * 440 * times), np.float32)


def test_a_word_is_found_in_the_quiet_around_it() -> None:
    sound = np.concatenate([tone(0.6, 10), tone(0.3, 9000), tone(0.6, 10)])
    assert len(digits.speech_in(sound)) == pytest.approx(0.3 * RATE, abs=RATE // 50)


def test_a_word_without_quiet_around_it_is_left_as_it_is() -> None:
    sound = tone(0.3, 9000)
    assert digits.speech_in(sound) is sound


def test_a_sound_is_put_into_the_window_at_full_loudness() -> None:
    window = digits.placed(tone(0.3, 10), 0.5)
    assert len(window) == WINDOW == len(digits.placed(tone(2, 10), 0.5))
    assert np.abs(window).max() == pytest.approx(digits.LOUDNESS, rel=0.01)
    assert not window[:3000].any()


def test_a_language_without_a_network_has_no_second_ear() -> None:
    assert digits.load("tlh") is None


def test_seven_is_heard_and_a_sentence_is_no_digit() -> None:
    ear = digits.load("en")
    assert ear is not None
    shares = ear.shares(read(RECORDED / "seven.wav"))
    assert shares is not None
    assert max(shares, key=lambda digit: shares[digit]) == "7"
    assert sum(shares.values()) == pytest.approx(1)
    assert ear.shares(read(RECORDED / "chatter.wav")) is None
    assert ear.shares(Audio(np.zeros(0, np.int16))) is None
