"""The ear for digits learns from people who say them with accents, near and far."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pytest

from nl2robot.speech.audio import RATE
from nl2robot.speech.speak.voices import VoiceError, voices
from nl2robot.training.digits import speakers as digits_speakers
from nl2robot.training.digits import training as digits_training


def test_what_can_be_told_apart_is_learned() -> None:
    rng = np.random.default_rng(2)
    answers = rng.integers(0, digits_speakers.NONE + 1, 4000)
    values = (np.eye(digits_speakers.NONE + 1)[answers] + rng.normal(0, 0.1, (4000, 11))) * 5
    network = digits_training._fitted(values.astype(np.float32), answers, "encoder", rng)
    both = digits_training._together([network, network])
    assert (both.log_shares(values).argmax(axis=1) == answers).mean() > 0.97
    assert both.log_shares(values) == pytest.approx(network.log_shares(values))


def test_a_word_is_heard_in_many_ways_and_stays_a_word() -> None:
    rng = np.random.default_rng(3)
    word = np.sin(np.arange(RATE // 2) / 5).astype(np.float32) * 0.5
    noise = rng.normal(0, 0.2, 2 * RATE).astype(np.float32)
    heard = [digits_training.heard(word, [noise], rng) for _ in range(30)]
    assert all(0.2 < audio.seconds < 2 for audio in heard)
    assert len({audio.samples.tobytes() for audio in heard}) == 30


@pytest.mark.parametrize("language", ["en", "de", "fr"])
def test_a_speaker_says_the_same_at_every_training(language: str) -> None:
    said = [digits_speakers._saying(language, "ff_siwis", digit, 0) for digit in range(10)]
    assert said == [digits_speakers._saying(language, "ff_siwis", n, 0) for n in range(10)]
    assert all(text.strip(" .?!") and 0.7 < speed < 1.5 for _, text, speed in said)


def test_robots_speak_every_digit_without_a_pause_around_it() -> None:
    try:
        voices("en")[-1]
        spoken = list(islice(digits_speakers.robotic("en", np.random.default_rng(1)), 12))
    except (IndexError, VoiceError):
        pytest.skip("no voice is installed")
    assert all(0.1 < len(each.sound) / RATE < 2 for each in spoken)
    assert all(np.abs(each.sound).max() == pytest.approx(0.5, abs=0.01) for each in spoken)
