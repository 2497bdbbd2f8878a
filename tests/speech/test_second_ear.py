"""The second ear: it hears what the other one does not, and says what is to be believed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nl2robot.models.catalogue import ModelError
from nl2robot.speech.audio import RATE, read
from nl2robot.speech.hear.expectation import ANYTHING, Expectation
from nl2robot.speech.hear.moonshine import Moonshine
from nl2robot.speech.hear.recogniser import LEAST_BELIEF, Recogniser
from nl2robot.speech.hear.rescorer import Evidence, SecondEar
from nl2robot.speech.hear.subwords import BEGIN, END, Subwords

SHOWN = Path(__file__).parents[2] / "nl2robot" / "data" / "recordings"
RECORDED = Path(__file__).parent / "recordings"
COMMANDS = [
    "go to the pharmacy and say good morning",
    "wait for a visitor, then take them to radiology",
    "take the visitor to Alice",
]


@pytest.fixture(scope="module")
def moonshine(second_model: Path) -> Moonshine:
    return Moonshine(second_model)


@pytest.fixture(scope="module")
def ear(moonshine: Moonshine) -> SecondEar:
    return SecondEar(moonshine)


# ── subwords ─────────────────────────────────────────────────────────────────────────────────


def _file_of(*subwords: str) -> bytes:
    first = [b"\5<unk>", b"\3<s>", b"\4</s>", *(b"\1" + bytes([byte]) for byte in range(256))]
    return b"".join(first) + b"".join(
        bytes([len(each.encode())]) + each.encode() for each in subwords
    )


def test_subwords_are_merged_as_they_were_learned(tmp_path: Path) -> None:
    file = tmp_path / "tokenizer.bin"
    file.write_bytes(_file_of("▁", "g", "o", "w", "▁g", "▁go", "ow"))
    subwords = Subwords.load(file)
    assert subwords.text(subwords.of("go gow")) == "go gow"
    # "▁g" was learned before "ow", and "▁go" before that too
    assert [subwords.text([n]) for n in subwords.of("gow")] == ["go", "w"]


@given(st.text(st.characters(exclude_categories=("C", "Z"), exclude_characters="▁"), min_size=1))
def test_whatever_is_written_can_be_read_again(word: str) -> None:
    subwords = Subwords(
        [b"<unk>", b"<s>", b"</s>", *(bytes([b]) for b in range(256)), "▁".encode()]
    )
    assert subwords.text([BEGIN, *subwords.of(f"{word} {word}"), END]) == f"{word} {word}"


@pytest.mark.parametrize("cut", [1, 3, 8])
def test_a_file_of_subwords_that_ends_early_is_told(tmp_path: Path, cut: int) -> None:
    file = tmp_path / "tokenizer.bin"
    file.write_bytes(_file_of("▁go", "▁pharmacy")[:-cut])
    with pytest.raises(ValueError, match="in the middle"):
        Subwords.load(file)


# ── what is likely to be said ────────────────────────────────────────────────────────────────


def test_what_follows_in_the_sentences_is_likely_and_nothing_is_impossible() -> None:
    expectation = Expectation([[10, 11, 12], [10, 11, 13], [20, 11, 14]], 100)
    after = expectation.after([BEGIN, 10, 11])
    assert after.argmax() in (12, 13)
    assert after[12] > after[14] > after[50]  # 14 follows 11, though not here
    assert after[50] > np.log(ANYTHING) - 10
    assert (
        expectation.of([10, 11, 12]) > expectation.of([20, 11, 12]) > expectation.of([50, 51, 52])
    )


@given(st.lists(st.lists(st.integers(3, 30), min_size=1, max_size=8), min_size=1, max_size=8))
def test_the_likely_ones_make_up_a_whole(sentences: list[list[int]]) -> None:
    expectation = Expectation(sentences, 40)
    for before in ([BEGIN], [BEGIN, *sentences[0]], [BEGIN, 39]):
        whole = float(np.exp(expectation.after(before)).sum())
        assert 1 <= whole <= 1 + 50 * ANYTHING + 0.01


# ── hearing ──────────────────────────────────────────────────────────────────────────────────


def test_a_command_is_heard_as_people_write_it(moonshine: Moonshine) -> None:
    sound = moonshine.listen(read(SHOWN / "pharmacy.wav").samples)
    assert sound.texts()[0].text == "Go to the pharmacy and say good morning."


def test_what_may_be_said_helps_to_hear_it(moonshine: Moonshine) -> None:
    """ "Wait for a visitor, then take them to radiology", of which freely it makes a "busier"."""
    sound = moonshine.listen(read(SHOWN / "visitor.wav").samples)
    freely = sound.texts()[0].text
    expecting = sound.texts(moonshine.expectation(["Wait for a visitor.", "Go to radiology."]))
    assert "visitor" not in freely
    assert "visitor" in expecting[0].text


def test_the_likelihood_is_that_of_the_text_it_writes(moonshine: Moonshine) -> None:
    sound = moonshine.listen(read(SHOWN / "pharmacy.wav").samples)
    best = sound.texts()[0]
    right, other = sound.likelihoods([best.text, "Go to the kitchen and say good morning."])
    assert right == pytest.approx(best.likelihood, abs=1.0)  # whatever the end is
    assert right > other + 3
    assert sound.likelihoods([]) == []


@pytest.mark.parametrize("seconds", [0.0, 0.05, 2.0])
def test_silence_and_scraps_of_sound_are_no_trouble(moonshine: Moonshine, seconds: float) -> None:
    sound = moonshine.listen(np.zeros(int(seconds * RATE), np.int16))
    assert sound.texts()


def test_noise_is_not_turned_into_the_same_words_for_ever(moonshine: Moonshine) -> None:
    noise = np.random.default_rng(0).normal(0, 3000, 10 * RATE).astype(np.int16)
    words = moonshine.listen(noise).texts(width=1)[0].text.split()
    assert len(words) <= 10 * 6.5 + 8
    assert not any(words[at : at + 2] * 4 == words[at : at + 8] for at in range(len(words)))


def test_what_others_heard_is_judged_as_well(ear: SecondEar) -> None:
    samples = read(SHOWN / "visitor.wav").samples
    heard = ear.hear(samples, COMMANDS, ["wait for a visitor then take them to radiology"])
    best = heard.readings[0]
    assert best.text.replace(",", "") == "wait for a visitor then take them to radiology"
    assert best.evidence.belief > 0.9
    assert "visitor" not in heard.free


def test_a_remark_is_not_believed_to_be_a_command(ear: SecondEar) -> None:
    heard = ear.hear(read(RECORDED / "chatter.wav").samples, COMMANDS, [COMMANDS[0]])
    beliefs = {each.text: each.evidence.belief for each in heard.readings}
    assert beliefs[COMMANDS[0]] < LEAST_BELIEF
    assert "printer" in heard.free


def test_belief_grows_with_the_evidence() -> None:
    some = Evidence(unlikely=6.0, subwords=8, unexpected=4.0, agreed=False)
    more = Evidence(unlikely=2.0, subwords=8, unexpected=4.0, agreed=False)
    both = Evidence(unlikely=6.0, subwords=8, unexpected=4.0, agreed=True)
    odd = Evidence(unlikely=6.0, subwords=8, unexpected=8.0, agreed=False)
    assert odd.belief < some.belief < min(more.belief, both.belief)
    nonsense = Evidence(unlikely=1e5, subwords=200, unexpected=10.0, agreed=False)
    assert 0 <= nonsense.belief < 1e-9


def test_the_recogniser_takes_its_word(recogniser: Recogniser) -> None:
    assert recogniser.second is not None
    heard = recogniser.recognise(read(SHOWN / "visitor.wav"), COMMANDS)
    assert heard.text.replace(",", "") == "wait for a visitor then take them to radiology"
    assert not heard.doubtful
    remark = recogniser.recognise(read(RECORDED / "chatter.wav"), COMMANDS)
    assert remark.text.startswith("the printer is out of paper")  # not a command that sounds alike
    free = recogniser.recognise(read(RECORDED / "chatter.wav"))
    assert free.text.startswith("the printer is out of paper")


def test_what_goes_on_for_too_long_is_doubted(recogniser: Recogniser) -> None:
    command = read(SHOWN / "pharmacy.wav")
    long = type(command)(np.tile(command.samples, 13))
    assert recogniser.recognise(long, COMMANDS).doubtful


def test_a_model_that_is_no_model_is_told(tmp_path: Path) -> None:
    (tmp_path / "encoder_model.ort").write_bytes(b"nothing")
    with pytest.raises(ModelError, match="fetch it again"):
        Moonshine(tmp_path)
