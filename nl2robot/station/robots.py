"""The robot that somebody names by its address, from the options of a command to its driver."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import IO, TYPE_CHECKING

from nl2robot.errors import ExitStatus, UserError
from nl2robot.paths import data_file, data_folder, made
from nl2robot.speech.speak.text_normalisation import as_spoken
from nl2robot.station.drawn_zones import DrawnZones
from robot_api.capabilities.driving import Goal
from robot_api.capabilities.sound import SILENT, Ears, Microphone, Sound
from robot_api.driver import Driver
from robot_api.errors import LostConnection, RobotError
from robot_api.robots.address import Address, BadAddress, parse
from robot_api.robots.guardian import Guardian, Order
from robot_api.robots.opening import open_robot
from robot_api.robots.places import NamedPlace, Places
from robot_api.robots.reading import Read, read_robot_file, without_file
from robot_api.robots.registry import RobotKind, Setup, kind_of

if TYPE_CHECKING:
    from sim.world.model import World, Zone

SIMULATED = "sim"
SERVERS = ("ws", "wss")
PASSWORD = "NL2ROBOT_ROBOT_PASSWORD"
"""The environment variable with what a robot's login asks for."""


@dataclass(frozen=True)
class Chosen:
    """The robot that was chosen, and what its file says."""

    address: Address
    kind: RobotKind
    read: Read
    has_file: bool = False

    @property
    def simulated(self) -> bool:
        return self.kind.scheme == SIMULATED

    @property
    def is_server(self) -> bool:
        """Whether there is a server of ours at the address."""
        return self.kind.scheme in SERVERS

    @property
    def server(self) -> str:
        """The address of such a server, as a client takes it."""
        return str(self.address).removeprefix("ws://")


def chosen(address: str, robot_file: str | None = None) -> Chosen:
    """What `--robot` and `--robot-file` name. Raises `UserError` and `RobotFileError`."""
    try:
        where = parse(address)
        kind = kind_of(where)
    except BadAddress as error:
        raise UserError(str(error)) from error
    if "://" in kind.example and not where.host:
        raise UserError(f"Where is the robot? Write its address as {kind.example}.")
    if robot_file is None:
        return Chosen(where, kind, without_file(kind))
    return Chosen(where, kind, read_robot_file(Path(robot_file), kind), has_file=True)


@contextmanager
def reached(
    robot: Chosen,
    world: World,
    sound: Sound = SILENT,
    password: str | None = None,
    places: Places | None = None,
) -> Iterator[Driver]:
    """The driver of a robot, let go of in the end; sent by `places`, else by those of the world.
    Raises `UserError`, `LostConnection`."""
    with alone(robot):
        with trouble_reaching():
            driver = opener(robot, world, sound, password, places)(robot.address)
        with guarded(robot, password), closing(driver):
            yield driver


def opener(
    robot: Chosen,
    world: World,
    sound: Sound = SILENT,
    password: str | None = None,
    places: Places | None = None,
) -> Callable[[Address], Driver]:
    """Makes a driver for the robot, wherever it is reached. Raises `RobotError`."""
    known = places or places_of(world, zones_of(world))
    own = _of_its_own(sound, world)

    def open_at(address: Address) -> Driver:
        return open_robot(
            address,
            robot.kind,
            read=robot.read,
            places=known,
            sound=own,
            password=password or os.environ.get(PASSWORD),
        )

    return open_at


@contextmanager
def guarded(robot: Chosen, password: str | None = None) -> Iterator[None]:
    """Meanwhile a process of its own stops the robot if this one is killed."""
    if robot.kind.brake is None:
        yield
        return
    guardian = Guardian(order_of(robot, password))
    try:
        yield
    finally:
        guardian.close()


def order_of(robot: Chosen, password: str | None = None, places: Places | None = None) -> Order:
    """The robot, for another process."""
    return Order.of(
        Setup(
            address=robot.address,
            file=robot.read.file,
            places=places or Places(),
            settings=robot.read.settings,
            password=password or os.environ.get(PASSWORD),
        )
    )


@contextmanager
def trouble_reaching() -> Iterator[None]:
    """What a robot says that does not let itself be driven is for the user. Raises `UserError`."""
    try:
        yield
    except LostConnection:
        raise
    except RobotError as error:
        raise UserError(str(error), ExitStatus.NO_ROBOT) from error


def _of_its_own(sound: Sound, world: World) -> Sound:
    """What a robot's own microphone hears is recognised here, and what its own voice speaks is made
    ready to be spoken."""

    def ears_at(microphone: Microphone) -> Ears:
        from nl2robot.speech.speak.aloud import ears_at

        return ears_at(world)(microphone)

    return replace(sound, ears_at=ears_at, spoken=as_spoken)


def zones_of(world: World) -> tuple[Zone, ...]:
    """The keep-out zones of the world's file, and those that were drawn on its map."""
    return (*world.zones, *DrawnZones(data_file("zones.yaml")).of(world))


def places_of(world: World, zones: tuple[Zone, ...]) -> Places:
    """What a robot that drives by a map of its own is told of the house."""
    named = {}
    for place in world.places:
        pose = place.pose
        named[place.name] = NamedPlace(
            name=place.name,
            kind=place.kind,
            goal=Goal(pose.x, pose.y, pose.theta, place.name) if pose is not None else None,
            aliases=tuple(alias for aliases in place.aliases.values() for alias in aliases),
        )
    return Places(named=named, keep_out=[zone.polygon for zone in zones])


@contextmanager
def alone(robot: Chosen) -> Iterator[None]:
    """No other server of this machine drives the robot meanwhile. Raises `UserError`."""
    if robot.kind.shared:
        yield
        return
    folder = made(data_folder() / "robots")
    name = "".join(c if c.isalnum() or c in ".-" else "_" for c in _machine(robot))
    with (folder / f"{name}.lock").open("a") as file:
        if not _locked(file):
            raise UserError(
                f"The robot at {robot.address} is already being driven from this machine. End the"
                " other server first, or talk to the robot through it: --robot ws://HOST:PORT.",
                ExitStatus.NO_ROBOT,
            )
        yield


def _machine(robot: Chosen) -> str:
    port = robot.address.port or robot.kind.port or ""
    return f"{robot.kind.scheme} {robot.address.host.lower()} {port}"


def _locked(file: IO[str]) -> bool:
    with suppress(ImportError):  # a system without such locks
        import fcntl

        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return False
    return True
