"""The review in the terminal: show a program and what it would do, ask, show it run."""

from __future__ import annotations

import contextlib
import os
import select
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal

from rich.console import Console
from rich.markup import escape
from rich.panel import Panel
from rich.syntax import Syntax
from rich.table import Table

from grammar.language import load_language
from grammar.lexicon import Lexicon
from nl2robot.cli.line_editor import LineEditor
from nl2robot.cli.live_line import LiveLine
from nl2robot.cli.on_the_way import OnTheWay
from nl2robot.cli.waiting import Waiting
from nl2robot.errors import ExitStatus, UserError
from nl2robot.knowledge import Knowledge
from nl2robot.plain import visible
from nl2robot.run.state import HELD
from nl2robot.run.trouble import error_told, told
from nl2robot.schedule.rhythm import local
from nl2robot.schedule.schedule import Listed
from nl2robot.schedule.words import a_date, a_moment
from nl2robot.translate.teaching import topic_of
from nl2robot.words import authorship, foreseen, words_in
from robot_api.errors import InvalidCall, RobotError
from robot_api.local_time import local_zone
from sim.world.model import name_in

if TYPE_CHECKING:
    from nl2robot.cli.operator import Operator
    from nl2robot.review.rehearsal import DryRun
    from nl2robot.review.review import Review
    from nl2robot.run.answers import Sentence
    from nl2robot.translate.outcome import Translation
    from sim.world.model import World

Decision = Literal["approve", "edit", "reject"]
_ELSE: Final[tuple[Decision, ...]] = ("edit", "reject")
_EVERYWHERE: Final[Mapping[str, tuple[str, str]]] = {
    "approve": ("a", "approve"),
    "edit": ("e", "edit"),
    "reject": ("r", "reject"),
}
"""What counts in every language that has no other meaning for it: scripts are written once."""
_EDITORS: Final = ("nano", "sensible-editor", "vim", "vi")
"""Tried one after the other where none is named: the first needs no explanation."""

__all__ = ["Decision", "Terminal", "answers", "words_in"]

NARROWEST = 20
"""Columns; a terminal that says it has fewer does not know."""


class _Console(Console):
    def on_broken_pipe(self) -> None:
        raise BrokenPipeError  # for `cli.main`; without this, rich would exit here and now


class Terminal:
    """What an operator sees and answers at a terminal."""

    def __init__(self, console: Console | None = None, language: str = "en") -> None:
        self.world: World | None = None
        self._knowledge: Knowledge | None = None
        self.speak(language)
        self.console = console or _Console(highlight=False, emoji=False)
        if self.console.width < NARROWEST:
            self.console.width = 80
        self._live = LiveLine(self.console)
        self._way = OnTheWay()

    editor: LineEditor | None = None
    """Completes and keeps what is typed, where somebody types."""

    heard: str | None = None
    """What the last line sounded like, if it was spoken."""

    aloud = False
    """Whether answers are also to be heard, from the robot's own loudspeaker here."""

    nobody = "nobody_there"
    """What is said, by its key in `terminal.yaml`, when a question is not answered."""

    unclear = "undecided"
    """The same, when what is answered decides nothing."""

    hears = False
    """Whether somebody may say "stop" at any time, and is to be listened to."""

    @property
    def somebody_is_there(self) -> bool:
        return sys.stdin.isatty()

    def speak(self, language: str) -> None:
        """Go on in a language."""
        self.language = language
        self.words = words_in(language)

    def accompany(self, operator: Operator, world: World | None = None) -> None:
        """Somebody operates a robot in a world from here; what it does may matter to how lines are
        read, and shows where it drives."""
        self.world = world
        self._knowledge = Knowledge(world) if world is not None else None
        self._way = OnTheWay(world)
        if self._live.possible:
            with contextlib.suppress(InvalidCall):  # a server that tells of no poses
                operator.watch(self._show_pose, "pose")

    def called(self, place: str) -> str:
        """A place by the name that it has in the language spoken."""
        known = self.world.place(place) if self.world is not None else None
        return name_in(known, self.language) if known is not None else place

    def lexicon(self) -> Lexicon | None:
        """The names of the world that the robot is in, if that is known."""
        return self._knowledge.lexicon(self.language) if self._knowledge is not None else None

    def trouble(self, kind: str | None, message: str) -> str:
        """What went wrong, in the language spoken."""
        return told(kind, message, self.language, self.lexicon())

    # --- before the run

    def waiting(self) -> Waiting:
        """What to show while a sentence is understood, should that take long."""
        return Waiting(self.language, self.console)

    def show_given_up(self) -> None:
        self.console.print(self.words["given_up"], markup=False)

    def show_refusal(self, translation: Translation) -> None:
        """Say why there is no program, and what could be said instead."""
        self.console.print(_plain(translation.message or ""))
        if translation.suggestions:
            self.console.print(load_language(self.language).phrase("could_say"))
            for phrase in translation.suggestions:
                self.console.print(f"  [bold]{_plain(phrase)}[/]")

    def show_message(self, translation: Translation) -> None:
        """Show an answer that is no program."""
        self.console.print(_plain(translation.message or ""))

    def show_phrases(self, phrases: Mapping[str, Sequence[str]], about: str = "") -> None:
        """What can be said, by topic; only the topic `about`, if there is one like it."""
        found = topic_of(about, list(phrases)) if about else None
        for topic, sentences in {found: phrases[found]}.items() if found else phrases.items():
            # Only the first letter: "Gesten und Bildschirm".
            self.console.print(f"[bold]{_plain(topic[:1].upper() + topic[1:])}[/]")
            for sentence in sentences:
                self.console.print(f"  {_plain(sentence)}", soft_wrap=True)

    def show_program(self, program: str) -> None:
        self.console.print(
            Panel(
                Syntax(visible(program).rstrip("\n"), "python", line_numbers=True, word_wrap=True),
                title=self.words["program"],
                title_align="left",
                border_style="dim",
            )
        )

    def show_when(self, when: str) -> None:
        """At what times a program is to be done, above its review."""
        self.console.print(f"[bold]{self.words['when']}[/] {_plain(when)}")

    def show_appointment(self, kept: Listed) -> None:
        """What is in the book from now on."""
        about = kept.appointment
        zone = about.rhythm.zone if about.rhythm is not None else local_zone()
        told = self.words["in_the_book" if kept.next else "in_the_book_at_event"].format(
            number=about.id,
            when=kept.when,
            next=a_moment(kept.next[0], zone, self.language) if kept.next else "",
            until=a_date(local(about.approved_until - 1, zone), self.language),
        )
        self.console.print(_plain(told))

    def show_review(self, review: Review, translation: Translation | None = None) -> None:
        """`translation` is what made the program, if it stands as it was made."""
        self.show_program(review.program)
        if translation is not None:
            for sentence in authorship(translation, self.language):
                self.console.print(f"[yellow]{_plain(sentence)}[/]")
        if translation is not None and translation.explanation:
            explanation = _plain(translation.explanation)
            self.console.print(f"[bold]{self.words['in_words']}[/] {explanation}")
        elif review.reading:
            self.console.print(f"[bold]{self.words['in_words']}[/]")
        if translation is None or len(review.reading) > 1:
            for told in review.reading:
                self.console.print(f"[dim]{told.line:>4}[/] {'  ' * told.depth}{_plain(told.text)}")
        for finding in review.findings:
            style, word = ("red", "error") if finding.severity == "error" else ("yellow", "note")
            where = f"{self.words[word]}, {self.words['line']} {finding.line}"
            message = self.trouble(finding.code, finding.message)
            self.console.print(f"[{style}]{where}:[/] {_plain(message)}")
        for risk in review.risks:
            where = f"{self.words['risk']}, {self.words['line']} {risk.line}"
            self.console.print(f"[yellow]{where}:[/] {_plain(risk.text)}")
        if review.dry_run is not None:
            self._show_dry_run(review.dry_run)

    def _show_dry_run(self, dry_run: DryRun) -> None:
        text = foreseen(dry_run, self.language)
        heading = self.words["dry_run"]
        why = self.trouble(dry_run.error, dry_run.message or "")
        self.console.print(f"[bold]{heading}[/] {text} {_plain(why)}".rstrip())
        self._way.plan(dry_run.path)
        if dry_run.places:
            way = " → ".join(self.called(place) for place in dry_run.places)
            self.console.print(f"  {self.words['way']}: {_plain(way)}")
        if dry_run.closed:
            closed = _plain(", ".join(self.called(place) for place in dry_run.closed))
            self.console.print(f"  [yellow]{self.words['closed']}: {closed}[/]")
        for words in dict.fromkeys(dry_run.says):
            self.console.print(f"  {self.words['says']}: {_plain(words)}")

    def decide(self, review: Review) -> tuple[Decision | None, str]:
        """Ask whether the program may run; returns the decision and the words of the answer. What
        is none of the answers is left to the caller: a correction, maybe. What cannot be approved
        is not offered for it; what did not come to its end in the dry run is only run if they
        insist, and no answer is a refusal."""
        insisting = review.acceptable and not review.came_through
        approving = "insist" if insisting else "approve"
        question = f"{approving}_edit_reject" if review.acceptable else "edit_reject"
        asked, undecided = self.words[question], None
        while True:
            answer = self.ask(asked, undecided).strip()
            said = answer.lower().strip(" .!,")
            if insisting and not said and self.somebody_is_there:
                return "reject", answer
            means = self._meaning(said)
            for decision in _ELSE:
                if means == decision:
                    return decision, answer
            if means == approving and review.acceptable:
                return "approve", answer
            # A key beside the right one is no command, and a "yes" may not be enough.
            if len(said) > 1 and not (insisting and means == "approve"):
                if self.editor is not None:
                    self.editor.remember(answer)  # a correction is a command
                return None, answer
            if not self.somebody_is_there:  # to read the question once more
                asked, undecided = "", answer

    def settle(self, review: Review) -> Decision:
        """The same where nothing can be corrected: what is none of the answers is asked again, and
        from a script it decides nothing. Raises `UserError`."""
        while True:
            decision, answer = self.decide(review)
            if decision is not None:
                return decision
            if not self.somebody_is_there:
                raise UserError(self._undecided(answer), ExitStatus.NOT_APPROVED)

    def _meaning(self, said: str) -> str:
        """Of an answer: a decision, "insist" or nothing."""
        for answers in (self.words["answers"], _EVERYWHERE):
            for way, words in answers.items():
                if said in words:
                    return str(way)
        return ""

    def _undecided(self, answer: str) -> str:
        return str(self.words[self.unclear].format(answer=visible(answer)))

    def next_line(self) -> str | None:
        """The next thing that somebody says or types on their own; None at the end of the input."""
        prompt = f"\n{self.words['you']}"
        try:
            return self.editor.command(prompt) if self.editor is not None else input(prompt)
        except EOFError:
            return None

    def ask(self, question: str, undecided: str | None = None) -> str:
        """Read a line. The end of the input counts as no answer, and no answer as a refusal.
        `undecided`: what was answered before and was no answer."""
        try:
            return input(question)
        except EOFError:
            print()
            sentence = self.words[self.nobody]
            if undecided is not None:
                sentence = self._undecided(undecided)
            raise UserError(sentence, ExitStatus.NOT_APPROVED) from None

    def typed(self, seconds: float) -> str | None:
        """A line that is typed within so many seconds, without asking for one."""
        if not self.keyboard_ready(seconds):
            return None
        line = sys.stdin.readline()
        self._live.leave()  # the key that ended the line began another
        if not line:  # the end of the input: whoever asks next is told
            time.sleep(seconds)
        return line.strip() or None

    @staticmethod
    def keyboard_ready(seconds: float) -> bool:
        """Whether something is typed within so many seconds."""
        try:
            ready, _, _ = select.select([sys.stdin], [], [], seconds)
        except (OSError, ValueError):  # an input that cannot be looked at without reading it
            time.sleep(seconds)
            return False
        return bool(ready)

    def edit(self, program: str) -> str:
        """Let the operator change the program in $VISUAL, $EDITOR or an editor that is there;
        returns the new text, or the old one (and says why) if that fails."""
        there = filter(shutil.which, _EDITORS)
        editor = os.environ.get("VISUAL") or os.environ.get("EDITOR") or next(there, _EDITORS[0])
        with tempfile.TemporaryDirectory(prefix="nl2robot-") as folder:
            file = Path(folder) / "program.py"
            try:
                file.write_text(program, encoding="utf-8")
                with _left_to_the_editor(signal.SIGINT):
                    subprocess.run([*shlex.split(editor), str(file)], check=True)
                return file.read_text(encoding="utf-8-sig")
            except UnicodeDecodeError:
                reason = self.words["editor_no_text"]
            except subprocess.CalledProcessError as error:
                reason = self.words["editor_status"].format(status=error.returncode)
            except OSError as error:
                reason = str(error.strerror)
            except ValueError as error:  # a quotation mark that is not closed
                reason = str(error)
        told = self.words["editor_failed"].format(editor=repr(editor), reason=reason)
        self.console.print(told, markup=False)
        return program

    # --- during the run

    def show_event(self, kind: str, data: Mapping[str, Any]) -> None:
        """Show an event of the wire as it comes."""
        self._live.leave()
        if kind == "program" and data["what"] == "call":
            arguments = ", ".join(
                f"{name}={_short(value)}"
                for name, value in data["arguments"].items()
                if value is not None
            )
            call = f"{data['method']}({arguments})"
            self.console.print(f"[dim]{data['line']:>4}[/] {_plain(call)}")
            self._way.begin(data["method"], data["arguments"])
        elif kind == "program" and data["what"] == "result":
            self._way.end()
            if data.get("error"):
                why = error_told(str(data["error"]), self.language, self.lexicon())
                self.console.print(f"     [red]{_plain(why)}[/]")
            elif data.get("result") is not None:
                self.console.print(f"     [green]→ {_plain(_short(data['result']))}[/]")
        elif kind == "program" and data["what"] == "print":
            self.console.print(f"     {_plain(data['text'].rstrip())}")

    def _show_pose(self, kind: str, pose: Mapping[str, Any]) -> None:
        """Where it is by now, in a line that is written again and again while it drives."""
        if self._way.place is None:
            return
        left = self._way.at(pose["x"], pose["y"])
        words = self.words["driving_there" if left is None else "driving"]
        place = visible(self.called(self._way.place))
        self._live.show(f"     {words.format(place=place, metres=round(left or 0))}")

    def show_unconfirmed(self) -> None:
        """The robot was told to stop and has not said that it stands."""
        self._live.leave()
        self.console.print(f"[bold red]{_plain(self.words['unconfirmed'])}[/]")

    def show_link(self, data: Mapping[str, Any]) -> None:
        """The robot was lost, or found again."""
        self._live.leave()
        if data["lost_since"] is not None:
            time, because = datetime.fromtimestamp(data["lost_since"]), data["because"] or ""
            told = self.words["robot_lost"].format(time=f"{time:%H:%M}", because=because)
            self.console.print(f"[bold red]{_plain(told.rstrip())}[/]")
        else:
            self.console.print(_plain(self.words["robot_found"]))

    def show_state(self, state: str, before: str | None) -> None:
        """The run in view was halted, goes on, or is being stopped."""
        key = "resumed" if state == "running" and before in HELD else state
        if told := self.words.get(f"state_{key}"):
            self._live.leave()
            self.console.print(f"[yellow]{_plain(told)}[/]")

    def show_error(self, error: RobotError) -> None:
        """What the robot could not do."""
        why = self.trouble(type(error).__name__, str(error))
        self.console.print(why, markup=False)

    def show_answer(
        self, answer: Sequence[Sentence], state: str, message: str | None, error: str | None = None
    ) -> None:
        """What came of a run; how it ended only where that was not as it should, or nothing did."""
        self._live.leave()
        self._way.end()
        with contextlib.suppress(BrokenPipeError):
            for sentence in answer:
                self.console.print(f"[bold green]{_plain(sentence.text)}[/]")
        if state != "done" or not answer:
            self.show_end(state, message, error)

    def show_end(self, state: str, message: str | None, error: str | None = None) -> None:
        """How a run ended, and why; `error` is the name of what it failed with."""
        self._live.leave()
        self._way.end()
        style = {"done": "green", "stopped": "yellow"}.get(state, "red")
        told = f"[{style}]{self.words.get(state, state)}[/]"
        # The reader of a pipe may have left; how it ended is in the exit status, too.
        with contextlib.suppress(BrokenPipeError):
            why = self.trouble(error, message or "")
            self.console.print(f"{told} {_plain(why)}".rstrip())

    @staticmethod
    def plain(text: str) -> str:
        """Text of others, for a table."""
        return _plain(text)

    def table(self, *headings: str) -> Table:
        table = Table(box=None, pad_edge=False, header_style="bold")
        for heading in headings:
            table.add_column(heading, overflow="fold")
        return table


def answers(language: str) -> frozenset[str]:
    """What may be answered when a program is to be approved, in words."""
    ways = words_in(language)["answers"].values()
    return frozenset(way for those in ways for way in those if len(way) > 1)


def _plain(text: str) -> str:
    """Text of others, for rich to print as it is."""
    return escape(visible(text))


@contextlib.contextmanager
def _left_to_the_editor(number: signal.Signals) -> Iterator[None]:
    """Ctrl-C in an editor is the editor's."""
    before = signal.signal(number, lambda *_: None)  # not SIG_IGN, which the editor would inherit
    try:
        yield
    finally:
        signal.signal(number, before)


def _short(value: Any, longest: int = 70) -> str:
    if isinstance(value, dict) and "x" in value and "y" in value:
        return str(value.get("place") or f"({value['x']:.2f}, {value['y']:.2f})")
    text = repr(value) if isinstance(value, str) else str(value)
    return text if len(text) <= longest else text[: longest - 1] + "…"
