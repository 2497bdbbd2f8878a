"""What is said when a command goes wrong; the sentences of all below it, in three languages."""

from __future__ import annotations

from collections.abc import Sequence

from nl2robot import sentences
from nl2robot.errors import ExitStatus, UserError
from nl2robot.words import terminal_language
from robot_api.errors import InvalidCall, LostConnection, RobotError, StopNotConfirmed
from sim.errors import SimError
from sim.world.yaml_nodes import FileProblems


def explained(error: BaseException) -> tuple[str, ExitStatus]:
    """What an error of the layers below means to a user, and to a script."""
    match error:
        case KeyboardInterrupt():
            return "\nInterrupted.", ExitStatus.INTERRUPTED
        case UserError():
            return str(error), error.status
        case FileProblems() | SimError() | InvalidCall():
            return str(error), ExitStatus.BAD_INPUT
        case LostConnection() | StopNotConfirmed():
            return str(error), ExitStatus.NO_ROBOT
        case RobotError():
            return str(error), ExitStatus.FAILED
        case OSError(strerror=str() as reason):
            what = f"The file {error.filename}" if error.filename else "The output"
            sentence = (
                f"{what} cannot be used ({reason}). Check its place, its rights and the disk."
            )
            return sentence, ExitStatus.BAD_INPUT
    sentence = f"Something went wrong inside nl2robot ({type(error).__name__}: {error})."
    return f"{sentence} Run it again with --debug and report what it prints.", ExitStatus.INTERNAL


def told(sentence: str, given: Sequence[str]) -> str:
    """A sentence of ours in the language that was asked for with --lang, else in that of the
    terminal; in English where there is none of it."""
    language = terminal_language()
    for number, word in enumerate(given):
        name, _, value = word.partition("=")
        if name in ("--lang", "--language"):
            language = value or next(iter(given[number + 1 :]), "")
    return sentences.told(sentence, language)
