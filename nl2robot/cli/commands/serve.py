"""`nl2robot serve`: the robot server and its web console, with a simulated hospital by default."""

from __future__ import annotations

import argparse
import logging
import sys
import time
import webbrowser
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Final

from nl2robot.building.broker import parse_broker
from nl2robot.cli.options.robot import add_address, robot_of
from nl2robot.cli.options.sound import add_sound, sound_of
from nl2robot.cli.options.values import add_clock, add_seed, speed, whole
from nl2robot.cli.options.world import add_world, world_of
from nl2robot.cli.run_log import open_log
from nl2robot.console.app import Console
from nl2robot.errors import ExitStatus, UserError
from nl2robot.fleet.address import FleetAddress, parse_fleet
from nl2robot.paths import authority_file, data_folder, pictures_folder
from nl2robot.review.review import get_ready
from nl2robot.run.retention import DAY, kept_for
from nl2robot.schedule.clerk import Settings
from nl2robot.schedule.quiet import quiet_hours
from nl2robot.schedule.service import Timing
from nl2robot.station.accounts import Accounts
from nl2robot.station.entrance import PAGES_AT, Entrance
from nl2robot.station.garbage import swept
from nl2robot.station.local_clock import beginning_of
from nl2robot.station.machine import allow_open_files, outdated_python
from nl2robot.station.robots import places_of, reached, zones_of
from nl2robot.station.station import robot_station, simulated_station
from nl2robot.translate import planners
from robot_api.capabilities.sound import SILENT
from robot_api.local_time import local_zone
from robot_api.server import Server
from robot_api.serving.access import LONGEST_SECRET, is_loopback

if TYPE_CHECKING:
    from nl2robot.station.certificates import Certificate

FIRST_ACCOUNT_WITHIN: Final = DAY
"""Seconds in which the first administrator's link is to be opened; the next start gives another."""
LOG_DAYS: Final = 90
"""That a run is kept, unless the hospital says otherwise."""
SWITCHES_WITHIN: Final = 0.001
"""Seconds that a thread which computes (a dry run) keeps others waiting: a stop takes several."""
SHORTEST_TOKEN: Final = 16
"""Letters and digits that nobody guesses."""


def _token(given: str) -> str:
    long = SHORTEST_TOKEN <= len(given) <= LONGEST_SECRET
    if not (long and given.isascii() and given.isprintable() and " " not in given):
        raise argparse.ArgumentTypeError(
            f"the token is to be {SHORTEST_TOKEN} letters and digits or more, which nobody guesses;"
            " leave it out to be given one"
        )
    return given


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--host",
        default="127.0.0.1",
        metavar="H",
        help="the address to listen at; 0.0.0.0 for everybody, encrypted, who signs in",
    )
    parser.add_argument("--port", type=whole(0, 65_535), default=9090, help="(default: 9090)")
    parser.add_argument(
        "--log-days",
        type=whole(1),
        default=LOG_DAYS,
        metavar="N",
        help=f"after how many days what is known of a run is deleted (default: {LOG_DAYS})",
    )
    parser.add_argument(
        "--mqtt",
        metavar="ADDRESS",
        help="the house's broker, mqtt://HOST:PORT/PREFIX: it hears of the robot, and may stop it",
    )
    parser.add_argument(
        "--quiet-hours",
        metavar="HOURS",
        help="in which no appointment begins, such as 22:00-06:00",
    )
    parser.add_argument(
        "--token",
        type=_token,
        help=f"what programs may show instead of signing in: {SHORTEST_TOKEN} letters or more",
    )
    encryption = parser.add_argument_group("encryption, where others are served")
    encryption.add_argument(
        "--certificate",
        metavar="FILE",
        help="a certificate of your own with its chain (PEM); default: one of a local authority",
    )
    encryption.add_argument("--key", metavar="FILE", help="its key (PEM, without a password)")
    encryption.add_argument(
        "--name",
        action="append",
        default=[],
        metavar="NAME",
        help="a name or address by which others reach this server, if this machine does not know it"
        " itself (more than once: several)",
    )
    encryption.add_argument(
        "--plain-http",
        action="store_true",
        help="none, because a proxy before this server encrypts",
    )
    fleet = parser.add_argument_group("a fleet, by `nl2robot fleet key` (docs/fleet.md)")
    fleet.add_argument(
        "--fleet",
        metavar="NAME[@ENDPOINT]",
        help="what this robot is called in its fleet, and where it meets the others: tcp/HOST:PORT"
        " (several with commas between)",
    )
    fleet.add_argument(
        "--fleet-listen",
        action="append",
        default=[],
        metavar="ENDPOINT",
        help="where others meet it: tcp/HOST:PORT (more than once: several; default: nowhere)",
    )
    fleet.add_argument(
        "--fleet-find", action="store_true", help="look for the others in this network (multicast)"
    )
    fleet.add_argument(
        "--fleet-config", metavar="FILE", help="Zenoh's own configuration, such as for TLS"
    )
    parser.add_argument("--open", action="store_true", help="open the console in a browser here")
    parser.add_argument(
        "--speed", type=speed, default=1.0, metavar="X", help="simulated seconds a second"
    )
    add_address(parser)
    add_world(parser)
    add_seed(parser)
    add_clock(parser, "the real time")
    add_sound(parser, browsers=True)


def run(options: argparse.Namespace) -> int:
    sys.setswitchinterval(SWITCHES_WITHIN)
    allow_open_files()
    robot = robot_of(options)
    timing = Timing(settings=_settings(options))
    broker = parse_broker(options.mqtt) if options.mqtt else None
    fleet = _fleet(options)
    world, log = world_of(options), open_log(options.debug)
    with ExitStack() as stack:
        stack.enter_context(kept_for(log, options.log_days * DAY))
        stack.enter_context(_told_here("nl2robot.building"))
        stack.enter_context(_told_here("nl2robot.fleet"))
        entrance = stack.enter_context(_entrance(options))
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
                entrance=entrance,
                pictures=pictures_folder(),
                sound=sound,
                console=Console,
                read=robot.read,
                start=beginning_of(world, options.clock),
                timing=timing,
                broker=broker,
                fleet=fleet,
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
                entrance=entrance,
                console=Console,
                timing=timing,
                broker=broker,
                fleet=fleet,
            )
            _, server = stack.enter_context(station)
        planners.get_ready()
        get_ready(world)
        stack.enter_context(swept(lambda: server.dispatcher.moves))
        server.serve_forever(lambda server: _say_where(server, entrance, options))
    return ExitStatus.OK


@contextmanager
def _told_here(part: str) -> Iterator[None]:
    """Warnings of a part of nl2robot are also told at this terminal: that the broker refuses the
    password is found out when nobody looks at a page yet."""
    logger, here = logging.getLogger(part), logging.StreamHandler()
    logger.addHandler(here)
    try:
        yield
    finally:
        logger.removeHandler(here)


def _fleet(options: argparse.Namespace) -> FleetAddress | None:
    """Where the robot meets its fleet, if it has one. Raises `UserError`."""
    if options.fleet is None:
        if options.fleet_listen or options.fleet_find or options.fleet_config:
            raise UserError("A robot of a fleet has a name there: add --fleet NAME.")
        return None
    return parse_fleet(
        options.fleet, tuple(options.fleet_listen), options.fleet_find, options.fleet_config
    )


def _settings(options: argparse.Namespace) -> Settings:
    """Of the appointments that are done here. Raises `UserError`."""
    quiet = quiet_hours(options.quiet_hours, local_zone()) if options.quiet_hours else None
    return Settings(quiet=quiet, kept=options.log_days * DAY)


@contextmanager
def _entrance(options: argparse.Namespace) -> Iterator[Entrance]:
    """Who may come in, and how it is encrypted. Raises `UserError`."""
    if bool(options.certificate) != bool(options.key):
        raise UserError("A certificate and its key belong together: give --certificate and --key.")
    accounts = Accounts(data_folder() / "accounts.sqlite")
    with closing(accounts), ExitStack() as stack:
        certificate = _certificate(options)
        if certificate is not None:
            from nl2robot.station.certificates import looked_after

            warn = logging.getLogger(__name__).warning
            stack.enter_context(looked_after(certificate, lambda sentence: warn("%s", sentence)))
        accounts.watch()
        yield Entrance(accounts, certificate, options.host, tuple(options.name))


def _certificate(options: argparse.Namespace) -> Certificate | None:
    """None for this machine alone, which nobody can listen in on, unless one was given."""
    if options.plain_http or (is_loopback(options.host) and not options.certificate):
        return None
    from nl2robot.station.certificates import LocalCertificate, given

    if options.certificate:
        return given(Path(options.certificate), Path(options.key))
    return LocalCertificate(authority_file().parent, more=options.name)


def _say_where(server: Server, entrance: Entrance, options: argparse.Namespace) -> None:
    port = int(server.address.rpartition(":")[2])
    accounts, page = entrance.accounts, entrance.url(port)
    accounts.note(PAGES_AT, entrance.url(port, by_address=True))
    wire = page.replace("http", "ws", 1).rstrip("/")
    print(f"The robot is at {wire} (page: {page}).")
    if not entrance.local:
        _say_who(entrance, page, options.token)
    print(f"Who only looks on opens {page}?token={accounts.link('observer')}")
    if options.open:
        _open_page(server, port)
    outdated = outdated_python()
    if outdated:
        sys.stdout.flush()  # where both go to one file, it stands there in this order
        print(outdated, file=sys.stderr)
    print("Ctrl-C stops the robot and ends the server.", flush=True)


def _say_who(entrance: Entrance, page: str, token: str | None) -> None:
    """How people, tablets and programs come in from elsewhere."""
    accounts, certificate = entrance.accounts, entrance.certificate
    if not any(each.role == "administrator" for each in accounts.accounts()):
        code = accounts.invite("administrator", "first account", None, FIRST_ACCOUNT_WITHIN)
        print(f"Its first administrator opens, within a day, {page}join/{code}")
    if certificate is not None and certificate.fingerprint:
        print(f"Devices come to trust it at {page}trust, by the fingerprint")
        print(f"  {certificate.fingerprint}")
    print("A tablet is paired with: nl2robot accounts pair face")
    token = token or accounts.link("operator")
    print(f"Programs must show this token: {token}")
    print(f"Operators open {page}?token={token}")


def _open_page(server: Server, port: int) -> None:
    # From here, so without encryption.
    page = f"http://127.0.0.1:{port}/" + (f"?token={server.token}" if server.token else "")
    if not webbrowser.open(page):
        print("There is no browser to open here. Open the page by its address.", flush=True)
