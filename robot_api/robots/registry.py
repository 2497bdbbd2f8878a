"""The kinds of robots that there are drivers for: ours, and those of other packages.

A package adds one by an entry point of the group `nl2robot.robots` that names a `RobotKind`:

    [project.entry-points."nl2robot.robots"]
    dog = "robot_dog.driver:DOG"
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import msgspec

from robot_api.capabilities.driving import Goal
from robot_api.capabilities.sound import SILENT, Sound
from robot_api.driver import Driver
from robot_api.robots.address import Address
from robot_api.robots.robot_file import RobotFile

Point = tuple[float, float]


@dataclass(frozen=True)
class NamedPlace:
    name: str
    kind: str
    goal: Goal | None = None
    """Where it is on the robot's map, in metres and degrees; None if nobody has said."""
    aliases: tuple[str, ...] = ()


@dataclass(frozen=True)
class Places:
    """What the world's file says of the house: a driver that knows its way is sent by these."""

    named: dict[str, NamedPlace] = field(default_factory=dict)
    """By name. Operators name more on the map while the robot is served, so a driver looks here at
    each call and keeps no copy."""
    keep_out: Sequence[Sequence[Point]] = ()
    """Outlines of where it must not drive, in metres on its map."""


@dataclass(frozen=True, kw_only=True)
class Setup:
    """What a driver is made from."""

    address: Address
    file: RobotFile = field(default_factory=RobotFile)
    places: Places = field(default_factory=Places)
    sound: Sound = SILENT
    """The loudspeaker and the ears of the machine that the server runs on."""
    settings: msgspec.Struct | None = None
    """The robot file's section of its wire, read as `RobotKind.settings`."""
    password: str | None = None


@dataclass(frozen=True, kw_only=True)
class RobotKind:
    """A kind of robot, and how to get a driver for one."""

    scheme: str
    """The address's beginning: "ros2"."""
    title: str
    """For people: "A robot with ROS 2 and Nav2, through rosbridge"."""
    example: str
    """An address: "ros2://HOST:9090"."""
    connect: Callable[[Setup], Driver]
    """Reaches the robot. It imports what it needs when it is called. Raises `LostConnection` (the
    robot cannot be reached), `AccessDenied` (it wants a login), `NotSupported` (it is not what its
    file says)."""
    modules: tuple[str, ...] = ()
    """Libraries that must be there."""
    extra: str | None = None
    """The extra of this project that brings them: `pip install nl2robot[ros]`."""
    port: int | None = None
    """Its usual port."""
    section: str | None = None
    """The section of a robot file that is about its wire: "ros"."""
    settings: type[msgspec.Struct] | None = None
    """What that section is read as."""
