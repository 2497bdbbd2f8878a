"""What one robot of a fleet hears and says, put together. Without sockets, threads and sleeps:
bytes go in with the time, bytes come out.

What is heard and believed is handed to the roll, the dispatcher, the performer, the stops and the
zones; what has to be said is said by `tick`, which is called several times a second.
"""

from __future__ import annotations

import logging
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, Protocol

import msgspec

from nl2robot.fleet.book import Errand, FleetBook
from nl2robot.fleet.dispatcher import Dispatcher
from nl2robot.fleet.messages import (
    About,
    Answer,
    Order,
    Plans,
    Standing,
    Stop,
    Stopped,
    ZoneEntry,
    Zones,
    packed,
    unpacked,
)
from nl2robot.fleet.plans import SharedPlans
from nl2robot.fleet.roll import Member, Roll
from nl2robot.fleet.sealing import NotBelieved, Opened, Opener, Sealed, Sealer
from nl2robot.fleet.stopping import Stops
from nl2robot.fleet.zones import SharedZones

STATE_EVERY: Final = 1.0
"""Seconds between two words from a robot that does nothing."""
STATE_SOONEST: Final = 0.2
"""Seconds between two words from one that moves."""
ABOUT_EVERY: Final = 30.0
ASKS_EVERY: Final = 0.5
"""Seconds between two questions for what somebody has not told."""
_log = logging.getLogger(__name__)


class Send(Protocol):
    """Give bytes to the network: to one robot, or to all of them if `to` is empty."""

    def __call__(self, to: str, raw: bytes, *, urgent: bool) -> None: ...


@dataclass(frozen=True, kw_only=True)
class Deeds:
    """What the robot does for its fleet, none of which may keep the caller waiting."""

    ordered: Callable[[str, Order], None]
    """Answer an order of that sender, some time."""
    stopped: Callable[[str, Stop], None]
    """Stop the robot for that sender, and say whether it stands."""
    zoned: Callable[[list[ZoneEntry]], None] = lambda entries: None
    """Draw and remove these keep-out zones."""
    changed: Callable[[Errand], None] = lambda errand: None
    """An errand of this dispatcher stands another way."""
    planned: Callable[[], None] = lambda: None
    """Something of the fleet's appointments is another."""


class Hub:
    """One robot in its fleet. One thread at a time may use it."""

    def __init__(
        self,
        *,
        book: FleetBook,
        key: bytes,
        about: About,
        standing: Callable[[], Standing],
        where: Callable[[str], tuple[float, float] | None],
        send: Send,
        deeds: Deeds,
        sign: Callable[[str, Order], Order] = lambda robot, order: order,
        session: str | None = None,
        clock: Callable[[], float] = time.time,
    ) -> None:
        """`sign` puts this station's signature under an order for the robot of that id."""
        self.me = book.robot
        self.book = book
        self.about = about
        self._standing = standing
        self._send = send
        self.deeds = deeds
        self._sign = sign
        self.sealer = Sealer(key, self.me, session)
        self._opener = Opener(key, self.me)
        self.roll = Roll()
        self.dispatcher = Dispatcher(
            book, self.roll, about.map, where, self._say_order, deeds.changed, clock
        )
        self.stops = Stops(lambda robot, stop: self.say("stop", stop, robot))
        self.zones = SharedZones(book, self.me, about.map)
        self.plans = SharedPlans(book, self.me, about.name)
        self.doubled = False
        """Whether another robot was heard that goes by this one's id: its data folder was copied,
        and with it what it has planned."""
        self.refused: Counter[str] = Counter()
        """What was not believed, by why."""
        self.bytes_sent = 0
        self._said: Standing | None = None
        self._said_at = float("-inf")
        self._about_at = float("-inf")
        self._asked_at = float("-inf")
        self._zones_owed = False
        self._zones_at = float("-inf")
        self._warned: set[str] = set()

    # --- in

    def hear(self, raw: bytes, now: float) -> None:
        """Something came from the network."""
        try:
            opened = self._opener.open(raw)
        except NotBelieved as error:
            self._doubt(error, now)
            return
        try:
            if opened.kind == "proof":
                self._greeted(opened, now)
                return
            if opened.kind == "who":
                self._answer_challenge(opened.sender, opened.payload)
                return
            if opened.kind == "tell":
                self.say("about", self.about, opened.sender)
                return
            if opened.kind == "plan":
                if self.plans.mine is not None:
                    self.say("plans", self.plans.mine, opened.sender)
                return
            message = unpacked(opened.kind, opened.payload)
        except (msgspec.MsgspecError, KeyError):
            self.refused["garbled"] += 1
            return
        self._understood(opened, message, now)

    def gone(self, robot: str, session: str) -> None:
        """The network says that a robot is gone."""
        self.roll.leaves(robot, session)

    # --- out

    def tick(self, now: float) -> None:
        """Say what is to be said by now."""
        if now - self._about_at >= ABOUT_EVERY:
            self._about_at = now
            self.say("about", self.about)
        self._say_state(now)
        self._ask_about(now)
        if self._zones_owed and now - self._zones_at >= ASKS_EVERY:
            self._zones_owed, self._zones_at = False, now
            self.say("zones", self.zones.message)
        self.note_self(now)
        self.dispatcher.tick(now)
        self.stops.tick(now)

    def say(self, kind: str, message: msgspec.Struct, to: str = "") -> None:
        """Seal it and send it. What is for this robot itself does not leave it."""
        if to == self.me:
            opened = Opened(self.me, self.sealer.session, 0, kind, b"")
            self._understood(opened, message, self._said_at)
            return
        self._put(kind, packed(message), to)

    def tell_zones(self) -> None:
        """The zones that are drawn here have changed."""
        self._zones_owed = True

    def note_self(self, now: float) -> None:
        """This robot is on its own roll, as the others have it on theirs."""
        mine = self.roll.greet(self.me, self.sealer.session, now)
        mine.about, mine.standing = self.about, self._said

    # --- inside

    def _put(self, kind: str, payload: bytes, to: str) -> None:
        raw = self.sealer.seal(kind, payload, to)
        self.bytes_sent += len(raw)
        self._send(to, raw, urgent=kind in ("stop", "stopped"))

    def _say_order(self, robot: str, order: Order) -> None:
        self.say("order", self._sign(robot, order), robot)

    def _say_state(self, now: float) -> None:
        since = now - self._said_at
        if since < STATE_SOONEST:
            return
        standing = msgspec.structs.replace(
            self._standing(), zones=self.zones.digest, plans=self.plans.digest
        )
        if standing == self._said and since < STATE_EVERY:
            return
        self._said, self._said_at = standing, now
        self.say("state", standing)

    def _doubt(self, error: NotBelieved, now: float) -> None:
        sealed = error.sealed
        if error.trouble == "own" and sealed is not None:
            if sealed.session != self.sealer.session:
                self.doubled = True
                self._warn(
                    "Another robot of the fleet has this robot's id: its data folder was copied."
                    " Remove fleet.sqlite from one of the two folders, and start that robot again."
                )
            return
        if error.trouble == "other":
            return
        self.refused[error.trouble] += 1
        if error.trouble == "unproven" and sealed is not None:
            self._ask_who(sealed, now)

    def _ask_who(self, sealed: Sealed, now: float) -> None:
        # Its challenge is answered before it is known: two newcomers would wait for each other.
        if sealed.kind == "who":
            self._answer_challenge(sealed.sender, sealed.payload)
        nonce = self._opener.challenge(sealed, now)
        if nonce is not None:
            self._put("who", nonce, sealed.sender)

    def _answer_challenge(self, sender: str, nonce: bytes) -> None:
        self._put("proof", nonce, sender)

    def _greeted(self, opened: Opened, now: float) -> None:
        """A newcomer: it is told at once what it would else wait for."""
        self.roll.greet(opened.sender, opened.session, now)
        self.say("about", self.about, opened.sender)
        if self._said is not None:
            self.say("state", self._said, opened.sender)

    def _ask_about(self, now: float) -> None:
        """Those who told it before we believed them."""
        if now - self._asked_at < ASKS_EVERY:
            return
        self._asked_at = now
        for each in self.roll.members.values():
            if each.about is None and each.id != self.me and not each.left:
                self._put("tell", b"", each.id)

    def _understood(self, opened: Opened, message: Any, now: float) -> None:
        sender = opened.sender
        if sender != self.me:
            member = self.roll.greet(sender, opened.session, now)
        match message:
            case About():
                member.about = message
            case Standing():
                if opened.number > member.number:  # the network may have changed their order
                    member.number, member.standing = opened.number, message
                if message.zones != self.zones.digest and self._on_this_map(member):
                    self._zones_owed = True  # one of us lacks something; so does the other say
                if sender != self.me and self.plans.lacks(sender, message.plans, now):
                    self._put("plan", b"", sender)
            case Order():
                self.deeds.ordered(sender, message)
            case Answer():
                self.dispatcher.hear(sender, opened.session, message, now)
            case Stop():
                self.deeds.stopped(sender, message)
            case Stopped():
                self.stops.hear(sender, message)
            case Zones():
                newer = self.zones.heard(message)
                if newer:
                    self.deeds.zoned(newer)
            case Plans():
                self.plans.heard(sender, message)
                self.deeds.planned()

    def _on_this_map(self, member: Member) -> bool:
        return member.about is not None and member.about.map == self.about.map

    def _warn(self, sentence: str) -> None:
        if sentence not in self._warned:
            self._warned.add(sentence)
            _log.warning("%s", sentence)
