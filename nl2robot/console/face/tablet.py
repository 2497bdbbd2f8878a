"""The pages at /face as the robot's tablet: `robot_api.capabilities.tablet.Tablet`.

Several may be open; all show the same, and whoever touches first is the one who answers. What the
program does to a page of HTML is done in one of them, the one that was touched last, where the
page's own scripts notice it; what comes of it is told to the others.
"""

from __future__ import annotations

import itertools
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

from nl2robot.console.face.video import Calls
from nl2robot.console.visitor import LANGUAGES
from robot_api.capabilities.base import Turns
from robot_api.capabilities.sound import Asked
from robot_api.capabilities.tablet import Act
from robot_api.driver import Event, StopFlag
from robot_api.errors import InvalidCall
from robot_api.server import Publish

ACT_WITHIN: Final = 2.0
"""Seconds that a face has to do something to the page it shows; after that it counts as gone."""

COMES_BACK_WITHIN: Final = 3.0
"""Seconds in which a page that is loaded anew is there again."""


@dataclass(eq=False)
class _Question:
    """What people are asked at the moment."""

    number: int
    asked: Asked
    answer: str | None = None
    over: threading.Event = field(default_factory=threading.Event)


@dataclass(eq=False)
class _Doing:
    """Something that a face is to do to the page it shows."""

    html: str | None = None
    done: threading.Event = field(default_factory=threading.Event)


class FaceTablet:
    """`changed(name, value)` is told what the faces are to show: "asking" and "screen", which is
    `content` at the beginning. `publish` sends the event "face.act" to the face that is to do
    something. `called(options, code)` is what options are called in a language, `speaks()` the
    language of the program that asks, if that is known."""

    def __init__(
        self,
        publish: Publish,
        changed: Callable[[str, Any], None],
        calls: Calls,
        content: Mapping[str, Any],
        called: Callable[[Sequence[str], str], Sequence[str]],
        speaks: Callable[[], str | None],
    ) -> None:
        self.called = called
        """See `Tablet.called`."""
        self._speaks = speaks
        self._publish = publish
        self._changed = changed
        self._calls = calls
        self._numbers = itertools.count(1)
        self._asking = Turns()
        self._lock = threading.RLock()  # for what follows
        # Each face, by the name of its connection, and whether it can be seen; the one that was
        # touched last is at the end.
        self._faces: dict[str, bool] = {}
        # When the last face that could be seen has been gone for long enough.
        self._missed_from = 0.0
        self._question: _Question | None = None
        self._doing: dict[int, _Doing] = {}
        self._content = content
        # What the robot showed, before anybody did anything to it.
        self._fresh: Mapping[str, Any] = content
        # The page as one of the faces has told it, and which.
        self._page: str | None = None
        self._teller: str | None = None

    # --- the tablet, as the robot sees it

    @property
    def connected(self) -> bool:
        """Also while a page is loaded anew."""
        return any(self._faces.values()) or time.monotonic() < self._missed_from

    helped = True
    """Somebody at the desk may answer for whoever is asked: `touched` takes it from anywhere."""

    def answer(self, stop: StopFlag, asked: Asked) -> str | None:
        """See `Tablet.answer`."""
        with self._asking.mine(stop):
            question = _Question(next(self._numbers), asked)
            stop.on_set(question.over.set)
            self._ask(question)
            try:
                question.over.wait()
            finally:
                self._ask(None)
        if question.answer is None:
            stop.check()
        return question.answer

    def page(self) -> str | None:
        """See `Tablet.page`."""
        return self._page

    def act(self, stop: StopFlag, act: Act, selector: str, text: str) -> str | None:
        """See `Tablet.act`."""
        number, doing = next(self._numbers), _Doing()
        with self._lock:
            face = self._leading()
            if face is None:
                return None
            self._doing[number] = doing
        order = {"number": number, "act": act, "selector": selector, "text": text}
        stop.on_set(doing.done.set)
        self._publish("face.act", order, face)
        doing.done.wait(ACT_WITHIN)
        with self._lock:
            del self._doing[number]
        stop.check()
        return doing.html

    def ring(self, stop: StopFlag, contact: str, over: Callable[[], None]) -> bool:
        """See `Tablet.ring`."""
        with self._lock:
            face = self._leading()
        return face is not None and self._calls.ring(stop, contact, face, over)

    def hang_up(self) -> None:
        """See `Tablet.hang_up`."""
        self._calls.hang_up()

    # --- what visitors leave there

    @property
    def typed(self) -> bool:
        """Whether somebody did something to the page that is shown."""
        return self._page is not None

    @property
    def fresh(self) -> Mapping[str, Any]:
        """What the robot showed last, as `show` takes it."""
        return {kind: self._fresh[kind] for kind in ("text", "html", "url") if kind in self._fresh}

    # --- the tablet, as its faces see it

    def came(self, face: str, visible: bool) -> None:
        """A face is open, or can be seen again, or no longer."""
        with self._lock:
            seen = self.connected
            self._faces[face] = visible
            if seen:
                self._miss()

    def left(self, face: str) -> None:
        """A face is closed."""
        with self._lock:
            if self._faces.pop(face, None):
                self._miss()

    def touched(self, face: str, number: int, answer: str) -> bool:
        """Somebody has touched or typed an answer; whether they were the first."""
        with self._lock:
            question = self._question
            if question is None or question.number != number or question.over.is_set():
                return False
            options = question.asked.options
            if options and answer not in options:
                raise InvalidCall("This is none of the buttons on the screen. Touch one of them.")
            self._leads(face)
            question.answer = answer
            question.over.set()
            return True

    def shown(self, content: Event) -> None:
        """The robot shows something else. The face that told the page need not draw it again."""
        with self._lock:
            html = content.get("html")
            by = self._teller if html is not None and html == self._page else None
            derived = by is not None
            if not derived:
                self._page = self._teller = None
                self._fresh = content
            self._show(content, by, derived)

    def told(self, face: str, page: int, html: str) -> None:
        """Somebody has done something to the page that a face shows."""
        with self._lock:
            if self._content.get("page") != page or "html" not in self._content:
                return
            self._leads(face)
            self._page, self._teller = html, face
            self._show({"html": html}, face, derived=True)

    def did(self, face: str, number: int, html: str | None) -> None:
        """A face has done what it was to do to its page, or could not."""
        with self._lock:
            doing = self._doing.get(number)
            if doing is None:
                return
            if html is not None:
                self._page, self._teller = html, face
            doing.html = html
            doing.done.set()

    # --- inside

    def _show(self, content: Event, by: str | None, derived: bool) -> None:
        """`derived`: it is the same page as before, with something done to it."""
        number = next(self._numbers)
        page = self._content["page"] if derived else number
        self._content = {**content, "number": number, "page": page, "by": by}
        self._changed("screen", self._content)

    def _ask(self, question: _Question | None) -> None:
        language = self._speaks() if question is not None else None
        with self._lock:
            self._question = question
            if question is None:
                self._changed("asking", None)
                return
            asked = question.asked
            options = list(asked.options) if asked.options is not None else None
            about = {
                "number": question.number,
                "question": asked.question,
                "options": options,
                "person": asked.person,
                "called": {code: list(self.called(options or (), code)) for code in LANGUAGES},
                "language": language,
            }
            self._changed("asking", about)

    def _miss(self) -> None:
        """If that was the last face, nobody can answer any more, unless it soon comes back."""
        if any(self._faces.values()):
            return
        self._missed_from = time.monotonic() + COMES_BACK_WITHIN
        timer = threading.Timer(COMES_BACK_WITHIN, self._let_go_if_alone)
        timer.daemon = True
        timer.start()

    def _let_go_if_alone(self) -> None:
        with self._lock:
            if self._question is not None and not (self.connected or self.helped):
                self._question.over.set()

    def _leads(self, face: str) -> None:
        if face in self._faces:
            self._faces[face] = self._faces.pop(face)

    def _leading(self) -> str | None:
        return next((face for face, seen in reversed(self._faces.items()) if seen), None)
