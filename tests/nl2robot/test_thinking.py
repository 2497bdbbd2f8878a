"""A language model takes its time: people see that, nobody else has to wait, and it can be given
up."""

import io
import json
import signal
import sys
import threading
from pathlib import Path

import pytest
from rich.console import Console

from grammar.planning.planner import Interrupted
from nl2robot.cli.session import Session
from nl2robot.cli.terminal import Terminal
from nl2robot.cli.waiting import Waiting
from nl2robot.errors import ExitStatus
from nl2robot.translate.outcome import Translation
from nl2robot.translate.thinking import Progress, Thought, published
from robot_api.errors import Stopped
from tests.nl2robot.conftest import SOON

WISH = "ward a might do with a wave from you"
"""What the rules do not know."""
OTHER_WISH = "ward b might do with a wave from you"
WRITTEN = {
    WISH: ['goto("ward a")\ngesture("wave")'],
    OTHER_WISH: ['goto("ward b")\ngesture("wave")'],
}
PROGRAM = 'robot.goto("ward a")\nrobot.gesture("wave")\n'
SLOW_MODEL = (sys.executable, str(Path(__file__).with_name("with_a_slow_model.py")))
CTRL_C = "\x03"


@pytest.fixture
def writer(scripted):
    """A language model that is in the middle of every program until `held` is cleared."""
    writer = scripted(WRITTEN)
    writer.held.set()
    yield writer
    writer.held.clear()


class Waits:
    """An operator who waits for a translation in a thread of their own."""

    def __init__(self, operator, words: str = WISH, talk: str | None = None) -> None:
        self.seen: list[Progress] = []
        self.thinking, self.writing = threading.Event(), threading.Event()
        self._came: Translation | None = None
        self._error: BaseException | None = None

        def saw(progress: Progress) -> None:
            self.seen.append(Progress(progress.what, progress.text.replace("'", '"')))
            {"thinking": self.thinking, "writing": self.writing}[progress.what].set()

        def wait() -> None:
            try:
                self._came = operator.translate(words, "en", "auto", talk, saw)
            except BaseException as error:  # noqa: BLE001 - raised again in `ends`
                self._error = error

        self._thread = threading.Thread(target=wait, daemon=True)
        self._thread.start()

    def ends(self) -> Translation:
        self._thread.join(SOON)
        assert not self._thread.is_alive(), "it never ends"
        if self._error is not None:
            raise self._error
        assert self._came is not None
        return self._came


# --- over the wire ---------------------------------------------------------------------------


def test_who_waits_sees_the_program_grow(operator, writer) -> None:
    waits = Waits(operator)
    assert waits.writing.wait(SOON)
    assert waits.seen == [Progress("thinking"), Progress("writing", 'robot.goto("ward a")\n')]
    writer.held.clear()
    translation = waits.ends()
    assert (translation.program, translation.source) == (PROGRAM, "model")


def test_what_the_rules_know_nobody_thinks_about(operator, writer) -> None:
    waits = Waits(operator, "go to ward a")
    assert waits.ends().source == "grammar"
    assert waits.seen == [] == writer.asked


def test_nobody_else_waits_and_a_stop_ends_it(station, operator, sit_down, writer) -> None:
    waits, other = Waits(operator), sit_down(station)
    assert waits.writing.wait(SOON)
    for somebody in (operator, other):
        assert somebody.robot.request("program.state") is None
        assert somebody.translate("go to ward b").status == "ok"
    other.stop()
    with pytest.raises(Stopped):
        waits.ends()


def test_it_can_be_given_up_and_the_next_sentence_is_understood(operator, writer) -> None:
    assert operator.translate("go to ward a", talk="the ward").status == "ok"
    waits = Waits(operator, talk="the ward")
    assert waits.writing.wait(SOON)
    operator.give_up()
    with pytest.raises(Stopped, match="cancelled"):
        waits.ends()
    # What was given up was never said.
    corrected = operator.translate("no, ward b", talk="the ward")
    assert corrected.program == 'robot.goto("ward b")\n'
    writer.held.clear()
    assert operator.translate(WISH, talk="the ward").program == PROGRAM


def test_who_gives_up_in_the_line_leaves_it_and_the_others_are_served(
    station, operator, sit_down, writer
) -> None:
    first = Waits(operator)
    assert first.writing.wait(SOON)
    impatient, patient = sit_down(station), sit_down(station)
    second, third = Waits(impatient, OTHER_WISH), Waits(patient, OTHER_WISH)
    assert second.thinking.wait(SOON)
    assert third.thinking.wait(SOON)
    impatient.give_up()
    with pytest.raises(Stopped):
        second.ends()
    assert len(writer.asked) == 1, "one sentence at a time"
    writer.held.clear()
    assert 'goto("ward a")' in (first.ends().program or "")
    assert 'goto("ward b")' in (third.ends().program or "")
    assert len(writer.asked) == 2, "nobody wrote for who was gone"


def test_nobody_writes_for_a_client_who_is_gone(station, operator, sit_down, writer) -> None:
    leaver = station.connect()
    gone = Waits(type(operator)(leaver, "Nurse Lee"))
    assert gone.writing.wait(SOON)
    waits = Waits(operator, OTHER_WISH)
    leaver.close()
    assert waits.writing.wait(SOON), "the model is still at the first sentence"


def test_others_may_look_on(station, operator, sit_down, writer) -> None:
    told, written = [], threading.Event()

    def listen(kind: str, data) -> None:
        told.append((data["what"], data["talk"], data["utterance"], "goto" in data.get("text", "")))
        if data["what"] == "writing":
            written.set()

    sit_down(station).watch(listen, "translation")
    Waits(operator, talk="the ward")
    assert written.wait(SOON)
    assert told == [("thinking", "the ward", WISH, False), ("writing", "the ward", WISH, True)]


def test_not_every_letter_is_told() -> None:
    now, told = [0.0], []
    tell = published(lambda kind, data: told.append(data["text"]), {}, lambda: now[0])
    for step in range(20):
        now[0] = step * 0.03
        tell(Progress("writing", str(step)))
    assert told == ["0", "4", "8", "12", "16"]


def test_who_thinks_on_after_it_was_given_up_tells_nobody() -> None:
    go_on, told = threading.Event(), []

    def think(watch) -> str:
        go_on.wait(SOON)
        watch.writing("too late")
        return "too late"

    thought = Thought(think, told.append)
    thought.give_up()
    assert thought.over
    go_on.set()
    with pytest.raises(Interrupted):
        thought.result()
    assert told == []


# --- at the terminal -------------------------------------------------------------------------


def test_ctrl_c_gives_up_the_thinking_and_the_talk_goes_on(start) -> None:
    chat = start("chat", "--world", "ward", at_terminal=True, program=SLOW_MODEL)
    chat.until("you: ")
    for _ in range(2):
        chat.type(f"{WISH}\n")
        chat.until("Thinking")
        chat.type(CTRL_C)
        assert "Given up" in chat.until("you: ")
    chat.type("go to ward a\n")
    chat.until("eject? ")
    chat.type(f"{WISH}\n")  # a correction
    chat.until("Thinking")
    chat.type(CTRL_C)
    assert 'goto("ward a")' in chat.until("eject? "), "the program is still to be decided about"
    chat.type("r\n")
    chat.until("you: ")
    chat.type("bye\n")
    assert chat.end() == ExitStatus.OK
    assert "Traceback" not in chat.output


@pytest.mark.parametrize("command", [("translate",), ("translate", "--json"), ("run",)])
def test_ctrl_c_once_or_twice_ends_a_command_with_a_sentence(start, command) -> None:
    given = start(*command, "--world", "ward", WISH, at_terminal=True, program=SLOW_MODEL)
    given.until("Thinking")
    given.type(CTRL_C)
    given.type(CTRL_C)
    assert given.end() == ExitStatus.INTERRUPTED
    assert "Traceback" not in given.output
    assert "Given up" in given.output or "Interrupted." in given.output


def test_what_other_programs_read_has_nothing_else_in_it(nl2robot, writer) -> None:
    writer.held.clear()
    status, out, err = nl2robot("translate", "--world", "ward", "--json", "--lang", "en", WISH)
    assert status == ExitStatus.OK
    assert json.loads(out)["program"] == PROGRAM
    assert err == "Thinking … Ctrl-C gives it up.\n"
    status, out, err = nl2robot("translate", "--world", "ward", "go to ward a")
    assert err == ""


def test_the_program_grows_on_the_screen_and_goes_when_it_is_there(monkeypatch) -> None:
    monkeypatch.setenv("TERM", "xterm")
    screen = io.StringIO()
    console = Console(file=screen, force_terminal=True, width=80, height=6)
    with Waiting("de", console) as waiting:
        waiting(Progress("thinking"))
        assert "Ich denke nach" in screen.getvalue()
        many = "".join(f'robot.say("{number}")\n' for number in range(20))
        waiting(Progress("writing", many))
    shown = screen.getvalue()
    assert 'say("19")' in shown
    assert 'say("9")' not in shown, "only what fits on the screen"
    waiting(Progress("writing", "robot.late()"))
    assert screen.getvalue() == shown


class Impatient(io.StringIO):
    """A screen at which somebody presses Ctrl-C once more, just when it is cleared."""

    presses = False

    def write(self, text: str) -> int:
        if self.presses:
            signal.raise_signal(signal.SIGINT)
        return super().write(text)


def test_ctrl_c_once_more_leaves_the_terminal_as_it_was(monkeypatch) -> None:
    monkeypatch.setenv("TERM", "xterm")
    screen, errors = Impatient(), sys.stderr
    with Waiting("en", Console(file=screen, force_terminal=True)) as waiting:
        waiting(Progress("writing", PROGRAM))
        screen.presses = True
    screen.presses = False
    assert sys.stderr is errors
    with pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)


class Typing(Terminal):
    """Somebody types a line while the robot is at work, and approves of everything."""

    def __init__(self, line: str) -> None:
        super().__init__(Console(file=io.StringIO(), width=100))
        self.line: str | None = line

    def typed(self, seconds: float) -> str | None:
        line, self.line = self.line, None
        return line


def test_a_line_that_is_typed_meanwhile_is_for_the_rules_only(slow_operator, writer) -> None:
    session = Session(slow_operator, Typing(WISH), approve_all=True)
    session.listens = True
    assert session.perform("wait 3 seconds") == ExitStatus.OK
    assert session.next_line() == WISH
    assert writer.asked == []


class Crying(Typing):
    """Says "stop" while a model thinks."""

    hears = True


def test_a_cry_of_stop_ends_the_thinking_too(operator, writer) -> None:
    session = Session(operator, Crying("stop"), approve_all=True)
    assert session.perform(WISH) == ExitStatus.INTERRUPTED
    assert "Given up" in session.terminal.console.file.getvalue()


# --- the review ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("language", "sentences"),
    [
        (
            "en",
            [
                "Written by a language model: read it before you approve.",
                "It made nothing of: “kindly”, “blue”.",
                "it would have the robot say: “Tea is ready.”",
            ],
        ),
        (
            "de",
            [
                "Von einem Sprachmodell geschrieben: Lesen Sie es, bevor Sie es freigeben.",
                "Nichts gemacht hat es aus: „kindly“, „blue“.",
                "ließe es den Roboter sagen: „Tea is ready.“",
            ],
        ),
        (
            "fr",
            [
                "Écrit par un modèle de langage : lisez-le avant de l'approuver.",
                "Il n'a rien fait de : « kindly », « blue ».",
                "il ferait dire au robot : « Tea is ready. »",
            ],
        ),
    ],
)
def test_who_approves_knows_that_a_model_wrote_it(operator, language, sentences) -> None:
    program = 'robot.say("Tea is ready.")\n'
    translation = Translation(
        utterance="kindly do the blue tea",
        status="ok",
        program=program,
        plan=None,
        source="model",
        confidence=0.9,
        explanation="I will say it.",
        message=None,
        suggestions=[],
        ms=1.0,
        unused=("kindly", "blue"),
        own=("Tea is ready.",),
    )
    terminal = Terminal(Console(file=io.StringIO(), width=200), language)
    terminal.show_review(operator.check(program, language), translation)
    shown = terminal.console.file.getvalue()
    for sentence in sentences:
        assert sentence in shown
        assert sentence in translation.readable(language)
    assert "I will say it." in shown
