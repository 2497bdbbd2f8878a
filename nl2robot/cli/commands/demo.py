"""`nl2robot demo`: what `make run` shows. A typed and a spoken command in the simulated hospital,
and one that a language model plans.

Asks nothing: this is the embedded simulator, and the commands are known.
"""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from nl2robot.cli.operator import Operator
from nl2robot.cli.options.values import user_name
from nl2robot.cli.run_log import open_log
from nl2robot.cli.session import Session
from nl2robot.cli.terminal import Terminal
from nl2robot.errors import ExitStatus, UserError
from nl2robot.knowledge import DEFAULT_WORLD, Knowledge
from nl2robot.models.catalogue import LARGE, get
from nl2robot.models.download import shown
from nl2robot.paths import PACKAGED
from nl2robot.run.runlog import RunLog
from nl2robot.speech.speak.voices import voices
from nl2robot.station.station import simulated_station
from nl2robot.translate.planners import CHOSEN
from nl2robot.voice.hearing import Ear
from sim.world.loading import load_world

TYPED = (
    "wait for a visitor, ask whether they want to go to radiology or to the pharmacy,"
    " take them there and come back; do that three times,"
    " then say that three visitors have been shown the way"
)
PLANNED = "Alice could do with some cheering up, so pop in and wish her a lovely day"
"""What the rules do not know."""
YES = "yes"
"""The answer, where it is asked whether that was meant."""
RECORDING = PACKAGED / "recordings" / "pharmacy.wav"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--folder", default="runs", metavar="DIR", help="where the pictures go (default: runs)"
    )


def run(options: argparse.Namespace) -> int:
    folder = Path(options.folder)
    terminal = Terminal()
    log = open_log(options.debug)
    typed = _perform(terminal, log, TYPED, None, folder / "typed")
    heard = _hear(terminal)
    spoken = _perform(terminal, log, heard, heard, folder / "spoken") if heard else ExitStatus.OK
    if _has_model(terminal):
        _perform(terminal, log, PLANNED, None, folder / "planned")
    terminal.console.print(
        '\nNow in your own words: [bold].venv/bin/nl2robot run "bring the red cup to Alice"[/]'
        "\nIn the browser:         [bold].venv/bin/nl2robot serve --open[/]"
    )
    terminal.console.print(how_to_hear())
    return typed or spoken


def how_to_hear() -> str:
    """How the robot speaks aloud, which it did not here; what it needs is installed only where
    somebody asks for it."""
    if voices("en"):
        return 'Aloud:                  [bold].venv/bin/nl2robot run "say good morning" --speak[/]'
    return (
        "Nothing was spoken aloud: no voice is installed, for they stand under the GPL."
        " Get them with: [bold]make voices[/]"
    )


def _perform(
    terminal: Terminal, log: RunLog, words: str, heard: str | None, picture: Path
) -> ExitStatus:
    terminal.console.rule(f"[bold]{'Spoken' if heard else 'Typed'}:[/] {words}")
    with simulated_station(load_world(DEFAULT_WORLD), log) as station:
        with station.connect() as robot:
            session = Session(Operator(robot, user_name()), terminal, approve_all=True)
            status = session.perform(words, heard)
            if status == ExitStatus.NOT_UNDERSTOOD and session.is_asked:
                terminal.console.print(f"> {YES}")
                status = session.perform(YES)
        if session.last_run is not None:
            for ending in (".svg", ".png", ".webp"):
                station.picture(session.last_run, picture.with_suffix(ending))
            terminal.console.print(
                f"Picture: {picture}.png (.svg; as a film {picture}.webp)", soft_wrap=True
            )
    return status


def _hear(terminal: Terminal) -> str | None:
    """What the recording says, or None (and why) where there is no speech model."""
    try:
        with shown() as progress:
            get("en", progress)
    except UserError as error:
        terminal.console.print(f"\nThe spoken command is left out. {error}", markup=False)
        return None
    ear = Ear(Knowledge(load_world(DEFAULT_WORLD)), "en")
    terminal.console.print(f"\nListening to {RECORDING.name} ...")
    return ear.hear(RECORDING).text


def _has_model(terminal: Terminal) -> bool:
    """Whether there is a language model, fetched if need be; told why where there is none."""
    chosen = os.environ.get(CHOSEN, LARGE)
    if chosen == "none":
        terminal.console.print(f"\nThe language model is left out, as {CHOSEN} says.")
        return False
    terminal.console.print(
        f"\nThe language model ({CHOSEN}=none leaves it out) plans what the rules do not know."
    )
    try:
        with shown() as progress:
            get(chosen, progress)
    except UserError as error:
        terminal.console.print(f"It is left out. {error}", markup=False)
        return False
    return True
