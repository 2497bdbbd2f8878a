"""Who speaks while a language model thinks is heard: nothing waits for it but its own answer."""

from __future__ import annotations

import base64
import threading
import time
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from nl2robot.knowledge import Knowledge
from nl2robot.speech.audio import RATE, Samples
from nl2robot.speech.hear.listening import COMMANDS, Listener, Manner
from nl2robot.speech.hear.recogniser import Heard, Reading
from nl2robot.translate.talk import Talk
from nl2robot.voice import services as voice_services
from nl2robot.voice.hearing import Ear
from nl2robot.voice.services import Microphones
from nl2robot.work import here
from robot_api.driver import StopFlag
from sim.world.loading import load_world

SOON = 30.0
WISH = "ward a might do with a wave from you"
"""What the rules do not know."""
VOICE, QUIET = np.full(RATE, 9000, np.int16), np.zeros(RATE, np.int16)


class Words:
    """A decoder that hears the same words in everything, and is as sure of them as it is told."""

    def __init__(self, text: str, doubtful: bool) -> None:
        self.heard = Heard(text, 1.0, (), doubtful, text, (Reading(text, 0.0, doubtful),), 2.0, 0.0)

    def begin(self) -> None: ...

    def accept(self, samples: Samples) -> str:
        return self.heard.text

    def pause(self) -> None: ...

    def end(self) -> Heard:
        return self.heard


class GoodEar(Ear):
    """Hears what it is to hear, without a speech model."""

    def __init__(self) -> None:
        self.knowledge, self.language = Knowledge(load_world("ward", names_only=True)), "en"
        self.text, self.doubtful, self._think = WISH, False, here

    def listener(self, manner: Manner = COMMANDS, also: Sequence[str] = ()) -> Listener:
        words = Words(self.text, self.doubtful)
        return Listener(words, manner, lambda frame: float(frame.max() > 5000))


class Bedside:
    """A microphone that somebody speaks into."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.ear, self.talk = GoodEar(), Talk()
        self.published: list[tuple[str, str, str | None]] = []
        monkeypatch.setattr(voice_services, "need", lambda language: None)
        monkeypatch.setattr(
            "nl2robot.voice.hearing.Ear", lambda knowledge, language, think: self.ear
        )
        self.microphones = Microphones(
            lambda: self.ear.knowledge, lambda name: self.talk, publish=self._publish
        )
        self.number = self.microphones.open(RATE, 1, "en", "the ward", connection="7")

    def _publish(self, kind: str, data: Any, to: str | None = None) -> None:
        self.published.append((kind, data["what"], to))

    def push(self, *sounds: Samples) -> list[dict[str, Any]]:
        """What is told while these sounds are pushed."""
        return [
            event
            for sound in sounds
            for at in range(0, len(sound), RATE // 10)
            for event in self.microphones.push(
                self.number, base64.b64encode(sound[at : at + RATE // 10].tobytes()).decode()
            )
        ]

    def say(self, text: str) -> list[dict[str, Any]]:
        """The same while somebody says this."""
        [opened] = self.microphones._open.values()
        self.ear.text = text
        opened.listener = self.ear.listener()
        return self.push(VOICE, QUIET)

    def comes(self) -> dict[str, Any]:
        """The next thing that is told while nobody speaks."""
        until = time.monotonic() + SOON
        while time.monotonic() < until:
            for event in self.push(QUIET[: RATE // 10]):
                return event
        raise AssertionError("nothing comes")


@pytest.fixture
def writer(scripted):
    """A language model that is in the middle of every program until `held` is cleared."""
    writer = scripted({WISH: ['goto("ward a")\ngesture("wave")']})
    writer.held.set()
    yield writer
    writer.held.clear()


@pytest.fixture
def bedside(monkeypatch) -> Bedside:
    return Bedside(monkeypatch)


def whats(events: list[dict[str, Any]]) -> list[str]:
    return list(dict.fromkeys(event["what"] for event in events))


def test_it_is_told_at_once_that_it_thinks_and_then_what_it_made_of_it(bedside, writer) -> None:
    told = bedside.say(WISH)
    assert whats(told) == ["began", "partial", "thinking"]
    assert told[-1] == {"what": "thinking", "text": WISH}
    assert ("translation", "thinking", "7") in bedside.published, "its client alone is told"
    # It hears on meanwhile.
    assert [event["what"] for event in bedside.say("go to ward b") if "translation" in event] == [
        "heard"
    ]
    writer.held.clear()
    heard = bedside.comes()
    assert (heard["what"], heard["text"]) == ("heard", WISH)
    assert heard["translation"]["source"] == "model"
    assert len(writer.asked) == 1, "what is only half said is for the rules"
    assert bedside.talk.last is not None and bedside.talk.last.utterance == WISH


def test_what_the_rules_know_comes_in_the_same_answer(bedside, writer) -> None:
    assert whats(bedside.say("go to ward a")) == ["began", "partial", "heard"]
    assert writer.asked == []


def test_what_is_doubtful_no_model_makes_sense_of(bedside, writer) -> None:
    bedside.ear.doubtful = True
    assert "thinking" not in whats(bedside.say(WISH))
    assert writer.asked == []


def test_a_cry_of_stop_ends_the_thinking(bedside, writer) -> None:
    bedside.say(WISH)
    told = bedside.say("stop")
    assert any(event.get("stop") for event in told if event["what"] == "partial")
    assert {"what": "given up", "text": WISH} in told
    assert bedside.talk.last is None or bedside.talk.last.utterance == "stop"


@pytest.mark.parametrize("connection", [None, "7"])
def test_a_stop_by_anybody_and_a_client_who_leaves_end_it(bedside, writer, connection) -> None:
    bedside.say(WISH)
    bedside.microphones.give_up("8")  # somebody else left
    assert bedside.push(QUIET) == []
    bedside.microphones.give_up(connection)
    assert bedside.comes() == {"what": "given up", "text": WISH}


def test_who_lets_go_of_the_button_waits_for_the_program(bedside, writer) -> None:
    told: list[dict[str, Any]] = []
    bedside.push(VOICE)
    closing = threading.Thread(
        target=lambda: told.extend(bedside.microphones.close(bedside.number)), daemon=True
    )
    closing.start()
    writer.held.clear()
    closing.join(SOON)
    assert [event["what"] for event in told] == ["heard"]
    assert told[0]["translation"]["source"] == "model"


def test_who_waits_for_the_program_can_give_it_up(bedside, writer) -> None:
    stop = StopFlag()
    bedside.push(VOICE)
    stop.set()
    assert bedside.microphones.close(bedside.number, stop) == [{"what": "given up", "text": WISH}]
