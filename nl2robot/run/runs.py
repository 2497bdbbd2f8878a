"""A run as those see it who have no part in it: the word that lets it begin, and how it stands."""

from __future__ import annotations

from typing import Literal

import msgspec

State = Literal["running", "pausing", "paused", "done", "failed", "stopped", "limit"]


class Approval(msgspec.Struct, frozen=True, kw_only=True):
    """Somebody's word that exactly this program may run once."""

    id: str
    program: str
    sha256: str
    by: str
    at: float
    """Seconds since the epoch."""
    utterance: str | None = None
    heard: str | None = None
    language: str | None = None
    plan: str | None = None
    continues: int | None = None
    """The run that was broken off, with which it goes on; what was done there is not done again."""
    proposed: str | None = None
    """The program that was proposed, if somebody changed it by hand."""
    changed_by: str | None = None


class Status(msgspec.Struct, frozen=True, kw_only=True):
    """How a run stands; what `program.state` and `program.wait` answer."""

    run: int
    state: State
    line: int | None
    message: str | None
    """Why it is not done, if it is over and is not."""
    error: str | None
    """What it failed with, as `sandbox.execution.Outcome.error`."""
    program: str
    sha256: str
    calls: int
    robot_lost_since: float | None = None
    """Seconds since the epoch; None while the robot can be reached."""
