"""Whisper hears German and French, where there is no other speech model too."""

from __future__ import annotations

import shutil
import struct
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nl2robot.errors import UserError
from nl2robot.knowledge import DEFAULT_WORLD, Knowledge
from nl2robot.models.catalogue import ModelError
from nl2robot.speech.audio import RATE, Audio, read
from nl2robot.speech.hear import ct2_file
from nl2robot.speech.hear.answers import expect, hear_answer
from nl2robot.speech.hear.byte_pairs import BytePairs
from nl2robot.speech.hear.log_mel import BANDS, log_mel
from nl2robot.speech.hear.recogniser import LEAST_BELIEF, Recogniser, load
from nl2robot.speech.hear.rescorer import SecondEar
from nl2robot.speech.hear.whisper import Whisper
from nl2robot.speech.hotword.spotting import Spotter
from nl2robot.voice.hearing import Ear
from sim.world.loading import load_world
from tests.speech.conftest import RECORDED

COMMANDS = ["Fahr zur Apotheke und sag guten Morgen.", "Bring die rote Tasse zu Alice."]


@pytest.fixture(scope="module")
def german(whisper_model: Path) -> Whisper:
    return Whisper(whisper_model, "de")


@pytest.fixture(scope="module")
def unaided(german: Whisper) -> Recogniser:
    return Recogniser(None, "de", SecondEar(german, "de"))


# ── subwords ─────────────────────────────────────────────────────────────────────────────────


def test_german_and_french_are_written_in_few_subwords(german: Whisper) -> None:
    text = "Fahr zur Apotheke, frag „Müller“ und grüß Zoë: ça va?"
    numbers = german.subwords.of(text)
    assert german.subwords.text(numbers) == text
    assert german.subwords.text([*german.subwords.begin, *numbers, german.subwords.end]) == text
    assert len(german.subwords.of("Fahr zur Apotheke und sag guten Morgen.")) <= 14


@given(text=st.text(st.characters(exclude_categories=("C", "Z")), min_size=1, max_size=40))
def test_whatever_is_written_can_be_read_again(german: Whisper, text: str) -> None:
    assert german.subwords.text(german.subwords.of(text)) == text


def test_another_language_than_it_knows_is_an_error(whisper_model: Path) -> None:
    with pytest.raises(KeyError):
        BytePairs.load(whisper_model / "tokenizer.json", "tlh")


# ── what it looks at ─────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("hertz", [200, 1000, 4000])
def test_a_tone_is_seen_in_its_band(hertz: int) -> None:
    tone = np.sin(2 * np.pi * hertz * np.arange(RATE) / RATE) * 8000
    seen = log_mel(tone.astype(np.int16), 2.0)
    assert seen.shape == (BANDS, 200)
    loudest = seen[:, :90].mean(axis=1).argmax()
    lower, higher = (log_mel((0.5 * tone * 0).astype(np.int16), 2.0), seen)
    assert higher[loudest, 50] > lower[loudest, 50] + 0.5
    assert seen[loudest, 150] < seen[loudest, 50] - 0.5  # then it is silent
    order = {200: (0, 10), 1000: (20, 35), 4000: (50, 70)}[hertz]
    assert order[0] <= loudest <= order[1]


# ── the file ─────────────────────────────────────────────────────────────────────────────────


def ct2(values: dict[str, np.ndarray]) -> bytes:
    def text(written: str) -> bytes:
        return struct.pack("<H", len(written) + 1) + written.encode() + b"\0"

    kinds = {np.dtype(np.float32): 0, np.dtype(np.int8): 1, np.dtype(np.float16): 4}
    data = struct.pack("<I", 6) + text("WardSpec") + struct.pack("<II", 3, len(values))
    for name, value in values.items():
        data += (
            text(name)
            + struct.pack("<B", value.ndim)
            + struct.pack(f"<{value.ndim}I", *value.shape)
        )
        data += struct.pack("<BI", kinds[value.dtype], value.nbytes) + value.tobytes()
    return data


def test_weights_are_read_as_they_were_written(tmp_path: Path) -> None:
    values = {
        "a/weight": np.arange(6, dtype=np.float16).reshape(2, 3),
        "a/scale": np.ones(2, np.float32),
        "heads": np.array(8, np.int8),
    }
    file = tmp_path / "model.bin"
    file.write_bytes(ct2(values))
    found = ct2_file.read(file)
    assert {name: value.tolist() for name, value in found.items()} == {
        name: value.tolist() for name, value in values.items()
    }
    file.write_bytes(ct2(values)[:-1])
    with pytest.raises(ValueError, match="ends early"):
        ct2_file.read(file)
    file.write_bytes(b"\7\0\0\0" + ct2(values)[4:])
    with pytest.raises(ValueError, match="format 7"):
        ct2_file.read(file)


# ── hearing ──────────────────────────────────────────────────────────────────────────────────


def test_a_german_command_is_heard_as_people_write_it(german: Whisper) -> None:
    sound = german.listen(read(RECORDED / "apotheke.wav").samples)
    assert sound.texts()[0].text == "Fahr zur Apotheke und sag guten Morgen."
    quickly = german.listen(read(RECORDED / "apotheke.wav").samples).texts(width=1)
    assert "Apotheke" in quickly[0].text


def test_our_decoder_and_that_of_the_library_find_the_same_likelihood(german: Whisper) -> None:
    sound = german.listen(read(RECORDED / "apotheke.wav").samples)
    for text in sound.texts()[:3]:
        if text.text.endswith("."):
            (ours,) = sound.likelihoods([text.text])
            # the end may be said in other ways, so ours is a little more
            assert text.likelihood - 0.5 < ours < text.likelihood + 1.5


def test_what_may_be_said_helps_to_hear_it(german: Whisper) -> None:
    sound = german.listen(read(RECORDED / "apotheke.wav").samples)
    (best, *_) = sound.texts(german.expectation(COMMANDS))
    assert best.text == COMMANDS[0]
    right, other = sound.likelihoods([COMMANDS[0], "Fahr zur Küche und sag guten Morgen."])
    assert right > other + 3


@pytest.mark.parametrize("seconds", [0.0, 0.05, 2.0])
def test_silence_and_scraps_of_sound_are_no_trouble(german: Whisper, seconds: float) -> None:
    sound = german.listen(np.zeros(int(seconds * RATE), np.int16))
    assert sound.texts()
    assert sound.texts(german.expectation(COMMANDS))


def test_noise_is_not_turned_into_the_same_words_for_ever(german: Whisper) -> None:
    noise = np.random.default_rng(0).normal(0, 3000, 10 * RATE).astype(np.int16)
    words = german.listen(noise).texts(german.expectation(COMMANDS))[0].text.split()
    assert len(words) <= 10 * 9 + 8


def test_without_another_model_it_hears_commands_and_doubts_remarks(unaided: Recogniser) -> None:
    heard = unaided.recognise(read(RECORDED / "apotheke.wav"), COMMANDS)
    assert heard.text == "Fahr zur Apotheke und sag guten Morgen"
    assert not heard.doubtful
    assert heard.confidence > LEAST_BELIEF
    remark = unaided.recognise(read(RECORDED / "drucker.wav"), COMMANDS)
    assert "Drucker" in remark.text  # not a command that sounds alike
    assert unaided.recognise(Audio(np.zeros(RATE, np.int16)), COMMANDS).text == ""


def test_words_come_while_they_are_spoken(unaided: Recogniser) -> None:
    decoding = unaided.open(COMMANDS)
    said = []
    sound = read(RECORDED / "apotheke.wav").samples
    for at in range(0, len(sound), RATE // 10):
        decoding.feed(sound[at : at + RATE // 10])
        said.append(decoding.so_far)
    assert said[0] == ""
    assert any("apotheke" in text for text in said)
    assert len(set(said)) <= 2 + len(sound) / RATE / 0.8  # it tells anew now and then only
    assert decoding.finish().text == "Fahr zur Apotheke und sag guten Morgen"


def test_it_cannot_listen_for_a_hot_word(unaided: Recogniser) -> None:
    with pytest.raises(UserError, match="train the word"):
        Spotter(unaided, "guten Morgen Doktor")


def test_an_answer_is_heard(unaided: Recogniser) -> None:
    options = expect("Apotheke, Radiologie", "de")
    apotheke = Audio(
        read(RECORDED / "apotheke.wav").samples[: int(1.35 * RATE)]
    )  # "Fahr zur Apotheke"
    assert hear_answer(unaided, apotheke, options).answer == "Apotheke"
    assert hear_answer(unaided, read(RECORDED / "drucker.wav"), options).answer is None


@pytest.mark.parametrize(("language", "recording"), [("de", "apotheke"), ("fr", "pharmacie")])
def test_what_is_said_in_german_or_french_becomes_a_program(
    whisper_model: Path, language: str, recording: str
) -> None:
    ear = Ear(Knowledge(load_world(DEFAULT_WORLD)), language)
    heard = ear.hear(RECORDED / f"{recording}.wav")
    program = ear.translate(heard).program
    assert program is not None
    assert program.startswith('robot.goto("pharmacy")\nrobot.say(')


def test_a_language_whose_only_model_is_damaged_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NL2ROBOT_MODELS", str(tmp_path))
    (tmp_path / "whisper").mkdir()
    for name in ("model.bin", "config.json", "tokenizer.json", "vocabulary.txt"):
        (tmp_path / "whisper" / name).write_bytes(b"nothing")
    with pytest.raises(ModelError, match="nl2robot models get de --again"):
        load("de")


def test_a_model_that_is_no_model_is_told(tmp_path: Path, whisper_model: Path) -> None:
    with pytest.raises(ModelError, match="fetch it again"):
        Whisper(tmp_path, "de")
    shutil.copytree(whisper_model, tmp_path / "whisper")
    (tmp_path / "whisper" / "model.bin").write_bytes(b"nothing")
    with pytest.raises(ModelError, match="nl2robot models get whisper --again"):
        Whisper(tmp_path / "whisper", "de")
