"""Options that several commands share, and what they stand for."""

from __future__ import annotations

import argparse
import functools
import getpass
import math
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from nl2robot.errors import UserError
from nl2robot.knowledge import DEFAULT_WORLD
from nl2robot.paths import authority_file, data_folder

if TYPE_CHECKING:
    from nl2robot.run.runlog import RunLog
    from nl2robot.speech.hear.full_duplex import FullDuplex
    from nl2robot.speech.speak.aloud import SoundFor
    from nl2robot.station.robots import Chosen
    from sim.world.model import World


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


def add_world(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--world",
        default=DEFAULT_WORLD,
        metavar="W",
        help=f"a built-in world's name or a YAML file (default: {DEFAULT_WORLD})",
    ).completer = _worlds  # type: ignore[attr-defined]


def _worlds(prefix: str, **_: object) -> list[str]:
    """For the completion by Tab in a shell: the built-in worlds, and files."""
    from sim.world.builtin import builtin_worlds

    folder = prefix[: prefix.rfind("/") + 1]
    files = [
        f"{folder}{path.name}{'/' if path.is_dir() else ''}"
        for path in Path(folder or ".").glob("*")
        if path.is_dir() or path.suffix in (".yaml", ".yml")
    ]
    return [*builtin_worlds(), *files]


def add_words(parser: argparse.ArgumentParser, help: str, nargs: str | None = None) -> None:
    """A sentence to the robot."""
    parser.add_argument("words", nargs=nargs, type=words, help=help).completer = _sentences  # type: ignore[attr-defined]


def _sentences(prefix: str, parsed_args: argparse.Namespace, **_: object) -> list[str]:
    """For the completion by Tab in a shell: what can be said in the world named so far."""
    from grammar.language import load_language
    from grammar.naming import joined_up
    from grammar.samples import samples
    from nl2robot.knowledge import Knowledge
    from nl2robot.translate.completing import completions, named_here
    from nl2robot.translate.routines import open_routines

    world, language = names_of(parsed_args), parsed_args.lang
    lexicon = Knowledge(world, routines=open_routines()).lexicon(language)
    said = (each for topic in samples(lexicon, language).values() for each in topic)
    joins = functools.partial(joined_up, language=load_language(language))
    return completions(prefix, said, named_here(world, language), joins)


def add_language(parser: argparse.ArgumentParser) -> None:
    from grammar.language import languages

    parser.add_argument(
        "--lang",
        "--language",
        default="en",
        choices=languages(),
        help="the language of the words (default: en)",
    )


def add_planner(parser: argparse.ArgumentParser, default: str | None = None) -> None:
    from nl2robot.translate.planners import AUTO, names

    parser.add_argument(
        "--planner",
        default=default or AUTO,
        choices=names(),
        help="what turns words into a plan: rules, a language model, or (auto) the rules for what"
        " they know and the model for the rest (default: %(default)s)",
    )


def add_seed(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--seed", type=whole(0), default=0, help="of the simulation: the same seed, the same course"
    )


def add_address(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--robot",
        default="sim",
        metavar="ADDRESS",
        help="sim, ws://HOST:PORT (a robot server), ros2://HOST ...; `nl2robot robots` lists them"
        " (default: sim)",
    )
    add_ca(parser)
    add_robot_file(parser)


def add_ca(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--ca",
        metavar="FILE",
        help="the certificate of the authority that the server at a wss:// address is certified by",
    )


def trust(options: argparse.Namespace) -> None:
    """Trust the authority that `--ca` names, and the one that a server on this machine has made.
    Raises `InvalidCall`."""
    from robot_api.client import trust_also

    here = authority_file()
    for file in (options.ca, here if here.exists() else None):
        if file is not None:
            trust_also(file)


def robot_of(options: argparse.Namespace) -> Chosen:
    """The robot that `add_address` lets people name. What its file says of who speaks and hears is
    asked of this machine as if it were an option. Raises `UserError`, `RobotFileError`."""
    from nl2robot.station.robots import chosen

    robot = chosen(options.robot, options.robot_file)
    if robot.is_server:
        trust(options)
    else:
        if not options.speak:
            options.speak = {"server": True, "tablet": "browser"}.get(robot.read.file.speech or "")
        if not options.mic and robot.read.file.hearing == "server":
            options.mic = True
    if options.voices and not robot.simulated:
        raise UserError("Only a simulated robot has people to hear. Leave --voices out.")
    return robot


def add_robot_file(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--robot-file",
        metavar="FILE",
        help="what an engineer wrote down of the robot: limits, joints, names (docs/robots.md)",
    )


def add_asking(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--ask-always",
        action="store_true",
        default=bool(os.environ.get("NL2ROBOT_ASK_ALWAYS")),
        help="ask also before a program that only looks or tells (or set NL2ROBOT_ASK_ALWAYS=1)",
    )


def add_robot(parser: argparse.ArgumentParser) -> None:
    add_address(parser)
    parser.add_argument("--token", help="the token that the robot server printed at its start")
    parser.add_argument(
        "--speed",
        type=speed,
        metavar="X",
        help="simulated seconds a second (default: as fast as the machine allows)",
    )
    add_world(parser)
    add_seed(parser)


def add_sound(parser: argparse.ArgumentParser, *, browsers: bool = False) -> None:
    """`browsers`: the robot may also speak where its pages are open."""
    where = "on the pages that are open, or into a file" if browsers else "or into this file"
    parser.add_argument(
        "--speak",
        nargs="?",
        const=True,
        default=False,
        type=_page_or_file if browsers else _sound_file,
        metavar="browser|FILE.wav" if browsers else "FILE.wav",
        help=f"the robot speaks from here: on the loudspeaker, {where}",
    )
    parser.add_argument(
        "--voices",
        action="store_true",
        help="the simulated people answer aloud, and the robot has to hear them",
    )
    parser.add_argument(
        "--mic",
        nargs="?",
        const=True,
        default=False,
        metavar="NAME",
        help="you answer what the robot asks: at this microphone",
    )
    parser.add_argument(
        "--robot-voice",
        metavar="NAME",
        help='the robot\'s voice: "piper", "espeak", or its full name',
    )


def _page_or_file(given: str) -> str | Path:
    from nl2robot.speech.speak.aloud import IN_BROWSERS

    return given if given == IN_BROWSERS else _sound_file(given)


def _sound_file(given: str) -> Path:
    if not given.lower().endswith(".wav"):
        raise argparse.ArgumentTypeError(
            f"{given!r} is no .wav file; what the robot shall do goes before --speak"
        )
    return Path(given)


@contextmanager
def sound_of(
    options: argparse.Namespace, world: World, language: str, duplex: FullDuplex | None = None
) -> Iterator[SoundFor | None]:
    """What `add_sound` lets people ask for; None if they did not."""
    if not (options.speak or options.voices or options.mic):
        if options.robot_voice:
            raise UserError("A voice is chosen, but nothing is spoken. Add --speak.")
        yield None
        return
    from nl2robot.speech.speak.aloud import Wishes, aloud

    if options.voices and options.mic:
        raise UserError(
            "Either the simulated people answer or you do. Leave --voices or --mic out."
        )
    wishes = Wishes(
        options.speak, options.voices, options.robot_voice, language, options.mic, options.seed
    )
    with aloud(wishes, world, duplex=duplex) as sound:
        yield sound


def names_of(options: argparse.Namespace) -> World:
    """The world as far as translating needs it: what goes by a name."""
    from nl2robot.station.named_places import with_named_places
    from sim.world.loading import load_world

    return with_named_places(load_world(options.world, names_only=True))


def world_of(options: argparse.Namespace) -> World:
    """The world, with the places that were named on its map."""
    from nl2robot.station.named_places import with_named_places
    from sim.world.loading import load_world

    return with_named_places(load_world(options.world))


def open_log(debug: bool = False) -> RunLog:
    """The run log in the user's data folder. What the server has to say about faults goes to a file
    beside it, with `debug` to standard error."""
    import logging
    from logging.handlers import RotatingFileHandler

    from nl2robot.run.runlog import RunLog

    logging.raiseExceptions = debug  # a full disk is told of elsewhere
    if not debug:
        faults = RotatingFileHandler(
            data_folder() / "faults.log", maxBytes=1_000_000, backupCount=2, delay=True
        )
        for name in ("robot_api", "nl2robot"):
            logger = logging.getLogger(name)
            logger.handlers = [faults]
            logger.propagate = False
    return RunLog(data_folder() / "runs.sqlite")


def user_name() -> str:
    """Who approves, for the log: $NL2ROBOT_USER, else the login name."""
    if name := os.environ.get("NL2ROBOT_USER"):
        return name
    try:
        return getpass.getuser()
    except (KeyError, OSError):  # no login name in a bare container
        return "unknown"


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
