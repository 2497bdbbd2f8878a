"""What came of an attack, in a row of the table that all of them end in."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Final

from rich.table import Table

from nl2robot.cli.terminal import Terminal

LONGEST: Final = 2500
"""Letters of a line of what somebody is told."""
_BEGINS: Final = re.compile(r"[\W\d_]*[^\W\d_]")
_ENDS: Final = re.compile(r"[.!?…:]\W*\Z")
_ONE_WORD: Final = re.compile(r"[^\W\d_][^\WA-Z\d_]*[.!?]")
"""A sentence all the same: "Merci."."""
_INNARDS: Final = re.compile(
    r"Traceback \(most|File \"[^\"]+\", line \d|<class '|<[^>]+ at 0x[0-9a-f]+>"
    r"|has a fault|Something went wrong inside"
)


@dataclass
class Row:
    """One attack."""

    attack: str
    tried: int = 0
    survived: int = 0
    stop: float | None = None
    """Milliseconds of the longest stop, where there were any: from its request to the answer that
    the robot stands; or, if who had it act was killed, from then until it stood."""
    memory: float | None = None
    """Megabytes that whoever was attacked has used at most."""
    failures: list[str] = field(default_factory=list)
    """Each with what makes it happen again."""

    def add(self, failure: str | None) -> None:
        """Count one more that was tried; `failure` tells what was not borne."""
        self.tried += 1
        if failure is None:
            self.survived += 1
        else:
            self.failures.append(failure)

    def stopped_in(self, milliseconds: float) -> None:
        self.stop = max(self.stop or 0.0, milliseconds)

    def used(self, megabytes: float) -> None:
        self.memory = max(self.memory or 0.0, megabytes)


def what_is_no_sentence(text: str | None) -> str | None:
    """Why this is nothing to say to people; None if it is a sentence, or several."""
    if not text or not text.strip():
        return "nothing is said"
    if _INNARDS.search(text):
        return f"innards of the software are shown: {text[:300]!r}"
    words = " " in text.strip() or _ONE_WORD.fullmatch(text.strip())
    if not _BEGINS.match(text) or not _ENDS.search(text) or not words:
        return f"no sentence: {text[:300]!r}"
    if len(max(text.splitlines(), key=len)) > LONGEST:
        return f"a line of {len(max(text.splitlines(), key=len))} letters: {text[:200]!r}"
    return None


def report(rows: Sequence[Row], title: str = "Attacks") -> int:
    """Print the failures and the table; returns the status to exit with."""
    console = Terminal().console
    failures = [(row.attack, failure) for row in rows for failure in row.failures]
    for attack, failure in failures:
        console.print(f"{attack}: {failure}", markup=False, highlight=False, soft_wrap=True)
    table = Table("attack", "tried", "survived", "worst stop", "worst memory", title=title)
    for column in table.columns[1:]:
        column.justify = "right"
    for row in rows:
        table.add_row(row.attack, *_told(row))
    table.add_row("all", *_told(total(rows)), style="bold")
    console.print(table)
    lost = any(row.survived < row.tried for row in rows) or bool(failures)
    return int(lost)


def total(rows: Iterable[Row]) -> Row:
    """All of them in one, but for the stops: not all of those were asked for by somebody."""
    whole = Row("all")
    for row in rows:
        whole.tried += row.tried
        whole.survived += row.survived
        if row.memory is not None:
            whole.used(row.memory)
    return whole


def _told(row: Row) -> tuple[str, str, str, str]:
    stop = "" if row.stop is None else f"{row.stop:.1f} ms"
    memory = "" if row.memory is None else f"{row.memory:.0f} MB"
    return f"{row.tried:,}", f"{row.survived:,}", stop, memory


def say(text: str) -> None:
    """Tell how far it is, beside the table."""
    print(text, file=sys.stderr, flush=True)
