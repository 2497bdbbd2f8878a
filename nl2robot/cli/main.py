"""The command line: `nl2robot COMMAND`. Each command is a module of `nl2robot.cli.commands`.

Only the module of the command that was asked for is imported, so that `translate` starts at once.
Exit statuses: `nl2robot.errors.ExitStatus`.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib
import io
import os
import signal
import sys
import traceback
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import Any, NoReturn

from nl2robot import __version__
from nl2robot.errors import ExitStatus
from nl2robot.texts import stand_in
from nl2robot.words import terminal_language, words_in

COMMANDS = {
    "run": "translate, show, ask for approval, run",
    "translate": "turn words into a program; never moves anything",
    "explain": "show how a sentence is read, and why not",
    "phrases": "what can be said here, by topic",
    "chat": "the same as a conversation in the terminal",
    "hotword": "say each time the hot word is heard",
    "listen": "turn what is said, or a recording, into a program or an answer",
    "routines": "commands with a name: list, explain, learn, change, forget, export, import",
    "schedule": "approved programs at set times: list, add, pause, call off, remove, history",
    "proposals": "what assistants propose to a server's robot: approve it, or say no",
    "fleet": "several robots: list them, give one something to do, call that off, stop them",
    "mcp": "a door for assistants, over the Model Context Protocol",
    "serve": "the robot server on one port, a simulated hospital by default",
    "accounts": "who may come in to the server here: people, and tablets by a QR code",
    "robots": "the kinds of robots there are drivers for, and a check of one robot",
    "languages": "what each language has, and a check of one",
    "plugins": "what other packages add, and a check of a planner, a voice or a page",
    "log": "show past runs, and replay them in the simulator",
    "world": "begin a world from a robot's map, check one, put what was drawn into its file",
    "test": "check canned utterances against what they should do",
    "lint": "look for names in a world that cannot be said or told apart",
    "models": "speech models: list, get, verify",
    "paraphrases": "measure how well commands with logical forms are understood",
    "bench": "measure how fast everything is on this machine",
    "demo": "a typed and a spoken command in the simulated hospital, with pictures",
    "completion": "completion by Tab in your shell: bash, zsh or fish",
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; returns the exit status. No traceback reaches a user unless `--debug`."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    _prepare()
    try:
        if "_ARGCOMPLETE" in os.environ:
            _complete(os.environ.get("COMP_LINE", ""))
        if not given:
            print(_start(), flush=True)
            return ExitStatus.OK
        options = _parser(given).parse_args(given)
        command = importlib.import_module(f"nl2robot.cli.commands.{options.command}")
        _tell_of_stand_in(options)
        status = int(command.run(options))
        sys.stdout.flush()
        return status
    except BrokenPipeError:  # `nl2robot log | head`
        status = ExitStatus.OK
    except (KeyboardInterrupt, Exception) as error:  # noqa: BLE001 - each becomes a sentence
        if arguments is None:
            # It ends; whoever presses Ctrl-C twice wants no more than that.
            signal.signal(signal.SIGINT, signal.SIG_IGN)
        if "--debug" in given:
            traceback.print_exc()
        failures = _failures()
        sentence, status = failures.explained(error)
        print(failures.told(sentence, given), file=sys.stderr)
        if arguments is None and status != ExitStatus.INTERRUPTED:
            signal.signal(signal.SIGINT, signal.default_int_handler)
    _let_go_of_output()
    return status


def _start() -> str:
    """What it is, and what to try first, in the language of the terminal."""
    return str(words_in(terminal_language())["start"]).format(version=__version__)


def _failures() -> ModuleType:
    """What explains errors. It knows those of every layer, and is loaded when there is one."""
    from nl2robot.cli import failures

    return failures


class _Parser(argparse.ArgumentParser):
    """Says what is wrong with a command in the language that was asked for; options may stand
    anywhere among the words."""

    given: Sequence[str] = ()
    _mixing = False

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        has_commands = any(each.nargs == argparse.PARSER for each in self._actions)
        if self._mixing or has_commands or "--" in (args or ()):
            return super().parse_known_args(args, namespace)
        self._mixing = True  # which calls this again
        try:
            return self.parse_known_intermixed_args(args, namespace)
        finally:
            self._mixing = False

    def error(self, message: str) -> NoReturn:
        failures = _failures()
        told = failures.told(message, self.given)
        if told == message:
            super().error(message)
        usage = self.format_usage().replace("usage: ", failures.told("usage: ", self.given), 1)
        self.exit(ExitStatus.BAD_INPUT, f"{usage}{self.prog}: {told}\n")


def _complete(line: str) -> None:
    """Tell a shell what the line that somebody types may become; does not return."""
    import argcomplete

    argcomplete.autocomplete(_parser(line.split()[1:]), always_complete_options=False)


def _prepare() -> None:
    """Streams that bear anything; and an end by `kill` or by closing the terminal is an end by
    Ctrl-C, so that the robot is stopped and the log is complete."""
    for name in ("stdin", "stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, Path(os.devnull).open("r+", encoding="utf-8"))  # noqa: SIM115
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    with contextlib.suppress(ValueError):  # not in the main thread, which gets the signals
        for name in ("SIGTERM", "SIGHUP"):
            if hasattr(signal, name):
                signal.signal(getattr(signal, name), signal.default_int_handler)


def _tell_of_stand_in(options: argparse.Namespace) -> None:
    """Once, to whoever speaks a language that somebody added and that has not all words."""
    language = getattr(options, "lang", None)
    told = stand_in(language) if isinstance(language, str) else None
    if told is not None:
        print(told, file=sys.stderr)


def _let_go_of_output() -> None:
    """What cannot be written any more (the reader has left, the disk is full) is not complained of
    a second time when Python ends."""
    try:
        sys.stdout.flush()
    except OSError:
        with contextlib.suppress(OSError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _parser(given: Sequence[str]) -> argparse.ArgumentParser:
    _Parser.given = given
    parser = _Parser(
        prog="nl2robot",
        description="Tell a social robot what to do in your own words.",
        epilog="nl2robot COMMAND --help says more about a command. Start with: nl2robot",
    )
    parser.add_argument("--version", action="version", version=f"nl2robot {__version__}")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    named = next((word for word in given if word in COMMANDS), None)
    for name, help_line in COMMANDS.items():
        command = commands.add_parser(
            name, help=help_line, description=f"{help_line[:1].upper()}{help_line[1:]}."
        )
        command.add_argument(
            "--debug", action="store_true", help="show the traceback when something goes wrong"
        )
        if name == named:
            importlib.import_module(f"nl2robot.cli.commands.{name}").add_arguments(command)
    return parser


def parser_of(command: str) -> argparse.ArgumentParser:
    """The parser of one command."""
    for action in _parser([command])._actions:
        if isinstance(action, argparse._SubParsersAction):
            found: argparse.ArgumentParser = action.choices[command]
            return found
    raise AssertionError("there are no commands")


if __name__ == "__main__":
    sys.exit(main())
