"""A second ear tells short digits apart."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from nl2robot.speech.audio import RATE, Audio, read
from nl2robot.speech.digits import classifier as digits
from nl2robot.speech.digits import encoder as digits_encoder
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


def test_the_one_word_that_stands_out_of_noise_is_found() -> None:
    rng = np.random.default_rng(1)
    noise = rng.normal(0, 900, 3 * RATE).astype(np.float32)
    noise[RATE : RATE + RATE // 3] += tone(1 / 3, 9000)[: RATE // 3]
    steps = np.repeat(rng.uniform(0.2, 2, 30), RATE // 10).astype(np.float32)  # people about
    word = digits.word_in(noise * np.where(np.arange(len(noise)) // RATE == 1, 1, steps))
    assert len(word) == pytest.approx(RATE / 3, abs=RATE / 5)


def test_two_words_as_loud_are_no_one_digit() -> None:
    quiet = tone(0.4, 10)
    sound = np.concatenate([tone(0.4, 9000), quiet, tone(0.4, 8000)])
    assert len(digits.word_in(sound)) > RATE


def shares_of(name: str) -> dict[str, float] | None:
    ear = digits.load("en")
    assert ear is not None
    return ear.shares(read(RECORDED / name))


def test_seven_is_heard_and_a_sentence_is_no_digit() -> None:
    shares = shares_of("seven.wav")
    assert shares is not None
    assert set(shares) == {*digits.DIGITS, digits.NONE}
    assert max(shares, key=lambda digit: shares[digit]) == "7"
    assert sum(shares.values()) == pytest.approx(1)
    assert shares_of("chatter.wav") is None


def test_seven_is_heard_where_the_second_ear_is_not_installed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(digits, "encoder", lambda language: None)
    shares = shares_of("seven.wav")
    assert shares is not None
    assert max(shares, key=lambda digit: shares[digit]) == "7"


@pytest.mark.parametrize("seconds", [0.0, 0.5])
def test_silence_is_no_digit(seconds: float) -> None:
    ear = digits.load("en")
    assert ear is not None
    assert ear.shares(Audio(np.zeros(int(seconds * RATE), np.int16))) is None


def test_an_encoder_that_cannot_be_used_is_done_without(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    (tmp_path / "encoder_model.ort").write_bytes(b"damaged")
    monkeypatch.setattr(digits_encoder, "find", lambda name: tmp_path)
    assert digits_encoder.encoder.__wrapped__("en") is None
    assert "less well" in caplog.text
