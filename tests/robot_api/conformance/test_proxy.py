"""A link that fails when it is told to."""

from __future__ import annotations

import contextlib
import socket
import threading
import time
from collections.abc import Iterator

import pytest

from robot_api.conformance import Proxy

SOON = 10  # seconds; what is waited for comes within milliseconds


@pytest.fixture
def echo() -> Iterator[int]:
    """The port of something that says again what it is told."""
    listening = socket.create_server(("127.0.0.1", 0))

    def serve(client: socket.socket) -> None:
        with client:
            while content := _received(client):
                client.sendall(content)

    def accept() -> None:
        while True:
            try:
                client, _ = listening.accept()
            except OSError:
                return
            threading.Thread(target=serve, args=(client,), daemon=True).start()

    threading.Thread(target=accept, daemon=True).start()
    yield listening.getsockname()[1]
    listening.close()


def _received(client: socket.socket) -> bytes:
    try:
        return client.recv(1000)
    except OSError:
        return b""


@pytest.fixture
def link(echo: int) -> Iterator[Proxy]:
    with Proxy("127.0.0.1", echo) as proxy:
        yield proxy


def client_of(link: Proxy) -> socket.socket:
    return socket.create_connection((link.host, link.port), SOON)


def test_it_carries_what_is_said_both_ways(link: Proxy) -> None:
    with client_of(link) as first, client_of(link) as second:
        first.sendall(b"to the lab")
        second.sendall(b"stop")
        assert first.recv(100) == b"to the lab"
        assert second.recv(100) == b"stop"
        assert link.passed == 2 * len(b"to the labstop")


def test_a_long_answer_arrives_whole_before_the_end(link: Proxy) -> None:
    text = b"blah " * 100_000
    with client_of(link) as client:
        sender = threading.Thread(target=lambda: (client.sendall(text), client.shutdown(1)))
        sender.start()
        heard = b"".join(iter(lambda: client.recv(65536), b""))
        sender.join(SOON)
    assert heard == text


def test_a_cut_ends_every_connection_and_refuses_new_ones_until_it_is_mended(link: Proxy) -> None:
    with client_of(link) as client:
        client.sendall(b"are you there?")
        assert client.recv(100) == b"are you there?"
        link.cut()
        with pytest.raises(ConnectionResetError):
            client.recv(100)
    port = link.port
    with pytest.raises(ConnectionRefusedError):
        client_of(link)
    link.mend()
    assert link.port == port
    with client_of(link) as client:
        client.sendall(b"again")
        assert client.recv(100) == b"again"


def test_what_is_frozen_comes_when_it_thaws(link: Proxy) -> None:
    with client_of(link) as client:
        link.freeze()
        client.sendall(b"are you there?")
        client.settimeout(0.2)
        with pytest.raises(TimeoutError):
            client.recv(100)
        link.mend()
        client.settimeout(SOON)
        assert client.recv(100) == b"are you there?"


def test_a_slow_link_takes_its_time_each_way(link: Proxy) -> None:
    with client_of(link) as client:
        link.delay(0.1)
        began = time.monotonic()
        client.sendall(b"slowly")
        assert client.recv(100) == b"slowly"
        assert time.monotonic() - began >= 0.2


def test_nonsense_is_as_long_as_what_was_said_and_the_same_every_time(link: Proxy) -> None:
    heard = []
    for _ in range(2):
        with client_of(link) as client:
            link.garble(seed=7)
            client.sendall(b"the pharmacy is on the left")
            heard.append(client.recv(100))
            link.mend()
    assert len(heard[0]) == len(b"the pharmacy is on the left")
    assert heard[0] != b"the pharmacy is on the left"
    assert heard[0] == heard[1]


def test_where_there_is_no_robot_a_connection_ends_at_once() -> None:
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    with (
        Proxy("127.0.0.1", port) as link,
        contextlib.suppress(ConnectionResetError),  # so soon that it never was one
        client_of(link) as client,
    ):
        assert _received(client) == b""
