"""Connections that ask for nothing take no room from those that do."""

from __future__ import annotations

import contextlib
import socket
import threading
from collections.abc import Iterator

import pytest

from robot_api.client import Robot
from robot_api.drivers import emulated
from robot_api.errors import InternalError
from robot_api.server import MAX_HEAD, Server
from robot_api.serving import two_way_port

SOON = 20.0


@pytest.fixture
def server() -> Iterator[Server]:
    with Server(emulated(), port=0) as server:
        yield server


@contextlib.contextmanager
def connections(server: Server, number: int, say: bytes = b"") -> Iterator[list[socket.socket]]:
    host, _, port = server.address.removeprefix("ws://").rstrip("/").partition(":")
    with contextlib.ExitStack() as stack:
        made = []
        for _ in range(number):
            each = stack.enter_context(socket.create_connection((host, int(port)), timeout=SOON))
            each.sendall(say)
            made.append(each)
        yield made


def is_closed(connection: socket.socket) -> bool:
    """Whether the other side closes it."""
    try:
        while connection.recv(4096):
            pass
    except (ConnectionResetError, BrokenPipeError):
        return True
    return True


@pytest.mark.parametrize("say", [b"", b"GET / HT", b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nA: "])
def test_a_stop_is_heard_among_hundreds_that_begin_and_never_ask(
    server: Server, say: bytes
) -> None:
    number = two_way_port.MOST_UNDECIDED + 50
    with connections(server, number, say) as many:
        with Robot(server.address) as robot:
            robot.stop()
        assert is_closed(many[0])  # the oldest has made room


def test_who_does_not_come_to_the_end_of_the_head_is_let_go(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(two_way_port, "BEGINS_WITHIN", 0.2)
    with (
        Server(emulated(), port=0) as server,
        connections(server, 1, b"GET / HTTP/1.1\r\nHost: ") as [slow],
        Robot(server.address) as robot,
    ):
        assert is_closed(slow)
        robot.say("Those who have asked stay.")


def test_a_head_has_its_limit(server: Server) -> None:
    head = b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nCookie: " + b"a" * (2 * MAX_HEAD)
    with connections(server, 1, head) as [one]:
        assert b"400" in one.recv(4096).split(b"\r\n")[0]


def test_a_clock_beyond_all_years_ends_nothing(
    server: Server, monkeypatch: pytest.MonkeyPatch
) -> None:
    ticked = threading.Event()

    def beyond() -> float:
        ticked.set()
        return 1e15

    with Robot(server.address) as robot:
        with monkeypatch.context() as clock:
            clock.setattr("uvicorn.server.time.time", beyond)
            for _ in range(2):  # it ticks on
                assert ticked.wait(SOON)
                ticked.clear()
            robot.stop()
        robot.say("What day is it?")
    with Robot(server.address) as robot:
        robot.say("It is an ordinary one.")


def test_a_server_that_has_ended_by_itself_is_told_of(monkeypatch: pytest.MonkeyPatch) -> None:
    server = Server(emulated(), port=0)
    with pytest.raises(InternalError, match="ended by a fault"):
        server.serve_forever(lambda server: setattr(server._uvicorn, "should_exit", True))
