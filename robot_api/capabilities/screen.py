"""Screen: `show`, `click`, `type_text`, `read_text`, `touch`."""

from __future__ import annotations

import threading
from abc import abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from robot_api.capabilities.base import Capability, Turns
from robot_api.capabilities.page import Page
from robot_api.capabilities.simulation import InSimulation
from robot_api.driver import StopFlag
from robot_api.errors import InvalidCall, NotFound, TimedOut

if TYPE_CHECKING:
    from robot_api.capabilities.emulation import Emulation
    from robot_api.capabilities.speech import Speech
    from sim.simulation import Simulation

Content = dict[str, Any]
"""What the screen shows, as the event "screen" says it: text, html, url, or options with text."""

TOUCH_TIMEOUT = 30.0
"""Seconds that somebody has to touch one of the buttons."""


class Screen(Capability):
    """A touchscreen whose pages are kept here, without a browser."""

    name = "screen"
    lacking = "has no screen"
    touchable = True

    def __init__(self, speech: Speech | None) -> None:
        super().__init__()
        self._speech = speech
        self._content: Content = {}
        self._page: Page | None = None
        self._lock = threading.RLock()  # for the two above
        self._touching = Turns()

    @abstractmethod
    def display(self, content: Content) -> None:
        """Show it and tell it to those who subscribed."""

    @abstractmethod
    def touched(self, stop: StopFlag, options: Sequence[str], timeout: float) -> str | None:
        """The button that is touched within `timeout` seconds, or None."""

    def show(self, stop: StopFlag, text: str | None, html: str | None, url: str | None) -> None:
        given = {"text": text, "html": html, "url": url}
        content = {kind: what for kind, what in given.items() if what is not None}
        if len(content) > 1:
            raise InvalidCall(
                "The screen shows one thing at a time. Give it a text, a page or an address."
            )
        with self._lock:
            self._content = content or {"text": ""}
            self._page = Page(html) if html is not None else None
            self.display(self._content)

    def click(self, stop: StopFlag, selector: str) -> None:
        with self._lock:
            self._open_page().click(selector)
            self._redraw()

    def type_text(self, stop: StopFlag, selector: str, text: str) -> None:
        with self._lock:
            self._open_page().type_text(selector, text)
            self._redraw()

    def read_text(self, stop: StopFlag, selector: str) -> str:
        with self._lock:
            return self._open_page().read_text(selector)

    def touch(self, stop: StopFlag, options: list[str], prompt: str | None) -> str:
        """Shows the buttons, then what was on the screen before."""
        with self._touching.mine(stop):
            content: Content = {"options": list(options)}
            if prompt:
                content["text"] = prompt
            self.display(content)
            try:
                if prompt and self._speech is not None:
                    self._speech.say(stop, prompt)
                touched = self.touched(stop, options, TOUCH_TIMEOUT)
            finally:
                with self._lock:
                    self.display(self._content or {"text": ""})
        if touched is None:
            raise TimedOut(
                f"Nobody touched the screen for {TOUCH_TIMEOUT:g} seconds. "
                "Ask again when somebody is there."
            )
        return touched

    def _open_page(self) -> Page:
        if self._page is None:
            raise NotFound(
                "The web page is not opened here, only its address is shown. Show a page of HTML."
                if "url" in self._content
                else "There is no page on the screen. Show a page of HTML first."
            )
        return self._page

    def _redraw(self) -> None:
        self._content = {"html": self._open_page().html}
        self.display(self._content)


class EmulatedScreen(Screen):
    """Somebody touches the canned answers in their order, then the first button."""

    def __init__(self, emulation: Emulation, speech: Speech | None) -> None:
        super().__init__(speech)
        self._emulation = emulation

    def display(self, content: Content) -> None:
        self._emulation.publish("screen", **content)

    def touched(self, stop: StopFlag, options: Sequence[str], timeout: float) -> str | None:
        answer = self._emulation.next_answer(options[0])
        touched = answer if answer in options else None
        self._emulation.pass_time(timeout if touched is None else 2.0, stop)
        return touched


class SimulatedScreen(InSimulation, Screen):
    def __init__(self, simulation: Simulation, speech: Speech | None) -> None:
        super().__init__(simulation, speech)
        self._content = simulation.robot.screen  # a copied simulation shows something already
        if "html" in self._content:
            self._page = Page(self._content["html"])

    def display(self, content: Content) -> None:
        self.simulation.show(content)

    def touched(self, stop: StopFlag, options: Sequence[str], timeout: float) -> str | None:
        return self.run(self.simulation.touch(options, timeout), stop)
