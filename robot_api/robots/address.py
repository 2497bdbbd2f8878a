"""Where a robot is: `ros2://192.168.1.20:9090`, `sim`."""

from __future__ import annotations

from dataclasses import dataclass
from urllib.parse import urlsplit


class BadAddress(ValueError):
    """It is no address of a robot; the message says what to write instead."""


@dataclass(frozen=True)
class Address:
    scheme: str
    """What kind of robot, a name in the registry: "sim", "ros2", "pepper" ..."""
    host: str = ""
    port: int | None = None
    """None: the kind's usual one."""
    user: str | None = None
    """Who signs in there, where the robot asks for a login; a password stands in no address."""

    def __str__(self) -> str:
        if not self.host:
            return self.scheme
        host = f"[{self.host}]" if ":" in self.host else self.host
        user = f"{self.user}@" if self.user else ""
        port = f":{self.port}" if self.port is not None else ""
        return f"{self.scheme}://{user}{host}{port}"


def parse(text: str) -> Address:
    """Read an address. Raises `BadAddress`. `host:port` alone is a server of ours, `ws://`."""
    given = text.strip()
    if "://" not in given:
        if given and ":" not in given:
            return Address(given.lower())
        given = f"ws://{given}"
    try:
        parts = urlsplit(given)
        host, port = parts.hostname or "", parts.port
    except ValueError:
        host, port, parts = "", None, urlsplit("")
    if not host or parts.path.strip("/") or parts.query or parts.fragment:
        raise BadAddress(f"{text!r} is no address of a robot. Write it as KIND://HOST:PORT.")
    if parts.password is not None:
        raise BadAddress(
            "A password must not stand in an address, where others see it. Put it into the"
            " environment variable NL2ROBOT_ROBOT_PASSWORD."
        )
    return Address(parts.scheme.lower(), host, port, parts.username)
