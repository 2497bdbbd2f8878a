"""Frames that are nearly right, and bytes that are none, to a server with a simulated robot.

    python -m tests.attacks.wire [--seed S] [--inputs N] [--only BURST]

They come in bursts, each made from the seed and its number alone. After each, the robot is stopped:
everything that was asked for has to be answered then, every refusal is a sentence, and nothing is
run that was not approved. A server that complains of a fault of its own has not borne it.
"""

from __future__ import annotations

import argparse
import contextlib
import hashlib
import logging
import queue
import random
import socket
import sqlite3
import sys
import tempfile
import threading
import time
from contextlib import closing
from pathlib import Path
from typing import Any, Final

import msgspec
import websockets.sync.client
from websockets.exceptions import WebSocketException

from robot_api.client import Robot
from robot_api.frame import Unreadable, read_frame
from tests.attacks.frames import Frames
from tests.attacks.mutations import bytes_like
from tests.attacks.outcome import Row, report, say, what_is_no_sentence
from tests.attacks.served import Served, memory, served

NAME: Final = "frames on the wire"
RAW: Final = "bytes on the port"
BURST: Final = 40
SECONDS: Final = 10.0
"""In which all of a burst is answered once the robot was stopped."""
RAW_SHARE: Final = 0.02
"""Of all inputs, those that are no frame at all."""
FAULTS_EVERY: Final = 50
"""Bursts after which it is asked whether the server complains of something."""
STOP: Final = '{"jsonrpc":"2.0","id":"the stop","method":"robot.stop"}'
GROWTH: Final = 250.0
"""Megabytes that the server may use beside what it had after its first bursts."""
FIRST_BURSTS: Final = 50
HEADS: Final = (
    b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
    b"Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n",
    b"GET /health HTTP/1.1\r\nHost: 127.0.0.1\r\nCookie: a=b; robot-1=c\r\n\r\n",
    b"POST /join/abc HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 5\r\n\r\na=b&c",
    b"GET /runs?words=%ff%00&since=2026 HTTP/1.1\r\nHost: 127.0.0.1\r\nRange: bytes=0-9\r\n\r\n",
    b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + b"\x11" * 80,
)
"""The last one begins as TLS does."""
_MASK: Final = b"\x01\x02\x03\x04"


class Lost(Exception):
    """What was not borne, in a sentence."""


class Attacker:
    """Sends bursts over a connection, and makes it again when the server has closed it."""

    def __init__(self, address: str, frames: Frames) -> None:
        self._address = address
        self._frames = frames
        self._opened = contextlib.ExitStack()
        self._wire: Any = None
        self._heard: queue.SimpleQueue[dict[str, Any] | None] = queue.SimpleQueue()
        self.approved: set[str] = set()
        """Hashes of what the server has said is approved."""

    def burst(self, seed: int, number: int, size: int) -> float:
        """Send it, then a stop; returns the stop's milliseconds. Raises `Lost`."""
        chance = random.Random(f"{NAME} {seed} {number}")
        made = [self._frames.made(chance, f"{number} {at}") for at in range(size)]
        told: dict[str, str] = {}
        awaited: set[str] = set()
        for frame in made:
            try:
                self._connected().send(frame.data)
            except (OSError, WebSocketException):  # it was told that this is none
                self._left()
                awaited.clear()
            else:
                told |= {each: ascii(frame.data)[:600] for each in frame.ids}
                if frame.ids and _can_be_read(frame.data):
                    awaited |= set(frame.ids)
        return self._stopped(awaited, told)

    def _stopped(self, awaited: set[str], told: dict[str, str]) -> float:
        began = time.perf_counter()
        took: float | None = None
        with contextlib.suppress(OSError, WebSocketException):
            self._connected().send(STOP)
        ends = time.monotonic() + SECONDS
        while took is None or awaited:
            try:
                heard = self._heard.get(timeout=max(0.0, ends - time.monotonic()))
            except queue.Empty:
                if took is None:
                    raise Lost(f"a stop is not answered within {SECONDS:.0f} s") from None
                least = min(awaited, key=lambda each: len(told[each]))
                raise Lost(f"{len(awaited)} calls are never answered: {told[least]}") from None
            if heard is None:  # the connection was closed, and with it what was asked over it
                self._left()
                awaited.clear()
                if took is None:
                    began = time.perf_counter()
                    self._connected().send(STOP)
                continue
            if heard.get("id") == "the stop":
                took = 1000 * (time.perf_counter() - began)
            awaited.discard(heard.get("id", ""))
            self._look(heard, told)
        return took

    def _look(self, heard: dict[str, Any], told: dict[str, str]) -> None:
        frame = told.get(str(heard.get("id")), "a frame that is no proper call")
        error = heard.get("error")
        if error is not None:
            wrong = what_is_no_sentence(error.get("message"))
            if error.get("data", {}).get("error") == "InternalError":
                wrong = f"an internal error: {error.get('message')}"
            if wrong is not None:
                raise Lost(f"{wrong}\n  {frame}")
            return
        result = heard.get("result")
        if isinstance(result, dict) and {"sha256", "by", "program"} <= set(result):
            self.approved.add(result["sha256"])

    def _connected(self) -> Any:
        if self._wire is None:
            address = f"ws://{self._address}/"
            self._heard = queue.SimpleQueue()
            self._wire = self._opened.enter_context(
                websockets.sync.client.connect(
                    address, open_timeout=SECONDS, max_size=None, compression=None
                )
            )
            threading.Thread(target=self._hear, args=(self._wire, self._heard), daemon=True).start()
        return self._wire

    @staticmethod
    def _hear(wire: Any, heard: queue.SimpleQueue[dict[str, Any] | None]) -> None:
        with contextlib.suppress(OSError, WebSocketException):
            while True:
                frame = wire.recv()
                content = msgspec.json.decode(frame)
                for each in content if isinstance(content, list) else [content]:
                    if "id" in each:  # no event
                        heard.put(each)
        heard.put(None)

    def _left(self) -> None:
        if self._wire is not None:
            self._wire = None
            with contextlib.suppress(OSError, WebSocketException):
                self._opened.close()

    def close(self) -> None:
        self._left()


def _can_be_read(data: str | bytes) -> bool:
    """Else it is refused as a whole, under no id."""
    try:
        read_frame(data)
    except Unreadable:
        return False
    return True


def raw(address: str, seed: int, number: int) -> None:
    """Bytes over a connection of their own. Raises `Lost` if the server neither answers nor lets
    it go."""
    chance = random.Random(f"{RAW} {seed} {number}")
    data = chance.choice(HEADS)
    if chance.random() < 0.5:
        data = HEADS[0] + b"".join(_websocket(chance) for _ in range(chance.randint(1, 5)))
    if chance.random() < 0.8:
        data = bytes_like(chance, [data, *HEADS][: chance.choice((1, 9))])
    host, _, port = address.partition(":")
    try:
        with socket.create_connection((host, int(port)), timeout=SECONDS) as wire:
            wire.sendall(data)
            wire.shutdown(socket.SHUT_WR)
            while wire.recv(65536):
                pass
    except TimeoutError:
        raise Lost(f"a connection is kept on: {data!r}") from None
    except OSError:
        pass  # reset, since nothing more was read


def _websocket(chance: random.Random) -> bytes:
    """A frame of a WebSocket, of any kind, length and honesty."""
    payload = chance.choice((b"", b"[]", b'{"jsonrpc":"2.0"}', b"\xff\xfe", b"a" * 126))
    head = bytes([chance.choice((0x81, 0x01, 0x80, 0x82, 0x88, 0x89, 0x8A, 0xF1, 0x83))])
    length = chance.choice((len(payload), 125, 126, 127, chance.randrange(256)))
    more = chance.choice((b"", (2 ** chance.randrange(63)).to_bytes(8, "big")))
    masked = bytes(byte ^ _MASK[at % 4] for at, byte in enumerate(payload))
    return head + bytes([0x80 | length & 0x7F]) + more + _MASK + masked


def unapproved(home: Path, approved: set[str]) -> list[str]:
    """What is in the log and was not approved, or not so."""
    with closing(sqlite3.connect(home / "runs.sqlite")) as database:
        rows = database.execute("SELECT id, program, sha256 FROM runs").fetchall()
    return [
        f"run {run} was not approved: {program!r}"
        for run, program, sha256 in rows
        if sha256 not in approved or hashlib.sha256(program.encode()).hexdigest() != sha256
    ]


def fuzzed(seed: int, inputs: int, only: int | None = None) -> list[Row]:
    """So many frames, and bytes that are none."""
    frames_row, bytes_row = Row(NAME), Row(RAW)
    bytes_left = max(1, round(inputs * RAW_SHARE))
    bursts = max(1, round((inputs - bytes_left) / BURST))
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder) / "home"
        home.mkdir()
        with served(home, "--speed", "20") as server:
            with Robot(server.address) as robot:
                frames = Frames(robot.request("rpc.discover"))
            began = time.monotonic()
            attacker = Attacker(server.address, frames)
            numbers = range(bursts) if only is None else range(only, only + 1)
            _bursts(server, attacker, frames_row, seed, numbers)
            rate = frames_row.tried / (time.monotonic() - began)
            say(f"{NAME}: {frames_row.tried} inputs, {rate:.0f} a second")
            began = time.monotonic()
            for number in range(bytes_left):
                bytes_row.add(_tried_raw(server, seed, number))
            rate = bytes_row.tried / (time.monotonic() - began)
            say(f"{RAW}: {bytes_row.tried} inputs, {rate:.0f} a second")
            for row in (frames_row, bytes_row):
                row.used(memory(server.pid))
            attacker.close()
            faults = server.faults()
            if faults is not None:
                bytes_row.failures.append(f"the server complains:\n{faults}")
        frames_row.failures += unapproved(home, attacker.approved)
    return [frames_row, bytes_row]


def _bursts(server: Served, attacker: Attacker, row: Row, seed: int, numbers: range) -> None:
    again = f"python -m tests.attacks.wire --seed {seed} --only"
    loaded, known = 0.0, set()
    for number in numbers:
        row.tried += BURST
        try:
            row.stopped_in(attacker.burst(seed, number, BURST))
            row.survived += BURST
        except Lost as lost:
            row.survived += BURST - 1
            kind = "".join(sign for sign in str(lost).split("\n")[0] if not sign.isdigit())
            if kind not in known:
                known.add(kind)
                row.failures.append(f"{lost}\n  {again} {number}")
        except (OSError, WebSocketException) as error:
            row.failures.append(f"the server is gone ({error})\n  {again} {number}")
            return
        if number == FIRST_BURSTS:
            loaded = memory(server.pid)
        if number % FAULTS_EVERY == 0 and (faults := server.faults()) is not None:
            row.survived -= 1
            row.failures.append(f"the server complains of burst {number} or before:\n{faults}")
            server.forget_faults()
    worst = memory(server.pid)
    if loaded and worst - loaded > GROWTH:
        row.failures.append(f"the server's memory grows from {loaded:.0f} to {worst:.0f} MB")


def _tried_raw(server: Served, seed: int, number: int) -> str | None:
    try:
        raw(server.address, seed, number)
    except Lost as lost:
        return f"{lost}\n  seed {seed}, number {number}"
    return None


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--inputs", type=int, default=20_000)
    parser.add_argument("--only", type=int, help="the number of one burst")
    given = parser.parse_args()
    logging.disable()  # of clients whose server is gone
    return report(fuzzed(given.seed, given.inputs, given.only), f"Wire, seed {given.seed}")


if __name__ == "__main__":
    sys.exit(main())
