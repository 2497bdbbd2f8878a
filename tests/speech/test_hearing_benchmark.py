"""The benchmark of hearing plays fair: its rooms echo as told, and its tables count right."""

from __future__ import annotations

import numpy as np
import pytest

from nl2robot.bench.belief import WAYS, Case, counted, fitted
from nl2robot.bench.hearing import CONDITIONS, Outcome, Tally, word_errors
from nl2robot.bench.trials import Trial, spoken
from nl2robot.speech import scenes
from nl2robot.speech.audio import RATE, Audio
from nl2robot.speech.hear.rescorer import Evidence


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


# ── when to believe what was heard ───────────────────────────────────────────────────────────


def case(speaker: str, unlikely: float, program: str | None, wanted: str | None) -> Case:
    trial = Trial("command", "x", speaker, "babble", 5.0, Audio(np.zeros(RATE, np.int16)))
    evidence = Evidence(unlikely, 6, 3.0, agreed=False)
    return Case(trial, wanted, ((evidence, program),) if program else (), ())


def test_the_limit_is_set_with_some_voices_and_counted_with_others() -> None:
    way = WAYS["second ear: likelihood"]
    clear = [case(voice, 1.0, "go", "go") for voice in ("joe", "ann")]
    noisy = [case(voice, 9.0, "come", "go") for voice in ("joe", "ann")]
    remarks = [case(voice, 5.0, "go", None) for voice in ("joe", "ann")]
    silent = [case("joe", 0.0, None, "go")]
    halves = [
        [each for each in (*clear, *noisy, *remarks, *silent) if each.trial.speaker == voice]
        for voice in ("joe", "ann")
    ]
    assert counted(halves, lambda known: way) == (2, 0, 0)
    deaf = [case("tom", 1.0, "come", "go"), case("tom", 5.0, "go", "go")]
    # tom's limit lets a remark of joe's in, and joe's a wrong program of tom's
    assert counted([deaf, halves[0]], lambda known: way) == (1, 1, 1)


def test_the_weights_of_the_belief_tell_right_from_wrong() -> None:
    cases = [case("joe", 1.0 + n / 20, "go", "go") for n in range(20)]
    cases += [case("joe", 6.0 + n / 20, "come", "go") for n in range(20)]
    constant, unlikely, *_ = fitted(cases)
    assert unlikely < 0
    assert constant + unlikely * 1.0 > constant + unlikely * 8.0
