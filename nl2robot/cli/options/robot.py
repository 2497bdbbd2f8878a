"""Which robot it is, and how it is reached."""

from __future__ import annotations

import argparse

from nl2robot.cli.options.values import add_clock, add_seed, speed
from nl2robot.cli.options.world import add_world
from nl2robot.errors import UserError
from nl2robot.paths import authority_file
from nl2robot.station.robots import Chosen, chosen
from robot_api.client import trust_also


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
    here = authority_file()
    for file in (options.ca, here if here.exists() else None):
        if file is not None:
            trust_also(file)


def robot_of(options: argparse.Namespace) -> Chosen:
    """The robot that `add_address` lets people name. What its file says of who speaks and hears is
    asked of this machine as if it were an option. Raises `UserError`, `RobotFileError`."""
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
    add_clock(parser, "a Monday at 08:00")
