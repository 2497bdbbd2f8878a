"""How well a file of commands with logical forms is understood: right, refused or wrong.

A file has a row for each command: the words, a tab, the logical form in the notation of the GPSR
commands (Walker, Peng, Cakmak 2019), in which "<object>", "<room>" and so on stand for names. A
command counts as right if the plan, without its names, asks for the same actions with the same
arguments in the same roles (`nl2robot.checks.frames`).
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

from grammar.plan import from_data
from grammar.planning.rules import NAME as RULES
from grammar.prepared import forget
from nl2robot.checks.frames import UNKNOWN, Frame, frames_of_form, frames_of_plan, parsed
from nl2robot.errors import UserError
from nl2robot.knowledge import Knowledge
from nl2robot.translate.translation import translate
from robot_api.errors import cause
from sim.world.files import read_text

DEFAULT_WORLD: Final = "household"
FILLED: Final = {
    "object": "apple",
    "category": "fruit",
    "location": "sofa",
    "room": "kitchen",
    "name": "Alex",
    "gesture": "waving",
    "whattosay": "the time",
    "question": "the question",
}
"""What stands for a placeholder in the words themselves: the name of something that is at home
in the household."""

Outcome = Literal["right", "refused", "wrong"]


@dataclass(frozen=True)
class Row:
    """A command and what it is said to mean."""

    words: str
    form: str

    @property
    def kind(self) -> str:
        """The logical form, short enough for a table."""
        short = re.sub(r"lambda \$\d e|\$\d|is_a|person|[\"<>]", "", self.form)
        return re.sub(r"\( *and|[()\s]+", " ", short).strip()


@dataclass(frozen=True)
class Score:
    """What became of a row."""

    row: Row
    outcome: Outcome
    head: bool
    """Whether the right actions are asked for, whatever their arguments."""
    got: str
    """The frames of the plan, or why there is none."""
    wanted: str


def load(file: Path) -> list[Row]:
    """The rows of a file; a first line with the names of the columns is passed over."""
    try:
        lines = read_text(file).splitlines()
    except (OSError, UnicodeDecodeError) as problem:
        raise UserError(f"{file} cannot be read: {cause(problem)}.") from None
    rows: list[Row] = []
    for number, line in enumerate(lines, start=1):
        words, tab, form = line.partition("\t")
        if not line.strip() or (number == 1 and form.strip() == "logical_form"):
            continue
        if not tab:
            raise UserError(f"{file}:{number}: no tab between the words and the logical form.")
        try:
            parsed(form)
        except ValueError as problem:
            raise UserError(f"{file}:{number}: {problem}.") from None
        rows.append(Row(words.strip(), form.strip()))
    return rows


def score(row: Row, knowledge: Knowledge, planner: str = RULES) -> Score:
    """Understand a command, which no other has come before, and compare."""
    wanted = frames_of_form(parsed(row.form))
    shown = "; ".join(map(str, wanted)) or UNKNOWN
    words = re.sub(r"<(\w+)>", lambda mark: FILLED.get(mark[1].lower(), mark[1]), row.words)
    forget()
    answer = translate(words, knowledge, "en", planner)
    if answer.plan is None:
        honest = UNKNOWN in row.form
        return Score(row, "right" if honest else "refused", honest, answer.message or "", shown)
    got = frames_of_plan(from_data(answer.plan), knowledge.lexicon("en"))
    right = UNKNOWN not in row.form and _same(got, wanted)
    head = _same(_heads(got), _heads(wanted))
    return Score(row, "right" if right else "wrong", head, "; ".join(map(str, got)), shown)


def _heads(frames: Sequence[Frame]) -> list[Frame]:
    return [Frame(each.head, optional=each.optional) for each in frames]


def _same(got: Sequence[Frame], wanted: Sequence[Frame]) -> bool:
    """Whether both ask for the same, with or without what is optional."""
    required = [each for each in got if not each.optional]
    every = [Frame(each.head, each.features) for each in got]
    return list(wanted) in (required, every)


@dataclass(frozen=True)
class Total:
    """The figures of several rows, as shares of 1."""

    rows: int
    head: float
    right: float
    refused: float
    wrong: float


def total(scores: Sequence[Score]) -> Total:
    outcomes = Counter(each.outcome for each in scores)
    count = max(1, len(scores))
    return Total(
        len(scores),
        sum(each.head for each in scores) / count,
        outcomes["right"] / count,
        outcomes["refused"] / count,
        outcomes["wrong"] / count,
    )


def by_kind(scores: Iterable[Score]) -> dict[str, list[Score]]:
    """The scores of each kind of logical form, the most frequent first."""
    kinds: dict[str, list[Score]] = {}
    for each in scores:
        kinds.setdefault(each.row.kind, []).append(each)
    return dict(sorted(kinds.items(), key=lambda item: -len(item[1])))
