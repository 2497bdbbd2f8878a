"""What stands before a server's pages and its wire: it lets in who may, and says as what.

Who may is decided by `robot_api.access`; here it is applied to requests.
"""

from __future__ import annotations

from collections.abc import Callable
from urllib.parse import urlencode

from starlette.datastructures import MutableHeaders
from starlette.requests import HTTPConnection
from starlette.responses import PlainTextResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocket

from robot_api import access
from robot_api.status import HEADERS

OPEN_TO_ALL = "/healthz"
"""Whether the server is alive is no secret."""


class Guard:
    """An application behind a guard; each scope that gets in says as what, in
    `scope["state"]["role"]`.

    `tokens` tells what guests must show, `local` says that the server listens on a loopback
    address, `pages` that it has pages, whose links may bring a token.
    """

    def __init__(
        self, app: ASGIApp, *, tokens: Callable[[], access.Tokens], local: bool, pages: bool
    ) -> None:
        self._app = app
        self._tokens = tokens
        self._local = local
        self._pages = pages

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        request = HTTPConnection(scope)
        role = self._role(request)
        if not isinstance(role, access.Refusal):
            scope.setdefault("state", {})["role"] = role
            answer = self._without_token(request) if scope["type"] == "http" else None
            await (answer or self._app)(scope, receive, _in_no_frame(send))
            return
        response = PlainTextResponse(role.sentence + "\n", role.status, HEADERS)
        if scope["type"] == "websocket":
            await WebSocket(scope, receive, send).send_denial_response(response)
        else:
            await response(scope, receive, send)

    def _role(self, request: HTTPConnection) -> access.Role | access.Refusal:
        role = access.admitted(
            request.headers, request.query_params, local=self._local, tokens=self._tokens()
        )
        nobody = isinstance(role, access.Refusal) and role.status == 401
        return "observer" if nobody and request.url.path == OPEN_TO_ALL else role

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
        response.set_cookie(self._tokens().cookie, token, httponly=True, samesite="strict")
        return response


def _in_no_frame(send: Send) -> Send:
    """No other web site shows the robot's pages within its own, where a click may mean something
    else than it seems to."""

    async def sent(message: Message) -> None:
        if message["type"] == "http.response.start":
            MutableHeaders(scope=message).setdefault("X-Frame-Options", "SAMEORIGIN")
        await send(message)

    return sent
