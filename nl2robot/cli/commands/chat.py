"""`nl2robot chat`: a conversation in the terminal; each command is reviewed, approved and run."""

from __future__ import annotations

import argparse
import contextlib
import functools
import sys
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import yaml

from grammar.language import load_language
from grammar.naming import joined_up
from nl2robot.cli.commands.run import open_session
from nl2robot.cli.line_editor import Complete, LineEditor
from nl2robot.cli.options.robot import add_robot, robot_of
from nl2robot.cli.options.sentence import add_language, add_planner
from nl2robot.cli.options.sound import add_sound
from nl2robot.cli.options.values import add_asking
from nl2robot.cli.session import Session
from nl2robot.cli.terminal import Terminal
from nl2robot.errors import ExitStatus
from nl2robot.paths import PACKAGED, data_file
from nl2robot.speech.hear.full_duplex import full_duplex
from nl2robot.station.robots import Chosen
from nl2robot.translate import planners
from nl2robot.translate.completing import Named, completions, named_here
from nl2robot.words import words_in
from robot_api.errors import LostConnection, RobotError

if TYPE_CHECKING:
    from nl2robot.speech.hear.full_duplex import FullDuplex

DATA = PACKAGED / "chat.yaml"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_robot(parser)
    add_sound(parser)
    parser.add_argument(
        "--voice",
        nargs="?",
        const=True,
        metavar="FILE",
        help="talk: at the microphone, or from a recording, after the hot word",
    )
    parser.add_argument("--device", metavar="NAME", help="the microphone, by a part of its name")
    parser.add_argument("--hot-word", metavar="WORDS", help='instead of "hey robot"')
    add_asking(parser)
    add_language(parser)
    add_planner(parser)


def run(options: argparse.Namespace) -> int:
    robot = robot_of(options)
    duplex = _duplex(options, robot)
    with (
        _terminal(options, duplex) as terminal,
        open_session(options, robot, terminal=terminal, duplex=duplex) as (session, _),
    ):
        session.listens = session.terminal.somebody_is_there
        if not options.voice and session.terminal.somebody_is_there:
            session.terminal.editor = LineEditor(data_file("history"), _completing(session))
        if not robot.is_server and options.planner != "grammar":
            planners.get_ready()
        session.terminal.console.print(session.terminal.words["greeting"], markup=False)
        while (line := session.next_line() or _next_line(session)) is not None:
            words = line.strip()
            if words.lower().rstrip(".!") in _endings(session.language):
                break
            if words:
                _answer(session, words)
    session.terminal.console.print(session.terminal.words["goodbye"])
    return ExitStatus.OK


def _completing(session: Session) -> Complete:
    """What a line may become here, in the language that is spoken by then."""

    @functools.cache
    def sentences(language: str) -> tuple[str, ...]:
        words = words_in(language)
        said = session.operator.phrases(language).values()
        return (*(each for topic in said for each in topic), words["help"], *_endings(language))

    @functools.cache
    def named(language: str) -> Sequence[Named]:
        assert session.terminal.world is not None
        return named_here(session.terminal.world, language)

    def complete(line: str) -> list[str]:
        language = session.language
        names = named(language) if session.terminal.world is not None else ()
        with contextlib.suppress(RobotError):  # at a server that is gone only the names are known
            joins = functools.partial(joined_up, language=load_language(language))
            return completions(line, sentences(language), names, joins)
        return completions(line, (), names)

    return complete


def _duplex(options: argparse.Namespace, robot: Chosen) -> FullDuplex | None:
    """Where the robot's loudspeaker and the microphone are both here."""
    if not (options.voice is True and options.speak is True and not robot.is_server):
        return None
    return full_duplex(lambda message: print(message, file=sys.stderr, flush=True))


@contextlib.contextmanager
def _terminal(options: argparse.Namespace, duplex: FullDuplex | None) -> Iterator[Terminal]:
    if not options.voice:
        yield Terminal(language=options.lang)
        return
    from nl2robot.cli.commands.talk import voice_terminal

    with voice_terminal(options, duplex) as terminal:
        yield terminal


@functools.cache
def _endings(language: str) -> set[str]:
    """The words that end the conversation."""
    words = yaml.safe_load(DATA.read_text(encoding="utf-8"))["endings"]
    return {*words["any"], *words.get(language, ())}


def _next_line(session: Session) -> str | None:
    while True:
        try:
            return session.terminal.next_line()
        except KeyboardInterrupt:
            print()  # nothing is running: Ctrl-C clears the line


def _answer(session: Session, words: str) -> None:
    if words == "?":  # in every language; in words, it is a command like others
        session.show_help()
        return
    try:
        spoken = session.terminal.heard == words  # and was not typed while something else ran
        session.perform(words, words if spoken else None)
    except KeyboardInterrupt:
        session.terminal.console.print(f"\n{session.terminal.words['rejected']}")
    except LostConnection:
        raise
    except RobotError as error:
        session.terminal.show_error(error)
