"""Who may talk to a robot's server: decided from the headers of a request alone.

A robot moves, so a server answers this machine only, unless it was started for another host: then
every request must bring a token, or the cookie of somebody who signed in. And no web page may drive
a robot behind its reader's back: a browser says in `Origin` which page a request comes from, and it
must be the server's own. A page whose name was made to point to this machine (DNS rebinding) gives
itself away by `Host`.

There are two tokens: the operator's, and the observer's, whose link shows everything and moves
nothing. A browser brings its token in the link once and in a cookie from then on. Whoever shows a
token that is wrong, or does not hold any more, is refused, also where nobody need show one: they
may be less than who is sitting at this machine.
"""

from __future__ import annotations

import hmac
import ipaddress
import secrets
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Final
from urllib.parse import urlsplit

from robot_api.serving.roles import Role

LONGEST_SECRET: Final = 200
"""Characters; what is longer is looked at by nobody."""


@dataclass(frozen=True)
class Guest:
    """Somebody who was let in."""

    role: Role
    name: str | None = None
    """Who they are, if they signed in: a person, or a tablet that was paired."""
    session: int | None = None
    """The number of what they came in by, if it can be withdrawn."""
    own: bool = False
    """Whether it is the server's own program, and nobody from outside."""


@dataclass(frozen=True)
class Refusal:
    """Why a request is not answered."""

    status: int
    """The HTTP status: 401 without the right token, 403 for a page from elsewhere."""
    sentence: str
    outdated: bool = False
    """Whether a token was shown, and is wrong or does not hold any more."""
    guest: Guest | None = None
    """Who may come in, but not see this."""


def new_token() -> str:
    """A token that cannot be guessed, and that no command line takes for an option."""
    return secrets.token_hex(16)


def is_loopback(host: str) -> bool:
    """Whether a host name or address means this machine only."""
    try:
        address = ipaddress.ip_address(host.strip("[]"))
    except ValueError:
        return host.lower() in ("localhost", "localhost.")
    mapped = getattr(address, "ipv4_mapped", None)  # how IPv4 looks at a socket of IPv6
    return (mapped or address).is_loopback


def _nobody(secret: str) -> None:
    return None


@dataclass(frozen=True)
class Tokens:
    """What a server's guests show. Without an operator's token, nobody need show one."""

    operator: str | None
    observer: str
    cookie: str
    """The name of the cookie in which a browser keeps its token."""
    own: str = ""
    """What the server's own program shows."""
    known: Callable[[str], Guest | None] = field(default=_nobody)
    """Who else shows a secret of their own, such as who has signed in."""


def admitted(
    headers: Mapping[str, str], query: Mapping[str, str], *, local: bool, tokens: Tokens
) -> Guest | Refusal:
    """As whom a request is welcome, or why it is refused.

    `headers` has lower-case names; `local` says that the server listens on a loopback address.
    """
    host = headers.get("host", "")
    if local and not is_loopback(_host_name(host)):
        return Refusal(403, f"This server answers this machine only, not {host[:100]!r}.")
    origin = headers.get("origin")
    if origin is not None and _address(origin) != _address(f"//{host}"):
        return Refusal(403, "Pages of other web sites may not talk to the robot.")
    given = _token_given(headers, query, tokens.cookie)
    if not given and tokens.operator is None:
        return Guest("administrator")  # who sits at this machine
    if given and _same(given, tokens.own):
        return Guest("operator", own=True)
    if _same(given, tokens.observer):
        return Guest("observer")
    if tokens.operator is not None and _same(given, tokens.operator):
        return Guest("operator")
    return tokens.known(given) or Refusal(
        401, "The robot's token is missing or wrong. Ask whoever started the server.", bool(given)
    )


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
    scheme, _, bearer = headers.get("authorization", "").partition(" ")
    if scheme.lower() == "bearer":
        given = bearer.strip()
    elif "token" in query:
        given = query["token"]
    else:
        given = _kept(headers.get("cookie", ""), cookie)
    return given if len(given) <= LONGEST_SECRET else given[:LONGEST_SECRET]


def _kept(cookies: str, name: str) -> str:
    """The cookie of this name. Not by `http.cookies`: that takes quadratic time for some headers,
    and this is done for everybody who sends one."""
    for cookie in cookies.split(";"):
        key, _, value = cookie.partition("=")
        if key.strip() == name:
            return value.strip().strip('"')
    return ""


def _same(given: str, token: str) -> bool:
    """Compared in a time that does not tell how much of it was right."""
    return hmac.compare_digest(given.encode(errors="replace"), token.encode())
