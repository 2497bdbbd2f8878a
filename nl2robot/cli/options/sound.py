"""What is heard of the robot, and who it hears."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from nl2robot.errors import UserError
from nl2robot.speech.speak.wishes import IN_BROWSERS, SoundFor, Wishes
from sim.world.model import World

if TYPE_CHECKING:
    from nl2robot.speech.hear.full_duplex import FullDuplex


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
    from nl2robot.speech.speak.aloud import aloud

    if options.voices and options.mic:
        raise UserError(
            "Either the simulated people answer or you do. Leave --voices or --mic out."
        )
    wishes = Wishes(
        options.speak, options.voices, options.robot_voice, language, options.mic, options.seed
    )
    with aloud(wishes, world, duplex=duplex) as sound:
        yield sound
