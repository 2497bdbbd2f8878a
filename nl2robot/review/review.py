"""The review of a program before it may run: check, policy, dry run and risks, in one report."""

from __future__ import annotations

import hashlib
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from datetime import datetime
from functools import partial
from typing import TYPE_CHECKING, Final, ParamSpec

import msgspec

from grammar.explain import explain_program
from grammar.language import load_language
from grammar.naming import naming
from nl2robot.knowledge import Knowledge
from nl2robot.review.apart import HELPERS, REVIEWS
from nl2robot.review.policy import violations
from nl2robot.review.rehearsal import BUDGET, DryRun, watched
from nl2robot.review.risks import Risk, Situation, Tried, risks
from nl2robot.work import Died, TookTooLong
from robot_api.errors import NotPossible
from robot_api.stub import stub
from sandbox.check import Finding, check

if TYPE_CHECKING:
    from nl2robot.run.going_on import Recall
    from sim.simulation import Simulation
    from sim.world.model import World

P = ParamSpec("P")

MOST_SECONDS: Final = BUDGET.real_seconds + 30.0
"""For a review; its dry run breaks off by itself before."""
_AT_A_TIME: Final = threading.BoundedSemaphore(REVIEWS)
UNFINISHED: Final = (
    "The review did not come to its end: this computer has too little memory, or too much else to"
    " do. Try again in a moment."
)


class Reading(msgspec.Struct, frozen=True):
    """A line of the program in plain words."""

    line: int
    depth: int
    text: str


class Review(msgspec.Struct, frozen=True, kw_only=True):
    """What a person should know before approving a program."""

    program: str
    sha256: str
    """Of exactly this text; an approval holds for no other."""
    findings: tuple[Finding, ...]
    """In order of lines; one of severity "error" stands in the way of approval."""
    reading: tuple[Reading, ...]
    """The program in plain words, as it stands: an edited one, too."""
    dry_run: DryRun | None
    """None if there was an error, or no simulated world to try it in."""
    risks: tuple[Risk, ...] = ()
    """What to think about before approving it, in order of lines; stands in nobody's way."""

    @property
    def acceptable(self) -> bool:
        return not any(finding.severity == "error" for finding in self.findings)

    @property
    def came_through(self) -> bool:
        """Whether its dry run, where there was one, came to the program's end: not failed, not
        broken off. Else whoever runs it does so all the same."""
        return self.dry_run is None or self.dry_run.complete


def digest(program: str) -> str:
    """The hash that an approval is bound to."""
    return hashlib.sha256(program.encode()).hexdigest()


def review(
    program: str,
    knowledge: Knowledge,
    simulation: Simulation | None = None,
    language: str = "en",
    seed: int | None = None,
    recall: Recall | None = None,
    at: datetime | None = None,
) -> Review:
    """Check a program without moving anything. `simulation` is a copy of the simulated world, in
    which the program is tried; `seed` is what its `random` will begin with; `recall` answers what
    was done of it before; `at` is when it would begin, if that is not now: what it does on
    Christmas Eve at six, with the robot as it stands today."""
    findings = [*check(program, stub()), *violations(program, knowledge)]
    findings.sort(key=lambda finding: (finding.line, finding.column))
    acceptable = not any(finding.severity == "error" for finding in findings)
    tried = None
    if acceptable and simulation is not None:
        if at is not None:
            simulation.set_clock(at)
        tried = _tried(program, simulation, seed, knowledge, recall)
    return Review(
        program=program,
        sha256=digest(program),
        findings=tuple(findings),
        reading=tuple(reading(program, knowledge, language)) if acceptable else (),
        dry_run=tried.dry_run if tried else None,
        risks=risks(program, knowledge, language, tried),
    )


def get_ready(world: World, language: str = "en") -> None:
    """Begin a process for reviews in this world, and load there what they need, in the background:
    the first one shall not wait for that."""

    def load() -> None:
        with suppress(Exception):  # told when it is needed
            HELPERS.call(partial(_load, world, language), MOST_SECONDS)

    threading.Thread(target=load, name="getting ready", daemon=True).start()


def _load(world: World, language: str) -> None:
    from sim.simulation import Simulation

    simulation = Simulation(world) if world.has_geometry else None
    review("robot.wait(0)\n", Knowledge(world), simulation, language)


def _apart(function: Callable[P, Review]) -> Callable[P, Review]:
    def done(*given: P.args, **more: P.kwargs) -> Review:
        try:
            with _AT_A_TIME:
                return HELPERS.call(partial(function, *given, **more), MOST_SECONDS)
        except (TookTooLong, Died) as error:
            raise NotPossible(UNFINISHED) from error

    return done


review_apart: Final = _apart(review)
"""`review` in a process of its own, for who has to hear a stop meanwhile. Raises `NotPossible` if
that ends before it is through."""


def _tried(
    program: str,
    simulation: Simulation,
    seed: int | None,
    knowledge: Knowledge,
    recall: Recall | None,
) -> Tried:
    situation = Situation.of(simulation)
    skills = knowledge.capabilities.skills if knowledge.capabilities is not None else ()
    course = watched(program, simulation, seed=seed, skills=skills, recall=recall)
    return Tried(situation, *course)


def reading(program: str, knowledge: Knowledge, language: str) -> Iterator[Reading]:
    """A program that was checked, line by line in plain words."""
    called = naming(knowledge.lexicon(language), load_language(language)).called
    for told in explain_program(program, language, called):
        yield Reading(told.line, told.depth, told.text)
