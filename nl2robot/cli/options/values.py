"""Kinds of arguments, and options that need nothing else."""

from __future__ import annotations

import argparse
import getpass
import math
import os
from collections.abc import Callable
from pathlib import Path

from nl2robot.errors import UserError
from sim.world.starts import starting


def words(given: str) -> str:
    """An argument that is text for people: what was no UTF-8 in it becomes a replacement sign."""
    return os.fsencode(given).decode(errors="replace")


def whole(least: int, most: int = 2**63 - 1) -> Callable[[str], int]:
    """An argument that is a whole number in these bounds; `most` is what SQLite can keep."""

    def number(given: str) -> int:
        try:
            value = int(given)
        except ValueError:
            value = least - 1
        if not least <= value <= most:
            bounds = f"from {least} to {most}" if most < 2**63 - 1 else f"of {least} or more"
            raise argparse.ArgumentTypeError(f"{given!r} is not a whole number {bounds}")
        return value

    return number


def speed(given: str) -> float:
    """An argument that says how fast simulated time passes."""
    try:
        value = float(given)
    except ValueError:
        value = math.nan
    if not (math.isfinite(value) and value > 0):
        raise argparse.ArgumentTypeError(f"{given!r} is not a number above 0, such as 1 or 0.5")
    return value


def clock(given: str) -> str:
    """An argument that says when a simulation begins."""
    try:
        starting(given)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None
    return given


def add_clock(parser: argparse.ArgumentParser, otherwise: str) -> None:
    parser.add_argument(
        "--clock",
        type=clock,
        metavar="TIME",
        help="what the simulated clock shows at the beginning: 08:00, or '2026-12-24 18:00'"
        f" (default: as the world's file says, else {otherwise})",
    )


def read_program(file: str) -> str:
    """The program in a file. Raises `UserError`."""
    try:
        return Path(file).read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise UserError(f"The program {file} is no text in UTF-8. Save it as UTF-8.") from error
    except OSError as error:
        raise UserError(
            f"The program {file} cannot be read ({error.strerror}). Check its name and rights."
        ) from error


def user_name() -> str:
    """Who approves, for the log: $NL2ROBOT_USER, else the login name."""
    if name := os.environ.get("NL2ROBOT_USER"):
        return name
    try:
        return getpass.getuser()
    except (KeyError, OSError):  # no login name in a bare container
        return "unknown"


def add_seed(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--seed", type=whole(0), default=0, help="of the simulation: the same seed, the same course"
    )


def add_asking(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--ask-always",
        action="store_true",
        default=bool(os.environ.get("NL2ROBOT_ASK_ALWAYS")),
        help="ask also before a program that only looks or tells (or set NL2ROBOT_ASK_ALWAYS=1)",
    )
