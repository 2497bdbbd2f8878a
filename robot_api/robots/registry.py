"""The kinds of robots that there are drivers for: ours, and those of other packages.

A package adds one by an entry point of the group `nl2robot.robots` that names a `RobotKind`:

    [project.entry-points."nl2robot.robots"]
    dog = "robot_dog.driver:DOG"
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from importlib.util import find_spec
from typing import Any, Final

import msgspec

from robot_api.capabilities.names import nearest
from robot_api.capabilities.sound import SILENT, Sound
from robot_api.driver import Driver
from robot_api.plugins import ROBOTS, Plugin, PluginError, plugins
from robot_api.robots.address import Address, BadAddress
from robot_api.robots.places import Places
from robot_api.robots.robot_file import RobotFile

OURS: Final = (
    "robot_api.robots.pretended:SIM",
    "robot_api.robots.pretended:EMULATOR",
    "robot_api.robots.wire:SERVER",
    "robot_api.robots.wire:SECURE_SERVER",
    "robot_api.robots.ros:ROS2",
    "robot_api.robots.ros:ROS1",
    "robot_api.robots.pepper:PEPPER",
    "robot_api.robots.furhat:FURHAT",
)
"""The kinds that come with the project. Their modules are imported when kinds are looked for; what
they need is imported when a robot is connected."""

_SCHEME: Final = re.compile(r"[a-z][a-z0-9+.-]*")


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


@dataclass(frozen=True)
class Brake:
    """Stops a robot from beside its driver, over a connection of its own."""

    halt: Callable[[], None]
    """Returns when the robot has confirmed that it stands. Raises `StopNotConfirmed`."""
    close: Callable[[], None]
    """Lets go of the robot; never raises."""


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
    """Reaches the robot (`when_called`). Raises `LostConnection` (the
    robot cannot be reached), `AccessDenied` (it wants a login), `NotSupported` (it is not what its
    file says)."""
    brake: Callable[[Setup], Brake] | None = None
    """Reaches the robot beside its driver, to stop it when that is killed (`guardian`). Raises
    `RobotError`. None for a robot that stands by itself when nobody drives it any more."""
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
    shared: bool = False
    """Whether several may drive it at the same time: it sees to that itself."""

    def missing(self) -> tuple[str, ...]:
        """The libraries that it needs and that are not installed."""
        return tuple(module for module in self.modules if not _is_installed(module))

    def how_to_install(self) -> str:
        """A sentence on what is missing; empty if nothing is."""
        missing = self.missing()
        if not missing:
            return ""
        several = len(missing) > 1
        need = f"{' and '.join(missing)}, which {'are' if several else 'is'} not installed"
        how = (
            f"Install it: pip install 'nl2robot[{self.extra}]'"
            if self.extra
            else "Its package's documentation says how to install it"
        )
        return f"{self.title} needs {need}. {how}."


def when_called(name: str, *more: Any) -> Callable[[Setup], Any]:
    """The function "module:name", for `connect` and `brake`; `more` is what it takes besides the
    setup. Its module is imported when it is called, for what speaks with a robot needs libraries
    that who has another robot has not."""
    module, _, function = name.partition(":")
    return lambda setup: getattr(import_module(module), function)(setup, *more)


@dataclass(frozen=True)
class Known:
    """What there is: kinds by scheme, and what was wrong with others."""

    kinds: Mapping[str, RobotKind]
    troubles: Mapping[str, str]
    """By name of an entry point, a sentence each: packages whose driver cannot be used."""


def known() -> Known:
    """All kinds of robots that there are drivers for, ours first. A driver that cannot be loaded
    is a sentence in `troubles`, and stands in nobody's way."""
    kinds: dict[str, RobotKind] = {kind.scheme: kind for kind in _ours()}
    troubles: dict[str, str] = {}
    for name, plugin in plugins(ROBOTS).items():
        try:
            kind = _loaded(plugin, kinds)
            kinds[kind.scheme] = kind
        except PluginError as error:
            troubles[name] = str(error)
    return Known(kinds, troubles)


def kind_of(address: Address) -> RobotKind:
    """The kind of the robot at an address. Raises `BadAddress` if there is no such kind."""
    there = known()
    kind = there.kinds.get(address.scheme)
    if kind is not None:
        return kind
    if address.scheme in there.troubles:
        raise BadAddress(there.troubles[address.scheme])
    near = nearest(address.scheme, there.kinds)
    hint = f"Did you mean {near}?" if near else f"There is {', '.join(there.kinds)}."
    raise BadAddress(
        f"There is no kind of robot called {address.scheme!r}. {hint}"
        " `nl2robot robots` lists what each needs."
    )


def _ours() -> Iterator[RobotKind]:
    for name in OURS:
        module, _, attribute = name.partition(":")
        try:
            yield getattr(import_module(module), attribute)
        except ModuleNotFoundError as error:
            if error.name != module:  # left out of this installation
                raise


def _loaded(plugin: Plugin, kinds: Mapping[str, RobotKind]) -> RobotKind:
    """The kind that a package adds to these. Raises `PluginError`."""
    kind = plugin.load()
    if not isinstance(kind, RobotKind):
        raise plugin.unusable(f"is no RobotKind: {plugin.value} is something else.")
    if not _SCHEME.fullmatch(kind.scheme):
        raise plugin.unusable(f"has the scheme {kind.scheme!r}, which no address can begin with.")
    if kind.scheme in kinds:
        raise plugin.unusable(f"is left out: {kind.scheme}:// belongs to another driver.")
    return kind


def _is_installed(module: str) -> bool:
    try:
        return find_spec(module) is not None
    except (ImportError, ValueError):  # of "a.b" the "a" is missing
        return False
