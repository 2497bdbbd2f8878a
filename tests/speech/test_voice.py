"""A nurse talks with the robot: what she says after the hot word is a line, as if it was typed."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
import pytest

from nl2robot.cli import main as cli
from nl2robot.cli.commands.talk import voice_input
from nl2robot.errors import ExitStatus, UserError
from nl2robot.knowledge import DEFAULT_WORLD, Knowledge
from nl2robot.speech.audio import RATE, Samples, read
from nl2robot.speech.hear.listening import Listener, Manner
from nl2robot.speech.hear.recogniser import Heard, Reading
from nl2robot.speech.hotword.detection import Detection
from nl2robot.speech.speak.voices import joined, voice
from nl2robot.translate.talk import Talk
from nl2robot.voice.hearing import Ear
from nl2robot.voice.services import MOST_OPEN, Microphones
from nl2robot.voice.voice import Cried, Hears, OwnVoice, Said, Slept, SpokenLines, VoiceInput, Woke
from robot_api.errors import InvalidCall
from sim.world.loading import load_world
from tests.speech.conftest import RECORDED, SHOWN

FRAME = 512
QUIET, VOICE = np.zeros(FRAME, np.int16), np.full(FRAME, 9000, np.int16)
HOT, STOP = np.full(FRAME, 1, np.int16), np.full(FRAME, 2, np.int16)
SECOND = RATE // FRAME


class Hearing:
    """A decoder that hears the same words in everything."""

    def __init__(self, text: str, doubtful: bool, free: str) -> None:
        self.heard = Heard(text, 1.0, (), doubtful, free, (Reading(text, 0.0, doubtful),), 2.0, 0.0)

    def begin(self) -> None: ...

    def accept(self, samples: Samples) -> str:
        return self.heard.text

    def pause(self) -> None: ...

    def end(self) -> Heard:
        return self.heard


class Spots:
    """Detects a word where the samples are marked so."""

    def __init__(self, word: str, mark: int) -> None:
        self.word, self.mark = word, mark

    def feed(self, samples: Samples) -> list[Detection]:
        return [Detection(self.word, 0.0, 1.0)] if (samples == self.mark).any() else []

    def reset(self) -> None: ...


def an_ear(text: str = "go to ward a", *, doubtful: bool = False, free: str = "", **settings):
    def listener() -> Listener:
        sounds = Hearing(text, doubtful, free)
        return Listener(sounds, Manner(patience=8.0), lambda frame: float(frame.max() > 5000))

    return VoiceInput(
        listener,
        lambda heard: heard,
        Spots("hey robot", 1),
        Spots("stop", 2),
        hot_words=["hey robot"],
        **settings,
    )


def happens(ear: VoiceInput, *blocks: Samples) -> list[object]:
    return [event for block in blocks for event in ear.feed(block)]


SPEECH = [QUIET] * SECOND + [VOICE] * SECOND + [QUIET] * SECOND


def test_nothing_is_heard_before_the_hot_word() -> None:
    assert happens(an_ear(), *SPEECH, *SPEECH) == []


def test_after_the_hot_word_the_next_sentence_is_a_line() -> None:
    ear = an_ear()
    assert happens(ear, HOT, *SPEECH) == [
        Woke("hey robot"),
        Hears("go to ward a"),
        Said("go to ward a"),
    ]
    assert happens(ear, *SPEECH) == []  # and then it is needed again


def test_a_question_needs_no_hot_word_before_its_answer() -> None:
    ear = an_ear("yes")
    ear.wake()
    assert happens(ear, *SPEECH)[-1] == Said("yes")


def test_who_says_nothing_has_to_call_again() -> None:
    ear = an_ear()
    assert happens(ear, HOT, *[QUIET] * 9 * SECOND) == [Woke("hey robot"), Slept()]


def test_hot_word_and_command_in_one_breath() -> None:
    ear = an_ear("robot go to ward a")
    assert happens(ear, HOT, *[VOICE] * SECOND, *[QUIET] * SECOND)[-1] == Said("go to ward a")


def test_the_hot_word_alone_is_no_line() -> None:
    ear = an_ear("hey robot")
    assert happens(ear, HOT, *SPEECH, *SPEECH) == [Woke("hey robot"), Hears(""), Hears("")]


def test_stop_is_obeyed_at_once_but_only_while_the_robot_is_busy() -> None:
    ear = an_ear()
    assert happens(ear, STOP) == []
    ear.busy(True)
    assert happens(ear, STOP) == [Cried("stop")]
    ear.busy(False)
    assert happens(ear, STOP) == []


def test_the_robot_does_not_obey_itself() -> None:
    ear = an_ear(says_itself={"stop", "hey robot"}.__contains__)
    ear.busy(True)
    assert happens(ear, STOP, HOT, *SPEECH) == []


def test_the_robot_knows_what_it_says_and_for_how_long() -> None:
    now = 0.0
    own = OwnVoice(lambda: now)
    assert not own.says("stop")
    own.note("speech", {"text": "The bus stop is over there.", "language": "en"})
    assert own.says("stop")
    assert not own.says("halt")
    own.note("program", {"what": "result", "method": "say"})
    assert own.says("stop")  # it still sounds
    now = 1.0
    assert not own.says("stop")
    own.note("speech", {"text": "Mind the stop.", "language": "en"})
    assert own.says("stop")
    now = 9.0  # nobody told that it is over: whoever cries stop then is somebody else
    assert not own.says("stop")


def test_what_may_have_been_something_else_is_asked_again() -> None:
    ear = an_ear("go to ward a", doubtful=True, free="goats award her")
    assert happens(ear, HOT, *SPEECH)[-1] == Said("go to ward a", True, "goats award her")


def test_what_both_decoders_heard_is_left_to_the_conversation() -> None:
    ear = an_ear("no the pharmacy", doubtful=True, free="no the pharmacy")
    assert happens(ear, HOT, *SPEECH)[-1] == Said("no the pharmacy", False, "no the pharmacy")


def test_an_unplugged_microphone_is_told_once() -> None:
    def blocks():
        yield HOT
        raise UserError("The microphone was unplugged.")

    lines = SpokenLines(an_ear(), blocks())
    lines.start()
    assert lines.next(5.0) == Woke("hey robot")
    with pytest.raises(UserError, match="unplugged"):
        lines.next(5.0)
    assert lines.next(0.0) is None


def test_a_fault_while_listening_is_told_and_the_keyboard_stays(caplog) -> None:
    def blocks():
        yield HOT
        raise ZeroDivisionError

    lines = SpokenLines(an_ear(), blocks())
    lines.start()
    assert lines.next(5.0) == Woke("hey robot")
    with pytest.raises(UserError, match="Type instead"):
        lines.next(5.0)


def test_a_recording_that_is_not_there_is_told_before_anything_begins(tmp_path, capsys) -> None:
    assert cli.main(["chat", "--voice", str(tmp_path / "nope.wav")]) == ExitStatus.BAD_INPUT
    said = capsys.readouterr()
    assert "is not there" in said.err
    assert not said.out


# --- with a real model ---------------------------------------------------------------------------


def spoken(text: str) -> Samples:
    from nl2robot.speech.audio import from_float

    sound = joined(voice("en").speak(text))
    return from_float((sound.samples / np.float32(32768))[:, None], sound.rate).samples


@pytest.fixture(scope="session")
def knowledge() -> Knowledge:
    return Knowledge(load_world(DEFAULT_WORLD))


def test_a_nurse_calls_the_robot_and_says_where_to_go(recogniser, knowledge) -> None:
    ear = voice_input(knowledge, "en")
    quiet = np.zeros(RATE, np.int16)
    sound = np.concatenate(
        [quiet, spoken("Hey robot."), quiet, spoken("Take the visitor to radiology."), quiet]
    )
    events = [event for at in range(0, len(sound), 1600) for event in ear.feed(sound[at:][:1600])]
    assert events[0] == Woke("hey robot")
    assert [event.text for event in events if isinstance(event, Said)] == [
        "take the visitor to radiology"
    ]


class TestOverTheWire:
    """A browser pushes what its microphone hears."""

    @pytest.fixture
    def microphones(self, recogniser, knowledge) -> Microphones:
        talks: dict[str | None, Talk] = {}
        return Microphones(lambda: knowledge, lambda name: talks.setdefault(name, Talk()))

    def test_words_come_while_they_are_spoken_and_the_program_at_the_end(self, microphones) -> None:
        sound = read(SHOWN / "pharmacy.wav").samples
        sound = np.concatenate([sound, np.zeros(RATE, np.int16)])
        number = microphones.open(RATE, 1, "en", None)
        told = []
        for at in range(0, len(sound), 1600):
            block = base64.b64encode(sound[at : at + 1600].tobytes()).decode()
            told += microphones.push(number, block)
        told += microphones.close(number)
        assert [event["what"] for event in told if event["what"] != "partial"] == ["began", "heard"]
        assert "go to the pharmacy" in [event.get("text") for event in told]
        translation = told[-1]["translation"]
        assert translation["program"].startswith('robot.goto("pharmacy")')

    def test_who_speaks_where_the_robot_is_not_heard_makes_it_silent(
        self, recogniser, knowledge
    ) -> None:
        silent: list[bool] = []
        microphones = Microphones(
            lambda: knowledge, lambda name: Talk(), give_way=lambda: silent.append(True)
        )
        sound = read(SHOWN / "pharmacy.wav").samples
        block = base64.b64encode(sound[: 2 * RATE].tobytes()).decode()
        for interrupts in (False, True):
            number = microphones.open(RATE, 1, "en", None, interrupts=interrupts)
            told = [event["what"] for event in microphones.push(number, block)]
            assert told[0] == "began"
            assert silent == [True] * interrupts

    def test_what_is_no_sound_is_refused(self, microphones) -> None:
        number = microphones.open(48_000, 2, "en", None)
        with pytest.raises(InvalidCall, match="base64"):
            microphones.push(number, "no sound at all!")
        assert microphones.push(number, base64.b64encode(b"odd").decode()) == []
        with pytest.raises(UserError, match="samples a second"):
            microphones.open(7, 1, "en", None)

    def test_a_closed_or_forgotten_microphone_is_told(self, microphones) -> None:
        first = microphones.open(RATE, 1, "en", None)
        for _ in range(MOST_OPEN):
            last = microphones.open(RATE, 1, "en", None)
        microphones.close(last)
        for number in (first, last, 999):
            with pytest.raises(InvalidCall, match="is not open"):
                microphones.push(number, "")

    def test_a_language_without_a_model_is_a_sentence(
        self, microphones, tmp_path, monkeypatch
    ) -> None:
        monkeypatch.setenv("NL2ROBOT_MODELS", str(tmp_path))
        with pytest.raises(UserError, match="German speech model is not installed"):
            microphones.open(RATE, 1, "de", None)

    def test_while_a_button_is_held_all_is_one_command(self, microphones) -> None:
        quiet = np.zeros(RATE, np.int16)
        first, then = read(SHOWN / "pharmacy.wav"), read(RECORDED / "x-ray-room.wav")
        sound = [first.samples, quiet, then.samples, quiet]
        number = microphones.open(RATE, 1, "en", None, held=True)
        told = [*pushes(microphones, number, np.concatenate(sound)), *microphones.close(number)]
        [heard] = [event for event in told if event["what"] == "heard"]
        assert heard["text"].startswith("go to the pharmacy and say good morning")
        assert heard["text"].endswith("take the patient to the x ray room")
        assert not any(event["what"] == "stop" or event.get("stop") for event in told)

    def test_stop_is_told_while_it_is_still_said(self, microphones) -> None:
        sound = np.concatenate([np.zeros(RATE, np.int16), spoken("Stop!")])
        number = microphones.open(RATE, 1, "en", None, held=True)
        assert {"what": "stop"} in pushes(microphones, number, sound)
        assert microphones.close(number)[-1]["stop"]

    def test_what_says_stop_is_told_from_what_only_has_the_word(
        self, recogniser, knowledge
    ) -> None:
        ear = Ear(knowledge)
        assert all(ear.is_stop(text) for text in ("stop", "please stop", "no stop", "stop moving"))
        assert not any(ear.is_stop(text) for text in ("", "go to the bus stop", "start", "go on"))


def pushes(microphones: Microphones, number: int, sound: Samples) -> list[dict[str, Any]]:
    """What is told while a sound is pushed a tenth of a second at a time."""
    return [
        event
        for at in range(0, len(sound), 1600)
        for event in microphones.push(
            number, base64.b64encode(sound[at : at + 1600].tobytes()).decode()
        )
    ]
