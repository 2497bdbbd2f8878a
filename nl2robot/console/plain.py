"""Plain pages beside the console's own: at the door, and where something went wrong. They need no
connection, no script but STOP's, and nothing of NiceGUI's."""

from __future__ import annotations

import logging
from typing import Any, Final
from urllib.parse import quote

from starlette.requests import HTTPConnection
from starlette.responses import HTMLResponse, PlainTextResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from nl2robot.console.rendering import rendered
from nl2robot.console.visitor import LANGUAGES, texts, visitor_of
from robot_api.serving.guard import YEAR

HEADERS: Final = {
    "Content-Security-Policy": (
        "default-src 'self'; object-src 'none'; base-uri 'none'; form-action 'self';"
        " frame-ancestors 'none'"
    ),
    # With "no-referrer", a browser would not say either that a form came from here.
    "Referrer-Policy": "same-origin",
    "Cache-Control": "no-store",
}

_log = logging.getLogger(__name__)


def page(
    request: HTTPConnection, template: str, title: str, *, status: int = 200, **about: Any
) -> Response:
    """A page of `templates/`, in the visitor's language, which they may choose on it where they
    need not say anything for it to come again."""
    visitor = visitor_of(request)
    chosen = request.query_params.get("lang", "")
    words = texts("door", visitor.language)
    again = request.scope.get("method") == "GET" and status < 400
    html = rendered(
        template,
        **{
            "language": visitor.language,
            "languages": LANGUAGES if again else None,
            "more": _more(request),
            "words": words,
            "frame": texts("frame", visitor.language),
            "title": title,
            "trouble": "",
            **about,
        },
    )
    response = HTMLResponse(html, status, HEADERS)
    if chosen in LANGUAGES:
        response.set_cookie("language", chosen, max_age=YEAR, samesite="lax")
    return response


def missing(request: HTTPConnection) -> Response:
    """What is answered for an address that nothing is at."""
    return _trouble(request, 404, "missing", "There is nothing at this address.")


def failed(request: HTTPConnection) -> Response:
    """What is answered where the software has a fault."""
    return _trouble(request, 500, "fault", "The robot's software has a fault. Its log says why.")


def slow(request: HTTPConnection) -> Response:
    """What is answered where it takes too long to find out what should be."""
    _log.warning("the page %s was not ready in time", request.url.path)
    return _trouble(request, 503, "slow", "The robot's computer is too busy just now.")


class Caught:
    """An application whose faults are logged once, and answered with a page."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        begun = False

        async def sent(message: Message) -> None:
            nonlocal begun
            begun = True
            await send(message)

        try:
            await self._app(scope, receive, sent)
        except Exception:  # noqa: BLE001 - whatever it is, a page says so
            _log.exception("the page %s failed", scope["path"])
            if begun:
                return
            await failed(HTTPConnection(scope))(scope, receive, send)


def wants_page(request: HTTPConnection) -> bool:
    """Whether a person looks at what is answered."""
    return "text/html" in request.headers.get("accept", "")


def _trouble(request: HTTPConnection, status: int, kind: str, sentence: str) -> Response:
    if not wants_page(request):
        return PlainTextResponse(sentence + "\n", status, HEADERS)
    visitor = visitor_of(request)
    words = texts("door", visitor.language)
    frame = texts("frame", visitor.language)
    places = [("/face", frame["face"])]
    if visitor.seat != "face":
        places = [("/", frame["desk"]), ("/map", frame["map"]), ("/runs", frame["runs"])]
    if status >= 500 and request.scope.get("method") == "GET":  # a tablet may have no other way
        again = request.url.path + (f"?{request.url.query}" if request.url.query else "")
        places = [(again, words["again"]), *places]
    return page(
        request,
        "door_trouble.html",
        words[f"{kind}_title"],
        status=status,
        sentence=words[kind],
        stop=visitor.guest is not None,
        links=places,
    )


def _more(request: HTTPConnection) -> str:
    """The rest of the query, for the links that change the language."""
    rest = [(key, value) for key, value in request.query_params.multi_items() if key == "next"]
    return "".join(f"&{key}={quote(value)}" for key, value in rest)
