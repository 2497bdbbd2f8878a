"""The appointments of the fleet, as one robot knows them: its own, and what the others told of
theirs. Without I/O but for the book.

Each appointment has one keeper, so there is nothing to agree on: what its keeper told last holds.
It stays known when the keeper is silent, and when this robot has been started anew.
"""

from __future__ import annotations

import hashlib
from typing import Final

import msgspec

from nl2robot.fleet.book import FleetBook
from nl2robot.fleet.messages import Plans
from nl2robot.schedule.plans import Plan

ASKS_EVERY: Final = 0.5
"""Seconds between two questions to the same robot."""


class SharedPlans:
    """As one robot knows them."""

    def __init__(self, book: FleetBook, robot: str, name: str) -> None:
        self._book = book
        self._robot = robot
        self._name = name
        self.mine: Plans | None = None
        """None: nobody has looked yet which there are."""
        self.known: dict[str, Plans] = dict(book.plans())
        """Of the others, by their ids."""
        self._digests = {id: _digest(each.plans) for id, each in self.known.items()}
        self._asked: dict[str, float] = {}

    @property
    def digest(self) -> str | None:
        """Of one's own; another one whenever something of them is another."""
        return self._digests.get(self._robot)

    def keep(self, plans: tuple[Plan, ...]) -> bool:
        """These are one's own now; whether that is new."""
        self.mine = Plans(self._name, plans)
        before, now = self.digest, _digest(plans)
        self._digests[self._robot] = now
        return before != now

    def lacks(self, robot: str, digest: str | None, now: float) -> bool:
        """Whether that robot is to be asked for its plans, which it says are these."""
        if digest is None or digest == self._digests.get(robot, _NONE):
            return False
        if now - self._asked.get(robot, float("-inf")) < ASKS_EVERY:
            return False
        self._asked[robot] = now
        return True

    def heard(self, robot: str, plans: Plans) -> None:
        """What a robot says of its own."""
        self._book.keep_plans(robot, plans)
        self._digests[robot] = _digest(plans.plans)
        if plans.plans:
            self.known[robot] = plans
        else:
            self.known.pop(robot, None)


def _digest(plans: tuple[Plan, ...]) -> str:
    return hashlib.sha256(msgspec.json.encode(plans)).hexdigest()[:8]


_NONE: Final = _digest(())
