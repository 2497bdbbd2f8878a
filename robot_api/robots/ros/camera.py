"""The camera: its pictures, which are fetched while somebody looks, and the codes in them."""

from __future__ import annotations

import io
import threading
import time
from base64 import b64decode
from binascii import Error as NotBase64
from collections.abc import Callable, Mapping
from typing import Any

from robot_api.capabilities.base import POLL
from robot_api.capabilities.camera import Look
from robot_api.capabilities.scanner import Scanner
from robot_api.capabilities.speech import Speech
from robot_api.driver import StopFlag
from robot_api.robots.ros.connection import Connection, Line

_EVERY = 0.2
"""Seconds between two pictures."""


class RosCamera:
    """A `robot_api.capabilities.camera.Camera` of sensor_msgs/CompressedImage: however many look,
    the pictures come once."""

    def __init__(self, connection: Connection, topic: str, kind: str) -> None:
        self._connection = connection
        self._topic = topic
        self._kind = kind
        self._lock = threading.Lock()
        self._looks: list[Look] = []

    def watch(self, look: Look) -> Callable[[], None]:
        with self._lock:
            if not self._looks:
                self._line().subscribe(self._topic, self._kind, self._hear, _EVERY)
            self._looks.append(look)

        def end() -> None:
            with self._lock:
                if look in self._looks:
                    self._looks.remove(look)
                    if not self._looks:
                        self._line().unsubscribe(self._topic)

        return end

    def check(self) -> None:
        """Raises `LostConnection` when the robot is gone."""
        self._line().now  # noqa: B018 - raises

    def _hear(self, message: Mapping[str, Any]) -> None:
        try:
            picture = b64decode(message.get("data", ""), validate=True)
        except (TypeError, ValueError, NotBase64):
            return  # no picture: the next one may be one
        for look in tuple(self._looks):
            look(picture)

    def _line(self) -> Line:
        """Pictures are large: they have a connection of their own."""
        return self._connection.line("camera")


class RosScanner(Scanner):
    """Reads codes in the pictures of the robot's camera."""

    def __init__(self, speech: Speech | None, camera: RosCamera) -> None:
        super().__init__(speech)
        self._camera = camera

    def read_code(self, stop: StopFlag, timeout: float) -> str | None:
        newest: list[bytes] = []
        came = threading.Event()

        def look(picture: bytes) -> None:
            newest[:] = [picture]
            came.set()

        leave = self._camera.watch(look)
        end = time.monotonic() + timeout
        try:
            while time.monotonic() < end:
                stop.check()
                self._camera.check()
                if came.wait(POLL):
                    came.clear()
                    code = code_in(newest[0])
                    if code:
                        return code
            return None
        finally:
            leave()


def code_in(data: bytes) -> str | None:
    """What the first code in a picture says, a JPEG or PNG; None if there is none."""
    import zxingcpp
    from PIL import Image, UnidentifiedImageError

    try:
        picture = Image.open(io.BytesIO(data)).convert("L")
    except (ValueError, OSError, UnidentifiedImageError):
        return None
    found = zxingcpp.read_barcodes(picture)
    return str(found[0].text) if found else None
