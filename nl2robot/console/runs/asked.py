"""What a visitor asks of the log, as it stands in an address: `?words=tea&state=failed`."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import date
from typing import Any
from urllib.parse import urlencode

import msgspec

from nl2robot.errors import UserError
from nl2robot.run.archive import LONGEST, STATES, State, Wanted

PROPERTIES: Mapping[str, Any] = {
    "words": {"type": "string", "maxLength": LONGEST},
    "state": {"enum": ["", *STATES]},
    "since": {"type": "string", "maxLength": 10},
    "until": {"type": "string", "maxLength": 10},
    "before": {"type": "integer", "minimum": 1},
}
"""The JSON Schema of each, for the wire."""


class BadDay(UserError):
    """What should be a day is none."""

    def __init__(self, day: str) -> None:
        super().__init__(f"{day!r} is no day. Write it as 2026-11-24.")
        self.day = day


class Asked(msgspec.Struct, frozen=True, kw_only=True):
    """A page of the list."""

    words: str = ""
    state: State | None = None
    since: date | None = None
    until: date | None = None
    before: int | None = None

    @property
    def wanted(self) -> Wanted:
        return Wanted(words=self.words, state=self.state, since=self.since, until=self.until)

    @property
    def limited(self) -> bool:
        """Whether not just any run is wanted."""
        return self.wanted != Wanted()

    def query(self, before: int | None = None) -> str:
        """The address's end that asks for the same; with `before`, for runs older than that one."""
        given = {**msgspec.to_builtins(self), "before": before}
        some = {name: value for name, value in given.items() if value}
        return f"?{urlencode(some)}" if some else ""


def asked(given: Mapping[str, Any]) -> Asked:
    """What is asked. What makes no sense in an address is left out, but for a day, which somebody
    may have typed. Raises `BadDay`."""
    state, before = given.get("state"), str(given.get("before") or "")
    return Asked(
        words=str(given.get("words") or "").strip()[:LONGEST],
        state=state if state in STATES else None,
        since=_day(given.get("since")),
        until=_day(given.get("until")),
        before=int(before) if before.isascii() and before.isdigit() and len(before) < 19 else None,
    )


def _day(text: str | None) -> date | None:
    if not text:
        return None
    try:
        return date.fromisoformat(text.strip())
    except ValueError:
        raise BadDay(text[:30]) from None
