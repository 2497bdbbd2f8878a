"""Screen: `show`, `click`, `type_text`, `read_text`, `touch`."""

from __future__ import annotations

import threading
import time
from abc import abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from robot_api.capabilities.base import Capability, Hub, Turns
from robot_api.capabilities.emulation import InEmulation
from robot_api.capabilities.page import Page
from robot_api.capabilities.simulation import InSimulation
from robot_api.capabilities.sound import Asked
from robot_api.capabilities.tablet import Act, answered, patience
from robot_api.driver import StopFlag
from robot_api.errors import InvalidCall, NotFound, TimedOut

if TYPE_CHECKING:
    from robot_api.capabilities.speech import Speech
    from sim.simulation import Simulation

Content = dict[str, Any]
"""What the screen shows, as the event "screen" says it: text, html, url, or options with text."""

TOUCH_TIMEOUT = 30.0
"""Seconds that somebody has to touch one of the buttons."""
_LOOKS_EVERY = 0.1
"""Seconds between two looks whether a tablet has come."""


class Screen(Capability):
    """A touchscreen whose pages are kept here, without a browser; a real tablet, if there is one,
    shows them and tells what people did to them."""

    name = "screen"
    lacking = "has no screen"

    def __init__(self, speech: Speech | None) -> None:
        super().__init__()
        self._speech = speech
        self._content: Content = {}
        self._page: Page | None = None
        self._lock = threading.RLock()  # for the two above
        self._touching = Turns()

    @property
    def touchable(self) -> bool:
        """Whether somebody can touch it now."""
        return True

    @abstractmethod
    def display(self, content: Content) -> None:
        """Show it and tell it to those who subscribed."""

    @abstractmethod
    def touched(self, stop: StopFlag, options: Sequence[str], timeout: float) -> str | None:
        """The button that is touched within `timeout` seconds, or None."""

    def noticed(self, answer: str) -> None:
        """Tell those who subscribed what was touched or typed on a real tablet."""

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
        self._act(stop, "click", selector)

    def type_text(self, stop: StopFlag, selector: str, text: str) -> None:
        self._act(stop, "type", selector, text)

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
                touched = self._pressed(stop, options, prompt)
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
        changed = self.tablet.page()
        return self._page if changed is None else Page(changed)

    def _act(self, stop: StopFlag, act: Act, selector: str, text: str = "") -> None:
        """Do it here, where it shows whether it can be done, and on the tablet, where the page's
        own scripts notice it."""
        with self._lock:
            page = self._open_page()
            if act == "click":
                page.click(selector)
            else:
                page.type_text(selector, text)
            html = self.tablet.act(stop, act, selector, text) or page.html
            self._page = Page(html)
            self._content = {"html": html}
            self.display(self._content)

    def _pressed(self, stop: StopFlag, options: Sequence[str], prompt: str | None) -> str | None:
        """Whoever stands at a real tablet presses a button, and need not wait until the prompt is
        spoken; should the tablet go away, or be none, somebody else does."""

        def prompted(stop: StopFlag) -> None:
            if prompt and self._speech is not None:
                self._speech.say(stop, prompt)

        def by_others(stop: StopFlag) -> str | None:
            prompted(stop)
            return self.touched(stop, options, TOUCH_TIMEOUT)

        def meanwhile(stop: StopFlag) -> None:
            prompted(stop)
            patience(stop, self.tablet, TOUCH_TIMEOUT)

        asked = Asked(self._language(), prompt, options)
        if not self.tablet.connected:
            if not self.tablet.helped:
                return by_others(stop)
            touched, others = answered(stop, self.tablet, asked, by_others)
            if touched is not None:
                self.noticed(touched)
            return touched if touched is not None else others
        touched, _ = answered(stop, self.tablet, asked, meanwhile)
        if touched is not None:
            self.noticed(touched)
        elif not self.tablet.connected:
            return self.touched(stop, options, TOUCH_TIMEOUT)
        return touched

    def _language(self) -> str:
        return self._speech.language if self._speech is not None else "en"


class EmulatedScreen(InEmulation, Screen):
    """Somebody touches the canned answers in their order, then the first button."""

    def display(self, content: Content) -> None:
        self.emulation.publish("screen", **content)

    def noticed(self, answer: str) -> None:
        self.emulation.publish("heard", text=answer, person=None)

    def touched(self, stop: StopFlag, options: Sequence[str], timeout: float) -> str | None:
        answer = self.emulation.next_answer(options[0])
        touched = answer if answer in options else None
        self.emulation.pass_time(timeout if touched is None else 2.0, stop)
        return touched


class SimulatedScreen(InSimulation, Screen):
    def __init__(self, simulation: Simulation, speech: Speech | None) -> None:
        super().__init__(simulation, speech)
        self._content = simulation.robot.screen  # a copied simulation shows something already
        if "html" in self._content:
            self._page = Page(self._content["html"])

    def display(self, content: Content) -> None:
        self.simulation.show(content)

    def noticed(self, answer: str) -> None:
        self.simulation.emit("heard", {"text": answer, "person": None})

    def touched(self, stop: StopFlag, options: Sequence[str], timeout: float) -> str | None:
        return self.run(self.simulation.touch(options, timeout), stop)


class TabletScreen(Screen):
    """A robot that has no screen of its own: the tablet that is put beside it, if there is one. The
    server's page `/face`, on whatever it is opened, is one."""

    def __init__(self, hub: Hub, speech: Speech | None) -> None:
        super().__init__(speech)
        self._hub = hub

    @property
    def touchable(self) -> bool:
        return self.tablet.connected

    def display(self, content: Content) -> None:
        self._hub.publish("screen", **content)

    def noticed(self, answer: str) -> None:
        self._hub.publish("heard", text=answer, person=None)

    def touched(self, stop: StopFlag, options: Sequence[str], timeout: float) -> str | None:
        """There is no tablet, or it went away: perhaps it comes."""
        end = time.monotonic() + timeout
        while not self.tablet.connected and (left := end - time.monotonic()) > 0:
            stop.wait(min(_LOOKS_EVERY, left))
            stop.check()
        touched, _ = answered(
            stop,
            self.tablet,
            Asked(self._language(), None, options),
            lambda stop: patience(stop, self.tablet, end - time.monotonic()),
        )
        if touched is not None:
            self.noticed(touched)
        return touched
