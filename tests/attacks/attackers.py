"""Those who attack a server, each in a process of its own: `python -m tests.attacks.attackers NAME
ADDRESS SECONDS`. They do nothing that the network does not allow, and say in the end how often."""

from __future__ import annotations

import contextlib
import itertools
import json
import random
import socket
import sys
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import httpx
import websockets.sync.client
from websockets.exceptions import WebSocketException

from robot_api.client import Robot
from robot_api.errors import RobotError, Stopped
from robot_api.protocol import MAX_FRAME

OPTIONS = json.dumps(
    {
        "jsonrpc": "2.0",
        "id": 1,
        "method": "robot.ask",
        "params": {"question": "?", "options": ["a"] * 60_000},
    },
    separators=(",", ":"),
)
BATCH = json.dumps(
    [
        {
            "jsonrpc": "2.0",
            "id": number,
            "method": "zones.draw",
            "params": {"name": "a", "polygon": [[0, 0]] * 70},
        }
        for number in range(64)
    ]
)


def _frames(frames: Callable[[random.Random], str | bytes]) -> Callable[[str], Iterator[None]]:
    """Frame after frame over one connection after the other, as fast as they are taken."""

    def attack(address: str) -> Iterator[None]:
        chance = random.Random(1)
        while True:
            with (
                contextlib.suppress(OSError, WebSocketException),
                websockets.sync.client.connect(f"ws://{address}/", open_timeout=5) as wire,
            ):
                reader = threading.Thread(target=_read, args=(wire,), daemon=True)
                reader.start()
                while True:
                    wire.send(frames(chance))
                    yield

    return attack


def _read(wire: Any) -> None:
    with contextlib.suppress(OSError, WebSocketException):
        for _ in wire:
            pass


def _garbage(chance: random.Random) -> str | bytes:
    signs = '[]{}",:\\0aN .-eE'
    size = int(10 ** chance.uniform(0, 5.4))
    if chance.random() < 0.3:
        return chance.randbytes(size)
    return "".join(chance.choices(signs, k=size))[:MAX_FRAME]


def _open(say: bytes) -> Callable[[str], Iterator[None]]:
    """Connections that begin and do not go on, 800 at a time."""

    def attack(address: str) -> Iterator[None]:
        host, _, port = address.partition(":")
        opened: list[socket.socket] = []
        while True:
            with contextlib.suppress(OSError):
                each = socket.create_connection((host, int(port)), timeout=5)
                opened.append(each)
                each.sendall(say)
            if len(opened) >= 800:
                opened.pop(0).close()
            yield

    return attack


def _colleagues(address: str) -> Iterator[None]:
    """Four who have sentences translated and programs reviewed all day."""
    program = 'for place in robot.places("ward"):\n    robot.goto(place)\n    robot.say("Hello.")\n'
    done = threading.Semaphore(0)

    def work() -> None:
        with Robot(address) as robot:
            while True:
                with contextlib.suppress(RobotError, Stopped):
                    robot.request("program.check", {"program": program})
                    sentence = {"utterance": "go to every ward and say hello", "planner": "grammar"}
                    robot.request("program.translate", sentence)
                done.release()

    for _ in range(4):
        threading.Thread(target=work, daemon=True).start()
    while True:
        done.acquire()
        yield


def _waiting(address: str) -> Iterator[None]:
    """Calls that wait, more than there are threads for one connection."""
    frame = json.dumps(
        [
            {"jsonrpc": "2.0", "id": number, "method": "robot.wait", "params": [5]}
            for number in range(64)
        ]
    )
    while True:
        with (
            contextlib.suppress(OSError, WebSocketException),
            websockets.sync.client.connect(f"ws://{address}/", open_timeout=5) as wire,
        ):
            wire.send(frame)
            yield
            for _ in wire:  # until it is answered, since somebody stopped the robot
                break


def _readers(address: str) -> Iterator[None]:
    """Three who open one page after the other."""
    pages = ("/", "/runs", "/map", "/drive", "/devices", "/face")
    done = threading.Semaphore(0)

    def read() -> None:
        for page in itertools.cycle(pages):
            with contextlib.suppress(httpx.HTTPError):
                httpx.get(f"http://{address}{page}", timeout=10).raise_for_status()
                done.release()

    for _ in range(3):
        threading.Thread(target=read, daemon=True).start()
    while True:
        done.acquire()
        yield


ATTACKS: dict[str, Callable[[str], Iterator[None]]] = {
    "60,000 options": _frames(lambda chance: OPTIONS),
    "batches of 64": _frames(lambda chance: BATCH),
    "brackets": _frames(lambda chance: "[" * MAX_FRAME),
    "quotation marks": _frames(lambda chance: '"' * MAX_FRAME),
    "garbage": _frames(_garbage),
    "silent connections": _open(b""),
    "heads without end": _open(b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nA: "),
    "large cookies": _open(b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nCookie: " + b"\\x" * 30_000),
    "64 calls that wait": _waiting,
    "four colleagues": _colleagues,
    "pages opened": _readers,
}


def main() -> None:
    name, address, seconds = sys.argv[1:]
    ends, tried = time.monotonic() + float(seconds), 0
    for _ in ATTACKS[name](address):
        tried += 1
        if time.monotonic() >= ends:
            break
    print(tried, flush=True)


if __name__ == "__main__":
    main()
