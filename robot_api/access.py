"""Who may talk to a robot's server: decided from the headers of a request alone.

A robot moves, so a server answers this machine only, unless it was started for another host: then
every request must bring the server's token. And no web page may drive a robot behind its reader's
back: a browser says in `Origin` which page a request comes from, and it must be the server's own.
A page whose name was made to point to this machine (DNS rebinding) gives itself away by `Host`.

There are two tokens: the operator's, and the observer's, whose link shows everything and moves
nothing. A browser brings its token in the link once and in a cookie from then on.
"""

from __future__ import annotations

import hmac
import ipaddress
import secrets
from collections.abc import Mapping
from dataclasses import dataclass
from http.cookies import CookieError, SimpleCookie
from typing import Literal
from urllib.parse import urlsplit

Role = Literal["operator", "observer"]
"""What somebody may do: everything, or look on and stop the robot."""


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


@dataclass(frozen=True)
class Tokens:
    """What a server's guests show. Without an operator's token, nobody need show one."""

    operator: str | None
    observer: str
    cookie: str
    """The name of the cookie in which a browser keeps its token."""


def admitted(
    headers: Mapping[str, str], query: Mapping[str, str], *, local: bool, tokens: Tokens
) -> Role | Refusal:
    """As what a request is welcome, or why it is refused.

    `headers` has lower-case names; `local` says that the server listens on a loopback address.
    """
    host = headers.get("host", "")
    if local and not is_loopback(_host_name(host)):
        return Refusal(403, f"This server answers this machine only, not {host[:100]!r}.")
    origin = headers.get("origin")
    if origin is not None and _address(origin) != _address(f"//{host}"):
        return Refusal(403, "Pages of other web sites may not talk to the robot.")
    given = _token_given(headers, query, tokens.cookie)
    if _same(given, tokens.observer):
        return "observer"
    if tokens.operator is not None and not _same(given, tokens.operator):
        return Refusal(
            401, "The robot's token is missing or wrong. Ask whoever started the server."
        )
    return "operator"


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


def _token_given(headers: Mapping[str, str], query: Mapping[str, str], cookie: str) -> str:
    scheme, _, given = headers.get("authorization", "").partition(" ")
    if scheme.lower() == "bearer":
        return given.strip()
    return query["token"] if "token" in query else _kept(headers.get("cookie", ""), cookie)


def _kept(cookies: str, name: str) -> str:
    try:
        kept = SimpleCookie(cookies).get(name)
    except CookieError:
        return ""
    return kept.value if kept else ""


def _same(given: str, token: str) -> bool:
    """Compared in a time that does not tell how much of it was right."""
    return hmac.compare_digest(given.encode(errors="replace"), token.encode())
