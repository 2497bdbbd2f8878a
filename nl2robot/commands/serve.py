"""`nl2robot serve`: the robot server, with a simulated hospital by default."""

from __future__ import annotations

import argparse

from nl2robot.commands.options import add_seed, add_world, open_log, pictures_folder, world_of
from nl2robot.errors import ExitStatus
from nl2robot.station import simulated_station
from robot_api.server import Server


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--host",
        default="127.0.0.1",
        metavar="H",
        help="the address to listen at; another than this machine's own needs a token",
    )
    parser.add_argument("--port", type=int, default=9090, help="(default: 9090)")
    parser.add_argument("--token", help="what clients must show; made up if others are served")
    parser.add_argument(
        "--speed", type=float, default=1.0, metavar="X", help="simulated seconds a second"
    )
    add_world(parser)
    add_seed(parser)


def run(options: argparse.Namespace) -> int:
    with simulated_station(
        world_of(options),
        open_log(options.debug),
        seed=options.seed,
        speed=options.speed,
        host=options.host,
        port=options.port,
        token=options.token,
        pictures=pictures_folder(),
    ) as station:
        station.server.serve_forever(_say_where)
    return ExitStatus.OK


def _say_where(server: Server) -> None:
    print(f"The robot is at ws://{server.address} (page: http://{server.address}/).")
    if server.token:
        print(f"Clients must show this token: {server.token}")
    print("Ctrl-C stops the robot and ends the server.", flush=True)
