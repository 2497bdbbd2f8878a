"""Pages of any slowness keep nobody from stopping the robot."""

from __future__ import annotations

import threading
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import httpx
import pytest
import websockets.sync.client
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response, StreamingResponse
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.types import Receive, Scope, Send
from starlette.websockets import WebSocket

from robot_api.client import Robot
from robot_api.drivers import emulated
from robot_api.errors import Stopped
from robot_api.server import Server

SOON = 20.0


class Pages:
    """An application as slow as anything."""

    def __init__(self) -> None:
        self.begun, self.may_go_on = threading.Event(), threading.Event()
        self.left = threading.Event()
        self.told: list[str] = []
        self.app = Starlette(
            routes=[
                Route("/slow", self._slow),
                Route("/broken", self._broken),
                Route("/parts", self._parts),
                Mount("/endless", self._endless),
                Route("/echo", self._echo, methods=["POST"]),
                WebSocketRoute("/talk", self._talk),
            ],
            lifespan=self._lifespan,
        )

    @asynccontextmanager
    async def _lifespan(self, app: Starlette) -> AsyncIterator[None]:
        self.told.append("begun")
        yield
        self.told.append("over")

    async def _slow(self, request: Request) -> Response:
        self.begun.set()
        self.may_go_on.wait(SOON)  # nothing else happens in this loop
        return PlainTextResponse("at last")

    async def _broken(self, request: Request) -> Response:
        raise ValueError("a fault of the page")

    async def _parts(self, request: Request) -> Response:
        async def parts() -> AsyncIterator[str]:
            for number in range(200):
                yield f"{number},"

        return StreamingResponse(parts())

    async def _endless(self, scope: Scope, receive: Receive, send: Send) -> None:
        """What it has for its reader comes some time."""
        await send({"type": "http.response.start", "status": 200, "headers": []})
        await send({"type": "http.response.body", "body": b"more ", "more_body": True})
        try:
            while (await receive())["type"] != "http.disconnect":
                pass
        finally:
            self.left.set()

    async def _echo(self, request: Request) -> Response:
        return Response(await request.body())

    async def _talk(self, socket: WebSocket) -> None:
        await socket.accept()
        async for text in socket.iter_text():
            await socket.send_text(text.upper())
        self.left.set()


@pytest.fixture
def pages() -> Pages:
    return Pages()


def test_a_stop_is_heard_while_a_page_is_built(pages) -> None:
    driver, driving = emulated(speed=1.0), threading.Event()
    driver.subscribe(
        lambda kind, data: (
            driving.set() if str(data.get("message", "")).startswith("drive") else None
        )
    )
    with Server(driver, port=0, pages=pages.app) as server:
        opened: list[str] = []

        def read() -> None:
            opened.append(httpx.get(f"http://{server.address}/slow", timeout=SOON).text)

        reading = threading.Thread(target=read)
        with Robot(server.address) as robot, Robot(server.address) as nurse:
            ended: list[Stopped] = []

            def drive() -> None:
                try:
                    robot.drive(0.5, 0, 60)
                except Stopped as stopped:
                    ended.append(stopped)

            moving = threading.Thread(target=drive)
            moving.start()
            assert driving.wait(SOON)
            reading.start()
            assert pages.begun.wait(SOON)
            nurse.stop()
            moving.join(SOON)
            assert ended and not opened  # the page is still being built
            pages.may_go_on.set()
            reading.join(SOON)
            assert opened == ["at last"]


def test_what_comes_and_goes_is_what_the_application_says(pages) -> None:
    with Server(emulated(), port=0, pages=pages.app) as server:
        url = f"http://{server.address}"
        assert pages.told == ["begun"]
        assert httpx.get(f"{url}/parts").text == "".join(f"{number}," for number in range(200))
        body = bytes(range(256)) * 5000
        assert httpx.post(f"{url}/echo", content=body, timeout=SOON).content == body
        assert httpx.get(f"{url}/nowhere").status_code == 404
        with websockets.sync.client.connect(f"ws://{server.address}/talk") as socket:
            for word in ("one", "two"):
                socket.send(word)
                assert socket.recv(timeout=SOON) == word.upper()
        assert pages.left.wait(SOON)
    assert pages.told == ["begun", "over"]


def test_a_page_with_a_fault_harms_nothing_else(pages) -> None:
    with Server(emulated(), port=0, pages=pages.app) as server, Robot(server.address) as robot:
        assert httpx.get(f"http://{server.address}/broken").status_code == 500
        assert robot.battery() > 0


def test_who_leaves_a_page_that_never_ends_is_noticed(pages) -> None:
    with Server(emulated(), port=0, pages=pages.app) as server:
        with httpx.stream("GET", f"http://{server.address}/endless/", timeout=SOON) as answer:
            assert next(answer.iter_text()).startswith("more")
        assert pages.left.wait(SOON)


def test_a_server_ends_while_somebody_reads_on(pages) -> None:
    with (
        Server(emulated(), port=0, pages=pages.app) as server,
        httpx.stream("GET", f"http://{server.address}/endless/", timeout=SOON) as answer,
    ):
        next(answer.iter_text())
        server.close()
    assert pages.left.wait(SOON)
