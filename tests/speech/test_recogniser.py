"""A real speech model hears commands, and notices what is none."""

from __future__ import annotations

import shutil
import threading
from pathlib import Path

import numpy as np
import pytest
import soundfile

from nl2robot.bench import recognition as benchmark
from nl2robot.models.catalogue import ModelError, need
from nl2robot.speech.audio import RATE, Audio, read
from nl2robot.speech.hear.levels import gain_for
from nl2robot.speech.hear.recogniser import Heard, Reading, Recogniser, SpeechError, choose
from tests.speech.conftest import RECORDED, SHOWN

# A small ward's way of talking: more words than the recordings hold, and ones that sound alike.
PHRASES = [
    "go to the pharmacy and say good night",
    "go to the lobby and say good morning",
    "wait for a nurse then bring them here",
    "wait for a visitor then take them to the x-ray room",
    "take the patient to radiology",
    "take two cups too",
    "turn left and move 2 metres",
    "stop",
]


def test_the_commands_of_the_demonstration_are_heard_word_for_word(recogniser: Recogniser) -> None:
    heard = recogniser.recognise(read(SHOWN / "pharmacy.wav"), PHRASES)
    assert heard.text == "go to the pharmacy and say good morning"
    assert heard.confidence > 0.8
    assert not heard.doubtful
    heard = recogniser.recognise(read(SHOWN / "visitor.wav"), PHRASES)
    assert heard.text == "wait for a visitor then take them to radiology"
    assert not heard.doubtful


def test_each_word_has_its_time_in_the_recording(recogniser: Recogniser) -> None:
    heard = recogniser.recognise(read(SHOWN / "pharmacy.wav"), PHRASES)
    starts = [word.start for word in heard.words]
    assert starts == sorted(starts)
    assert all(0 <= word.start < word.end <= heard.seconds_of_audio for word in heard.words)
    assert heard.words[0].start == pytest.approx(0.3, abs=0.2)  # a quarter second of quiet first


def test_a_remark_to_a_colleague_is_doubtful_and_told_as_it_was(
    recogniser: Recogniser,
) -> None:
    """With a limited vocabulary it comes back as words of commands, sure of most of them. So it is
    in languages without a second ear; with one it is heard as it was."""
    heard = recogniser.recognise(read(RECORDED / "chatter.wav"), PHRASES)
    assert not heard.doubtful
    assert "out of paper" in heard.text
    alone = Recogniser(need("en"), "en")
    heard = alone.recognise(read(RECORDED / "chatter.wav"), PHRASES)
    assert heard.doubtful
    assert heard.free_text is not None
    assert "out of paper" in heard.free_text


def test_without_limits_anything_may_be_said(recogniser: Recogniser) -> None:
    heard = recogniser.recognise(read(RECORDED / "chatter.wav"))
    assert "out of paper again" in heard.text
    assert not heard.doubtful


@pytest.mark.parametrize("rate", [8_000, 48_000])
def test_a_telephone_and_a_studio_are_heard_as_well(
    recogniser: Recogniser, tmp_path: Path, rate: int
) -> None:
    import soxr

    samples, given_rate = soundfile.read(SHOWN / "pharmacy.wav")
    other = soxr.resample(samples, given_rate, rate)
    soundfile.write(tmp_path / "stereo.wav", np.stack([other * 0, other], axis=1), rate)
    heard = recogniser.recognise(read(tmp_path / "stereo.wav"), PHRASES)
    assert heard.text == "go to the pharmacy and say good morning"


def test_a_voice_from_far_away_is_made_louder(recogniser: Recogniser) -> None:
    samples = read(SHOWN / "pharmacy.wav").samples
    heard = recogniser.recognise(Audio((samples // 50).astype(np.int16)), PHRASES)
    assert heard.text == "go to the pharmacy and say good morning"


def test_two_commands_with_a_pause_between_are_both_heard(recogniser: Recogniser) -> None:
    pause = np.zeros(2 * RATE, np.int16)
    both = [read(SHOWN / "pharmacy.wav").samples, pause, read(SHOWN / "visitor.wav").samples]
    heard = recogniser.recognise(Audio(np.concatenate(both)), PHRASES)
    assert heard.text.startswith("go to the pharmacy and say good morning wait for a visitor")
    assert heard.readings[0].text == heard.text
    assert not heard.doubtful


@pytest.mark.parametrize(
    "samples",
    [
        np.zeros(0, np.int16),
        np.full(1, 9000, np.int16),
        np.full(333, 9000, np.int16),
        np.zeros(3 * RATE, np.int16),
        np.random.default_rng(0).normal(0, 10, 2 * RATE).astype(np.int16),
    ],
    ids=["nothing", "one sample", "an odd few", "silence", "a quiet room"],
)
def test_where_nobody_speaks_nothing_is_heard(
    recogniser: Recogniser, samples: np.ndarray[tuple[int], np.dtype[np.int16]]
) -> None:
    heard = recogniser.recognise(Audio(samples), PHRASES)
    assert (heard.text, heard.confidence, heard.doubtful) == ("", 0.0, False)


def test_a_written_word_is_found_in_the_model_and_given_back_as_written(
    recogniser: Recogniser,
) -> None:
    """The model knows xray and twelve, people write x-ray and 12."""
    assert recogniser.unknown_words(["Take her to the x-ray room, ward 12!", "Qwxyzal"]) == [
        "Qwxyzal"
    ]
    heard = recogniser.recognise(read(RECORDED / "x-ray-room.wav"), PHRASES)
    assert heard.text == "take the patient to the x-ray room"
    assert heard.readings[0].text == heard.text


def test_a_word_the_model_does_not_know_does_no_harm_to_the_others(recogniser: Recogniser) -> None:
    phrases = ["go to the pharmacy", "qwxyzal and say good morning", "qwxyzal"]
    heard = recogniser.recognise(read(SHOWN / "pharmacy.wav"), phrases)
    assert heard.text == "go to the pharmacy and say good morning"


@pytest.mark.parametrize("phrases", [[], ["qwxyzal"], [", . !"], [""]])
def test_where_nothing_can_be_heard_it_is_said(recogniser: Recogniser, phrases: list[str]) -> None:
    """libvosk would end the program."""
    with pytest.raises(SpeechError, match="knows none of the words"):
        recogniser.recognise(read(SHOWN / "pharmacy.wav"), phrases)


def test_two_people_are_heard_at_once(recogniser: Recogniser) -> None:
    heard: dict[str, str] = {}

    def hear(name: str) -> None:
        heard[name] = recogniser.recognise(read(SHOWN / name), PHRASES).text

    threads = [threading.Thread(target=hear, args=(path.name,)) for path in SHOWN.glob("*.wav")]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert heard["pharmacy.wav"] == "go to the pharmacy and say good morning"
    assert heard["visitor.wav"] == "wait for a visitor then take them to radiology"


def test_nothing_is_written_to_the_terminal(
    recogniser: Recogniser, capfd: pytest.CaptureFixture[str]
) -> None:
    recogniser.recognise(read(SHOWN / "visitor.wav"), PHRASES)
    assert capfd.readouterr() == ("", "")


def test_a_damaged_model_is_said_to_be(recogniser: Recogniser, tmp_path: Path) -> None:
    (tmp_path / "am").mkdir()
    (tmp_path / "am" / "final.mdl").write_bytes(b"not a model")
    with pytest.raises(ModelError, match=r"cannot be used. Run `nl2robot models get en --again`"):
        Recogniser(tmp_path, "en")
    shutil.rmtree(tmp_path / "am")
    with pytest.raises(ModelError):
        Recogniser(tmp_path, "en")


def test_the_benchmark_reports_its_figures(recogniser: Recogniser) -> None:
    figures = benchmark.measure(repeats=1)
    assert set(figures) == {
        "load model (s)",
        "recording to text, with second opinion (s)",
        "real-time factor, with second opinion",
        "real-time factor, free",
    }
    assert all(value > 0 for value in figures.values())


def test_sound_is_decoded_while_it_comes(recogniser: Recogniser) -> None:
    """In pieces of any size, of which the sound is as loud as if it had been known before."""
    audio = read(SHOWN / "pharmacy.wav")
    decoding = recogniser.open(PHRASES, gain=gain_for(audio.samples))
    partial = []
    for start in range(0, len(audio.samples), 5_555):
        decoding.feed(audio.samples[start : start + 5_555])
        partial.append(decoding.so_far)
    assert partial[-1].startswith("go to the pharmacy")
    heard = decoding.finish()
    assert heard.text == "go to the pharmacy and say good morning"
    assert heard.words[0].start == pytest.approx(0.3, abs=0.2)
    assert heard.seconds_of_audio == pytest.approx(audio.seconds)
    assert not heard.doubtful


def test_a_decoder_that_is_used_again_begins_anew(recogniser: Recogniser) -> None:
    for name, first in (("pharmacy.wav", "go"), ("visitor.wav", "wait"), ("pharmacy.wav", "go")):
        heard = recogniser.recognise(read(SHOWN / name), PHRASES)
        assert heard.words[0].text == first
        assert heard.words[0].start == pytest.approx(0.3, abs=0.2)


def test_nothing_fed_is_nothing_heard(recogniser: Recogniser) -> None:
    heard = recogniser.open(PHRASES).finish()
    assert (heard.text, heard.seconds_of_audio) == ("", 0.0)


# ── choosing among the readings, without a model ─────────────────────────────────────────────


def heard(text: str, *readings: Reading, doubtful: bool = False) -> Heard:
    return Heard(
        text=text,
        confidence=0.9,
        words=(),
        doubtful=doubtful,
        free_text="weight for busier",
        readings=readings,
        seconds_of_audio=1.0,
        seconds_taken=0.1,
    )


def understood(text: str) -> bool:
    return text in {"wait for a visitor", "wait"}


def test_what_is_understood_at_once_stays() -> None:
    first = heard("wait", Reading("wait for a visitor", 0.1, False))
    assert choose(first, understood) is first


def test_the_best_fitting_reading_that_makes_sense_is_chosen() -> None:
    chosen = choose(
        heard(
            "weight for a visitor",
            Reading("weight for a visitor", 0.02, False),
            Reading("weight for busier", 0.0, False),
            Reading("wait for a visitor", -0.01, False),
            Reading("wait", -0.02, False),
        ),
        understood,
    )
    assert chosen.text == "wait for a visitor"
    assert chosen.confidence == pytest.approx(0.99)
    assert not chosen.doubtful


def test_a_reading_that_does_not_fit_the_sound_is_not_chosen() -> None:
    """Somebody said something else; that it would make a command is no reason to act."""
    remark = heard("weight", Reading("wait for a visitor", -0.6, True), doubtful=True)
    chosen = choose(remark, understood)
    assert chosen.doubtful
    assert chosen.text == "weight for busier"  # what it sounds like, to show the speaker
    assert chosen.confidence == 0.0


def test_a_doubtful_command_stays_one_to_ask_about() -> None:
    command = heard("wait", Reading("wait", -0.3, True), doubtful=True)
    assert choose(command, understood) is command


def test_a_doubtful_command_gives_way_to_one_that_fits() -> None:
    chosen = choose(
        heard("wait", Reading("wait for a visitor", -0.02, False), doubtful=True), understood
    )
    assert chosen.text == "wait for a visitor"
