"""A port that takes encrypted and plain connections: what a client sends first says which it is.
It keeps room for those who have something to say.

So programs on the robot's own computer go on without a certificate, and who comes from elsewhere
without encryption is not met by silence: the application sees it (`scope["scheme"]`) and says what
to do. To uvicorn it looks like one of asyncio's servers.
"""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import socket
import ssl
from collections.abc import Callable
from typing import Final

import uvicorn

TLS_RECORD: Final = b"\x16"
"""With this begins a TLS handshake, and no request of HTTP."""
BEGINS_WITHIN: Final = 10.0
"""Seconds that a client has to send its first byte, as many again for the handshake, and as many
for the head of its first request."""
MOST_UNDECIDED: Final = 200
"""Connections that have not said yet what they want; the oldest is let go for another."""
LOOKS_AFTER: Final = (0.01, 0.02, 0.05, 0.1, 0.2)
"""Seconds between two looks whether the head of a request is complete; the last goes on."""
PAUSE: Final = 0.1
"""Seconds that are waited when this process can open no more connections."""


class TwoWayServer(uvicorn.Server):
    """A uvicorn server whose sockets are such ports."""

    def __init__(self, config: uvicorn.Config, encryption: ssl.SSLContext | None) -> None:
        """Without `encryption` all connections are plain."""
        super().__init__(config)
        self._encryption = encryption

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets=[])

        def protocol() -> asyncio.Protocol:
            made: asyncio.Protocol = self.config.http_protocol_class(  # type: ignore[call-arg]
                config=self.config, server_state=self.server_state, app_state=self.lifespan.state
            )
            return made

        ports = [_Port(each, protocol, self._encryption) for each in sockets or ()]
        self.servers.extend(ports)  # type: ignore[arg-type]

    async def on_tick(self, counter: int) -> bool:
        try:
            return await super().on_tick(counter)
        except (ValueError, OverflowError, OSError):
            # Somebody has set the clock beyond all years, for which there is no date header.
            return self.should_exit


class _Port:
    """One listening socket; to be made in the loop thread."""

    def __init__(
        self,
        listening: socket.socket,
        protocol: Callable[[], asyncio.Protocol],
        encryption: ssl.SSLContext | None,
    ) -> None:
        listening.setblocking(False)
        self._listening = listening
        self._protocol = protocol
        self._encryption = encryption
        # Those that are not connected yet, the oldest first.
        self._beginning: dict[asyncio.Task[None], None] = {}
        self._accepting = asyncio.create_task(self._accept())

    def close(self) -> None:
        self._accepting.cancel()
        for each in tuple(self._beginning):
            each.cancel()

    async def wait_closed(self) -> None:
        with contextlib.suppress(asyncio.CancelledError):
            await self._accepting

    async def _accept(self) -> None:
        loop = asyncio.get_running_loop()
        while True:
            try:
                connection, _ = await loop.sock_accept(self._listening)
            except OSError:  # such as too many open files
                await asyncio.sleep(PAUSE)
                continue
            if len(self._beginning) >= MOST_UNDECIDED:
                next(iter(self._beginning)).cancel()
            task = asyncio.create_task(self._begin(connection))
            self._beginning[task] = None
            task.add_done_callback(lambda task: self._beginning.pop(task, None))

    async def _begin(self, connection: socket.socket) -> None:
        close = connection.close
        try:
            async with asyncio.timeout(BEGINS_WITHIN):
                first = await _peek(connection)
            if first:
                encrypted = first == TLS_RECORD and self._encryption is not None
                transport, protocol = await asyncio.get_running_loop().connect_accepted_socket(
                    self._protocol,
                    connection,
                    ssl=self._encryption if encrypted else None,
                    ssl_handshake_timeout=BEGINS_WITHIN if encrypted else None,
                )
                close = transport.abort
                async with asyncio.timeout(BEGINS_WITHIN):
                    await _asked(transport, protocol)
                return
        except (OSError, TimeoutError):
            pass  # it left, is silent, or does not trust the certificate
        except asyncio.CancelledError:
            close()
            raise
        close()


async def _asked(transport: asyncio.Transport, protocol: asyncio.BaseProtocol) -> None:
    """Wait until the head of the first request has come, or the other side has left."""
    pauses = itertools.chain(LOOKS_AFTER, itertools.repeat(LOOKS_AFTER[-1]))
    while not (
        transport.is_closing()
        or transport.get_protocol() is not protocol  # that of a WebSocket from now on
        or getattr(protocol, "cycle", None) is not None  # uvicorn answers a request
    ):
        await asyncio.sleep(next(pauses))


async def _peek(connection: socket.socket) -> bytes:
    """The first byte that comes, left where it is; nothing if the other side has closed."""
    connection.setblocking(False)
    loop = asyncio.get_running_loop()
    there = asyncio.Event()
    loop.add_reader(connection, there.set)
    try:
        await there.wait()
    finally:
        loop.remove_reader(connection)
    return connection.recv(1, socket.MSG_PEEK)
