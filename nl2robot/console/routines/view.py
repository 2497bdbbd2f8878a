"""A routine as the page shows it: what it does in the reader's words, its steps, its program, and
what the dry run says."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from datetime import datetime
from functools import lru_cache
from typing import Any, Final, TypedDict

from markupsafe import Markup

from grammar.explain import explain_steps
from grammar.language import load_language
from grammar.lexicon import Lexicon
from grammar.naming import naming
from grammar.plan import Plan
from grammar.program import write_program
from grammar.summary import summary
from grammar.writing import PlanError
from nl2robot.console.desk.highlight import highlighted
from nl2robot.console.desk.outlook import outlook
from nl2robot.console.visitor import texts
from nl2robot.review.review import Review
from nl2robot.run.archive import Archive
from nl2robot.run.runlog import LogError
from nl2robot.run.trouble import told
from nl2robot.station.part import Backstage
from nl2robot.translate.routines import Routine
from nl2robot.translate.teaching import Teacher
from sim.world.model import World

CARDS_KNOWN: Final = 500


class Shown(TypedDict):
    """A routine for the wire; `steps` are depth and text, times ISO 8601, local."""

    name: str
    language: str
    sentence: str
    program: str
    sha256: str
    works: bool
    does: str
    steps: list[tuple[int, str]]
    written: str
    learned: str
    by: str
    changed: str
    changed_by: str
    formerly: list[str]
    imported: str
    reviewed: bool
    reviewed_by: str
    runs: int | None


@dataclass(frozen=True)
class Body:
    """What a sentence or a program does here, for one reader."""

    works: bool
    does: str
    """In plain words; why it cannot be used here, if it does not work."""
    steps: tuple[tuple[int, str], ...] = ()
    program: str = ""


@dataclass(frozen=True)
class Card:
    """A routine for one reader."""

    routine: Routine
    body: Body
    runs: int | None
    """How often it was run; None if that cannot be read."""

    @property
    def lines(self) -> list[Markup]:
        return highlighted(self.body.program) if self.body.program else []

    @property
    def sha256(self) -> str:
        return digest(self.routine)


def digest(routine: Routine) -> str:
    """The hash that a review of a routine is bound to."""
    return hashlib.sha256(routine.body.encode()).hexdigest()


class Viewer:
    """Makes cards of routines."""

    def __init__(self, backstage: Backstage, archive: Archive) -> None:
        self._backstage = backstage
        self._knowledge = backstage.runner.knowledge
        self._archive = archive
        # A sentence takes some milliseconds to be understood, and a page has many.
        self._understood = lru_cache(CARDS_KNOWN)(self._understand)

    def cards(self, reader: str) -> list[Card]:
        """All routines: those in the reader's language first."""
        assert self._knowledge.routines is not None
        known = sorted(
            self._knowledge.routines.known(),
            key=lambda each: (each.language != reader, each.language, each.name.lower()),
        )
        return [self.card(each, reader) for each in known]

    def card(self, routine: Routine, reader: str) -> Card:
        return Card(routine, self.body(routine, reader), self._times(routine))

    def body(self, routine: Routine, reader: str) -> Body:
        """What a routine does, also one that is not kept yet."""
        lexicons = (self._knowledge.lexicon(routine.language), self._knowledge.lexicon(reader))
        return self._understood(routine, lexicons, reader)

    def _understand(self, routine: Routine, lexicons: tuple[Lexicon, ...], reader: str) -> Body:
        plan, why = Teacher.of(self._knowledge, routine.language).plan_of(routine)
        if plan is None:
            return Body(False, why, program=routine.program)
        try:
            program = routine.program or write_program(plan)
        except PlanError:
            program = ""
        steps = self._steps(plan, lexicons[-1], reader)
        review = self._backstage.runner.review
        findings = review(program, self._knowledge, language=reader).findings if program else ()
        errors = [found for found in findings if found.severity == "error"]
        if errors:
            line = f"{texts('desk', reader)['line']} {errors[0].line}"
            why = f"{line}: {told(errors[0].code, errors[0].message, reader, lexicons[-1])}"
            return Body(False, why, steps, program)
        called = naming(lexicons[-1], load_language(reader)).called
        return Body(True, summary(plan, reader, called), steps, program)

    @staticmethod
    def _steps(plan: Plan, lexicon: Lexicon, reader: str) -> tuple[tuple[int, str], ...]:
        return tuple(explain_steps(plan, reader, naming(lexicon, load_language(reader)).called))

    def _times(self, routine: Routine) -> int | None:
        try:
            since = datetime.fromisoformat(routine.learned).timestamp() if routine.learned else 0.0
        except ValueError:  # somebody wrote it by hand
            since = 0.0
        try:
            return self._archive.times_said((routine.name, *routine.formerly), since)
        except LogError:
            return None

    def tested(self, body: Body, reader: str) -> dict[str, Any]:
        """The dry run of what a routine does, with its picture; nothing moves."""
        reviewed = self._backstage.runner.check(body.program, reader)
        seen = outlook(reviewed, texts("desk", reader), reader, self._knowledge)
        return {
            **seen.as_told(texts("desk", reader)),
            "good": seen.good and reviewed.acceptable,
            "picture": _picture(reviewed, self._knowledge.world),
        }


def as_data(card: Card) -> dict[str, Any]:
    """A card for the wire."""
    routine, body = card.routine, card.body
    return {
        "name": routine.name,
        "language": routine.language,
        "sentence": routine.sentence,
        "program": routine.program,
        "sha256": card.sha256,
        "works": body.works,
        "does": body.does,
        "steps": [list(step) for step in body.steps],
        "written": body.program,
        "learned": routine.learned,
        "by": routine.by,
        "changed": routine.changed,
        "changed_by": routine.changed_by,
        "formerly": list(routine.formerly),
        "imported": routine.imported,
        "reviewed": routine.reviewed,
        "reviewed_by": routine.reviewed_by,
        "runs": card.runs,
    }


def _picture(reviewed: Review, world: World) -> str | None:
    """The way of the dry run on the floor, as SVG; None if it stays where it is."""
    path = reviewed.dry_run.path if reviewed.dry_run is not None else ()
    if len(path) < 2 or not world.has_geometry:
        return None
    from sim.pictures import drawing as pictures

    return pictures.way_svg(world, path)
