"""A link to a robot that can be cut, frozen, slowed down and garbled.

    with Proxy("192.168.1.20", 9090) as link:
        driver = connect(link.host, link.port)
        link.cut()
        ...
        link.mend()

A small TCP proxy: who connects to it is connected to the robot.
"""

from __future__ import annotations

import asyncio
import contextlib
import random
import socket
import struct
import threading
from collections.abc import Awaitable, Callable, Coroutine
from dataclasses import dataclass, field
from typing import Any, Final

_CHUNK: Final = 65536
_AT_ONCE: Final = struct.pack("ii", 1, 0)
"""A socket that lingers for no time is reset when it is closed, like one whose cable is cut."""
_START: Final = 10.0
"""Seconds that the proxy's own thread has to do what it is asked."""

_Pipe = asyncio.Queue[tuple[float, bytes]]
"""What has been read and is to be sent: when, and what; nothing is the end."""


@dataclass(eq=False)
class _Connection:
    """One client, and its connection to the robot."""

    writers: list[asyncio.StreamWriter]
    tasks: list[asyncio.Task[None]] = field(default_factory=list)


class Proxy:
    """A link to the robot at that host and port. Any thread may call any of it."""

    def __init__(self, host: str, port: int) -> None:
        self.host = "127.0.0.1"
        self.port = 0
        """Where it is reached; a free port of this machine, the same until it is closed."""
        self.passed = 0
        """Bytes that have come from the robot."""
        self._robot = (host, port)
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name="proxy", daemon=True)
        # All of the following is touched by that thread alone.
        self._server: asyncio.Server | None = None
        self._connections: set[_Connection] = set()
        self._flowing = asyncio.Event()
        self._delay = 0.0
        self._noise: random.Random | None = None

    def __enter__(self) -> Proxy:
        self._thread.start()
        self._flowing.set()
        self._do(self._listen())
        return self

    def __exit__(self, *_: object) -> None:
        self._do(self._cut())
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(_START)
        self._loop.close()

    # --- what can be done to it ------------------------------------------------------------------

    def cut(self) -> None:
        """Break every connection off, and refuse new ones."""
        self._do(self._cut())

    def freeze(self) -> None:
        """Hold everything back, both ways, and answer nobody; no connection ends."""
        self._do(self._set(self._flowing.clear))

    def delay(self, seconds: float) -> None:
        """Take so long to carry anything, each way."""
        self._do(self._set(lambda: setattr(self, "_delay", seconds)))

    def garble(self, seed: int = 1) -> None:
        """Make nonsense of all that the robot says."""
        self._do(self._set(lambda: setattr(self, "_noise", random.Random(seed))))

    def mend(self) -> None:
        """Carry everything as it is again, at once; what was held back comes first."""
        self._do(self._mend())

    # --- in the proxy's own thread ---------------------------------------------------------------

    def _do(self, what: Coroutine[Any, Any, None]) -> None:
        asyncio.run_coroutine_threadsafe(what, self._loop).result(_START)

    async def _set(self, change: Callable[[], None]) -> None:
        change()

    async def _listen(self) -> None:
        self._server = await asyncio.start_server(self._serve, self.host, self.port)
        self.port = self._server.sockets[0].getsockname()[1]

    async def _mend(self) -> None:
        self._delay, self._noise = 0.0, None
        self._flowing.set()
        if self._server is None:
            await self._listen()

    async def _cut(self) -> None:
        if self._server is not None:
            self._server.close()
            self._server = None
        for connection in tuple(self._connections):
            self._break_off(connection)

    def _break_off(self, connection: _Connection) -> None:
        for writer in connection.writers:
            raw: socket.socket = writer.get_extra_info("socket")
            with contextlib.suppress(OSError):
                raw.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, _AT_ONCE)
            writer.transport.abort()
        for task in connection.tasks:
            task.cancel()
        self._connections.discard(connection)

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        connection = _Connection([writer])
        self._connections.add(connection)
        try:
            from_robot, to_robot = await asyncio.open_connection(*self._robot)
        except OSError:
            self._break_off(connection)
            return
        connection.writers.append(to_robot)
        pipes: tuple[_Pipe, _Pipe] = (asyncio.Queue(), asyncio.Queue())
        ways: list[Awaitable[None]] = [
            self._read(reader, pipes[0], False),
            self._write(to_robot, pipes[0]),
            self._read(from_robot, pipes[1], True),
            self._write(writer, pipes[1]),
        ]
        connection.tasks = [asyncio.ensure_future(way) for way in ways]
        if connection not in self._connections:  # cut while it was being made
            self._break_off(connection)
        await asyncio.wait(connection.tasks)
        self._break_off(connection)

    async def _read(self, reader: asyncio.StreamReader, pipe: _Pipe, of_robot: bool) -> None:
        content = b"begin"
        while content:
            try:
                content = await reader.read(_CHUNK)
            except OSError:
                content = b""
            if of_robot:
                self.passed += len(content)
                if self._noise is not None:
                    content = self._noise.randbytes(len(content))
            pipe.put_nowait((self._loop.time() + self._delay, content))

    async def _write(self, writer: asyncio.StreamWriter, pipe: _Pipe) -> None:
        while True:
            due, content = await pipe.get()
            await asyncio.sleep(max(0.0, due - self._loop.time()))
            await self._flowing.wait()
            with contextlib.suppress(OSError, RuntimeError):  # that side has left
                if not content:
                    writer.write_eof()
                    return
                writer.write(content)
                await writer.drain()
