"""`nl2robot serve`: the robot server and its web console, with a simulated hospital by default."""

from __future__ import annotations

import argparse
import socket
import time
import webbrowser
from contextlib import ExitStack

from nl2robot import planners
from nl2robot.commands.options import (
    add_address,
    add_seed,
    add_sound,
    add_world,
    open_log,
    robot_of,
    sound_of,
    speed,
    whole,
    world_of,
)
from nl2robot.errors import ExitStatus
from nl2robot.paths import pictures_folder
from nl2robot.robots import places_of, reached, zones_of
from nl2robot.station import robot_station, simulated_station
from robot_api.capabilities.sound import SILENT
from robot_api.server import Server


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--host",
        default="127.0.0.1",
        metavar="H",
        help="the address to listen at; another than this machine's own needs a token",
    )
    parser.add_argument("--port", type=whole(0, 65_535), default=9090, help="(default: 9090)")
    parser.add_argument("--token", help="what clients must show; made up if others are served")
    parser.add_argument("--open", action="store_true", help="open the console in a browser here")
    parser.add_argument(
        "--speed", type=speed, default=1.0, metavar="X", help="simulated seconds a second"
    )
    add_address(parser)
    add_world(parser)
    add_seed(parser)
    add_sound(parser, browsers=True)


def run(options: argparse.Namespace) -> int:
    from nl2robot.console.app import Console

    robot = robot_of(options)
    world, log = world_of(options), open_log(options.debug)
    with ExitStack() as stack:
        sound = stack.enter_context(sound_of(options, world, "en"))
        if robot.simulated:
            simulated = simulated_station(
                world,
                log,
                seed=options.seed,
                speed=options.speed,
                host=options.host,
                port=options.port,
                token=options.token,
                pictures=pictures_folder(),
                sound=sound,
                console=Console,
                read=robot.read,
            )
            server = stack.enter_context(simulated).server
        else:
            here = sound(time.monotonic) if sound else SILENT
            places = places_of(world, zones_of(world))
            driver = stack.enter_context(reached(robot, world, here, places=places))
            station = robot_station(
                driver,
                world,
                log,
                zones=lambda: zones_of(world),
                places=places,
                sound=here,
                host=options.host,
                port=options.port,
                token=options.token,
                console=Console,
            )
            _, server = stack.enter_context(station)
        planners.get_ready()
        server.serve_forever(_open_page if options.open else _say_where)
    return ExitStatus.OK


def _open_page(server: Server) -> None:
    _say_where(server)
    port = server.address.rpartition(":")[2]
    page = f"http://127.0.0.1:{port}/" + (f"?token={server.token}" if server.token else "")
    if not webbrowser.open(page):
        print("There is no browser to open here. Open the page by its address.", flush=True)


def _say_where(server: Server) -> None:
    host, _, port = server.address.rpartition(":")
    if host in ("0.0.0.0", "[::]"):  # every address of this machine, and none that clients can use
        host = socket.gethostname()
    page = f"http://{host}:{port}/"
    print(f"The robot is at ws://{host}:{port} (page: {page}).")
    if server.token:
        print(f"Clients must show this token: {server.token}")
        print(f"Operators open {page}?token={server.token}")
    print(f"Who only looks on opens {page}?token={server.observer_token}")
    print("Ctrl-C stops the robot and ends the server.", flush=True)
