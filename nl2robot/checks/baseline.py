"""What sentences became when they were last kept, so that it can be told what changed since.

A baseline is a JSON file beside a team's sentences: for each file and sentence, its status and its
program. It is written when it is not there, and again when asked for; a change is no failure.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import msgspec

from nl2robot.changes import difference
from nl2robot.checks.canned import Result
from nl2robot.errors import UserError
from robot_api.errors import cause


class Kept(msgspec.Struct, frozen=True):
    """What a sentence became."""

    status: str
    program: str | None


Baseline = dict[str, dict[str, Kept]]
"""By file, then by sentence."""


def kept(results: Iterable[tuple[str, Result]]) -> Baseline:
    """The baseline of these results; each comes with the name of its file."""
    baseline: Baseline = {}
    for name, result in results:
        became = Kept(result.status, result.program)
        baseline.setdefault(name, {})[result.test.say] = became
    return baseline


def read(file: Path) -> Baseline:
    """Read a baseline. Raises `UserError`."""
    try:
        return msgspec.json.decode(file.read_bytes(), type=Baseline)
    except (OSError, msgspec.DecodeError) as error:
        raise UserError(
            f"{file}: this is no baseline ({cause(error)})."
            " Delete it, and the next run writes a new one."
        ) from error


def write(file: Path, baseline: Baseline) -> None:
    """Write a baseline, one sentence a line or more, so that a version control can compare it.
    Raises `UserError`."""
    data = msgspec.json.format(msgspec.json.encode(baseline), indent=1)
    try:
        file.write_bytes(data + b"\n")
    except OSError as error:
        raise UserError(f"{file}: the baseline cannot be written ({error.strerror}).") from error


def changes(before: Baseline, now: Baseline) -> Iterable[str]:
    """Each sentence that became something else, in words."""
    for name, sentences in now.items():
        old = before.get(name, {})
        for say, became in sentences.items():
            was = old.get(say)
            if was is None:
                yield f"{name}: new: {say}"
            elif was.status != became.status:
                yield f"{name}: was {was.status}, is {became.status} now: {say}"
            elif was != became:
                shown = difference(was.program or "", became.program or "", "before", "now")
                yield f"{name}: another program now: {say}\n{shown}"
        yield from (f"{name}: gone: {say}" for say in old if say not in sentences)
