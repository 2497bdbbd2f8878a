"""What the suite found: the problems, and a row for each capability."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Literal

import msgspec

State = Literal["works", "stood in for", "lacks", "not tried", "problems"]

PARTS = ("stopping", "limits", "events", "link", "two clients", "killed server")
"""What is looked at besides the capabilities of the method table."""


class Problem(msgspec.Struct, frozen=True):
    """Something that a driver does otherwise than promised."""

    method: str | None
    """The method, or None if it is about the driver as a whole."""
    message: str
    part: str
    """The capability or one of `PARTS`: the row that it stands in."""

    def __str__(self) -> str:
        return f"{self.method}: {self.message}" if self.method else self.message


class Row(msgspec.Struct, frozen=True, kw_only=True):
    """What was found of one capability, or of one of `PARTS`."""

    part: str
    state: State
    note: str = ""
    """By what it is stood in for, why the robot lacks it, why it was not tried."""
    without: tuple[str, ...] = ()
    """The methods that the robot lacks though it has the capability."""
    problems: tuple[Problem, ...] = ()

    @property
    def remarks(self) -> str:
        """All that is to be said besides the state, on one line."""
        lacking = f"without {', '.join(self.without)}" if self.without else ""
        return "; ".join(filter(None, (self.note, lacking, *map(str, self.problems))))


class Report(list[Problem]):
    """The problems, a list that is empty if there are none; and what was found of each part."""

    def __init__(self, robot: str, rows: Iterable[Row]) -> None:
        self.robot = robot
        """What the robot is called."""
        self.rows: Sequence[Row] = tuple(rows)
        super().__init__(problem for row in self.rows for problem in row.problems)

    def table(self) -> str:
        """A table in Markdown, which a terminal and a page of the docs take as it is."""
        cells = [
            ("", self.robot, "remarks"),
            *((row.part, row.state, row.remarks.replace("|", "\\|")) for row in self.rows),
        ]
        widths = [max(len(line[column]) for line in cells) for column in range(2)]
        lines = [
            f"| {part:{widths[0]}} | {state:{widths[1]}} | {remarks} |"
            for part, state, remarks in cells
        ]
        rule = f"|{'-' * (widths[0] + 2)}|{'-' * (widths[1] + 2)}|---|"
        return "\n".join([lines[0], rule, *lines[1:]]) + "\n"

    def to_json(self) -> dict[str, Any]:
        """The same as JSON data: {"robot": ..., "rows": [{"part": ..., "state": ..., ...}]}."""
        return {"robot": self.robot, "rows": msgspec.to_builtins(list(self.rows))}
