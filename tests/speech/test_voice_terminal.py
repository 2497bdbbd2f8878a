"""A terminal with a microphone: lines are spoken or typed, whichever comes first."""

from __future__ import annotations

import io
import os
import threading
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from rich.console import Console

from nl2robot.cli import main as cli
from nl2robot.cli.commands.demo import RECORDING
from nl2robot.cli.voice_terminal import VoiceTerminal
from nl2robot.errors import ExitStatus, UserError
from nl2robot.speech.audio import Samples
from nl2robot.voice.voice import VoiceInput
from tests.speech.test_voice import HOT, SPEECH, STOP, an_ear

Sit = Callable[..., VoiceTerminal]


class Keyboard:
    """Where somebody types, or has left."""

    def __init__(self) -> None:
        reading, self._writing = os.pipe()
        self.input = os.fdopen(reading)

    def type(self, line: str) -> None:
        os.write(self._writing, f"{line}\n".encode())

    def leave(self) -> None:
        if self._writing >= 0:
            os.close(self._writing)
            self._writing = -1


@pytest.fixture
def keyboard(monkeypatch: pytest.MonkeyPatch) -> Iterator[Keyboard]:
    made = Keyboard()
    monkeypatch.setattr("sys.stdin", made.input)
    yield made
    made.leave()
    made.input.close()


@pytest.fixture
def sit(keyboard: Keyboard) -> Iterator[Sit]:
    """Somebody sits there, and the microphone takes up these blocks of sound, then nothing more
    until they stand up: a microphone does not end."""
    terminals: list[VoiceTerminal] = []
    over = threading.Event()

    def make(
        *sounds: Samples, ear: VoiceInput | None = None, ends: bool = False, again: bool = False
    ) -> VoiceTerminal:
        def microphone() -> Iterator[Samples]:
            yield from sounds
            while again and not over.is_set():
                yield from sounds
            if not ends:
                over.wait()

        hears = ear or an_ear()
        terminals.append(VoiceTerminal(microphone(), lambda language: hears, console=quiet()))
        return terminals[-1]

    yield make
    over.set()
    for each in terminals:
        each.close()


class Reads(io.StringIO):
    """Somebody who reads along, and does something as soon as they read that."""

    def __init__(self, text: str, do: Callable[[], None]) -> None:
        super().__init__()
        self._text, self._do = text, do

    def write(self, text: str) -> int:
        if self._text in text:
            self._do()
        return super().write(text)


def quiet() -> Console:
    return Console(file=io.StringIO())


def shown(terminal: VoiceTerminal) -> str:
    file = terminal.console.file
    assert isinstance(file, io.StringIO)
    return file.getvalue()


def test_what_is_said_after_the_hot_word_is_the_line(sit: Sit, capsys: Any) -> None:
    terminal = sit(HOT, *SPEECH)
    assert terminal.next_line() == "go to ward a"
    assert terminal.heard == "go to ward a"
    assert "go to ward a" in capsys.readouterr().out


def test_who_types_need_not_speak(sit: Sit, keyboard: Keyboard) -> None:
    terminal = sit()
    keyboard.type("go to the lobby")
    assert terminal.next_line() == "go to the lobby"
    assert terminal.heard is None


def test_an_answer_needs_no_hot_word(sit: Sit) -> None:
    assert sit(*SPEECH, ear=an_ear("yes"), again=True).ask("Run it?") == "yes"


def test_stop_is_heard_while_the_robot_is_busy(sit: Sit) -> None:
    assert sit(STOP, again=True).typed(30) == "stop"


def test_a_doubtful_sentence_is_asked_again_and_not_done(
    sit: Sit, keyboard: Keyboard, monkeypatch: pytest.MonkeyPatch
) -> None:
    terminal = sit(HOT, *SPEECH, ear=an_ear("go to ward a", doubtful=True, free="goats award her"))
    nurse = Reads("goats award her", lambda: keyboard.type("go to ward b"))
    monkeypatch.setattr("sys.stdout", nurse)
    assert terminal.next_line() == "go to ward b"
    assert "goats award her" in nurse.getvalue()


def test_when_the_recording_is_over_and_nobody_types_it_ends(sit: Sit, keyboard: Keyboard) -> None:
    terminal = sit(HOT, *SPEECH, ends=True)
    assert terminal.next_line() == "go to ward a"
    keyboard.leave()
    assert terminal.next_line() is None
    with pytest.raises(UserError):
        terminal.ask("Run it?")


def test_a_microphone_that_is_pulled_out_leaves_the_keyboard(keyboard: Keyboard) -> None:
    def pulled() -> Iterator[Samples]:
        yield HOT
        raise UserError("The microphone was unplugged. Plug it in, or type.")

    nurse = Reads("unplugged", lambda: keyboard.type("go to the lobby"))
    terminal = VoiceTerminal(pulled(), lambda language: an_ear(), console=Console(file=nurse))
    assert terminal.next_line() == "go to the lobby"
    assert "unplugged" in nurse.getvalue()
    terminal.close()


def test_a_language_that_cannot_be_heard_can_still_be_typed(keyboard: Keyboard) -> None:
    def voice_for(language: str) -> VoiceInput:
        if language == "fr":
            raise UserError("There is no speech model for French. Get it: nl2robot models get fr")
        return an_ear()

    terminal = VoiceTerminal(iter(()), voice_for, console=quiet())
    terminal.speak("fr")
    assert "models get fr" in shown(terminal)
    keyboard.type("va au hall")
    assert terminal.next_line() == "va au hall"
    terminal.close()


def test_a_conversation_with_a_recording_ends_with_it(
    keyboard: Keyboard, capsys: pytest.CaptureFixture[str]
) -> None:
    """Nobody says the hot word in it, so nothing is done."""
    keyboard.leave()
    assert cli.main(["chat", "--voice", str(RECORDING)]) == ExitStatus.OK
    said = capsys.readouterr().out
    assert "hey robot" in said
    assert "robot.goto" not in said
