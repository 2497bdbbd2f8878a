"""The reviews that were made here lately, so that an approval needs no dry run of its own.

A review holds for the world that it was made in: while the robot stands where it stood and holds
what it held, with the same doors closed and the same zones drawn. People walk about all the time:
where they are counts for nothing here, and in the end the time does.
"""

from __future__ import annotations

import threading
import time
from collections import OrderedDict
from collections.abc import Hashable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from nl2robot.review.review import Review
    from sim.simulation import Simulation

KEPT: Final = 50
HOLDS: Final = 600.0
"""Seconds; as long as somebody may think about a program."""

Key = tuple[str, int | None]
"""The hash of a program, and the run that it goes on with."""


@dataclass(frozen=True)
class _Made:
    review: Review
    world: Hashable
    at: float
    """On the monotonic clock."""


class Reviews:
    """Any thread may use it."""

    def __init__(self) -> None:
        self._made: OrderedDict[Key, _Made] = OrderedDict()
        self._lock = threading.Lock()

    def keep(self, review: Review, continues: int | None, world: Hashable) -> None:
        """`world` is what `as_it_is` told of it when the review was made."""
        key = (review.sha256, continues)
        with self._lock:
            self._made[key] = _Made(review, world, time.monotonic())
            self._made.move_to_end(key)
            while len(self._made) > KEPT:
                self._made.popitem(last=False)

    def of(self, sha256: str, continues: int | None, world: Hashable) -> Review | None:
        """The last one of that program, if it still holds."""
        with self._lock:
            made = self._made.get((sha256, continues))
        if made is None or made.world != world or time.monotonic() - made.at > HOLDS:
            return None
        return made.review


def as_it_is(stage: Simulation) -> Hashable:
    """What a dry run there depends on, but for the people."""
    view, world = stage.view(), stage.world
    robot = view.robot
    pose = (round(robot.x, 2), round(robot.y, 2), round(robot.theta))
    return pose, tuple(robot.holding), view.closed, world.zones, world.places
