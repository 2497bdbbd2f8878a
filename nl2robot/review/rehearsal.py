"""The dry run: the program in a copy of the simulated world, as fast as the machine allows.

How far a program is followed is counted in what happens in it (steps of the simulation, calls,
rounds of its loops), never in the seconds that the machine takes: the same program in the same
world has the same dry run on a fast and on a busy machine.
"""

from __future__ import annotations

import math
import threading
from collections import Counter
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Literal

import msgspec

from nl2robot.review.endless import went_on
from nl2robot.review.sought import Sought
from robot_api.capabilities.names import one_of
from robot_api.driver import StopFlag
from robot_api.drivers import simulated
from robot_api.errors import Stopped
from sandbox.execution import Execution
from sandbox.limits import Limits

if TYPE_CHECKING:
    from nl2robot.run.going_on import Recall
    from sim.record import Record, Sample
    from sim.simulation import Simulation


@dataclass(frozen=True)
class Budget:
    """How far a program is followed before its dry run breaks off."""

    seconds: float = 600.0
    """Of simulated time, without what is leapt over of long waits: about three seconds
    of a quiet machine, as long as a person likes to wait for a review."""
    calls: int = 1000
    """Of robot methods, without those by which a program looks at the clock and waits on,"""
    waits: int = 20_000
    """and with them: more than a day of looking every ten seconds whether it is time."""
    rounds: int = 2_000_000
    """Of loops, and calls of functions."""
    real_seconds: float = 180.0
    """The one limit by the clock on the wall, far above what the others allow: a machine that is
    still not through by then is in trouble, and the dry run says so (`BreakOff` "machine")."""


BUDGET: Final = Budget()
_WAITS: Final = ("wait", "wait_until", "clock")
MANY_POINTS = 200
"""Of the path, for who draws it on a map."""


BreakOff = Literal["time", "calls", "computing", "machine"]
"""Which part of the budget was used up; "machine" is the clock on the wall."""


class DryRun(msgspec.Struct, frozen=True, kw_only=True):
    """What the program would do; people's answers are those of the simulated people."""

    status: Literal["done", "failed", "stopped", "limit", "unfinished"]
    """As an outcome of `sandbox.execution`, or "unfinished" if it broke off."""
    message: str | None
    """Why it would not be done."""
    line: int | None
    """Where it would end, if it would not be done."""
    seconds: float
    """How long it would take, in simulated time."""
    metres: float
    """How far it would drive."""
    says: tuple[str, ...]
    asks: tuple[str, ...]
    holds: tuple[str, ...]
    """What it would hold at the end."""
    shows: tuple[str, ...]
    places: tuple[str, ...]
    """The places it would drive to or through, in order."""
    path: tuple[tuple[float, float], ...]
    """Where it would drive, in metres: a point every half metre or so, at most `MANY_POINTS`."""
    calls: int
    course: tuple[Event, ...] = ()
    """All of it in the order in which it would happen."""
    closed: tuple[str, ...] = ()
    """The places of its rounds that it would not reach, and leave out."""
    error: str | None = None
    """The name of the error it would end with: a robot's ("NotFound") or Python's ("NameError")."""
    broke_off: BreakOff | None = None
    """Why it is unfinished."""
    goes_on: bool = False
    """Unfinished for that it has no end: it goes on until somebody stops it, and did so without a
    failure for as long as it was followed."""

    @property
    def complete(self) -> bool:
        """Whether it came to the end that the program has, if it has one, and nothing failed on
        the way."""
        return self.status in ("done", "stopped") or self.goes_on


class Event(msgspec.Struct, frozen=True):
    """Something that would happen: a place reached, words spoken, asked or shown, a thing moved."""

    kind: EventKind
    what: str


@dataclass(frozen=True)
class Call:
    """A robot call of the dry run. Times are those of the simulation."""

    line: int
    method: str
    arguments: dict[str, Any]
    began: float
    ended: float


@dataclass(frozen=True)
class Course:
    """All that a dry run did, for who looks for what is risky about it."""

    calls: tuple[Call, ...]
    record: Record


EventKind = Literal["was at", "said", "asked", "showed", "took", "put", "gave"]
_KIND_OF_HAPPENING: Final[dict[str, EventKind]] = {
    "speech": "said",
    "screen": "showed",
    "grab": "took",
    "put": "put",
    "give": "gave",
}


def rehearse(
    program: str,
    simulation: Simulation,
    budget: Budget = BUDGET,
    seed: int | None = None,
    skills: Collection[str] = (),
) -> DryRun:
    """Run the program in a simulation of its own, whose time is free to run; its `random` begins
    with `seed`, or with the same number every time. `skills`: what the robot can do that the
    simulated one cannot; nothing is known of how long it takes or what comes of it, so it passes at
    once."""
    return watched(program, simulation, budget, seed, skills)[0]


class _Patience(StopFlag):
    """A stop flag that sets itself when the budget's simulated time is used up."""

    def __init__(self, simulation: Simulation, budget: Budget) -> None:
        super().__init__()
        self._simulation = simulation
        self._until = simulation.stepped + budget.seconds
        self.broke_off: BreakOff | None = None

    def break_off(self, why: BreakOff) -> None:
        self.broke_off = self.broke_off or why
        self.set("The dry run broke off.")

    def is_set(self) -> bool:
        if self._simulation.stepped >= self._until:
            self.break_off("time")
        return super().is_set()


def watched(
    program: str,
    simulation: Simulation,
    budget: Budget = BUDGET,
    seed: int | None = None,
    skills: Collection[str] = (),
    recall: Recall | None = None,
) -> tuple[DryRun, Course]:
    """As `rehearse`, with the course of it. `recall` answers the calls that were done before."""
    driver = simulated(simulation)
    own = set(skills) - set(driver.capabilities().skills)
    began = simulation.time
    patience = _Patience(simulation, budget)
    asks: list[tuple[float, Event]] = []
    calls: list[Call] = []
    counts: Counter[str] = Counter()
    sought = Sought()

    def call(method: str, arguments: dict[str, Any], line: int) -> Any:
        if recall is not None and recall.goes_on:
            return recall.answer(method, arguments)
        left = arguments if recall is None else recall.left_of(method, arguments)
        at = simulation.time
        try:
            return sought.call(method, arguments, lambda: do(method, left))
        finally:
            counts[method] += 1
            calls.append(Call(line, method, left, at, simulation.time))

    def do(method: str, arguments: dict[str, Any]) -> Any:
        done = len(calls)
        waits = sum(counts[each] for each in _WAITS)
        if done >= budget.waits or done - waits >= budget.calls:
            patience.break_off("calls")
        patience.check()
        if method == "ask":
            asks.append((simulation.time, Event("asked", arguments["question"])))
        if method == "stop":
            raise Stopped  # as the real robot's stop ends every program
        if method == "do" and one_of(arguments["skill"], own):
            return None
        return driver.call(method, arguments, patience)

    def give_up() -> None:
        patience.break_off("machine")
        driver.stop("The dry run broke off.")
        execution.stop()

    limits = Limits(
        computing=budget.real_seconds,
        total_computing=budget.real_seconds,
        rounds=budget.rounds,
    )
    closed: dict[str, str] = {}
    execution = Execution(
        program, call, seed=seed or 0, limits=limits, on_closed=closed.__setitem__
    )
    watchdog = threading.Timer(budget.real_seconds, give_up)
    watchdog.daemon = True
    watchdog.start()
    try:
        outcome = execution.run()
    finally:
        watchdog.cancel()
        driver.close()

    if recall is not None:
        outcome = recall.judged(outcome)
    broke_off = patience.broke_off
    if outcome.error == "rounds":
        broke_off = "computing"
    elif outcome.error == "computing":
        broke_off = "machine"
    record = simulation.record.between(began)
    way = _thinned(record.samples)
    course = [*_visited(simulation, way), *asks]
    for happening in record.happenings:
        kind = _KIND_OF_HAPPENING.get(happening.kind)
        if kind is not None:
            what = next(iter(happening.data.values()), "")
            told = ", ".join(map(str, what)) if isinstance(what, list) else str(what)
            course.append((happening.time, Event(kind, told)))
    events = tuple(event for _, event in sorted(course, key=lambda timed: timed[0]))
    dry_run = DryRun(
        status="unfinished" if broke_off else outcome.status,
        message=None if broke_off or outcome.status == "done" else outcome.message,
        line=outcome.line,
        seconds=round(simulation.time - began, 1),
        metres=round(record.distance, 1),
        says=_of("said", events),
        asks=_of("asked", events),
        holds=tuple(simulation.robot.holding),
        shows=_of("showed", events),
        places=_of("was at", events),
        path=_path(way),
        calls=len(calls),
        course=events,
        closed=tuple(closed),
        error=None if broke_off else outcome.error,
        broke_off=broke_off,
        goes_on=broke_off in ("time", "calls") and went_on(program, [call.line for call in calls]),
    )
    return dry_run, Course(tuple(calls), record)


def _of(kind: EventKind, events: Iterable[Event]) -> tuple[str, ...]:
    return tuple(event.what for event in events if event.kind == kind)


def _thinned(samples: Sequence[Sample], apart: float = 0.5) -> list[Sample]:
    """Samples with some way between them, in metres."""
    kept = list(samples[:1])
    for sample in samples[1:]:
        if math.dist((sample.x, sample.y), (kept[-1].x, kept[-1].y)) >= apart:
            kept.append(sample)
    return kept


def _path(way: Sequence[Sample]) -> tuple[tuple[float, float], ...]:
    """Where the samples are, with both ends; of a long way not all of them."""
    step = max(1, math.ceil((len(way) - 1) / (MANY_POINTS - 1)))
    kept = [*way[:-1:step], *way[-1:]]
    return tuple((round(sample.x, 2), round(sample.y, 2)) for sample in kept)


def _visited(simulation: Simulation, way: Iterable[Sample]) -> list[tuple[float, Event]]:
    """The places on the way, each with the time at which it was reached."""
    found: list[tuple[float, Event]] = []
    for sample in way:
        place = simulation.world.place_at(sample.x, sample.y)
        if place is not None and (not found or found[-1][1].what != place.name):
            found.append((sample.time, Event("was at", place.name)))
    return found
