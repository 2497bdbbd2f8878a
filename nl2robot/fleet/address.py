"""Where a robot meets its fleet, and what it is called there.

    ward-a                                     a name; nobody is met but who finds it
    ward-a@tcp/10.0.0.5:7447                   it connects to whoever listens there
    ward-a@tcp/10.0.0.5:7447,tls/hub:7447      to several, of which some may be away

A robot opens no port unless it is told where to listen, and looks for nobody by itself unless it is
told to.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from nl2robot.errors import UserError

_ENDPOINT: Final = re.compile(r"(?:tcp|tls|quic)/(?:\[[0-9A-Fa-f:]+\]|[A-Za-z0-9._-]+):(\d{1,5})")
LONGEST_NAME: Final = 60


class BadFleet(UserError):
    """It says nowhere to meet a fleet; the message says what to write instead."""


@dataclass(frozen=True)
class FleetAddress:
    """How a robot joins."""

    name: str
    """What people of the fleet call it."""
    connects: tuple[str, ...] = ()
    """Endpoints in Zenoh's notation, `tcp/HOST:PORT`."""
    listens: tuple[str, ...] = ()
    finds: bool = False
    """Whether it looks for others by multicast."""
    config: Path | None = None
    """Zenoh's own configuration, for what is not said here: TLS, roles."""
    key: bytes | None = field(default=None, repr=False)
    """None: this machine's (`nl2robot.fleet.key`)."""


def parse_fleet(
    text: str, listens: tuple[str, ...] = (), finds: bool = False, config: str | None = None
) -> FleetAddress:
    """Read `NAME[@ENDPOINT[,ENDPOINT ...]]`. Raises `BadFleet`."""
    name, _, rest = text.partition("@")
    name = name.strip()
    if not name or len(name) > LONGEST_NAME or not name.isprintable():
        raise BadFleet(
            f"{text!r} does not say what this robot is called in its fleet."
            " Write it as NAME or NAME@tcp/HOST:PORT."
        )
    connects = tuple(each.strip() for each in rest.split(",") if each.strip())
    for each in (*connects, *listens):
        found = _ENDPOINT.fullmatch(each)
        if found is None or int(found[1]) > 65_535:
            raise BadFleet(f"{each!r} is no place to meet a fleet. Write it as tcp/HOST:PORT.")
    return FleetAddress(name, connects, listens, finds, Path(config) if config else None)
