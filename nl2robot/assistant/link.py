"""An assistant's connection to a robot's server: it asks what an assistant may, and no more.

On the robot's own computer nobody has to show anything, and would be an administrator. An assistant
is not to be one, so it comes in there as what it is, by a link of its own
(`nl2robot.station.accounts`), which can be withdrawn.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final, TypeVar

import msgspec

from nl2robot.errors import UserError
from nl2robot.paths import data_folder
from nl2robot.station.accounts import NOTICED_AFTER, Accounts
from nl2robot.station.clients import client_of
from robot_api.client import Robot
from robot_api.driver import Capabilities
from robot_api.errors import AccessDenied
from robot_api.serving.access import is_loopback
from robot_api.serving.roles import RIGHTS

T = TypeVar("T")

ROLE: Final = "assistant"
MAY: Final = frozenset(
    {
        *("robot.capabilities", "robot.stop", "station.state", "places.list", "schedule.list"),
        *("program.translate", "program.check", "program.wait", "program.answer"),
        *("proposal.make", "proposal.show", "proposal.wait", "proposal.withdraw"),
    }
)
"""All that is ever asked of the server, whatever it would allow."""


def connected(address: str, token: str | None) -> Link:
    """Raises `UserError`, `RobotError`."""
    if token is None and is_loopback(_host(address)):
        token = _own_token()
        # A server that has never seen it learns of it within half a second.
        for _ in range(4):
            with contextlib.suppress(AccessDenied):
                return Link(Robot(address, token=token))
            time.sleep(NOTICED_AFTER)
        raise UserError(
            f"The server at {address} keeps its accounts elsewhere than this user does. Make a"
            " token there, `nl2robot accounts token NAME`, and give it with --token."
        )
    return Link(client_of(address, token))


class Link:
    """To one server. Any thread may use it; a lost connection is made again by the next call."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot

    def ask(self, method: str, kind: type[T], parameters: Mapping[str, Any] | None = None) -> T:
        """Raises `RobotError`."""
        assert method in MAY
        return msgspec.convert(self._robot.request(method, dict(parameters or {})), kind)

    def capabilities(self) -> Capabilities:
        return self._robot.capabilities()

    def stop(self, who: str) -> None:
        """Stop the robot and its program; returns when it stands. Raises `StopNotConfirmed`."""
        self._robot.request("robot.stop", {"who": who})

    def close(self) -> None:
        self._robot.close()


def _own_token() -> str:
    accounts = Accounts(_accounts())
    try:
        return accounts.link(ROLE)
    finally:
        accounts.close()


def _accounts() -> Path:
    return data_folder() / "accounts.sqlite"


def _host(address: str) -> str:
    """Without the scheme, the port and what comes after."""
    host = address.rpartition("://")[2].partition("/")[0]
    name, _, port = host.rpartition(":")
    return name if port.isdecimal() and name else host


assert "operate" not in RIGHTS[ROLE] and "drive" not in RIGHTS[ROLE]
