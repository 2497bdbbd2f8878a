"""What a review found, kept with an approval, and what is new in a later one.

An appointment is approved once and done many times in a world that changes: a zone is drawn, a
ward is added, a door is locked. Before each time its program is reviewed again, and what is in that
review and was not in the approved one has to be seen by somebody. Where the robot happens to stand
then, who walks about and how long it takes is no news, nor is a risk that is gone. Who is looked
for may be anywhere, so a program that looks for somebody is approved for all places at once.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final, Literal

import msgspec

from nl2robot.review.rehearsal import DryRun
from nl2robot.review.review import Review

_DEPENDS_ON_THE_MOMENT: Final = ("leaves", "long", "unproven")
"""Kinds of risks: out of the ward that the robot stands in, how long the way is; whether it came to
its end is told by itself."""


class News(msgspec.Struct, frozen=True):
    """Something that a review found and an earlier one did not."""

    kind: Literal["finding", "risk", "place", "closed", "fails"]
    text: str
    """Of a finding or a risk its sentence, of a failure its message, else a place."""


class Findings(msgspec.Struct, frozen=True, kw_only=True):
    """What of a review an approval is for."""

    findings: tuple[tuple[int, str], ...]
    """Line and sentence."""
    risks: tuple[tuple[int, str, str], ...]
    """Line, kind and sentence."""
    stood: str | None
    """Where the robot was when it was tried; None if nobody tried it, or that place has no name."""
    places: tuple[str, ...]
    """Where something was done, or it ended; sorted."""
    closed: tuple[str, ...]
    """The places of its rounds that it could not reach."""
    complete: bool
    """Whether it came to its end."""
    error: str | None
    message: str | None
    looks_everywhere: bool = False
    """Whether it looks for somebody, or something, wherever that may be."""


def findings_of(review: Review) -> Findings:
    dry_run = review.dry_run
    visited = dry_run.places if dry_run is not None else ()
    return Findings(
        findings=tuple((each.line, each.message) for each in review.findings),
        risks=tuple(
            (each.line, each.kind, each.text)
            for each in review.risks
            if each.kind not in _DEPENDS_ON_THE_MOMENT
        ),
        stood=visited[0] if visited else None,
        places=tuple(sorted(set(_worked_in(dry_run)))) if dry_run is not None else (),
        closed=tuple(sorted(dry_run.closed)) if dry_run is not None else (),
        complete=review.came_through,
        error=dry_run.error if dry_run is not None else None,
        message=dry_run.message if dry_run is not None else None,
        looks_everywhere=_looks_everywhere(review.program),
    )


def encoded(findings: Findings) -> str:
    """As the book keeps it."""
    return msgspec.json.encode(findings).decode()


def decoded(kept: str) -> Findings:
    return msgspec.json.decode(kept, type=Findings)


def news(approved: Findings, now: Findings) -> tuple[News, ...]:
    """What somebody has to see before it is done once more; empty if nothing is."""
    return tuple(_news(approved, now))


def _news(approved: Findings, now: Findings) -> Iterator[News]:
    known = set(approved.findings)
    for line, message in now.findings:
        if (line, message) not in known:
            yield News("finding", message)
    risks = {(line, kind) for line, kind, _ in approved.risks}
    for line, kind, text in now.risks:
        if (line, kind) not in risks:
            yield News("risk", text)
    anywhere = approved.looks_everywhere and now.looks_everywhere
    for place in () if anywhere else now.places:
        if place not in approved.places and place != now.stood:
            yield News("place", place)
    for place in now.closed:
        if place not in approved.closed:
            yield News("closed", place)
    if not now.complete and (approved.complete or approved.error != now.error):
        yield News("fails", now.message or "")


def _worked_in(dry_run: DryRun) -> Iterator[str]:
    place = None
    for event in dry_run.course:
        if event.kind == "was at":
            place = event.what
        elif place is not None:
            yield place
    if place is not None:
        yield place


def _looks_everywhere(program: str) -> bool:
    """Whether it calls `robot.find` without a place."""
    try:
        tree = ast.parse(program)
    except (SyntaxError, ValueError, RecursionError):
        return False
    return any(
        isinstance(each, ast.Call)
        and isinstance(each.func, ast.Attribute)
        and each.func.attr == "find"
        and isinstance(each.func.value, ast.Name)
        and each.func.value.id == "robot"
        and len(each.args) < 2
        and all(given.arg != "place" for given in each.keywords)
        for each in ast.walk(tree)
    )
