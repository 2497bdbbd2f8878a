"""What this robot does for its fleet: looks at what it is offered, and does it."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Final

import msgspec

from nl2robot.errors import UserError
from nl2robot.fleet.book import FleetBook, Offer
from nl2robot.fleet.messages import Order
from nl2robot.fleet.trust import Station
from nl2robot.review.review import digest
from nl2robot.run.runner import Runner
from nl2robot.run.state import GOING
from nl2robot.schedule.findings import News, decoded, findings_of, news
from nl2robot.schedule.outcomes import Outcome, asking_of, outcomes
from robot_api.errors import RobotError

LATEST_RUNS: Final = 200
_log = logging.getLogger(__name__)


class OwnRobot:
    """A `nl2robot.fleet.performing.Means`."""

    def __init__(
        self,
        runner: Runner,
        book: FleetBook,
        station: Station,
        waits: Callable[[], str | None],
    ) -> None:
        """`waits` tells why the robot begins nothing now; None if it is free."""
        self._runner = runner
        self._book = book
        self._station = station
        self._waits = waits

    def doubts(self, sender: str, order: Order) -> str | None:
        me = self._book.robot
        doubt = self._station.doubts(sender, me, order) if sender != me else None
        if doubt is not None:
            _log.warning("The fleet's order %s was not taken. %s", order.offer, doubt)
        return doubt

    def consider(self, offer: Offer) -> str | None:
        waits = self._waits()
        if waits is not None:
            return f"It is not free ({waits})."
        if digest(offer.program) != offer.sha256:
            return "The program is not the one that was approved."
        try:
            approved = decoded(offer.reviewed)
            review = self._runner.check(offer.program, offer.language)
        except (msgspec.MsgspecError, UserError, RobotError) as error:
            return str(error)
        if not review.acceptable:
            return next(each.message for each in review.findings if each.severity == "error")
        new = [
            each
            for each in news(approved, findings_of(review))
            # Where nobody could try it, its places stand in the program alone.
            if each.kind != "place" or approved.stood is not None or approved.places
        ]
        return _told(new[0]) if new else None

    def begin(self, offer: Offer) -> int:
        approval = self._runner.approve(
            offer.program,
            offer.sha256,
            offer.by,
            utterance=offer.sentence,
            language=offer.language,
            insists=True,  # the review just now found what was approved
        )
        return self._runner.run(approval.id)

    def came(self, run: int) -> tuple[str | None, str | None]:
        present = self._runner.state()
        if present is not None and present.run == run:
            return (None, None) if present.state in GOING else (present.state, present.message)
        found = self._runner.log.run(run)
        if found is None or found.status is None:
            return "broken_off", None
        return found.status, found.message

    def reminded(self, run: int) -> tuple[Outcome, ...]:
        found = self._runner.log.run(run)
        if found is None or asking_of(found.program) is None:
            return ()
        return tuple(outcomes(found.program, self._runner.log.calls(run)))

    def lost(self, offer: Offer) -> int | None:
        known = self._book.runs(LATEST_RUNS)  # the same appointment is done every day
        for run in self._runner.log.runs(LATEST_RUNS):
            if (run.sha256, run.approved_by) == (offer.sha256, offer.by) and run.id not in known:
                return run.id
        return None


def _told(new: News) -> str:
    said = {
        "place": "Here it would also work at “{}”.",
        "closed": "Here it does not reach “{}”.",
        "fails": "Here it does not come to its end: {}",
    }
    return said.get(new.kind, "{}").format(new.text)
