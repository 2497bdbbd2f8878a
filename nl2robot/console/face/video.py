"""Video calls between the robot's face and an operator's page: who rings whom, and who answers.

Picture and sound go from page to page (WebRTC); only what the two need to find each other goes over
the robot's wire, through here. There is one call at a time, as the robot has one face.

    ringing -> answered -> ended          the event "call.state", to each page that it concerns

Who goes from page to page of the console stays in the call: a page that is gone may come back as
another one within `RETURNS_WITHIN`, with the key that only its browser knows, and the two connect
anew. Meanwhile the other side is told that it is `away`.
"""

from __future__ import annotations

import hmac
import itertools
import secrets
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Final, Literal

from nl2robot.wire import an_object, schema_of
from robot_api.driver import StopFlag
from robot_api.errors import NotPossible, TimedOut
from robot_api.server import Context, Publish, Service

RINGS_FOR: Final = 30.0
"""Seconds that somebody has to answer."""
RETURNS_WITHIN: Final = 8.0
"""Seconds that a page that is gone has to come back."""
LONGEST_SIGNAL: Final = 100_000

Side = Literal["face", "operator"]
Ending = Literal["hung_up", "declined", "nobody", "lost", "elsewhere", "no_way"]

EVENTS: Final = {
    "call.state": "call, state (ringing | calling | answered | away | ended), caller (face |"
    " operator), who; offers, if answered: whether this page makes the first offer; key, if calling"
    " or answered: to come back with, as another page; because, if ended",
    "call.signal": "call, signal: what the other side's WebRTC connection has to say",
}


@dataclass(eq=False)
class _Call:
    number: int
    caller: Side
    who: str
    """Whom the robot calls, or who calls the robot."""
    pages: dict[Side, str | None]
    """The two pages that talk, by the names of their connections."""
    ringing: set[str]
    """The pages that ring."""
    over: Callable[[], None]
    """Called when it has ended."""
    because: Ending | None = None
    answered: bool = False
    settled: threading.Event = field(default_factory=threading.Event)
    """It is answered, or it has ended."""
    patience: threading.Timer | None = None
    keys: dict[Side, str] = field(default_factory=dict)
    """What a page proves with that it is the one that talked."""
    away: dict[Side, threading.Timer] = field(default_factory=dict)
    """The sides that are between two pages, each with the end of patience."""
    alone: threading.Timer | None = None
    """The end of patience while no page rings, for one was left that did."""

    def other(self, page: str) -> str | None:
        """The page that this one talks to."""
        face, operator = self.pages["face"], self.pages["operator"]
        if not self.answered or page not in (face, operator):
            return None
        return operator if page == face else face


class Calls:
    """Any thread may call any of it."""

    def __init__(
        self,
        publish: Publish,
        rings_for: float = RINGS_FOR,
        returns_within: float = RETURNS_WITHIN,
    ) -> None:
        self._publish = publish
        self._rings_for = rings_for
        self._returns_within = returns_within
        self._numbers = itertools.count(1)
        self._lock = threading.RLock()  # for what follows
        self._ready: dict[str, Side] = {}
        self._call: _Call | None = None

    # --- the robot calls

    def ring(self, stop: StopFlag, contact: str, face: str, over: Callable[[], None]) -> bool:
        """See `Tablet.ring`; the call is made at this face."""
        with self._lock:
            operators = self._pages("operator")
            if not operators or self._ready.get(face) != "face":
                return False
            call = self._begin("face", contact, face, operators, over)
        stop.on_set(call.settled.set)
        call.settled.wait()
        if stop.is_set():
            self._end(call, "hung_up")
            stop.check()
        if call.answered:
            return True
        if call.because == "declined":
            raise NotPossible(f"{contact} declined the call. Try again later, or call another.")
        if call.because == "nobody":
            raise TimedOut(
                f"Nobody answered for {self._rings_for:g} seconds. Try again later, or call"
                " another."
            )
        raise NotPossible("The call was ended before anybody answered. Call again.")

    def hang_up(self) -> None:
        """End the call, if there is one."""
        with self._lock:
            if self._call is not None:
                self._end(self._call, "hung_up")

    # --- the pages

    def services(self) -> dict[str, Service]:
        number = {"type": "integer", "minimum": 1}
        return {
            "call.ready": Service(
                lambda p, context: self._came(
                    context.connection, "face" if context.role == "face" else p["side"]
                ),
                an_object({"side": {"enum": ["face", "operator"]}}, "side"),
                "Let this page be rung up, as the robot's face or as an operator's.",
                right="face",
                result=schema_of(None),
            ),
            "call.start": Service(
                lambda p, context: self._start(context.connection, p["who"]),
                an_object({"who": {"type": "string", "minLength": 1, "maxLength": 200}}, "who"),
                "Call the robot: its faces ring.",
                result=schema_of(int),
            ),
            "call.answer": Service(
                lambda p, context: self._answer(context.connection, p["call"]),
                an_object({"call": number}, "call"),
                "Take the call that rings here; the result says whether it still rang.",
                right="face",
                result=schema_of(bool),
            ),
            "call.resume": Service(
                lambda p, context: self._came_back(context.connection, p["call"], p["key"]),
                an_object(
                    {"call": number, "key": {"type": "string", "maxLength": 100}}, "call key"
                ),
                "Go on with a call that another page of this browser was in; the result says"
                " whether it still is.",
                result=schema_of(bool),
            ),
            "call.end": Service(
                self._left_off,
                an_object(
                    {"call": number, "because": {"enum": ["hung_up", "lost", "no_way"]}}, "call"
                ),
                "End the call, or decline the one that rings here.",
                right="face",
                result=schema_of(None),
            ),
            "call.signal": Service(
                self._passed_on,
                an_object({"call": number, "signal": {"type": "object"}}, "call signal"),
                "Tell the other side's WebRTC connection something.",
                right="face",
                result=schema_of(None),
            ),
        }

    def left(self, page: str) -> None:
        """A page is gone."""
        with self._lock:
            self._ready.pop(page, None)
            call = self._call
            if call is None:
                return
            side = next((side for side, there in call.pages.items() if there == page), None)
            if side is not None:
                self._wait_for(call, side)
            elif page in call.ringing:
                call.ringing.discard(page)
                if not call.ringing:  # the next page rings, too
                    call.alone = self._later(self._nobody_rings, call)

    def close(self) -> None:
        self.hang_up()

    def _came(self, page: str, side: Side) -> None:
        """A page that is opened while it rings rings, too."""
        with self._lock:
            self._ready[page] = side
            call = self._call
            if call is not None and not call.answered and call.caller != side:
                call.ringing.add(page)
                self._tell(call, page, "ringing")

    def _came_back(self, page: str, number: int, key: str) -> bool:
        with self._lock:
            call = self._call
            if call is None or call.number != number:
                return False
            sides = (s for s, known in call.keys.items() if hmac.compare_digest(known, key))
            side = next(sides, None)
            if side is None:
                return False
            waiting = call.away.pop(side, None)
            if waiting is not None:
                waiting.cancel()
            before, call.pages[side] = call.pages[side], page
            if before is not None and before != page:  # in another window
                self._tell(call, before, "ended", because="elsewhere")
            call.ringing.discard(page)
            if call.away:
                return True  # the other side is on its way, too, and then they connect
            if not call.answered:
                self._tell(call, page, "calling", key=key)
            else:
                self._connect(call, offers=side)
            return True

    def _start(self, page: str, who: str) -> int:
        with self._lock:
            if self._call is not None:
                raise NotPossible("The robot is in a video call. Wait until it is over.")
            faces = self._pages("face")
            if not faces:
                raise NotPossible(
                    "The robot's face is not open anywhere. Open the page /face on its tablet."
                )
            return self._begin("operator", who, page, faces, _nothing).number

    def _answer(self, page: str, number: int) -> bool:
        with self._lock:
            call = self._call
            if call is None or call.number != number or page not in call.ringing:
                return False
            called: Side = "operator" if call.caller == "face" else "face"
            call.pages[called] = page
            call.answered = True
            others, call.ringing = call.ringing - {page}, set()
            for other in others:
                self._tell(call, other, "ended", because="elsewhere")
            call.keys[called] = secrets.token_urlsafe(16)
            if call.caller not in call.away:
                self._connect(call, offers=call.caller)
            self._settle(call)
            return True

    def _left_off(self, parameters: Mapping[str, Any], context: Context) -> None:
        page, because = context.connection, parameters.get("because", "hung_up")
        with self._lock:
            call = self._call
            if call is None or call.number != parameters["call"]:
                return
            if page in call.pages.values():
                self._end(call, because)
            elif page in call.ringing:
                self._rings_no_more(call, page, "declined")

    def _passed_on(self, parameters: Mapping[str, Any], context: Context) -> None:
        with self._lock:
            call = self._call
            if call is None or call.number != parameters["call"]:
                return
            other = call.other(context.connection)
        if other is not None:
            self._publish("call.signal", dict(parameters), other)

    # --- inside

    def _connect(self, call: _Call, offers: Side) -> None:
        """The two connect to each other. One side makes the offer, when the other is sure to
        listen."""
        for side in sorted(call.pages, key=lambda side: side == offers):
            key = call.keys[side]
            self._tell(call, call.pages[side], "answered", offers=side == offers, key=key)

    def _wait_for(self, call: _Call, side: Side) -> None:
        """The page of this side is gone; perhaps to come back as another one."""
        call.pages[side] = None
        call.away[side] = self._later(self._stayed_away, call, side)
        for other, page in call.pages.items():
            if other != side:
                self._tell(call, page, "away")

    def _stayed_away(self, call: _Call, side: Side) -> None:
        with self._lock:
            if side in call.away:
                self._end(call, "lost")

    def _nobody_rings(self, call: _Call) -> None:
        with self._lock:
            if not call.ringing and not call.answered:
                self._end(call, "nobody")

    def _later(self, act: Callable[..., None], *arguments: Any) -> threading.Timer:
        timer = threading.Timer(self._returns_within, act, arguments)
        timer.daemon = True
        timer.start()
        return timer

    def _pages(self, side: Side) -> set[str]:
        return {page for page, its_side in self._ready.items() if its_side == side}

    def _begin(
        self, caller: Side, who: str, page: str, ringing: set[str], over: Callable[[], None]
    ) -> _Call:
        if self._call is not None:
            raise NotPossible("The robot is in a video call. Wait until it is over.")
        pages: dict[Side, str | None] = {"face": None, "operator": None, caller: page}
        call = _Call(next(self._numbers), caller, who, pages, set(ringing), over)
        call.keys[caller] = secrets.token_urlsafe(16)
        self._call = call
        self._tell(call, page, "calling", key=call.keys[caller])
        for other in ringing:
            self._tell(call, other, "ringing")
        call.patience = threading.Timer(self._rings_for, self._unanswered, [call])
        call.patience.daemon = True
        call.patience.start()
        return call

    def _unanswered(self, call: _Call) -> None:
        with self._lock:
            if not call.answered:
                self._end(call, "nobody")

    def _rings_no_more(self, call: _Call, page: str, because: Ending) -> None:
        """It is over only when no other page rings."""
        call.ringing.discard(page)
        self._tell(call, page, "ended", because="hung_up")
        if not call.ringing:
            self._end(call, because)

    def _end(self, call: _Call, because: Ending) -> None:
        with self._lock:
            if call.because is not None:
                return
            call.because = because
            if self._call is call:
                self._call = None
            for timer in (*call.away.values(), call.alone):
                if timer is not None:
                    timer.cancel()
            for page in {*call.ringing, *call.pages.values()}:
                self._tell(call, page, "ended", because=because)
            self._settle(call)
        # In a thread of its own: the robot may take its time, and a page that left may not.
        threading.Thread(target=call.over, name="call over", daemon=True).start()

    def _settle(self, call: _Call) -> None:
        if call.patience is not None:
            call.patience.cancel()
        call.settled.set()

    def _tell(self, call: _Call, page: str | None, state: str, **more: Any) -> None:
        if page is not None:
            about = {"call": call.number, "state": state, "caller": call.caller, "who": call.who}
            self._publish("call.state", {**about, **more}, page)


def _nothing() -> None:
    pass
