"""How people come to a server's pages: under which address, with which accounts, how encrypted."""

from __future__ import annotations

import contextlib
import socket
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from robot_api.serving import access

if TYPE_CHECKING:
    from nl2robot.station.accounts import Accounts
    from nl2robot.station.certificates import Certificate

PAGES_AT: Final = "pages"
"""The fact in `Accounts` that says where the pages are."""


@dataclass(frozen=True)
class Entrance:
    accounts: Accounts
    certificate: Certificate | None
    """None where nothing is encrypted here: on this machine alone, or behind a proxy."""
    host: str
    """The address that is listened at."""
    names: tuple[str, ...] = ()
    """By which others reach it, where this machine does not know that itself."""

    @property
    def local(self) -> bool:
        """Whether nobody but this machine can come in."""
        return access.is_loopback(self.host)

    def url(self, port: int, *, by_address: bool = False) -> str:
        """Where others find the pages, with a slash at its end. `by_address`: also those who know
        this machine by no name, as most tablets."""
        scheme = "https" if self.certificate else "http"
        name = own_address if by_address else socket.gethostname
        host = reachable(self.names[0] if self.names else self.host, name)
        return f"{scheme}://{host}:{port}/"


def reachable(host: str, name: Callable[[], str] = socket.gethostname) -> str:
    """The host by which clients reach what listens at this one."""
    if host in (
        "0.0.0.0",
        "::",
        "[::]",
        "",
    ):  # every address of this machine, and none of a client's
        return name()
    return f"[{host}]" if ":" in host and not host.startswith("[") else host


def own_address() -> str:
    """The address of this machine in its network; its name, if it is in none."""
    with contextlib.closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as asking:
        try:
            # Nothing is sent: only the way there is looked up, to an address that nobody has.
            asking.connect(("192.0.2.1", 9))
        except OSError:
            return socket.gethostname()
        return str(asking.getsockname()[0])
