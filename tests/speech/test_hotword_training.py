"""Heads are learned from some voices, and measured with others."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest
import soundfile

from nl2robot.bench import hotword_voices
from nl2robot.bench.hotword import Stage, all_said
from nl2robot.bench.hotword_corpus import Places, Speech, seeded, words_of
from nl2robot.bench.hotword_voices import ROBOTIC, UNSEEN, Cast, Half
from nl2robot.speech.audio import RATE, AudioError
from nl2robot.speech.hotword.head import Head
from nl2robot.speech.hotword.words import WORDS
from nl2robot.speech.scenes import level
from nl2robot.speech.speak.voices import Sound
from nl2robot.training.hotword.training import absent, joined, main, microphone, recorded

LIVELY = [
    "af_heart",
    "af_nova",
    "am_adam",
    "am_puck",
    "bf_emma",
    "bm_fable",
    "ff_siwis",
    "zm_yunxi",
]


class FakeKokoro:
    """Says nothing, but tells who was asked."""

    asked: ClassVar[list[str]] = []

    def __init__(self, speaker: str, language: str) -> None:
        self.name = f"kokoro-{speaker}"
        self.asked.append(f"{speaker} {language}")

    def speak(self, text: str, *, speed: float, pitch: float) -> list[Sound]:
        return [Sound(np.full(2400, 9000, np.int16), 24_000)]


def asked(monkeypatch: pytest.MonkeyPatch, language: str, half: Half) -> set[str]:
    monkeypatch.setattr(hotword_voices, "speakers", lambda: LIVELY)
    monkeypatch.setattr(hotword_voices, "Kokoro", FakeKokoro)
    monkeypatch.setattr(FakeKokoro, "asked", [])
    rng = seeded(0, language)
    cast = Cast(language, half, rng)
    for _ in range(60):
        assert len(cast.clip("stop", neural=True).heard(rng)) > 0
    return set(FakeKokoro.asked)


@pytest.mark.parametrize("language", ["en", "de", "fr"])
def test_who_is_learned_from_is_not_measured_with(
    language: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    learned = asked(monkeypatch, language, Half.TRAINING)
    measured = asked(monkeypatch, language, Half.EVALUATION)
    assert {each.split()[0] for each in learned} == set(LIVELY) - set(UNSEEN)
    assert {each.split()[0] for each in measured} == set(LIVELY) & set(UNSEEN)
    assert not set(ROBOTIC[Half.TRAINING]) & set(ROBOTIC[Half.EVALUATION])
    spoken = {each.split()[1] for each in learned | measured}
    assert spoken == {"en-us", "en-gb-x-rp"} if language == "en" else {language}


def test_without_neural_voices_one_trains_and_measures_with_robotic_ones(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As with `--word "hey pepper"` where nothing was fetched."""
    monkeypatch.setenv("NL2ROBOT_MODELS", str(tmp_path))
    cast = Cast("de", Half.TRAINING, seeded(0, "de"))
    assert (cast.has_neural, cast.neural_share) == (False, 0.0)
    stage = Stage(WORDS["de"], takes=2)
    assert stage.neural == (False,)
    (said,) = all_said(stage, "halt", 10, 1, neural=False)
    assert 1.6 < said.end < len(said.samples) / RATE


def test_noise_for_a_while_that_is_no_whole_number_of_samples_comes_to_an_end() -> None:
    sounds = list(Stage(WORDS["en"], takes=1).noises("corridor", 2.00006 / 3600))
    assert sum(len(sound.samples) for sound in sounds) == 2 * RATE


@pytest.mark.parametrize("language", ["en", "de", "fr"])
def test_nobody_says_the_words_by_chance(language: str) -> None:
    words = WORDS[language]
    avoid = frozenset(part for word in (words.hot, *words.stop) for part in words_of(word))
    remarks = {}
    for half in Half:
        speech = Speech(language, half, seeded(0, language), avoid)
        remarks[half] = {speech.remark() for _ in range(200)}
        assert not avoid & {word for text in remarks[half] for word in words_of(text)}
    assert not remarks[Half.TRAINING] & remarks[Half.EVALUATION]


def test_a_joined_head_is_as_sure_as_its_parts_are_on_average() -> None:
    rng = np.random.default_rng(0)
    sound = rng.normal(size=(1, 96)).astype(np.float32)

    def head() -> Head:
        weights = (rng.normal(size=(96, 4)), rng.normal(size=4), rng.normal(size=(4, 1)))
        return Head("stop", 0.5, (*weights, rng.normal(size=1)))

    def odds(head: Head) -> float:
        score = float(head.scores(sound)[0])
        return float(np.log(score / (1 - score)))

    heads = [head(), head()]
    assert odds(joined(heads)) == pytest.approx(np.mean([odds(each) for each in heads]), rel=0.01)


def test_a_microphone_is_near_or_far_and_never_louder_than_full_scale() -> None:
    rng = seeded(0, "microphone")
    tone = np.sin(np.arange(RATE) / 5).astype(np.float32)
    peaks = [float(np.abs(microphone(tone, rng)).max()) for _ in range(60)]
    assert max(peaks) <= 1
    assert min(peaks) < 0.05
    assert len(microphone(tone, rng)) == len(tone)


def test_recordings_of_a_ward_teach_what_is_not_the_word(tmp_path: Path) -> None:
    rng = seeded(0, "ward")
    for name, seconds in (("night.wav", 45), ("visits/day.flac", 3)):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        talk = rng.normal(0, 0.02, seconds * RATE)
        soundfile.write(tmp_path / name, talk, RATE)
    (tmp_path / "notes.txt").write_text("Recorded on ward 4.")
    pieces = recorded(tmp_path)
    assert [round(len(piece) / RATE) for piece in pieces] == [20, 20, 5, 3]
    assert [level(piece) for piece in pieces] == pytest.approx([0.1] * 4, rel=0.01)
    noise = rng.normal(0, 0.1, 60 * RATE).astype(np.float32)
    where = Places({"babble": [noise], "corridor": [noise], "noise": [noise]}, [], rng)
    examples = absent(pieces, where, rng)
    assert not examples.labels.any()
    # All of it twice, in steps of 80 ms.
    assert len(examples.ends) == pytest.approx(2 * 48 / 0.08, rel=0.15)


def test_a_recording_that_cannot_be_read_is_told(tmp_path: Path) -> None:
    (tmp_path / "broken.wav").write_bytes(b"RIFF")
    with pytest.raises(AudioError, match=r"broken\.wav"):
        recorded(tmp_path)


@pytest.mark.parametrize(
    ("file", "told"), [("broken.wav", "broken.wav"), ("notes.txt", "There is no recording in")]
)
def test_what_cannot_be_learned_from_is_told_before_half_an_hour_of_work(
    tmp_path: Path, file: str, told: str
) -> None:
    (tmp_path / file).write_bytes(b"RIFF")
    with pytest.raises(SystemExit, match=told):
        main(["--lang", "en", "--absent", str(tmp_path)])
