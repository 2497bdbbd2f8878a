"""What stands before a server's pages and its wire: it lets in who may, and says as whom.

Who may is decided by `robot_api.serving.access`; here it is applied to requests. `scope["state"]`
has who is let in as `guest`, and as `cookie` the name of the cookie in which a browser keeps its
secret.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable
from typing import Any, Final, Protocol
from urllib.parse import urlencode

from starlette.datastructures import MutableHeaders
from starlette.requests import HTTPConnection
from starlette.responses import PlainTextResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocket

from robot_api.serving import access, roles
from robot_api.serving.access import Guest, Refusal
from robot_api.serving.status import HEADERS

OPEN_TO_ALL: Final = "/healthz"
"""Whether the server is alive is no secret."""
WITHDRAWN: Final = 4401
"""The code with which a connection is closed whose guest is known no more."""
YEAR: Final = 365 * 24 * 3600
PAGE_HEADERS: Final = {
    # NiceGUI writes scripts and styles into its pages and compiles its templates in the browser.
    # The pages and pictures that the robot shows come from anywhere.
    "Content-Security-Policy": (
        "default-src 'self'; script-src 'self' 'unsafe-inline' 'unsafe-eval';"
        " style-src 'self' 'unsafe-inline'; img-src * data: blob:; media-src * data: blob:;"
        " font-src * data:; frame-src *; worker-src 'self' blob:; connect-src 'self' ws: wss:;"
        " object-src 'none'; base-uri 'self'; form-action 'self'; frame-ancestors 'self'"
    ),
    "Permissions-Policy": "camera=(self), microphone=(self), geolocation=()",
    "Referrer-Policy": "same-origin",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "SAMEORIGIN",
}
"""What every answer says to a browser, unless it says so itself. No other web site may show the
robot's pages within its own, where a click may mean something else than it seems to."""


class Doors(Protocol):
    """How people come in who bring no token of the server's own: accounts, and pages to sign in."""

    def known(self, secret: str) -> Guest | None:
        """Who shows this secret, if it holds. In the loop thread, so it may not wait."""

    def holds(self, guest: Guest) -> bool:
        """Whether they are still known as this. In the loop thread."""

    def is_open(self, path: str) -> bool:
        """Whether anybody may see this page."""

    def is_plain(self, path: str) -> bool:
        """Whether it may be seen without encryption, too: nothing is typed there."""

    def needs(self, path: str) -> roles.Right:
        """The right that a page needs."""

    def refused(self, request: HTTPConnection, refusal: Refusal) -> Response:
        """What is answered instead of a page. A refusal of status 426 is one of a request without
        encryption."""


class Guard:
    """An application behind a guard.

    `tokens` tells what guests must show, `local` says that the server listens on a loopback
    address, `pages` that it has pages, whose links may bring a token, `encrypted` that only this
    machine may do without encryption.
    """

    def __init__(
        self,
        app: ASGIApp,
        *,
        tokens: Callable[[], access.Tokens],
        local: bool,
        pages: bool,
        encrypted: bool = False,
        doors: Doors | None = None,
    ) -> None:
        self._app = app
        self._tokens = tokens
        self._local = local
        self._pages = pages
        self._encrypted = encrypted
        self._doors = doors
        # The connections of guests who may be known no more one day; each closes its own.
        self._open: dict[_Closable, Guest] = {}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        request = HTTPConnection(scope)
        guest = self._guest(request)
        if isinstance(guest, Refusal):
            await self._refuse(request, guest, receive, send)
            return
        scope.setdefault("state", {}).update(guest=guest, cookie=self._tokens().cookie)
        if scope["type"] == "http":
            app = self._without_token(request) or self._app
            await app(scope, receive, _with_headers(send))
        elif guest is not None and guest.session is not None:
            connection = _Closable(send)
            self._open[connection] = guest
            try:
                await self._app(scope, receive, connection.send)
            finally:
                del self._open[connection]
        else:
            await self._app(scope, receive, send)

    def check_guests(self) -> None:
        """Close the connections of those who are known no more. In the loop thread."""
        for connection, guest in tuple(self._open.items()):
            if self._doors is None or not self._doors.holds(guest):
                connection.close()

    def _guest(self, request: HTTPConnection) -> Guest | Refusal | None:
        """Who sent this; None for somebody unknown who may see it all the same."""
        path, doors = request.url.path, self._doors
        is_page = request.scope["type"] == "http"
        is_open = is_page and (path == OPEN_TO_ALL or (doors is not None and doors.is_open(path)))
        is_plain = is_page and (path == OPEN_TO_ALL or (doors is not None and doors.is_plain(path)))
        if self._encrypted and not is_plain and not _encrypted_or_here(request):
            return Refusal(426, f"This robot speaks encrypted only: use {_secure(request)}.")
        guest = access.admitted(
            request.headers, request.query_params, local=self._local, tokens=self._tokens()
        )
        if isinstance(guest, Refusal):
            return None if guest.status == 401 and is_open else guest
        if not is_page or doors is None or is_open:
            return guest
        allowed = roles.may(guest.role, doors.needs(path))
        return guest if allowed else Refusal(403, "Your role does not allow this.", guest=guest)

    async def _refuse(
        self, request: HTTPConnection, refusal: Refusal, receive: Receive, send: Send
    ) -> None:
        if request.scope["type"] == "websocket":
            response: Response = _sentence(refusal)
            socket = WebSocket(request.scope, receive, send)
            await socket.send_denial_response(response)
            return
        doors = self._doors
        response = doors.refused(request, refusal) if doors else _sentence(refusal)
        await response(request.scope, receive, _with_headers(send))

    def _without_token(self, request: HTTPConnection) -> Response | None:
        """For a page whose link brought a token: keep it in a cookie, and out of the address that
        others may see. An empty token makes an observer of this machine its operator again."""
        query = dict(request.query_params)
        if not self._pages or request.scope["method"] != "GET" or "token" not in query:
            return None
        token = query.pop("token")
        path = request.url.path + (f"?{urlencode(query)}" if query else "")
        # No second slash, lest a browser take the path for another host.
        response = RedirectResponse("/" + path.lstrip("/"), 303, HEADERS)
        keep(response, request, token)
        return response


def keep(response: Response, request: HTTPConnection, secret: str) -> None:
    """Let the browser keep what it is let in by, for a year; an empty one is forgotten."""
    response.set_cookie(
        request.scope["state"]["cookie"],
        secret,
        max_age=YEAR if secret else 0,
        httponly=True,
        samesite="strict",
        secure=request.url.scheme == "https",
    )


class _Closable:
    """The sending side of a WebSocket that can be closed from outside the application."""

    def __init__(self, send: Send) -> None:
        self._send = send
        self._closed = False
        # Kept, for a task that nobody holds may be collected before it is done.
        self._closing: Any = None

    async def send(self, message: Message) -> None:
        if not self._closed:
            await self._send(message)

    def close(self) -> None:
        """The application learns of it as of any connection that has ended."""
        if not self._closed:
            self._closed = True
            reason = "You are signed out."
            message = {"type": "websocket.close", "code": WITHDRAWN, "reason": reason}
            self._closing = asyncio.ensure_future(self._end(message))

    async def _end(self, message: Message) -> None:
        with contextlib.suppress(Exception):  # it has ended by itself meanwhile
            await self._send(message)


def _encrypted_or_here(request: HTTPConnection) -> bool:
    """Whether nobody on the way could read it."""
    if request.url.scheme in ("https", "wss"):
        return True
    client, server = request.scope.get("client"), request.scope.get("server")
    if client is None or server is None:
        return True  # no network at all
    return access.is_loopback(client[0]) or client[0] == server[0]


def _secure(request: HTTPConnection) -> str:
    scheme = "wss" if request.scope["type"] == "websocket" else "https"
    return f"{scheme}://{request.headers.get('host', '')[:100]}/"


def _sentence(refusal: Refusal) -> Response:
    # By 426 a client would understand that it may go on here; ours take 403 for a refusal.
    status = 403 if refusal.status == 426 else refusal.status
    return PlainTextResponse(refusal.sentence + "\n", status, HEADERS)


def _with_headers(send: Send) -> Send:
    async def sent(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            for name, value in PAGE_HEADERS.items():
                headers.setdefault(name, value)
        await send(message)

    return sent
