"""A fleet without a network: its robots say what they have to say into a list, from which a story
hands it on, loses it, or hands it on twice."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from msgspec.structs import replace

from nl2robot.fleet.book import Errand, FleetBook, Offer
from nl2robot.fleet.hub import Deeds, Hub
from nl2robot.fleet.messages import About, Answer, Order, Standing, Stop, Stopped
from nl2robot.fleet.performing import Performer
from nl2robot.fleet.trust import Station
from nl2robot.review.review import digest
from nl2robot.schedule.findings import Findings, encoded
from nl2robot.schedule.outcomes import Outcome

KEY = b"the key of the ward, which nobody else has"
FLOOR = "ward"
EIGHT = 1796022000.0 - 1000.0
"""So that a story begins at eight in Zurich, on Monday, 30 November 2026."""
NOTHING_FOUND = encoded(
    Findings(
        findings=(),
        risks=(),
        stood=None,
        places=(),
        closed=(),
        complete=True,
        error=None,
        message=None,
    )
)


class Killed(BaseException):
    """The robot's process is gone."""


class FakeRobot:
    """A robot of the fleet: what it keeps outlives its process."""

    def __init__(
        self,
        net: FakeNetwork,
        name: str,
        x: float = 0.0,
        folder: Path | None = None,
        **about: Any,
    ) -> None:
        self.net, self.name, self.x = net, name, x
        self.book = FleetBook(about.pop("book", ":memory:"))
        self.id = self.book.robot
        self.about = About(
            name=name,
            kind="simulator",
            methods=about.pop("methods", ("say", "goto")),
            world="ward",
            map=about.pop("map", FLOOR),
            version="1",
        )
        self.standing = Standing(state="idle", x=x, y=0.0, battery=80.0)
        self.refuses: str | None = None
        self.runs: list[Offer] = []
        """All that it has begun in its life."""
        self.over: dict[int, str] = {}
        self.reminders: dict[int, tuple[Outcome, ...]] = {}
        """What came of its runs that reminded somebody."""
        self.stood: list[str] = []
        self.dies_at: str | None = None
        """ "note" or "run": it is killed as soon as that was done for something that begins."""
        self.station = Station(folder)
        self.starts()

    def starts(self) -> None:
        """A process of it begins."""
        self.alive = True
        self.hub = Hub(
            book=self.book,
            key=KEY,
            about=self.about,
            standing=lambda: self.standing,
            where=lambda place: (10.0, 0.0) if place == "pharmacy" else None,
            send=lambda to, raw, *, urgent: self.net.sent(self, to, raw),
            deeds=Deeds(ordered=self._ordered, stopped=self._stopped),
            sign=lambda robot, order: self.station.signed(self.id, robot, order),
            clock=lambda: self.wall,
        )
        self.performer = Performer(
            self.book, self.hub.sealer.session, self, lambda: self.net.now + self.drift
        )

    drift = 0.0
    """Seconds by which its clock is ahead."""

    def answers(self, sender: str, order: Order) -> Answer:
        """What it says to an order that is for it."""
        answer = self.performer.answer(sender, order)
        assert answer is not None
        return answer

    @property
    def wall(self) -> float:
        """What its clock shows, in seconds since the epoch."""
        return EIGHT + self.net.now + self.drift

    def _ordered(self, sender: str, order: Order) -> None:
        try:
            answer = self.performer.answer(sender, order)
        except Killed:
            self.alive = False
            return
        if answer is not None:
            self.hub.say("answer", answer, sender)

    def _stopped(self, sender: str, stop: Stop) -> None:
        self.stood.append(stop.because)
        self.hub.say("stopped", Stopped(stop.stop, True), sender)

    # what it does with an offer (`nl2robot.fleet.performing.Means`)

    def doubts(self, sender: str, order: Order) -> str | None:
        return self.station.doubts(sender, self.id, order) if sender != self.id else None

    def consider(self, offer: Offer) -> str | None:
        return self.refuses

    def begin(self, offer: Offer) -> int:
        if self.dies_at == "note":
            raise Killed
        self.runs.append(offer)
        if self.dies_at == "run":
            raise Killed
        return len(self.runs)

    def came(self, run: int) -> tuple[str | None, str | None]:
        return self.over.get(run), None

    def reminded(self, run: int) -> tuple[Outcome, ...]:
        return self.reminders.get(run, ())

    def lost(self, offer: Offer) -> int | None:
        return next((n for n, each in enumerate(self.runs, 1) if each.id == offer.id), None)


class FakeNetwork:
    """What was said and has not come yet."""

    def __init__(self) -> None:
        self.now = 1000.0
        self.robots: list[FakeRobot] = []
        self.under_way: list[tuple[FakeRobot, FakeRobot, bytes]] = []
        self.cut: set[frozenset[str]] = set()
        """Pairs of robots' names that do not reach each other."""
        self.heard_of: list[bytes] = []

    def robot(self, name: str, x: float = 0.0, **about: Any) -> FakeRobot:
        self.robots.append(FakeRobot(self, name, x, **about))
        return self.robots[-1]

    def sent(self, sender: FakeRobot, to: str, raw: bytes) -> None:
        self.heard_of.append(raw)
        for each in self.robots:
            if each is not sender and to in ("", each.id):
                self.under_way.append((sender, each, raw))

    def hand_on(self, number: int = 0, *, keep: bool = False) -> None:
        """One message comes; `keep`: it will come once more."""
        sender, to, raw = self.under_way[number]
        if not keep:
            del self.under_way[number]
        if to.alive and frozenset((sender.id, to.id)) not in self.cut:
            to.hub.hear(raw, self.now)

    def goes_on(self, seconds: float, step: float = 0.25) -> None:
        """Time passes in which all that is said comes at once."""
        ends = self.now + seconds
        while self.now < ends:
            self.now += step
            for each in self.robots:
                if each.alive:
                    each.hub.tick(self.now)
            while self.under_way:
                self.hand_on()


def errand(program: str = 'robot.say("Hello.")\n', **more: Any) -> Errand:
    made = Errand(
        id=digest(program)[:16],
        program=program,
        sha256=digest(program),
        sentence="say hello",
        language="en",
        by="Nurse Kim (fleet, from ward a)",
        reviewed=NOTHING_FOUND,
        at=0.0,
    )
    return replace(made, **more)


def begun(net: FakeNetwork) -> Iterator[tuple[str, str]]:
    """Each time that something was begun: by whom, and what."""
    for robot in net.robots:
        for each in robot.runs:
            yield robot.name, each.program
