"""The robot listens all the time, for its name and for "stop"."""

from __future__ import annotations

import json
import tracemalloc
from pathlib import Path
from typing import cast

import numpy as np
import pytest
import soundfile

from nl2robot.bench.hotword_corpus import seeded, silence
from nl2robot.bench.hotword_voices import trimmed
from nl2robot.cli.main import main
from nl2robot.errors import UserError
from nl2robot.speech import scenes
from nl2robot.speech.audio import RATE, Samples, read
from nl2robot.speech.embeddings import STEP, EmbeddingStream, embed
from nl2robot.speech.hear.recogniser import Recogniser
from nl2robot.speech.hear.search import Network
from nl2robot.speech.hotword.detection import Detection
from nl2robot.speech.hotword.detector import Heads, HotWord, StopWord
from nl2robot.speech.hotword.head import Head, load_head
from nl2robot.speech.hotword.judge import Judge, judge_of
from nl2robot.speech.hotword.spotting import Spotter
from nl2robot.speech.hotword.words import WORDS
from nl2robot.speech.speak.voices import espeak, joined
from tests.speech.conftest import RECORDED, SHOWN


def spoken(text: str, language: str = "en-us", speaker: str = "m5") -> scenes.Signal:
    """In a voice that no head was trained with."""
    import soxr

    sound = joined(espeak(language, speaker).speak(text))
    samples = soxr.resample(sound.samples.astype(np.float32) / 32768, sound.rate, RATE)
    return trimmed(np.asarray(samples, np.float32)) * np.float32(0.5)


def said(text: str, language: str = "en-us", speaker: str = "m5") -> tuple[Samples, float]:
    """With silence around it; and when it ends, in seconds."""
    sound = spoken(text, language, speaker)
    whole = np.concatenate([silence(1), sound, silence(1)])
    return scenes.audio(whole).samples, 1 + len(sound) / RATE


@pytest.mark.parametrize(
    ("language", "voice"), [("en", "en-us"), ("de", "de"), ("fr", "fr")], ids=["en", "de", "fr"]
)
def test_the_robot_is_called_in_each_language(language: str, voice: str) -> None:
    """No speech model is needed: there is none for German here."""
    samples, end = said(WORDS[language].hot, voice, "f3")
    (heard,) = HotWord(language).feed(samples)
    assert heard.word == WORDS[language].hot
    assert heard.time == pytest.approx(end, abs=0.4)
    assert 0.5 < heard.score <= 1


@pytest.mark.parametrize("language", ["en", "de", "fr"])
def test_stop_is_heard_at_once_without_the_hot_word(language: str) -> None:
    ears = StopWord(language)
    assert ears.words == tuple(WORDS[language].stop)
    for word in ears.words:
        ears = StopWord(language)
        samples, end = said(f"{word}!", {"en": "en-us"}.get(language, language))
        heard = [each for each in ears.feed(samples) if each.word == word]
        assert len(heard) == 1
        assert heard[0].time < end + 0.3


def test_a_nurse_calls_the_robot_in_a_corridor_and_tells_it_what_to_do_at_once() -> None:
    speech = np.concatenate(
        [silence(1.5), spoken("hey robot"), silence(0.1), spoken("go to the pharmacy"), silence(1)]
    )
    rng = seeded(1, "a corridor")
    samples = scenes.audio(scenes.at_snr(speech, scenes.corridor(6, rng), 10, rng)).samples
    assert [each.word for each in HotWord("en").feed(samples)] == ["hey robot"]


def test_a_remark_a_command_without_a_name_and_silence_call_nobody() -> None:
    ears, stop = HotWord("en"), StopWord("en")
    for recording in (RECORDED / "chatter.wav", *SHOWN.glob("*.wav")):
        samples = read(recording).samples
        assert ears.feed(samples) == []
        assert stop.feed(samples) == []
    for quiet in (np.zeros(0, np.int16), np.zeros(1, np.int16), np.zeros(2 * RATE, np.int16)):
        assert ears.feed(quiet) == stop.feed(quiet) == []


def test_it_does_not_matter_in_what_blocks_the_sound_comes() -> None:
    samples, _ = said("hey robot")
    at_once = HotWord("en").feed(samples)
    ears = HotWord("en")
    heard = [each for block in np.array_split(samples, 77) for each in ears.feed(block)]
    assert [(each.word, each.time) for each in heard] == [(e.word, e.time) for e in at_once]
    assert len(heard) == 1


def test_after_a_pause_of_listening_the_same_is_heard_again() -> None:
    samples, _ = said("hey robot")
    ears = HotWord("en")
    first, cut = ears.feed(samples), ears.feed(samples[: 3 * len(samples) // 7])
    ears.reset()
    (again,) = ears.feed(samples)
    assert len(first) == 1
    assert cut == []
    assert again.time > 2 * first[0].time


def test_a_long_sound_has_the_embeddings_of_the_same_sound_as_it_comes() -> None:
    samples, _ = said("hey robot, what is the time?")
    stream = EmbeddingStream()
    blocks = [stream.feed(samples[at : at + 999]) for at in range(0, len(samples), 999)]
    assert len(embed(samples)) == len(samples) // STEP
    np.testing.assert_allclose(np.concatenate(blocks), embed(samples), atol=1e-3)
    assert embed(samples[:5]).shape == (0, 96)


def test_a_head_of_ones_own_is_found_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NL2ROBOT_HOME", str(tmp_path))
    (tmp_path / "hotwords" / "en").mkdir(parents=True)
    assert load_head("en", "hey ../../pepper") is None
    rng = np.random.default_rng(0)
    weights = (rng.normal(size=(96 * 3, 4)), np.zeros(4), rng.normal(size=(4, 1)), np.zeros(1))
    Head("Hey Pepper!", 0.25, weights).save(tmp_path / "hotwords" / "en")
    found = load_head("en", "hey pepper")
    assert found is not None
    assert (found.threshold, found.steps) == (0.25, 3)


# ── the second stage, where the second speech model is installed ─────────────────────────────


@pytest.mark.parametrize(
    ("language", "installed", "word", "other"),
    [
        ("en", "en-moonshine", "hey robot", "the robot"),
        ("de", "whisper", "hallo Roboter", "der Roboter"),
        ("fr", "whisper", "salut robot", "le robot"),
    ],
)
def test_the_second_stage_hears_the_word_in_what_the_head_is_unsure_of(
    language: str,
    installed: str,
    word: str,
    other: str,
    second_model: Path,
    whisper_model: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The same doubtful score, and one of them was it."""
    (tmp_path / installed).symlink_to(second_model.parent / installed)
    monkeypatch.setenv("NL2ROBOT_MODELS", str(tmp_path))
    judge = judge_of(language, word, 0.8)
    assert judge is not None
    verdicts = []
    for text in (word, other):
        samples, end = said(text, language, speaker="m3")  # clearly: both far from 0
        verdicts.append(judge.verdict(samples[: int((end + 0.08) * RATE)], 0.1))
    assert verdicts[0] > 0 >= verdicts[1]


def test_where_two_speech_models_are_installed_both_judge(
    second_model: Path, whisper_model: Path
) -> None:
    judge = judge_of("en", "hey robot", 0.8)
    assert judge is not None
    both, one = WORDS["en"].judged["hey robot"].ways
    assert judge.floor == both.floor < one.floor


@pytest.mark.parametrize(("likelihood", "asked"), [(-60.0, 0), (-2.0, 1)])
def test_the_slower_model_is_not_asked_of_what_the_quicker_one_ruled_out(
    likelihood: float, asked: int
) -> None:
    class Says:
        def __init__(self, likelihood: float) -> None:
            self.likelihood, self.asked = likelihood, 0

        def listen(self, samples: Samples) -> Says:
            self.asked += 1
            return self

        def likelihoods(self, texts: list[str]) -> list[float]:
            return [self.likelihood for _ in texts]

    judged = WORDS["en"].judged["hey robot"]
    quicker, slower = Says(likelihood), Says(-2.0)
    models = [cast("Network", quicker), cast("Network", slower)]
    verdict = Judge(models, judged, judged.ways[0], 0.8).verdict(said("hey robot")[0], 0.5)
    assert (quicker.asked, slower.asked) == (1, asked)
    assert (verdict > 0) == bool(asked)


def test_without_the_second_model_the_head_alone_decides(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NL2ROBOT_MODELS", str(tmp_path))
    assert judge_of("en", "hey robot", 0.8) is None
    assert len(StopWord("en").feed(said("stop!")[0])) == 1
    assert len(HotWord("en").feed(said("hey robot")[0])) == 1


def test_a_call_is_not_lost_when_the_second_stage_fails(caplog: pytest.LogCaptureFixture) -> None:
    class Broken:
        def listen(self, samples: Samples) -> None:
            raise RuntimeError("out of memory")

    head = load_head("en", "hey robot")
    assert head is not None
    judged = WORDS["en"].judged["hey robot"]
    judge = Judge([cast("Network", Broken())], judged, judged.ways[1], head.threshold)
    samples, _ = said("hey robot")
    (heard,) = Heads([head], [judge]).feed(samples)
    (alone,) = Heads([head], [None]).feed(samples)
    assert (heard.word, heard.time) == (alone.word, alone.time)
    assert "heard without it" in caplog.text


# ── a word without a head: by the speech model ───────────────────────────────────────────────


def test_any_other_name_is_heard_without_training(recogniser: Recogniser) -> None:
    samples, end = said("good morning doctor")
    (heard,) = Spotter(recogniser, "good morning doctor").feed(samples)
    assert heard.time == pytest.approx(end, abs=0.8)


def test_a_name_that_was_not_said_is_not_heard(recogniser: Recogniser) -> None:
    spotter = Spotter(recogniser, "good morning doctor")
    for recording in (RECORDED / "chatter.wav", *SHOWN.glob("*.wav")):
        assert spotter.feed(read(recording).samples) == []


@pytest.mark.parametrize("word", ["qwxyzal", "hey qwxyzal", "", "!"])
def test_a_name_that_can_never_be_heard_is_refused(recogniser: Recogniser, word: str) -> None:
    with pytest.raises(UserError, match=r"never hear it. Choose another hot word"):
        Spotter(recogniser, word)


def test_a_language_without_hot_words_is_said() -> None:
    with pytest.raises(UserError, match=r"no hot word for the language 'it'. There are: en, de"):
        HotWord("it")
    with pytest.raises(UserError, match="no hot word"):
        StopWord("it")


# ── the command ──────────────────────────────────────────────────────────────────────────────


def test_the_command_tells_when(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    samples, end = said("hey robot")
    file = tmp_path / "call.wav"
    soundfile.write(file, samples, RATE)
    assert main(["hotword", "--wav", str(file), "--json"]) == 0
    heard = json.loads(capsys.readouterr().out)
    assert heard["word"] == "hey robot"
    assert heard["time"] == pytest.approx(end, abs=0.4)
    assert main(["hotword", "--stop", "--wav", str(file)]) == 0
    assert capsys.readouterr().out == ""


def test_the_command_says_what_is_wrong(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NL2ROBOT_MODELS", str(tmp_path))
    assert main(["hotword", "--wav", str(tmp_path / "missing.wav")]) == 2
    assert "is not there" in capsys.readouterr().err
    wav = str(RECORDED / "seven.wav")
    assert main(["hotword", "--lang", "de", "--word", "hallo Anton", "--wav", wav]) == 2
    assert "Hier fehlt das Spracherkennungsmodell für Deutsch." in capsys.readouterr().err


# ── long recordings ──────────────────────────────────────────────────────────────────────────────


class Counts:
    """A detector that only counts, and hears a word at the end of each half hour."""

    def __init__(self, *_: object) -> None:
        self.samples = 0
        self.largest = 0

    def feed(self, samples: Samples) -> list[Detection]:
        before, self.samples = self.samples, self.samples + len(samples)
        self.largest = max(self.largest, len(samples))
        half = 1800 * RATE
        heard = self.samples // half > before // half
        return [Detection("hey robot", self.samples / RATE, 1.0)] if heard else []


def test_a_recording_of_an_hour_is_heard_in_the_memory_of_a_second(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    file, minutes, rate = tmp_path / "night.wav", 61, 8_000
    noise = np.random.default_rng(0).normal(0, 0.01, (60 * rate, 2)).astype(np.float32)
    with soundfile.SoundFile(file, "w", rate, 2, "ULAW") as sound:
        for _ in range(minutes):
            sound.write(noise)
    ears = Counts()
    monkeypatch.setattr("nl2robot.cli.commands.hotword.HotWord", lambda *_: ears)
    tracemalloc.start()
    try:
        assert main(["hotword", "--wav", str(file)]) == 0
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert ears.samples == pytest.approx(minutes * 60 * RATE, abs=RATE)
    assert ears.largest <= 2 * RATE
    assert peak < 20e6  # the samples alone are 117 MB
    assert len(capsys.readouterr().out.splitlines()) == 2


def test_a_long_recording_that_is_none_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "night.wav").write_bytes(b"RIFF" + bytes(100))
    assert main(["hotword", "--wav", str(tmp_path / "night.wav")]) == 2
    assert "is not a recording" in capsys.readouterr().err
    (tmp_path / "nothing.wav").write_bytes(b"")
    assert main(["hotword", "--wav", str(tmp_path / "nothing.wav")]) == 2
    assert "is empty" in capsys.readouterr().err
