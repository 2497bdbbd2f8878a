"""An assistant's connection to a robot's server: it asks what an assistant may, and no more.

On the robot's own computer nobody has to show anything, and would be an administrator. An assistant
is not to be one, so it comes in there as what it is, by a link of its own
(`nl2robot.station.accounts`), which can be withdrawn.
"""

from __future__ import annotations

import contextlib
import threading
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
from robot_api.errors import AccessDenied, LostConnection
from robot_api.serving.access import is_loopback
from robot_api.serving.roles import RIGHTS

T = TypeVar("T")

ROLE: Final = "assistant"
MAY: Final = frozenset(
    {
        *("robot.capabilities", "robot.stop", "station.state", "places.list", "schedule.list"),
        *("program.translate", "program.check", "program.wait", "program.answer"),
        *("program.list", "proposal.list", "proposal.make", "proposal.wait", "proposal.withdraw"),
    }
)
"""All that is ever asked of the server, whatever it would allow."""


def connected(address: str, token: str | None) -> Link:
    """One that is tried at once; a server that is not there yet may come. Raises `UserError`."""
    link = Link(address, token)
    with contextlib.suppress(LostConnection):
        link.robot()
    return link


class Link:
    """To one server. Any thread may use it; a connection that is not there, or was lost, is made by
    the next call."""

    def __init__(self, address: str, token: str | None) -> None:
        self._address = address
        self._token = token
        self._here = token is None and is_loopback(_host(address))
        self._connecting = threading.Lock()
        self._robot: Robot | None = None

    def robot(self) -> Robot:
        """Raises `UserError`, `LostConnection`."""
        with self._connecting:
            if self._robot is None:
                self._robot = self._come_in()
            return self._robot

    def _come_in(self) -> Robot:
        if not self._here:
            return client_of(self._address, self._token)
        token = _own_token()
        # A server that has never seen it learns of it within half a second.
        for _ in range(4):
            with contextlib.suppress(AccessDenied):
                return Robot(self._address, token=token)
            time.sleep(NOTICED_AFTER)
        raise UserError(
            f"The server at {self._address} keeps its accounts elsewhere than this user does, or"
            " was started with a token. Make one for the assistant where it runs, `nl2robot"
            " accounts token NAME`, and give it with --token."
        )

    def ask(self, method: str, kind: type[T], parameters: Mapping[str, Any] | None = None) -> T:
        """Raises `RobotError`."""
        assert method in MAY
        return msgspec.convert(self.robot().request(method, dict(parameters or {})), kind)

    def capabilities(self) -> Capabilities:
        return self.robot().capabilities()

    def stop(self, who: str) -> None:
        """Stop the robot and its program; returns when it stands. Raises `StopNotConfirmed`."""
        self.robot().request("robot.stop", {"who": who})

    def close(self) -> None:
        if self._robot is not None:
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
