"""Pages for which something is looked up, that may take its time: a long log, a busy machine.

    @page("/runs", show)
    def runs(request: Request) -> str: ...    # in a thread of its own; `show` puts it on the page

NiceGUI waits three seconds for a page, and then shows one of its own: without STOP, in English,
and written for developers. Here people wait longer, and then read what they may do.
"""

from __future__ import annotations

import asyncio
import inspect
from collections.abc import Callable
from typing import Any, Final

from starlette.requests import Request
from starlette.responses import Response

from nl2robot.console.plain import slow

WITHIN: Final = 60.0
"""Seconds: a person who waits for a page has given up before."""
AT_LAST: Final = 10.0
"""Seconds more until NiceGUI shows its own."""

Look = Callable[..., str]


def page(path: str, show: Callable[[str], None], within: float = WITHIN) -> Callable[[Look], Look]:
    """Registers what looks something up, with the request and what is in the path, as a page."""

    def register(look: Look) -> Look:
        from nicegui import ui

        async def build(request: Request, **given: Any) -> Response | None:
            looking = asyncio.to_thread(look, request, **given)
            try:
                html = await asyncio.wait_for(looking, within)
            except TimeoutError:
                return slow(request)
            show(html)
            return None

        build.__signature__ = inspect.signature(look, eval_str=True)  # type: ignore[attr-defined]
        ui.page(path, response_timeout=within + AT_LAST)(build)
        return look

    return register
