"""Who may talk to a robot's server: decided from the headers of a request alone.

A robot moves, so a server answers this machine only, unless it was started for another host: then
every request must bring the server's token. And no web page may drive a robot behind its reader's
back: a browser says in `Origin` which page a request comes from, and it must be the server's own.
A page whose name was made to point to this machine (DNS rebinding) gives itself away by `Host`.
"""

from __future__ import annotations

import hmac
import ipaddress
import secrets
from collections.abc import Mapping
from dataclasses import dataclass
from urllib.parse import urlsplit


@dataclass(frozen=True)
class Refusal:
    """Why a request is not answered."""

    status: int
    """The HTTP status: 401 without the right token, 403 for a page from elsewhere."""
    sentence: str


def new_token() -> str:
    """A token that cannot be guessed, and that no command line takes for an option."""
    return secrets.token_hex(16)


def is_loopback(host: str) -> bool:
    """Whether a host name or address means this machine only."""
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return host.lower() in ("localhost", "localhost.")


def refusal(
    headers: Mapping[str, str], query: Mapping[str, str], *, local: bool, token: str | None
) -> Refusal | None:
    """Why a request is refused, or None if it is welcome.

    `headers` has lower-case names; `local` says that the server listens on a loopback address.
    """
    host = headers.get("host", "")
    if local and not is_loopback(_host_name(host)):
        return Refusal(403, f"This server answers this machine only, not {host[:100]!r}.")
    origin = headers.get("origin")
    if origin is not None and _address(origin) != _address(f"//{host}"):
        return Refusal(403, "Pages of other web sites may not talk to the robot.")
    if token is not None and not _same(_token_given(headers, query), token):
        return Refusal(
            401, "The robot's token is missing or wrong. Ask whoever started the server."
        )
    return None


def _host_name(host: str) -> str:
    return _address(f"//{host}")[0]


def _address(url: str) -> tuple[str, int | None]:
    """The host name and the port, None for the usual one; a host that is no host matches nothing
    but itself."""
    try:
        parts = urlsplit(url)
        return parts.hostname or "", None if parts.port in (80, 443) else parts.port
    except ValueError:
        return url, -1


def _token_given(headers: Mapping[str, str], query: Mapping[str, str]) -> str:
    scheme, _, given = headers.get("authorization", "").partition(" ")
    return given.strip() if scheme.lower() == "bearer" else query.get("token", "")


def _same(given: str, token: str) -> bool:
    """Compared in a time that does not tell how much of it was right."""
    return hmac.compare_digest(given.encode(errors="replace"), token.encode())
