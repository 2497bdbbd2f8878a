"""The command line: `nl2robot COMMAND`. Each command is a module of `nl2robot.commands`.

Only the module of the command that was asked for is imported, so that `translate` starts at once.
Exit statuses: `nl2robot.errors.ExitStatus`.
"""

from __future__ import annotations

import argparse
import importlib
import sys
from collections.abc import Sequence

from nl2robot import __version__
from nl2robot.errors import ExitStatus, UserError

COMMANDS = {
    "run": "translate, show, ask for approval, run",
    "translate": "turn words into a program; never moves anything",
    "chat": "the same as a conversation in the terminal",
    "listen": "turn a recording into a program, or into an answer",
    "serve": "the robot server on one port, a simulated hospital by default",
    "log": "show past runs, and replay them in the simulator",
    "test": "check canned utterances against what they should do",
    "models": "speech models: list, get, verify",
    "bench": "measure how fast everything is on this machine",
    "demo": "a typed and a spoken command in the simulated hospital, with pictures",
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; returns the exit status. No traceback reaches a user unless `--debug`."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    debug = "--debug" in given
    try:
        options = _parser(given).parse_args(given)
        command = importlib.import_module(f"nl2robot.commands.{options.command}")
        return int(command.run(options))
    except KeyboardInterrupt:
        print("\nInterrupted. The robot is standing still.", file=sys.stderr)
        return ExitStatus.INTERRUPTED
    except BrokenPipeError:  # `nl2robot log | head`
        sys.stderr.close()
        return ExitStatus.OK
    except UserError as error:
        if debug:
            raise
        print(error, file=sys.stderr)
        return error.status
    except Exception as error:
        if debug:
            raise
        return _explain(error)


def _parser(given: Sequence[str]) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="nl2robot",
        description="Tell a social robot what to do in your own words.",
        epilog="nl2robot COMMAND --help says more about a command. Start with: nl2robot demo",
    )
    parser.add_argument("--version", action="version", version=f"nl2robot {__version__}")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    named = next((word for word in given if word in COMMANDS), None)
    for name, help_line in COMMANDS.items():
        command = commands.add_parser(
            name, help=help_line, description=f"{help_line}.".capitalize()
        )
        command.add_argument(
            "--debug", action="store_true", help="show the traceback when something goes wrong"
        )
        if name == named:
            importlib.import_module(f"nl2robot.commands.{name}").add_arguments(command)
    return parser


def _explain(error: Exception) -> int:
    """Say in a sentence what an error of the layers below means to a user."""
    from robot_api.errors import LostConnection, RobotError
    from sim.world import WorldError

    if isinstance(error, WorldError):
        print(error, file=sys.stderr)
        return ExitStatus.BAD_INPUT
    if isinstance(error, LostConnection):
        print(error, file=sys.stderr)
        return ExitStatus.NO_ROBOT
    if isinstance(error, RobotError):
        print(error, file=sys.stderr)
        return ExitStatus.FAILED
    print(
        f"Something went wrong inside nl2robot ({type(error).__name__}: {error})."
        " Run the command again with --debug and report what it prints.",
        file=sys.stderr,
    )
    return ExitStatus.INTERNAL


if __name__ == "__main__":
    sys.exit(main())
