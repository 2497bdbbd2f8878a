"""The benchmark of hearing plays fair: its rooms echo as told, and its tables count right."""

from __future__ import annotations

import numpy as np
import pytest

from nl2robot.hearing_benchmark import CONDITIONS, Outcome, Tally, word_errors
from nl2robot.speech import scenes
from nl2robot.speech.audio import RATE, Audio
from nl2robot.speech.trials import Trial, spoken


def outcome(kind: str, decibels: float | None, *, right: bool, asked: bool = False) -> Outcome:
    trial = Trial(
        kind, "go to the lobby", "joe", "babble", decibels, Audio(np.zeros(RATE, np.int16))
    )
    return Outcome(trial, "", right, asked, errors=0 if right else 2)


def test_a_room_echoes_as_loud_as_told() -> None:
    response = scenes.echo(np.random.default_rng(1), seconds=0.5, direct=6)
    rest = np.sum(np.square(response[1:]))
    assert 10 * np.log10(response[0] ** 2 / rest) == pytest.approx(6, abs=0.1)


def test_a_radio_plays_as_long_as_told() -> None:
    tune = scenes.music(2.0, np.random.default_rng(1))
    assert len(tune) == 2 * RATE
    assert 0.5 < np.abs(tune).max() <= 1


def test_words_left_out_put_in_and_mistaken_are_counted() -> None:
    said = ["go", "to", "the", "lobby"]
    assert word_errors(said, said) == 0
    assert word_errors(said, ["go", "the", "lobby", "now"]) == 2
    assert word_errors(said, []) == 4


def test_the_table_tells_shares_for_each_condition() -> None:
    tally = Tally("en")
    tally.outcomes = [
        outcome("new commands", None, right=True),
        outcome("new commands", 5.0, right=False),
        outcome("new commands", 5.0, right=False, asked=True),
        outcome("remarks", 5.0, right=False),
    ]
    rows = dict(tally.rows())
    at = CONDITIONS.index("5 dB")
    assert rows["new commands: right"][0] == "100 %"
    assert rows["new commands: wrong"][at] == "50 %"
    assert rows["new commands: asked again"][-1] == "33 %"
    assert rows["new commands: words wrong"][at] == "50 %"
    assert rows["remarks: acted on"][at] == "100 %"
    assert rows["remarks: acted on"][0] == "-"


@pytest.mark.parametrize("language", ["en", "de", "fr"])
def test_there_is_something_to_say_in_each_language(language: str) -> None:
    assert set(spoken(language)) == {"commands", "remarks", "asides", "options"}
    assert all(spoken(language).values())
