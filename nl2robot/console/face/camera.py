"""What the robot's camera sees: `GET /camera?after=7`, the next picture that is newer than that.

The answer is a JPEG or PNG with its number in the header `Picture`; 204 if none has come within two
seconds, so that a page knows when what it shows is old. A page asks for one after the other: none
is sent that nobody has room for, and the robot sends none when nobody asks. Operators alone look
through it, for it sees patients. Nothing is kept.
"""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Callable
from typing import Final

from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route

from nl2robot.console.visitor import visitor_of
from nl2robot.station.part import Backstage, Part
from robot_api.capabilities.camera import Camera
from robot_api.errors import RobotError

PATIENCE: Final = 2.0
"""Seconds to wait for a picture."""
LEFT_AFTER: Final = 5.0
"""Seconds after which who has not asked again looks no more."""
LARGEST: Final = 8_000_000
"""Bytes; a larger picture is left out."""
_KINDS: Final = {b"\xff\xd8\xff": "image/jpeg", b"\x89PNG": "image/png"}
"""By their first bytes. A browser is sent nothing else, whatever the robot calls it."""


class Viewer:
    """Looks through the camera for all pages that ask, and lets go of it when none does.

    `now` tells seconds."""

    def __init__(self, camera: Camera, now: Callable[[], float] = time.monotonic) -> None:
        self._camera = camera
        self._now = now
        self._lock = threading.Lock()  # for what follows
        self._leave: Callable[[], None] | None = None
        self._asked = 0.0
        self._number = 0
        self._picture = b""
        self._waiting: set[tuple[asyncio.AbstractEventLoop, asyncio.Event]] = set()

    async def newer(self, number: int, patience: float = PATIENCE) -> tuple[int, bytes] | None:
        """The newest picture and its number, if it is newer than that one or becomes so within so
        many seconds. Raises `LostConnection`."""
        if self._begins():
            try:
                leave = await run_in_threadpool(self._camera.watch, self._take)
            except BaseException:
                self._leave = None
                raise
            with self._lock:
                self._leave = leave
        waiting = asyncio.get_running_loop(), asyncio.Event()
        with self._lock:
            if self._number != number and self._picture:
                return self._number, self._picture
            self._waiting.add(waiting)
        try:
            await asyncio.wait_for(waiting[1].wait(), patience)
        except TimeoutError:
            return None
        finally:
            with self._lock:
                self._waiting.discard(waiting)
        return self._number, self._picture

    def close(self) -> None:
        """Look no more."""
        with self._lock:
            leave, self._leave, self._picture = self._leave, None, b""
        if leave is not None:
            leave()

    def _begins(self) -> bool:
        """Somebody asks; True for who has to begin to look."""
        with self._lock:
            self._asked = self._now()
            if self._leave is not None:
                return False
            self._leave = _nothing_yet
            return True

    def _take(self, picture: bytes) -> None:
        """In a thread of the camera's."""
        if self._now() - self._asked > LEFT_AFTER:
            # Not in this thread, which may be the one that would have to answer.
            threading.Thread(target=self.close, name="camera left", daemon=True).start()
            return
        if len(picture) > LARGEST or kind_of(picture) is None:
            return
        with self._lock:
            self._number += 1
            self._picture = picture
            for loop, event in self._waiting:
                loop.call_soon_threadsafe(event.set)
            self._waiting.clear()


def _nothing_yet() -> None:
    """Stands for what ends the looking while that begins."""


def kind_of(picture: bytes) -> str | None:
    """Its media type, if it is one that is shown."""
    return next((kind for begin, kind in _KINDS.items() if picture.startswith(begin)), None)


def part(backstage: Backstage) -> Part:
    if backstage.camera is None:
        return Part()
    viewer = Viewer(backstage.camera)

    async def look(request: Request) -> Response:
        if not visitor_of(request).operates:
            return _told(403, "Only operators look through the robot's camera.")
        after = request.query_params.get("after", "0")
        try:
            found = await viewer.newer(int(after) if after.isascii() and after.isdigit() else 0)
        except RobotError as error:
            return _told(503, str(error))
        if found is None:
            return Response(status_code=204, headers=_UNKEPT)
        number, picture = found
        return Response(picture, 200, {**_UNKEPT, "Picture": str(number)}, kind_of(picture))

    return Part(routes=[Route("/camera", look)], close=viewer.close)


_UNKEPT: Final = {"Cache-Control": "no-store", "X-Content-Type-Options": "nosniff"}


def _told(status: int, sentence: str) -> Response:
    return PlainTextResponse(sentence + "\n", status, _UNKEPT)
