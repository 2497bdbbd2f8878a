"""The fleet, for the appointments that are kept at this robot (`nl2robot.schedule.handing`)."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import AbstractContextManager
from datetime import datetime

import msgspec

from nl2robot.fleet.book import Errand
from nl2robot.fleet.hub import Hub
from nl2robot.knowledge import Knowledge
from nl2robot.review.review import Review, review
from nl2robot.run.runner import Runner
from nl2robot.schedule.appointments import Appointment
from nl2robot.schedule.handing import Handed
from nl2robot.schedule.plans import Plan, Planned, planned
from nl2robot.schedule.service import in_the_name_of


class Kept(msgspec.Struct, frozen=True, kw_only=True):
    """An appointment of the fleet, and who keeps it."""

    robot: str
    """The id of the robot that keeps it."""
    name: str
    here: bool
    """Whether that is this one."""
    known: bool
    """Whether it is known how that robot stands."""
    planned: Planned


class Keeping:
    """A `nl2robot.schedule.handing.Company`. Any thread may use it."""

    def __init__(
        self,
        hub: Hub,
        lock: AbstractContextManager[object],
        review: Callable[..., Review],
        name: str,
        add: Callable[[Errand], Errand],
        clock: Callable[[], float],
    ) -> None:
        """`clock` tells seconds that nobody sets, as those of the hub."""
        self._hub = hub
        self._lock = lock
        self._review = review
        self._name = name
        self._add = add
        self._clock = clock

    @property
    def id(self) -> str:
        return self._hub.me

    @property
    def doubled(self) -> bool:
        return self._hub.doubled

    def check(self, program: str, language: str = "en", *, at: datetime | None = None) -> Review:
        return self._review(program, language, at=at)

    def hand_out(self, id: str, appointment: Appointment, until: float) -> None:
        with self._lock:
            if self._hub.book.errand(id) is None:
                self._add(
                    Errand(
                        id=id,
                        program=appointment.program,
                        sha256=appointment.sha256,
                        sentence=appointment.sentence,
                        language=appointment.language,
                        by=f"{in_the_name_of(appointment)} (fleet, from {self._name})",
                        reviewed=appointment.reviewed,
                        at=time.time(),
                        until=until,
                    )
                )

    def handed(self, id: str) -> Handed | None:
        with self._lock:
            errand = self._hub.book.errand(id)
            if errand is None:
                return None
            member = self._hub.roll.members.get(errand.robot or "")
            known = errand.robot is None or (member is not None and member.known(self._clock()))
        return Handed(
            state=errand.state,
            robot=errand.robot_name,
            known=known,
            message=errand.message,
            refused=errand.refused,
            reminded=errand.reminded,
        )

    def call_off(self, id: str) -> None:
        with self._lock:
            self._hub.dispatcher.call_off(id)

    def tell(self, plans: tuple[Plan, ...]) -> None:
        with self._lock:
            if self._hub.plans.keep(plans):
                self._hub.deeds.planned()

    def plans(self, language: str = "en") -> list[Kept]:
        """The appointments of the fleet, those that are kept here first."""
        with self._lock:
            now, shared = self._clock(), self._hub.plans
            mine = {self._hub.me: shared.mine} if shared.mine is not None else {}
            found = []
            for id, plans in (mine | shared.known).items():
                member = self._hub.roll.members.get(id)
                here = id == self._hub.me
                known = here or (member is not None and member.known(now))
                found += [
                    Kept(
                        robot=id,
                        name=member.name if member is not None else plans.name,
                        here=here,
                        known=known,
                        planned=planned(each, known, time.time(), language),
                    )
                    for each in plans.plans
                ]
        return found


def check_for_all(
    runner: Runner, program: str, language: str = "en", at: datetime | None = None
) -> Review:
    """A review for a robot that can do everything: as it would be done here, if this robot can do
    it; else as far as that can be told. What a robot lacks its own review says."""
    made = runner.check(program, language, at=at)
    if not made.acceptable:
        made = review(program, Knowledge(runner.knowledge.world), language=language, at=at)
    return made
