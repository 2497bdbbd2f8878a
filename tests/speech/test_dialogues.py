"""Whole dialogues from sound to sound: the robot asks aloud, people answer in voices of their own,
and what the robot makes of it is what it heard."""

from __future__ import annotations

import re
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
import soundfile
from numpy.typing import NDArray

from nl2robot.cli import main as cli
from nl2robot.errors import UserError
from nl2robot.models import catalogue as models
from nl2robot.speech.audio import RATE
from nl2robot.speech.hear.recogniser import Recogniser
from nl2robot.speech.hear.replies import AtMicrophone, Microphone, Replies
from nl2robot.speech.speak.aloud import RobotVoice, aloud
from nl2robot.speech.speak.loudspeaker import Handed
from nl2robot.speech.speak.people import FEMALE, MALE, SimulatedVoices, person_called
from nl2robot.speech.speak.speaking import Speaker
from nl2robot.speech.speak.voices import Sound as Samples
from nl2robot.speech.speak.voices import voice
from nl2robot.speech.speak.wishes import Wishes
from robot_api.capabilities.sound import Asked, Sound
from robot_api.driver import StopFlag
from robot_api.drivers import emulated, simulated
from robot_api.errors import NotPossible, Stopped
from sim.simulation import Simulation
from sim.world.loading import load_world

SOON = 10.0


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch) -> Path:
    """Nothing reaches the user's own log and cache."""
    monkeypatch.setenv("NL2ROBOT_MODELS", str(models.models_folder()))
    monkeypatch.setenv("NL2ROBOT_HOME", str(tmp_path / "home"))
    return tmp_path


# --- the commands --------------------------------------------------------------------------------


def test_alice_is_asked_what_she_wants_and_answers(
    recogniser: Recogniser, tmp_path: Path, capsys
) -> None:
    words = "go to Alice and ask whether she wants coffee or tea"
    sound = tmp_path / "dialogue.wav"
    # A robotic voice for the robot, too: this is about Alice.
    asks = ["run", words, "--yes", "--voices", "--speak", str(sound), "--robot-voice", "espeak"]
    assert cli.main(asks) == 0
    assert "→ 'coffee'" in capsys.readouterr().out
    # She says "yes" first; the robot asks again, and then she says "coffee".
    samples, rate = soundfile.read(sound)
    assert 15 < len(samples) / rate < 60  # she is looked for in her own room first
    assert abs(samples[: 15 * rate]).max() == 0  # on the way
    assert abs(samples[15 * rate :]).max() > 0.2


def test_henry_is_asked_what_he_drinks_and_is_understood_at_once(
    recogniser: Recogniser, tmp_path: Path
) -> None:
    wishes = Wishes(speak=tmp_path / "henry.wav", voices=True, voice="espeak")
    ward = Simulation(load_world("ward"), seed=1)
    events: list[tuple[str, str | None]] = []
    with aloud(wishes, ward.world) as sound:
        assert sound is not None
        robot = simulated(ward, sound(lambda: ward.time))
        robot.subscribe(lambda kind, data: events.append((kind, data.get("text"))))
        assert robot.call("find", {"thing": "Henry"}, StopFlag())
        question = {"question": "What would you like?", "options": ["water", "tea", "coffee"]}
        assert robot.call("ask", question, StopFlag()) == "water"
        robot.close()
    told = [event for event in events if event[0] in ("speech", "heard", "screen")]
    assert told == [("speech", "What would you like?"), ("heard", "water")]


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--voices", "--lang", "de"], "fehlt das Spracherkennungsmodell für Deutsch"),
        (["--speak", "sound.mp3"], "is no .wav file"),
        (["--speak", "/proc/no/sound.wav"], "cannot be written"),
        (["--speak", "sound.wav", "--robot-voice", "anna"], "There is no voice 'anna'"),
        (["--robot-voice", "piper"], "Add --speak"),
        (["--robot", "ws://127.0.0.1:1", "--speak"], "A robot at a server is heard there"),
    ],
)
def test_what_is_missing_is_told_before_anything_runs(
    tmp_path: Path, monkeypatch, capsys, options: list[str], told: str
) -> None:
    monkeypatch.setenv("NL2ROBOT_MODELS", str(tmp_path / "none"))
    monkeypatch.chdir(tmp_path)
    try:
        status = cli.main(["run", "say hello", "--world", "ward", "--yes", *options])
    except SystemExit as ended:
        status = int(ended.code or 0)
    written = capsys.readouterr()
    assert status == 2
    assert told in written.err
    assert "robot.say" not in written.out


# --- the robot -----------------------------------------------------------------------------------


class Megaphone:
    """A loudspeaker that remembers what it was told to say."""

    def __init__(self) -> None:
        self.said: list[tuple[str, str, int]] = []

    @contextmanager
    def speaking(self, stop: StopFlag, text: str, language: str, volume: int) -> Iterator[None]:
        self.said.append((text, language, volume))
        yield


class Ear:
    """Somebody real answers."""

    def __init__(self, *answers: str | None) -> None:
        self.answers = list(answers)
        self.asked: list[Asked] = []

    def hear(self, stop: StopFlag, timeout: float, asked: Asked) -> str | None:
        self.asked.append(asked)
        return self.answers.pop(0)


@pytest.mark.parametrize("kind", ["simulated", "emulated"])
def test_a_robot_speaks_as_loud_and_in_the_language_it_was_told_to(kind: str) -> None:
    megaphone = Megaphone()
    sound = Sound(megaphone)
    ward = Simulation(load_world("ward"))
    robot = simulated(ward, sound) if kind == "simulated" else emulated(sound=sound)
    for method, arguments in (
        ("say", {"text": "Hello."}),
        ("set_volume", {"percent": 20}),
        ("set_language", {"code": "de"}),
        ("say", {"text": "Hallo."}),
        ("say", {"text": "Bonjour.", "language": "fr"}),
    ):
        robot.call(method, arguments, StopFlag())
    robot.close()
    assert megaphone.said == [("Hello.", "en", 70), ("Hallo.", "de", 20), ("Bonjour.", "fr", 20)]


@pytest.mark.parametrize("kind", ["simulated", "emulated"])
def test_a_robot_with_ears_hears_who_is_really_there(kind: str) -> None:
    ear = Ear("hm", "tea please", None, None)
    sound = Sound(ears=ear)
    ward = Simulation(load_world("ward"))
    robot = simulated(ward, sound) if kind == "simulated" else emulated(sound=sound)
    events: list[str] = []
    robot.subscribe(lambda kind, data: events.append(data["text"]) if kind == "heard" else None)
    question = {"question": "Coffee or tea?", "options": ["coffee", "tea"]}
    assert robot.call("ask", question, StopFlag()) == "tea"
    assert events == ["hm", "tea please"]
    assert ear.asked[0] == Asked("en", "Coffee or tea?", ["coffee", "tea"], None)
    robot.close()


def test_a_stop_silences_the_robot_within_a_tenth_of_a_second() -> None:
    class Slow:
        name = "slow"

        def speak(self, text: str, **_: object) -> Iterator[Samples]:
            speaks.set()
            assert may_go_on.wait(SOON)
            yield from voice("en", "espeak").speak(text)

    speaks, may_go_on = threading.Event(), threading.Event()
    heard: list[float] = []
    speaker = Speaker(
        Handed(lambda sound, at: heard.append(sound.seconds)), voice_for=lambda language: Slow()
    )
    robot = simulated(Simulation(load_world("ward")), Sound(RobotVoice(speaker)))
    ended: list[float] = []

    def say() -> None:
        with pytest.raises(Stopped):
            robot.call("say", {"text": "A long story."}, StopFlag())
        ended.append(time.perf_counter())

    talks = threading.Thread(target=say)
    talks.start()
    assert speaks.wait(SOON)
    began = time.perf_counter()
    robot.stop("Nurse Kim pressed stop.")
    assert not speaker.is_speaking
    talks.join(SOON)
    assert ended[0] - began < 0.1
    may_go_on.set()
    robot.call("say", {"text": "Hello."}, StopFlag())
    assert len(heard) == 1
    robot.close()
    speaker.close()


# --- the people ----------------------------------------------------------------------------------


def test_everybody_has_a_voice_of_their_own_and_keeps_it() -> None:
    assert person_called("Alice") == person_called("alice")
    assert person_called("Alice", "female").variant in FEMALE
    assert person_called("Henry", "male").variant in MALE
    assert len({person_called(name) for name in ("Alice", "Bob", "Clara", "Henry", "Grace")}) == 5


@pytest.fixture
def people(recogniser: Recogniser) -> Iterator[SimulatedVoices]:
    speaker = Speaker(Handed(lambda sound, at: None))
    yield SimulatedVoices(
        replies=Replies(
            lambda language: recogniser, lambda language: ["yes", "no", "the pharmacy"]
        ),
        genders={"Alice": "female", "Henry": "male"},
        speaker=speaker,
        clock=lambda: 0.0,
    )
    speaker.close()


@pytest.mark.parametrize(
    ("person", "words", "options"),
    [
        ("Henry", "kitchen", ["kitchen", "lobby", "office"]),
        ("Alice", "no thank you", ["yes", "no"]),
        ("Grace", "seven", ["five", "seven", "nine"]),
    ],
)
def test_what_people_answer_is_heard(
    people: SimulatedVoices, person: str, words: str, options: list[str]
) -> None:
    heard = people.heard(StopFlag(), person, words, Asked("en", "Which?", options))
    assert heard is not None and heard in words


def test_a_free_answer_is_heard(people: SimulatedVoices) -> None:
    assert people.heard(StopFlag(), "Alice", "the pharmacy", Asked("en")) == "the pharmacy"


def test_silence_is_heard_as_nothing(people: SimulatedVoices) -> None:
    assert people.heard(StopFlag(), "Alice", "...", Asked("en", None, ["yes", "no"])) is None


def test_a_stop_waits_for_no_recogniser(people: SimulatedVoices) -> None:
    stop = StopFlag()
    stop.set("Stop.")
    began = time.perf_counter()
    with pytest.raises(Stopped):
        people.heard(stop, "Alice", "yes", Asked("en", None, ["yes", "no"]))
    assert time.perf_counter() - began < 1


def test_a_language_that_cannot_be_heard_is_told_of() -> None:
    def no_model(language: str) -> Recogniser:
        raise UserError("The German speech model is not installed.")

    speaker = Speaker(Handed(lambda sound, at: None))
    people = SimulatedVoices(
        replies=Replies(no_model, lambda language: []),
        genders={},
        speaker=speaker,
        clock=lambda: 0.0,
    )
    with pytest.raises(NotPossible, match="German speech model is not installed"):
        people.heard(StopFlag(), "Alice", "ja", Asked("de"))
    speaker.close()


def test_nothing_is_made_where_nothing_is_wished_for() -> None:
    with aloud(Wishes(), load_world("ward")) as sound:
        assert sound is None


def test_the_example_in_the_docs_runs() -> None:
    page = (Path(__file__).parents[2] / "docs" / "speaking.md").read_text("utf-8")
    (example,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    exec(compile(example, "docs/speaking.md", "exec"), {})


def at_a_microphone(*sounds: Sequence[int]) -> Microphone:
    """One that hears these sounds, and then nothing for a long time."""

    @contextmanager
    def opened() -> Iterator[Iterator[NDArray[np.int16]]]:
        quiet = np.zeros(RATE, np.int16)
        yield iter([quiet, *(np.asarray(sound, np.int16) for sound in sounds), *[quiet] * 20])

    return opened


def test_somebody_real_answers_at_the_microphone(people: SimulatedVoices) -> None:
    said = people.sound_of("Henry", "the kitchen please", "en").samples
    ears = AtMicrophone(at_a_microphone(said), people.replies)
    assert ears.hear(StopFlag(), 5.0, Asked("en", "Where to?", ["kitchen", "lobby"])) == "kitchen"


def test_a_number_is_expected_of_how_many(people: SimulatedVoices) -> None:
    said = people.sound_of("Alice", "twelve", "en").samples
    ears = AtMicrophone(at_a_microphone(said), people.replies)
    assert ears.hear(StopFlag(), 5.0, Asked("en", "How many patients are here?")) == "12"


def test_nobody_answers_at_the_microphone_and_a_stop_ends_the_waiting(
    people: SimulatedVoices,
) -> None:
    ears = AtMicrophone(at_a_microphone(), people.replies)
    assert ears.hear(StopFlag(), 5.0, Asked("en", "Where to?")) is None
    stop = StopFlag()
    stop.set()
    with pytest.raises(Stopped):
        ears.hear(stop, 5.0, Asked("en", "Where to?"))


def test_options_that_the_model_cannot_hear_are_left_to_the_screen(
    people: SimulatedVoices,
) -> None:
    sound = people.sound_of("Alice", "qwrtz", "en")
    heard = people.replies.recognised(sound, Asked("en", None, ["qwrtz", "xyzzq"]))
    assert heard not in ("qwrtz", "xyzzq")
