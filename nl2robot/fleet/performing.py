"""A robot's side of an offer: what it promises, begins once, and tells of it. Without I/O but for
the book.

    offer -> accepted (it was reviewed here; noted; the robot waits HOLDS seconds for the word)
    go    -> begun    (noted first, then begun; within HOLDS seconds of accepting it)
          -> expired  (the word came too late, or to another process: noted, never begun)
    withdraw -> withdrawn (noted, never begun), unless it has begun

Whatever order orders come in, and however often, each offer is begun once or never: what is in the
book is never taken back, and an order for an offer that is not there can begin nothing.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, Protocol

import msgspec

from nl2robot.fleet.book import FleetBook, Offer
from nl2robot.fleet.messages import Answer, Order, Stand
from nl2robot.schedule.outcomes import Outcome
from robot_api.errors import RobotError

HOLDS: Final = 20.0
"""Seconds that a robot keeps itself free for what it has accepted, by its own clock."""
TAKEN: Final = "It has promised to do something else. Wait a moment."
TOO_LATE: Final = "The word to begin came too late. Have it done anew."
BROKEN_OFF: Final = "broken_off"


class Means(Protocol):
    """What a robot does with an offer."""

    def doubts(self, sender: str, order: Order) -> str | None:
        """Why nobody answers for this order, if nobody does (`nl2robot.fleet.trust`)."""

    def consider(self, offer: Offer) -> str | None:
        """Review it here, now; why it is not done, if it is not."""

    def begin(self, offer: Offer) -> int:
        """Begin it, in the name of who approved it; the number of its run. Raises `RobotError`,
        and then has not begun it."""

    def came(self, run: int) -> tuple[str | None, str | None]:
        """How a run ended and why, as far as it has ended."""

    def reminded(self, run: int) -> tuple[Outcome, ...]:
        """What came of a run that is over, if it reminded somebody."""

    def lost(self, offer: Offer) -> int | None:
        """The run of an offer that a process which is gone had begun, if it came to that."""


class Performer:
    """Answers orders, one after the other."""

    def __init__(
        self, book: FleetBook, session: str, means: Means, clock: Callable[[], float]
    ) -> None:
        """`clock` tells seconds that nobody sets, read when something happens: a review takes its
        time."""
        self._book = book
        self._session = session
        self._means = means
        self._clock = clock
        self._accepted: tuple[str, float] | None = None
        """The offer that the robot waits for, and until when."""

    def answer(self, sender: str, order: Order) -> Answer | None:
        """What came of an order; None if it is for another process with this robot's id. Raises
        `UserError` if the book cannot be written: then nothing was begun."""
        kept = self._book.offer(order.offer)
        if kept is None and order.session not in ("", self._session):
            return None
        if kept is not None and kept.sender != sender:
            return Answer(offer=order.offer, stand="refused")  # it is nobody else's to begin
        doubt = self._means.doubts(sender, order)
        if doubt is not None:
            if kept is None:  # not noted: who makes up offers cannot use up those of others
                return Answer(offer=order.offer, stand="refused", why=doubt)
            order = msgspec.structs.replace(order, what="ask")
        if order.what == "offer":
            return self._told(kept or self._offered(sender, order))
        if kept is None:  # an offer that never came here, or that comes later than its end
            stand: Stand = "withdrawn" if order.what == "withdraw" else "expired"
            kept = Offer(id=order.offer, sender=sender, stand=stand, session=self._session)
            return self._told(self._book.note(kept))
        if kept.stand == "accepted":
            kept = self._decided(kept, order)
        return self._told(kept)

    def _offered(self, sender: str, order: Order) -> Offer:
        offer = Offer(
            id=order.offer,
            sender=sender,
            stand="accepted",
            session=self._session,
            program=order.program,
            sha256=order.sha256,
            sentence=order.sentence,
            language=order.language,
            by=order.by,
            reviewed=order.reviewed,
        )
        if self._accepted is not None and self._clock() < self._accepted[1]:
            why: str | None = TAKEN
        else:
            why = self._means.consider(offer)
        if why is not None:
            return self._book.note(msgspec.structs.replace(offer, stand="refused", why=why))
        self._book.note(offer)
        self._accepted = (offer.id, self._clock() + HOLDS)
        return offer

    def _decided(self, offer: Offer, order: Order) -> Offer:
        """Of one that was accepted."""
        holds = (
            offer.session == self._session
            and self._accepted is not None
            and self._accepted[0] == offer.id
            and self._clock() < self._accepted[1]
        )
        if order.what == "ask" and holds:
            return offer
        if self._accepted is not None and self._accepted[0] == offer.id:
            self._accepted = None
        if order.what == "withdraw":
            return self._book.note(msgspec.structs.replace(offer, stand="withdrawn"))
        if not holds:
            return self._book.note(msgspec.structs.replace(offer, stand="expired", why=TOO_LATE))
        begun = self._book.note(msgspec.structs.replace(offer, stand="begun"))
        try:
            run = self._means.begin(offer)
        except RobotError as error:
            return self._book.note(msgspec.structs.replace(offer, stand="refused", why=str(error)))
        return self._book.note(msgspec.structs.replace(begun, run=run))

    def _told(self, offer: Offer) -> Answer:
        if offer.stand == "begun":
            offer = self._followed(offer)
        return Answer(
            offer=offer.id,
            stand=offer.stand,
            why=offer.why,
            run=offer.run,
            status=offer.status,
            reminded=offer.reminded,
        )

    def _followed(self, offer: Offer) -> Offer:
        """One that has begun, and may be over."""
        run = offer.run
        if run is None and offer.session != self._session:  # killed between its note and its run
            run = self._means.lost(offer)
            if run is None:
                over = msgspec.structs.replace(offer, stand="over", status=BROKEN_OFF)
                return self._book.note(over)
        if run is None:
            return offer
        status, why = self._means.came(run)
        if status is None:
            return offer
        came = self._means.reminded(run)
        over = msgspec.structs.replace(
            offer, stand="over", status=status, why=why, run=run, reminded=came
        )
        return self._book.note(over)
