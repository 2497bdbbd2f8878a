"""Somebody speaks, stops, and has been heard; with and without words."""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nl2robot.cli.commands.listen import live
from nl2robot.errors import UserError
from nl2robot.speech import scenes
from nl2robot.speech.audio import RATE, Audio, Samples, read
from nl2robot.speech.hear import levels, streaming
from nl2robot.speech.hear.listening import (
    ANSWERS,
    COMMANDS,
    FRAME,
    Event,
    Listener,
    NothingHeard,
    PartialText,
    SpeechBegan,
    SpeechEnded,
    TooLong,
    has_speech,
)
from nl2robot.speech.hear.recogniser import Heard, Recogniser
from nl2robot.speech.hear.streaming import Streaming
from tests.speech.conftest import RECORDED, SHOWN

PHARMACY = read(SHOWN / "pharmacy.wav").samples
VISITOR = read(SHOWN / "visitor.wav").samples
PHRASES = [
    "go to the pharmacy and say good night",
    "go to the lobby and say good morning",
    "wait for a visitor then take them to radiology",
    "stop",
]


def sure(samples: Samples) -> float:
    """A voice detector that a test can tell what to think: the first sample, in percent."""
    return float(samples[0]) / 100


def sound(*parts: tuple[float, int]) -> Samples:
    """For it: so many seconds, for each of which it is so sure."""
    return np.concatenate(
        [np.full(round(seconds * RATE / FRAME) * FRAME, percent) for seconds, percent in parts]
    ).astype(np.int16)


def quiet(seconds: float) -> Samples:
    """A room in which nobody speaks."""
    return np.random.default_rng(1).normal(0, 3, int(seconds * RATE)).astype(np.int16)


def heard(listener: Listener, samples: Samples, block: int = 320) -> list[Event]:
    return [
        event
        for start in range(0, len(samples), block)
        for event in listener.feed(samples[start : start + block])
    ]


def ended(events: Iterable[Event]) -> list[SpeechEnded]:
    return [event for event in events if isinstance(event, SpeechEnded)]


# --- when somebody speaks


def test_an_utterance_begins_and_ends_and_comes_with_a_little_around_it() -> None:
    listener = Listener(detector=sure)
    began, end = heard(listener, sound((2, 1), (1, 90), (1.5, 2)))
    assert isinstance(began, SpeechBegan)
    assert isinstance(end, SpeechEnded)
    assert began.at == pytest.approx(2, abs=0.05)
    assert end.at == pytest.approx(3, abs=0.05)
    assert end.heard is None
    samples = end.audio.samples
    assert end.audio.seconds == pytest.approx(COMMANDS.before + 1 + COMMANDS.after, abs=0.1)
    assert (samples[0], samples[len(samples) // 2], samples[-1]) == (1, 90, 2)
    assert not listener.speaking


@pytest.mark.parametrize("block", [1, 100, 512, 5000, 10**6])
def test_it_is_the_same_in_whatever_blocks_the_sound_comes(block: int) -> None:
    samples = sound((0.5, 0), (0.5, 80), (1, 0))[: -FRAME // 2]
    (end,) = ended(heard(Listener(detector=sure), samples, block))
    assert end.at == pytest.approx(1, abs=0.05)


def test_a_nurse_who_stops_to_think_is_waited_for_and_her_pause_is_kept() -> None:
    pause = COMMANDS.pause - 0.1
    (end,) = ended(
        heard(Listener(detector=sure), sound((1, 90), (pause, 0), (1, 90), (COMMANDS.pause, 0)))
    )
    assert end.audio.seconds == pytest.approx(2 + pause + COMMANDS.after, abs=0.1)


def test_two_commands_are_two_and_an_answer_is_waited_for_less_long() -> None:
    samples = sound((1, 90), (0.6, 0), (1, 90), (1, 0))
    assert len(ended(heard(Listener(detector=sure), samples))) == 1
    assert len(ended(heard(Listener(manner=ANSWERS, detector=sure), samples))) == 2


def test_a_voice_that_sinks_goes_on_where_it_would_not_have_begun() -> None:
    (end,) = ended(heard(Listener(detector=sure), sound((1, 90), (2, 40), (1, 0))))
    assert end.at == pytest.approx(3, abs=0.05)
    assert heard(Listener(detector=sure), sound((3, 40), (1, 0))) == []


def test_a_knock_is_no_speech() -> None:
    assert heard(Listener(detector=sure), sound((1, 0), (0.064, 99), (1, 0))) == []


def test_a_television_is_too_long_and_is_not_listened_to_until_it_is_off() -> None:
    listener = Listener(manner=replace(COMMANDS, longest=5), detector=sure)
    *_, last = heard(listener, sound((20, 90)))
    assert last == TooLong(pytest.approx(5, abs=0.1))
    assert not listener.speaking
    events = heard(listener, sound((0.2, 0), (3, 90), (1, 0)))  # still the same programme
    assert events == []
    assert len(ended(heard(listener, sound((1, 90), (1, 0))))) == 1


def test_where_nobody_speaks_that_is_told_as_often_as_wanted() -> None:
    listener = Listener(manner=replace(COMMANDS, patience=8), detector=sure)
    assert heard(listener, sound((20, 0))) == [NothingHeard(pytest.approx(8, abs=0.1))] * 2
    assert heard(Listener(detector=sure), sound((20, 0))) == []


def test_who_speaks_until_the_sound_ends_has_been_heard() -> None:
    listener = Listener(detector=sure)
    heard(listener, sound((1, 90)))
    listener.feed(np.full(100, 90, np.int16))
    (end,) = ended(listener.finish())
    assert len(end.audio.samples) == pytest.approx(RATE + 100, abs=FRAME)
    assert listener.finish() == []


# --- whether it is speech


def test_two_commands_from_a_microphone_are_found_by_the_real_detector() -> None:
    samples = np.concatenate([quiet(1), PHARMACY, quiet(1), VISITOR, quiet(1)])
    first, second = ended(heard(Listener(), samples))
    assert first.at == pytest.approx(1 + 2.4, abs=0.15)  # the recordings begin and end quietly
    assert second.at == pytest.approx(1 + 2.65 + 1 + 3.2, abs=0.15)


def test_people_are_heard_in_a_noisy_corridor() -> None:
    random = np.random.default_rng(7)
    noise = scenes.corridor(20, random)
    for number, path in enumerate(sorted([*SHOWN.glob("*.wav"), *RECORDED.glob("*.wav")])):
        spoken = np.concatenate([quiet(1), read(path).samples, quiet(1)])
        noisy = scenes.at_snr(scenes.signal(Audio(spoken)), noise, 10, random)
        assert has_speech(scenes.audio(noisy)), (number, path.name)


def music(seconds: float) -> Samples:
    """A piano that plays whatever comes to its mind."""
    random, length = np.random.default_rng(3), int(seconds * RATE)
    played = np.zeros(length + RATE)
    time = np.arange(RATE // 2) / RATE
    for start in range(0, length, RATE // 4):
        pitch = 440 * 2 ** ((int(random.integers(40, 80)) - 69) / 12)
        for overtone in range(1, 6):
            tone = np.sin(2 * np.pi * pitch * overtone * time) / overtone * np.exp(-5 * time)
            played[start : start + len(tone)] += tone
    return (played[:length] / np.abs(played).max() * 20_000).astype(np.int16)


@pytest.mark.parametrize(
    "samples",
    [
        np.zeros(0, np.int16),
        np.zeros(5 * RATE, np.int16),
        quiet(5),
        np.full(5 * RATE, 32767, np.int16),
        np.random.default_rng(0).normal(0, 8000, 5 * RATE).astype(np.int16),
        (12_000 * np.sin(2 * np.pi * 100 * np.arange(5 * RATE) / RATE)).astype(np.int16),
        scenes.audio(scenes.corridor(10, np.random.default_rng(5))).samples,
        music(5),
    ],
    ids=["nothing", "silence", "a quiet room", "stuck", "noise", "hum", "corridor", "piano"],
)
def test_what_is_no_voice_is_not_speech(samples: Samples) -> None:
    assert not has_speech(Audio(samples))


def test_a_word_that_is_cut_out_closely_is_still_speech() -> None:
    seven = read(RECORDED / "seven.wav").samples
    loud = np.nonzero(np.abs(seven) > 500)[0]
    assert has_speech(Audio(seven[loud[0] : loud[-1]]))


# --- what is said


@pytest.mark.parametrize(
    ("loudness", "block"), [(1.0, 320), (0.05, 4000), (1.7, 512)], ids=["near", "far", "shouting"]
)
def test_the_words_come_while_they_are_spoken_and_are_there_at_the_end(
    recogniser: Recogniser, loudness: float, block: int
) -> None:
    spoken = np.concatenate([quiet(0.6), PHARMACY * np.float32(loudness), quiet(1)])
    samples = np.clip(spoken, -32768, 32767).astype(np.int16)
    events = heard(Listener(Streaming(recogniser, PHRASES)), samples, block)
    partial = [event.text for event in events if isinstance(event, PartialText)]
    (end,) = ended(events)
    assert end.heard is not None
    assert end.heard.text == "go to the pharmacy and say good morning"
    assert not end.heard.doubtful
    assert end.heard.readings
    assert len(partial) > 2
    assert "go to the pharmacy" in partial[-2]
    assert end.heard.seconds_of_audio == pytest.approx(end.audio.seconds, abs=0.1)


def test_clipped_speech_is_still_heard(recogniser: Recogniser) -> None:
    """The microphone is turned up far too high."""
    clipped = np.clip(PHARMACY.astype(np.int32) * 8, -32768, 32767).astype(np.int16)
    samples = np.concatenate([quiet(0.6), clipped, quiet(1)])
    (end,) = ended(heard(Listener(Streaming(recogniser, PHRASES)), samples))
    assert end.heard is not None
    assert end.heard.text == "go to the pharmacy and say good morning"


def test_who_goes_on_after_a_pause_has_said_one_thing(recogniser: Recogniser) -> None:
    """When the pause is half over, the text of what was said so far is made ready."""
    samples = np.concatenate([PHARMACY[:-4000], quiet(0.4), VISITOR[4000:], quiet(1)])
    (end,) = ended(heard(Listener(Streaming(recogniser, PHRASES)), samples))
    assert end.heard is not None
    assert end.heard.text.startswith("go to the pharmacy and say good morning wait for a visitor")
    assert end.heard.text.endswith("radiology")


def test_the_text_is_there_before_the_pause_is_over(recogniser: Recogniser) -> None:
    decoder = Streaming(recogniser, PHRASES)
    listener = Listener(decoder)
    heard(listener, np.concatenate([quiet(0.5), PHARMACY, quiet(0.25)]))
    assert listener.speaking
    assert decoder._heard is not None
    assert decoder._heard.text == "go to the pharmacy and say good morning"


def test_after_a_shout_a_whisper_is_decoded_again_as_loud_as_it_should_have_been(
    recogniser: Recogniser, monkeypatch: pytest.MonkeyPatch
) -> None:
    again = []
    whole = Recogniser.recognise

    def recognise(self: Recogniser, audio: Audio, *given: Any, **more: Any) -> Heard:
        again.append(audio)
        return whole(self, audio, *given, **more)

    monkeypatch.setattr(Recogniser, "recognise", recognise)
    listener = Listener(Streaming(recogniser, PHRASES))
    far = (VISITOR // 40).astype(np.int16)
    told = []
    for spoken in (PHARMACY, far, far):
        (end,) = ended(heard(listener, np.concatenate([spoken, quiet(1)])))
        assert end.heard is not None
        told.append(end.heard.text)
    assert told[0] == "go to the pharmacy and say good morning"
    assert told[1] == told[2] == "wait for a visitor then take them to radiology"
    assert len(again) == 1  # the third time the loudness is known


def test_one_word_is_heard_before_its_loudness_could_be_learned(recogniser: Recogniser) -> None:
    seven = read(RECORDED / "seven.wav").samples
    listener = Listener(Streaming(recogniser, ["seven", "four"]), manner=ANSWERS)
    (end,) = ended(heard(listener, np.concatenate([seven, quiet(0.5)])))
    assert end.heard is not None
    assert end.heard.text == "seven"


def test_what_may_be_said_changes_with_the_question(recogniser: Recogniser) -> None:
    decoder = Streaming(recogniser, PHRASES)
    listener = Listener(decoder)
    decoder.expect(["yes please", "no thanks"])
    answer = read(RECORDED / "yes-please.wav").samples
    (end,) = ended(heard(listener, np.concatenate([answer, quiet(1)])))
    assert end.heard is not None
    assert end.heard.text == "yes please"
    decoder.expect(None)  # anything
    chatter = read(RECORDED / "chatter.wav").samples
    (end,) = ended(heard(listener, np.concatenate([chatter, quiet(1)])))
    assert end.heard is not None
    assert "out of paper" in end.heard.text


def test_speech_that_was_too_long_leaves_nothing_behind(recogniser: Recogniser) -> None:
    listener = Listener(Streaming(recogniser, PHRASES), replace(COMMANDS, longest=2))
    events = heard(listener, np.concatenate([PHARMACY, quiet(1)]))
    assert isinstance(events[-1], TooLong)
    listener.manner = COMMANDS
    (end,) = ended(heard(listener, np.concatenate([VISITOR, quiet(1)])))
    assert end.heard is not None
    assert end.heard.text == "wait for a visitor then take them to radiology"


def test_the_loudness_is_held_back_rather_than_clipped() -> None:
    loudness = streaming._Loudness()
    loudness.begin()
    gain = loudness.guess(np.array([1000, -1000], np.int16))
    assert gain * 1000 == pytest.approx(levels.LOUDNESS * 32767)
    for peak in (1000, 20_000, -32768, 500):
        kept = loudness.held_back(np.array([peak], np.int16)).astype(float)
        assert abs(kept[0] * gain) <= 32767
    assert not loudness.was_far_out


# --- the command


class Said:
    """What becomes of speech, in place of a translation."""

    def __init__(self, listener: Listener) -> None:
        self._listener = listener
        self.seconds: list[float] = []

    def listener(self) -> Listener:
        return self._listener

    def recording(self, audio: Audio) -> None:
        raise NotImplementedError

    def spoken(self, speech: SpeechEnded) -> None:
        self.seconds.append(speech.at)
        if len(self.seconds) == 2:
            raise UserError("That was one too many. Say it again.")


class Words:
    """A decoder that counts."""

    def begin(self) -> None:
        self._blocks = 0

    def accept(self, samples: Samples) -> str:
        self._blocks += 1
        return "word " * (self._blocks // 10)

    def pause(self) -> None: ...

    def end(self) -> Any:
        return None


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


SPOKEN = sound((1, 0), (2, 90), (1, 0))


def test_words_are_shown_while_they_are_spoken_where_they_can_be_overwritten() -> None:
    shown = Terminal()
    live([SPOKEN], Said(Listener(Words(), detector=sure)), shown, quiet=False)
    assert "\r\x1b[K… word word " in shown.getvalue()
    assert shown.getvalue().endswith("\r\x1b[K")
    for output, silent in ((io.StringIO(), False), (Terminal(), True)):
        live([SPOKEN], Said(Listener(Words(), detector=sure)), output, quiet=silent)
        assert output.getvalue() == ""


def test_one_utterance_that_fails_does_not_end_the_listening(
    capsys: pytest.CaptureFixture[str],
) -> None:
    said = Said(Listener(detector=sure))
    assert live([SPOKEN] * 3, said, io.StringIO(), quiet=True) == 0
    assert len(said.seconds) == 3
    assert "one too many" in capsys.readouterr().err


def test_ctrl_c_ends_it_and_half_a_command_is_not_acted_on() -> None:
    def blocks() -> Iterator[Samples]:
        yield sound((1, 0), (1, 90))
        raise KeyboardInterrupt

    said = Said(Listener(detector=sure))
    assert live(blocks(), said, io.StringIO(), quiet=True) == 0
    assert said.seconds == []


@pytest.mark.parametrize(
    ("language", "nothing", "too_long"),
    [
        (
            "en",
            "Nothing was heard for 10 seconds. Check that the microphone is on",
            "This was too long for a command.",
        ),
        ("de", "Seit 10 Sekunden ist nichts zu hören.", "Das war zu lang für einen Befehl."),
        ("fr", "On n'entend rien depuis 10 secondes.", "C'était trop long pour un ordre."),
    ],
)
def test_a_microphone_that_is_switched_off_is_suspected_once(
    capsys: pytest.CaptureFixture[str], language: str, nothing: str, too_long: str
) -> None:
    listener = Listener(manner=replace(COMMANDS, patience=10, longest=5), detector=sure)
    heard = [sound((35, 0), (8, 90), (1, 0))]
    live(heard, Said(listener), io.StringIO(), quiet=True, language=language)
    told = capsys.readouterr().err
    assert told.count(nothing) == 1
    assert told.count(too_long) == 1


@pytest.mark.parametrize("options", [(), ("--expect", "digits")])
def test_a_recording_of_music_is_nothing_heard(
    recogniser: Recogniser,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    options: tuple[str, ...],
) -> None:
    import soundfile

    from nl2robot.cli.main import main

    soundfile.write(tmp_path / "piano.wav", music(5), RATE)
    main(["listen", "--wav", str(tmp_path / "piano.wav"), *options])
    told = capsys.readouterr().out
    assert "Nothing was heard" in told or "heard: nothing, answer: - (0%)" in told
