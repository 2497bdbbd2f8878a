"""A dispatcher: has each errand done by one robot, once. Without I/O but for the book.

    looking -> offer to the best -> it accepts -> given (noted) -> go -> begun -> over

Only one robot at a time is ever told to go, and that is in the book before it is told: so an offer
that nobody answers can be made to the next one, for whoever was not told to go begins nothing. Who
was told to go keeps the errand until it says itself that it has not begun and never will, however
long nothing is heard of it.
"""

from __future__ import annotations

import secrets
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final, Literal

from msgspec.structs import replace

from nl2robot.fleet.book import Errand, FleetBook
from nl2robot.fleet.choosing import called, first_place, ranked
from nl2robot.fleet.messages import NOT_BEGUN, Answer, Order
from nl2robot.fleet.roll import Roll

AGAIN: Final = 0.5
"""Seconds after which an order that was not answered is sent again."""
FOLLOWS: Final = 1.0
"""Seconds between two questions how something goes that has begun."""
ANSWERS_WITHIN: Final = 15.0
"""Seconds that a robot has to accept an offer: it reviews it first."""
PATIENCE: Final = 120.0
"""Seconds in which a robot is looked for."""
REST: Final = 10.0
"""Seconds in which a robot that refused is not asked again for the same errand."""
MOST_OPEN: Final = 100
"""Errands that a dispatcher has in hand."""

Say = Callable[[str, Order], None]
"""Send an order to the robot of this id."""


@dataclass
class _Hand:
    """What is remembered of an errand beside the book."""

    since: float
    offered: tuple[str, str, str, float] | None = None
    """An offer that is not answered: its id, the robot's, its process, and when it was made."""
    said: float = float("-inf")
    """When an order was sent last."""
    resting: dict[str, float] = field(default_factory=dict)
    """Until when a robot is not asked again."""


class Dispatcher:
    """Those of one robot's station."""

    def __init__(
        self,
        book: FleetBook,
        roll: Roll,
        floor: str,
        where: Callable[[str], tuple[float, float] | None],
        say: Say,
        changed: Callable[[Errand], None] = lambda errand: None,
        clock: Callable[[], float] = time.time,
    ) -> None:
        """`floor` is the hash of the map that errands are approved for; `where` a place is on it.
        `changed` is told of each errand that stands another way; `clock` is the one by which
        some are wanted until a moment."""
        self._book = book
        self._roll = roll
        self._floor = floor
        self._where = where
        self._say = say
        self._changed = changed
        self._clock = clock
        self._open = {each.id: each for each in reversed(book.errands()) if each.open}
        self._hands: dict[str, _Hand] = {}

    @property
    def full(self) -> bool:
        return len(self._open) >= MOST_OPEN

    def add(self, errand: Errand, now: float) -> Errand:
        """Have it done from now on."""
        self._hands[errand.id] = _Hand(now)
        return self._keep(errand)

    def call_off(self, id: str) -> Errand | None:
        """Not to be begun any more, if it can be; None if it is not in hand. One that a robot was
        told to begin is its robot's: a stop ends it there."""
        errand = self._open.get(id)
        if errand is None or errand.state != "looking":
            return errand
        self._withdraw(errand)
        return self._keep(replace(errand, state="called_off"))

    def call_off_all(self) -> None:
        """Nothing is to be begun any more that no robot was told to begin."""
        for id in tuple(self._open):
            self.call_off(id)

    def tick(self, now: float) -> None:
        """Say what is to be said by now."""
        for errand in tuple(self._open.values()):
            hand = self._hands.setdefault(errand.id, _Hand(now))
            if errand.state == "looking":
                self._look(errand, hand, now)
            elif errand.state == "given" and now - hand.said >= AGAIN:
                self._order(errand, hand, "go", now)
            elif errand.state == "begun" and now - hand.said >= FOLLOWS:
                self._order(errand, hand, "ask", now)

    def hear(self, sender: str, session: str, answer: Answer, now: float) -> None:
        """What a process of a robot says of an offer."""
        for errand in tuple(self._open.values()):
            hand = self._hands.setdefault(errand.id, _Hand(now))
            offered = hand.offered
            if errand.state == "looking":
                # Of two processes with one id the word goes to the one that was asked.
                if (
                    offered is not None
                    and offered[:2] == (answer.offer, sender)
                    and (answer.stand != "accepted" or session == offered[2])
                ):
                    self._decided(errand, hand, sender, answer, now)
                    return
            elif (errand.offer, errand.robot) == (answer.offer, sender):
                self._goes(errand, hand, answer, now)
                return
        if answer.stand == "accepted":  # nobody waits for it any more
            self._say(sender, Order(offer=answer.offer, what="withdraw", session=session))

    # --- inside

    def _look(self, errand: Errand, hand: _Hand, now: float) -> None:
        if hand.offered is not None:
            offer, robot, session, at = hand.offered
            if now - at < ANSWERS_WITHIN:
                if now - hand.said >= AGAIN:
                    hand.said = now
                    self._say(robot, _offer(errand, offer, session))
                return
            self._withdraw(errand)
            self._rests(errand, hand, robot, "It did not answer.", now)
            errand = self._open[errand.id]
        if self._is_late(errand, hand, now):
            self._keep(replace(errand, state="nobody"))
            return
        robots = [
            each
            for each in self._roll.members.values()
            if errand.wanted in (None, each.id) and hand.resting.get(each.id, now) <= now
        ]
        place = first_place(errand.program)
        goal = self._where(place) if place is not None else None
        best, _ = ranked(robots, called(errand.program), self._floor, goal, now)
        busy: set[str | None] = {
            each.robot for each in self._open.values() if each.state == "given"
        }
        busy |= {each.offered[1] for each in self._hands.values() if each.offered is not None}
        free = next((each for each in best if each not in busy), None)
        if free is not None:
            session = self._roll.members[free].session
            hand.offered = (secrets.token_hex(8), free, session, now)
            hand.said = now
            self._say(free, _offer(errand, hand.offered[0], session))

    def _is_late(self, errand: Errand, hand: _Hand, now: float) -> bool:
        if errand.until is not None:
            return self._clock() > errand.until
        return now - hand.since > PATIENCE

    def _decided(self, errand: Errand, hand: _Hand, robot: str, answer: Answer, now: float) -> None:
        """What a robot says to an offer for which it was not told to go."""
        if answer.stand != "accepted":
            hand.offered = None
            self._rests(errand, hand, robot, answer.why or "", now)
            return
        assert hand.offered is not None
        session = hand.offered[2]
        hand.offered = None
        member = self._roll.members.get(robot)
        name = member.name if member is not None else robot
        # In the book before it is said: from here on it is this robot's.
        given = replace(
            errand,
            state="given",
            offer=answer.offer,
            robot=robot,
            robot_name=name,
            session=session,
        )
        self._order(self._keep(given), hand, "go", now)

    def _goes(self, errand: Errand, hand: _Hand, answer: Answer, now: float) -> None:
        """What the robot says that was told to go."""
        if answer.stand == "over":
            state = answer.status or "broken_off"
            self._keep(
                replace(
                    errand,
                    state=state,
                    run=answer.run,
                    message=answer.why,
                    reminded=answer.reminded,
                )
            )
        elif answer.stand == "begun":
            if errand.state != "begun" or errand.run != answer.run:
                self._keep(replace(errand, state="begun", run=answer.run))
        elif answer.stand in NOT_BEGUN and errand.state == "given":
            robot = errand.robot
            assert robot is not None
            looking = replace(errand, state="looking", offer=None, robot=None, robot_name=None)
            self._keep(looking)
            self._rests(looking, hand, robot, answer.why or "", now)

    def _rests(self, errand: Errand, hand: _Hand, robot: str, why: str, now: float) -> None:
        hand.resting[robot] = now + REST
        hand.offered = None
        member = self._roll.members.get(robot)
        name = member.name if member is not None else robot
        self._keep(replace(errand, refused={**errand.refused, name: why}))

    def _withdraw(self, errand: Errand) -> None:
        hand = self._hands.get(errand.id)
        if hand is not None and hand.offered is not None:
            offer, robot, session, _ = hand.offered
            hand.offered = None
            self._say(robot, Order(offer=offer, what="withdraw", session=session))

    def _order(self, errand: Errand, hand: _Hand, what: Literal["go", "ask"], now: float) -> None:
        hand.said = now
        assert errand.robot is not None and errand.offer is not None
        order = Order(offer=errand.offer, what=what, session=errand.session)
        self._say(errand.robot, order)

    def _keep(self, errand: Errand) -> Errand:
        self._book.keep(errand)
        if errand.open:
            self._open[errand.id] = errand
        else:
            self._open.pop(errand.id, None)
            self._hands.pop(errand.id, None)
        self._changed(errand)
        return errand


def _offer(errand: Errand, offer: str, session: str) -> Order:
    return Order(
        offer=offer,
        session=session,
        what="offer",
        program=errand.program,
        sha256=errand.sha256,
        sentence=errand.sentence,
        language=errand.language,
        by=errand.by,
        reviewed=errand.reviewed,
    )
