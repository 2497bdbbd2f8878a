"""The door of the console: who may see which page, and the pages for those who may not yet.

`/sign-in` for people with an account, `/join/CODE` for a tablet that is paired and for the first
administrator, `/trust` for whoever shall trust the robot's certificate. They are plain pages, for
they are all that somebody unknown gets to see.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping
from typing import Any, Final
from urllib.parse import parse_qs

from starlette.concurrency import run_in_threadpool
from starlette.requests import HTTPConnection, Request
from starlette.responses import PlainTextResponse, RedirectResponse, Response
from starlette.routing import BaseRoute, Route

from nl2robot.console.plain import HEADERS, page, wants_page
from nl2robot.console.visitor import texts, visitor_of
from nl2robot.errors import UserError
from nl2robot.station.accounts import LONGEST_NAME, TooSoon
from nl2robot.station.entrance import Entrance
from nl2robot.station.part import Backstage, Part
from robot_api.serving.access import Guest, Refusal
from robot_api.serving.guard import keep
from robot_api.serving.roles import Right

PLAIN: Final = frozenset(
    {
        *("/trust", "/authority.crt", "/favicon.ico", "/static/icon.svg"),
        *("/static/console.css", "/static/door/door.css", "/static/door/look.js"),
    }
)
"""What anybody may see, also before their device trusts the robot."""
NEEDS: Final[Mapping[str, Right]] = {
    "/static": "know",
    "/openrpc.json": "know",
    "/face": "know",
    "/sign-out": "know",
    "/codes": "operate",
    "/devices": "operate",
}
"""The rights that pages need, with all that is below them; every other one needs that to look."""
LARGEST_FORM: Final = 4096
"""Bytes."""

_log = logging.getLogger(__name__)


class Doors:
    """See `robot_api.serving.guard.Doors`."""

    def __init__(self, entrance: Entrance) -> None:
        self._entrance = entrance
        self.known = entrance.accounts.known
        self.holds = entrance.accounts.holds

    def is_open(self, path: str) -> bool:
        return path in PLAIN or path == "/sign-in" or path.startswith("/join/")

    def is_plain(self, path: str) -> bool:
        return path in PLAIN

    def needs(self, path: str) -> Right:
        return next(
            (
                right
                for place, right in NEEDS.items()
                if path == place or path.startswith(f"{place}/")
            ),
            "look",
        )

    def refused(self, request: HTTPConnection, refusal: Refusal) -> Response:
        if not wants_page(request) or (refusal.status == 403 and refusal.guest is None):
            status = 403 if refusal.status == 426 else refusal.status
            return PlainTextResponse(refusal.sentence + "\n", status, HEADERS)
        if refusal.status == 426:
            return _trust(request, self._entrance, 403)
        if refusal.guest is not None:
            return _denied(request, refusal.guest)
        words = texts("door", visitor_of(request).language)
        trouble = words["outdated"] if refusal.outdated else ""
        query = f"?{request.url.query}" if request.url.query and not refusal.outdated else ""
        next_page = request.url.path + query
        return _sign_in(request, self._entrance, 401, next=next_page, trouble=trouble)


def part(backstage: Backstage) -> Part:
    entrance = backstage.entrance
    return Part(routes=_routes(entrance) if entrance else ())


def _routes(entrance: Entrance) -> list[BaseRoute]:
    accounts = entrance.accounts

    async def sign_in(request: Request) -> Response:
        if request.method == "GET":
            return _sign_in(request, entrance, 200, next=request.query_params.get("next", "/"))
        form = await _form(request)
        name, next_page = form.get("name", "")[:LONGEST_NAME].strip(), form.get("next", "/")
        words, address = texts("door", visitor_of(request).language), _address(request)
        again: dict[str, Any] = {"next": next_page, "name": name}
        try:
            secret = await run_in_threadpool(
                accounts.sign_in, name, form.get("password", ""), address, _browser(request)
            )
        except TooSoon as wait:
            trouble = words["too_soon"].format(seconds=int(wait.seconds) + 1)
            return _sign_in(request, entrance, 429, trouble=trouble, **again)
        if secret is None:
            _log.warning("Somebody at %s failed to sign in as %r.", address, name)
            return _sign_in(request, entrance, 403, trouble=words["wrong"], **again)
        return _let_in(request, secret, next_page)

    async def sign_out(request: Request) -> Response:
        secret = request.cookies.get(request.state.cookie, "")
        await run_in_threadpool(accounts.sign_out, secret)
        return _let_in(request, "", "/sign-in")

    async def join(request: Request) -> Response:
        code = request.path_params["code"]
        invitation = await run_in_threadpool(accounts.invitation, code)
        words = texts("door", visitor_of(request).language)
        if invitation is None:
            about: dict[str, Any] = {"invitation": None, "first": False}
            trouble = words["join_over"]
            title = words["join_title"]
            return page(request, "door_join.html", title, status=410, trouble=trouble, **about)
        first = invitation.role == "administrator"
        trouble, name = "", ""
        if request.method == "POST" and first:
            form = await _form(request)
            name, password = form.get("name", ""), form.get("password", "")
            try:
                await run_in_threadpool(accounts.add, name, "administrator", password)
            except UserError:
                trouble = words["not_a_password"]
            else:
                await run_in_threadpool(accounts.spend, code)
                secret = await run_in_threadpool(
                    accounts.sign_in, name, password, _address(request), _browser(request)
                )
                return _let_in(request, secret or "", "/")
        elif request.method == "POST":
            secret = await run_in_threadpool(accounts.join, code)
            if secret is not None:
                return _let_in(request, secret, "/face" if invitation.role == "face" else "/")
        return page(
            request,
            "door_join.html",
            words["first_title" if first else "join_title"],
            trouble=trouble,
            name=name,
            code=code,
            first=first,
            invitation=None if first else invitation,
        )

    async def trust(request: Request) -> Response:
        return _trust(request, entrance, 200)

    async def authority(request: Request) -> Response:
        certificate = entrance.certificate and entrance.certificate.authority_file
        if not certificate:
            return PlainTextResponse("This server has no authority of its own.\n", 404, HEADERS)
        content = await run_in_threadpool(certificate.read_bytes)
        return Response(content, media_type="application/x-x509-ca-cert")

    return [
        Route("/sign-in", sign_in, methods=["GET", "POST"]),
        Route("/sign-out", sign_out, methods=["POST"]),
        Route("/join/{code}", join, methods=["GET", "POST"]),
        Route("/trust", trust),
        Route("/authority.crt", authority),
    ]


def _sign_in(request: HTTPConnection, entrance: Entrance, status: int, **about: Any) -> Response:
    words = texts("door", visitor_of(request).language)
    return page(
        request,
        "door_sign_in.html",
        words["sign_in_title"],
        status=status,
        **{
            "name": "",
            "accounts": bool(entrance.accounts.accounts()),
            "here": entrance.local,
            "trust": entrance.certificate is not None,
            **about,
        },
    )


def _trust(request: HTTPConnection, entrance: Entrance, status: int) -> Response:
    words = texts("door", visitor_of(request).language)
    certificate = entrance.certificate
    scheme = "https" if certificate else request.url.scheme
    return page(
        request,
        "door_trust.html",
        words["trust_title"],
        status=status,
        fingerprint=certificate.fingerprint if certificate else None,
        secure=f"{scheme}://{request.headers.get('host', '')}/",
    )


def _denied(request: HTTPConnection, guest: Guest) -> Response:
    """What somebody is told who may come in, but not there. A face has but one page."""
    if guest.role == "face":
        return RedirectResponse("/face", 303, HEADERS)
    words = texts("door", visitor_of(request).language)
    return page(
        request,
        "door_trouble.html",
        words["denied_title"],
        status=403,
        sentence=words["denied"],
        stop=True,
        links=[("/sign-in", words["sign_in"])],
    )


def _let_in(request: Request, secret: str, next_page: str) -> Response:
    """Go on, with the secret in a cookie; an empty one is forgotten. `next_page` comes from
    outside: nobody is sent to another host."""
    inside = next_page.startswith("/") and not next_page.startswith(
        ("//", "/\\", "/sign-", "/join")
    )
    response = RedirectResponse(
        next_page if inside or next_page == "/sign-in" else "/", 303, HEADERS
    )
    keep(response, request, secret)
    return response


async def _form(request: Request) -> dict[str, str]:
    """What was filled in; nothing if that is more than anybody fills in."""
    body = b""
    async for block in request.stream():
        body += block
        if len(body) > LARGEST_FORM:
            return {}
    return {key: values[0] for key, values in parse_qs(body.decode(errors="replace")).items()}


def _address(request: HTTPConnection) -> str:
    return request.client.host if request.client else ""


def _browser(request: HTTPConnection) -> str:
    """What signed in, as people call it: "Firefox, Android"."""
    agent = request.headers.get("user-agent", "")
    browsers = ("Edg", "Firefox", "Chrome", "Safari")
    systems = ("Android", "iPad", "iPhone", "Windows", "Mac OS", "Linux")
    found = [next((word for word in words if word in agent), "") for words in (browsers, systems)]
    return ", ".join(word.replace("Edg", "Edge") for word in found if word) or "?"
