"""Pepper's tablet: `show`, `touch` and the pages of a program, or this server's page `/face`.

With a face page the tablet is a browser like any other: the page learns by itself what it is to
show, and tells what is touched (`robot_api.capabilities.tablet`). Without one, texts, pages and
buttons are sent to the tablet as pages of their own, and what is touched comes back over `qi`.
"""

from __future__ import annotations

import base64
import queue
import time
import uuid
from collections.abc import Sequence
from contextlib import suppress
from html import escape
from typing import Final

from robot_api.capabilities.base import POLL, Hub
from robot_api.capabilities.screen import Content, Screen
from robot_api.capabilities.speech import Speech
from robot_api.driver import StopFlag
from robot_api.errors import NotPossible, RobotError
from robot_api.robots.pepper.line import Line
from robot_api.robots.pepper.session import Wire

_SHOWS_WITHIN: Final = 5.0
"""Seconds that the tablet may take to show a page: it is slow."""
_STYLE: Final = (
    "body{margin:0;min-height:100vh;display:flex;flex-direction:column;justify-content:center;"
    "font:48px/1.3 sans-serif;text-align:center;background:#10222e;color:#fff}"
    "p{margin:32px}button{margin:12px 80px;padding:24px;font:inherit;border:0;border-radius:16px;"
    "background:#8fe3ff;color:#10222e}"
)


class PepperScreen(Screen):
    def __init__(self, wire: Wire, speech: Speech | None, hub: Hub, face_page: str | None) -> None:
        super().__init__(speech)
        self._wire = wire
        self._hub = hub
        self._face_page = face_page
        self._touches: queue.SimpleQueue[str] = queue.SimpleQueue()
        self._question = ""  # what its buttons begin with when they tell that they were touched

    def begin(self) -> None:
        """Take the tablet. Raises a `RobotError`."""
        self._wire.each_time(self._take)

    def _take(self, line: Line) -> None:
        if self._face_page is not None:
            line.call("ALTabletService", "showWebview", self._face_page, within=_SHOWS_WITHIN)
        else:
            line.listen("ALTabletService", "onJSEvent", self._touches.put)

    def display(self, content: Content) -> None:
        self._hub.publish("screen", **content)
        if self._face_page is None:
            self._load(self._page_of(content))

    def noticed(self, answer: str) -> None:
        self._hub.publish("heard", text=answer, person=None)

    def touched(self, stop: StopFlag, options: Sequence[str], timeout: float) -> str | None:
        end = time.monotonic() + timeout
        while time.monotonic() < end:
            stop.check()
            self._wire.check()
            try:
                told = self._touches.get(timeout=POLL)
            except queue.Empty:
                continue
            question, _, which = told.partition(" ")
            if question == self._question and which.isdigit() and int(which) < len(options):
                self.noticed(options[int(which)])
                return options[int(which)]
        return None

    def close(self) -> None:
        """Give the tablet back to the robot."""
        with suppress(RobotError):
            self._wire.call("ALTabletService", "hideWebview", within=_SHOWS_WITHIN)

    def _page_of(self, content: Content) -> str:
        """The address of a page with that content."""
        if "url" in content:
            return str(content["url"])
        if "html" in content:
            return _as_address(str(content["html"]))
        text = "".join(
            f"<p>{escape(line)}</p>" for line in str(content.get("text", "")).split("\n")
        )
        self._question = uuid.uuid4().hex
        buttons = "".join(
            f"<button onclick=\"ALTabletBinding.raiseEvent('{self._question} {number}')\">"
            f"{escape(option)}</button>"
            for number, option in enumerate(content.get("options", ()))
        )
        return _as_address(
            '<!doctype html><html><head><meta charset="utf-8">'
            f"<style>{_STYLE}</style></head><body>{text}{buttons}</body></html>"
        )

    def _load(self, address: str) -> None:
        shown = self._wire.call("ALTabletService", "showWebview", address, within=_SHOWS_WITHIN)
        if shown is False:
            raise NotPossible("My tablet shows nothing. Switch it on, or start me again.")


def _as_address(html: str) -> str:
    return "data:text/html;charset=utf-8;base64," + base64.b64encode(html.encode()).decode()
