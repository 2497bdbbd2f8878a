"""`nl2robot run`: a sentence becomes a program, is shown, approved, and run."""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from nl2robot.cli.operator import Operator
from nl2robot.cli.options.robot import add_robot, robot_of
from nl2robot.cli.options.sentence import add_language, add_planner, add_words
from nl2robot.cli.options.sound import add_sound, sound_of
from nl2robot.cli.options.values import add_asking, read_program, user_name
from nl2robot.cli.options.world import world_of
from nl2robot.cli.run_log import open_log
from nl2robot.cli.session import Session
from nl2robot.cli.terminal import Terminal
from nl2robot.errors import UserError
from nl2robot.paths import pictures_folder
from nl2robot.station.garbage import swept
from nl2robot.station.local_clock import beginning_of
from nl2robot.station.pictures import check_picture
from nl2robot.station.robots import Chosen, reached, zones_of
from nl2robot.station.station import (
    Station,
    remote_station,
    robot_station,
    simulated_station,
)
from nl2robot.words import words_in
from robot_api.capabilities.sound import SILENT

if TYPE_CHECKING:
    from nl2robot.run.runlog import RunLog
    from nl2robot.speech.hear.full_duplex import FullDuplex
    from sim.world.model import World


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_words(parser, "what the robot should do", nargs="?")
    parser.add_argument("--program", metavar="FILE", help="run this program instead of words")
    add_robot(parser)
    add_sound(parser)
    parser.add_argument(
        "--picture", metavar="FILE", help="save a picture of the run (.svg, .png, .webp, .gif)"
    )
    parser.add_argument("-y", "--yes", action="store_true", help="approve without being asked")
    add_asking(parser)
    add_language(parser)
    add_planner(parser)


def run(options: argparse.Namespace) -> int:
    if (options.words is None) == (options.program is None):
        raise UserError(words_in(options.lang)["say_what"])
    program = read_program(options.program) if options.program is not None else None
    picture = Path(options.picture) if options.picture is not None else None
    robot = robot_of(options)
    if picture is not None:
        if not robot.simulated:
            raise UserError(
                "Only a robot simulated here can be drawn. Leave --picture or --robot out."
            )
        check_picture(picture)
    with open_session(options, robot, approve_all=options.yes) as (session, station):
        if program is None:
            status = session.perform(options.words)
        else:
            status = session.perform_program(program)
        if picture is not None and session.last_run is not None:
            station.picture(session.last_run, picture)
            told = session.terminal.words["picture"].format(file=picture)
            session.terminal.console.print(told, soft_wrap=True, markup=False)
        return status


@contextmanager
def open_session(
    options: argparse.Namespace,
    robot: Chosen,
    *,
    approve_all: bool = False,
    terminal: Terminal | None = None,
    duplex: FullDuplex | None = None,
) -> Iterator[tuple[Session, Station]]:
    """Open the robot that was chosen and sit down at the terminal. `duplex` is what its
    loudspeaker has in common with the terminal's microphone."""
    log = open_log(options.debug)
    world = world_of(options)
    with _station(options, robot, world, log, duplex) as station, station.connect() as client:
        yield (
            Session(
                Operator(client, user_name()),
                terminal or Terminal(language=options.lang),
                language=options.lang,
                planner=options.planner,
                approve_all=approve_all,
                world=world,
                ask_always=options.ask_always,
            ),
            station,
        )


@contextmanager
def _station(
    options: argparse.Namespace,
    robot: Chosen,
    world: World,
    log: RunLog,
    duplex: FullDuplex | None,
) -> Iterator[Station]:
    if robot.is_server:
        if options.speak or options.voices or options.mic:
            raise UserError(
                "A robot at a server is heard there."
                " Leave --robot out, or --speak, --voices and --mic."
            )
        if robot.has_file:
            raise UserError(
                "A robot file belongs to the server that drives the robot. Give it to"
                " `nl2robot serve` there, and leave it out here."
            )
        with remote_station(robot.server, world, log, token=options.token) as station:
            yield station
        return
    with ExitStack() as stack:
        sound = stack.enter_context(sound_of(options, world, options.lang, duplex))
        if robot.simulated:
            simulated = stack.enter_context(
                simulated_station(
                    world,
                    log,
                    seed=options.seed,
                    speed=options.speed,
                    pictures=pictures_folder(),
                    sound=sound,
                    read=robot.read,
                    start=beginning_of(world, options.clock) if options.clock else None,
                )
            )
            # Who is spoken to in German answers so.
            simulated.simulation.set_language(options.lang)
            stack.enter_context(swept(lambda: simulated.server.dispatcher.moves))
            yield simulated
            return
        here = sound(time.monotonic) if sound else SILENT
        driver = stack.enter_context(reached(robot, world, here))
        real = robot_station(driver, world, log, zones=lambda: zones_of(world), sound=here)
        station, server = stack.enter_context(real)
        stack.enter_context(swept(lambda: server.dispatcher.moves))
        yield station
