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
from collections.abc import Callable, Coroutine
from typing import Any, Final

_CHUNK: Final = 65536
_AT_ONCE: Final = struct.pack("ii", 1, 0)
"""A socket that lingers for no time is reset when it is closed, like one whose cable is cut."""
_START: Final = 10.0
"""Seconds that the proxy's own thread has to do what it is asked."""

_Pipe = asyncio.Queue[tuple[float, bytes]]
"""What has been read and is to be sent: when, and what; nothing is the end."""


class Proxy:
    """A link to the robot at that host and port. Any thread may call any of it."""

    def __init__(self, host: str, port: int) -> None:
        self.host = "127.0.0.1"
        self.port = 0
        """Where it is reached; a free port of this machine, the same until it is closed."""
        self.passed = 0
        """Bytes that it has carried, both ways."""
        self._robot = (host, port)
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name="proxy", daemon=True)
        # All of the following is touched by that thread alone.
        self._server: asyncio.Server | None = None
        self._serving: set[asyncio.Task[Any]] = set()
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
        """Carry everything as it is again; what was held back comes first."""
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
        for task in self._serving:
            task.cancel()
        await asyncio.gather(*self._serving, return_exceptions=True)

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Carry what one client and the robot say to each other."""
        task = asyncio.current_task()
        assert task is not None
        self._serving.add(task)
        sides = [writer]
        try:
            from_robot, to_robot = await asyncio.open_connection(*self._robot)
            sides.append(to_robot)
            there: _Pipe = asyncio.Queue()
            back: _Pipe = asyncio.Queue()
            async with asyncio.TaskGroup() as ways:
                ways.create_task(self._read(reader, there, of_robot=False))
                ways.create_task(self._write(to_robot, there))
                ways.create_task(self._read(from_robot, back, of_robot=True))
                ways.create_task(self._write(writer, back))
        except (OSError, asyncio.CancelledError):  # there is no robot, or the link is cut
            for side in sides:
                _reset(side)
        finally:
            for side in sides:
                side.close()
            self._serving.discard(task)

    async def _read(self, reader: asyncio.StreamReader, pipe: _Pipe, *, of_robot: bool) -> None:
        content = b"begin"
        while content:
            try:
                content = await reader.read(_CHUNK)
            except OSError:
                content = b""
            self.passed += len(content)
            if of_robot and self._noise is not None:
                content = self._noise.randbytes(len(content))
            pipe.put_nowait((self._loop.time() + self._delay, content))

    async def _write(self, writer: asyncio.StreamWriter, pipe: _Pipe) -> None:
        while True:
            due, content = await pipe.get()
            await asyncio.sleep(max(0.0, due - self._loop.time()))
            await self._flowing.wait()
            if writer.is_closing():
                return  # that side has left
            with contextlib.suppress(OSError):
                if not content:
                    writer.write_eof()
                    return
                writer.write(content)
                await writer.drain()


def _reset(side: asyncio.StreamWriter) -> None:
    """End the connection with nothing more said, as if its cable were cut."""
    raw: socket.socket = side.get_extra_info("socket")
    with contextlib.suppress(OSError):
        raw.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, _AT_ONCE)
    side.transport.abort()
