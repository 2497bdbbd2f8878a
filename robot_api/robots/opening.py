"""From an address to a driver that keeps to its robot file."""

from __future__ import annotations

import logging

from robot_api import limits
from robot_api.capabilities.sound import SILENT, Sound
from robot_api.composed import ComposedDriver
from robot_api.driver import Driver
from robot_api.errors import InternalError, NotSupported, RobotError, cause
from robot_api.robots.address import Address
from robot_api.robots.places import Places
from robot_api.robots.reading import Read, without_file
from robot_api.robots.registry import RobotKind, Setup
from robot_api.robots.robot_file import RobotFile

_log = logging.getLogger("robot_api.robots")


def open_robot(
    address: Address,
    kind: RobotKind,
    *,
    read: Read | None = None,
    places: Places | None = None,
    sound: Sound = SILENT,
    password: str | None = None,
) -> Driver:
    """Reach the robot at an address. Raises `LostConnection`, `AccessDenied`, `NotSupported` (what
    it needs is not installed, or it is no such robot), `InternalError` (a fault of its driver) and
    `RobotFileError`."""
    lacking = kind.how_to_install()
    if lacking:
        raise NotSupported(lacking)
    read = read if read is not None else without_file(kind)
    setup = Setup(
        address=address,
        file=read.file,
        places=places or Places(),
        sound=sound,
        settings=read.settings,
        password=password,
    )
    try:
        driver = kind.connect(setup)
    except RobotError:
        raise
    except Exception as error:
        _log.exception("the driver for %s failed", address)
        raise InternalError(
            f"The driver for {kind.scheme}:// failed while it reached for the robot"
            f" ({type(error).__name__}: {cause(error)}). Tell whoever made it."
        ) from error
    try:
        hold(driver, read)
    except BaseException:
        driver.close()
        raise
    return driver


def hold(driver: Driver, read: Read) -> None:
    """The robot keeps to its file from now on. Raises `RobotFileError`."""
    has = driver.capabilities()
    for joint in read.file.joints:
        trouble = limits.trouble_with_joint(joint, read.file, has)
        if trouble is not None:
            raise read.error(trouble, joint)
    if isinstance(driver, ComposedDriver):
        driver.hold(read.file)
    elif read.file != RobotFile() and not limits.keeps(has, read.file):
        raise read.error(
            f"{has.name} does not keep to a robot file from here. Give the file to the server that"
            " drives it, or leave it out."
        )
