"""Web pages in a loop of their own: to build one takes longer than a stop may.

An application of the wire's loop, which only hands over what comes and goes; what answers runs in
another thread's loop. The two share the processor, but neither waits for the other to come to an
end of what it is at (`sys.setswitchinterval`).
"""

from __future__ import annotations

import asyncio
import contextlib
import threading
from collections.abc import AsyncIterator, Awaitable
from typing import Final, TypeVar

from starlette.applications import Starlette
from starlette.types import ASGIApp, Message, Receive, Scope, Send

T = TypeVar("T")

ENDS_WITHIN: Final = 5.0
"""Seconds that the application has to come to its end."""


class Beside:
    """Answers what `app` would answer."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app
        self._loop: asyncio.AbstractEventLoop | None = None

    @contextlib.asynccontextmanager
    async def running(self) -> AsyncIterator[None]:
        """While this lasts, requests are answered. Raises what the application's start raises."""
        begun: asyncio.Future[asyncio.Event] = asyncio.get_running_loop().create_future()
        thread = threading.Thread(
            target=self._run, args=(asyncio.get_running_loop(), begun), name="pages", daemon=True
        )
        thread.start()
        over = await begun
        assert self._loop is not None
        try:
            yield
        finally:
            with contextlib.suppress(RuntimeError):  # it has ended by itself
                self._loop.call_soon_threadsafe(over.set)
            await asyncio.to_thread(thread.join, ENDS_WITHIN)

    def _run(self, wire: asyncio.AbstractEventLoop, begun: asyncio.Future[asyncio.Event]) -> None:
        async def until_it_is_over() -> None:
            self._loop, over = asyncio.get_running_loop(), asyncio.Event()
            async with contextlib.AsyncExitStack() as stack:
                if isinstance(self._app, Starlette):  # one that is mounted is not told by itself
                    await stack.enter_async_context(self._app.router.lifespan_context(self._app))
                wire.call_soon_threadsafe(begun.set_result, over)
                await over.wait()

        try:
            with asyncio.Runner(loop_factory=type(wire)) as runner:  # a loop of the same kind
                runner.run(until_it_is_over())
        except Exception as error:
            if begun.done():
                raise
            wire.call_soon_threadsafe(begun.set_exception, error)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        assert self._loop is not None, "nobody has begun it"
        wire = asyncio.get_running_loop()

        async def received() -> Message:
            return await _elsewhere(receive(), wire)

        async def sent(message: Message) -> None:
            await _elsewhere(send(message), wire)

        await _elsewhere(self._app(scope, received, sent), self._loop)


async def _elsewhere(work: Awaitable[T], loop: asyncio.AbstractEventLoop) -> T:
    """The result of a coroutine that another loop runs; who is cancelled here cancels it there."""
    return await asyncio.wrap_future(asyncio.run_coroutine_threadsafe(_whole(work), loop))


async def _whole(work: Awaitable[T]) -> T:
    return await work
