"""What stands in the book: appointments, each time that one was due, and what has to be told."""

from __future__ import annotations

from typing import Any, Final, Literal

import msgspec

from nl2robot.schedule.outcomes import Outcome
from nl2robot.schedule.rhythm import Rhythm
from nl2robot.schedule.triggers import Trigger

State = Literal["due", "claimed", "running", "done", "failed", "skipped", "missed", "asked"]
"""Of a time that came: it waits until the robot is free (due); it is taken, to be reviewed and
begun (claimed); its program runs; or what came of it. "skipped" was not wanted, "missed" was wanted
and not done, "asked" was not done because somebody has to approve it anew."""
OVER: Final = ("done", "failed", "skipped", "missed", "asked")

Why = Literal["ended", "changed", "moved"]
"""Why an appointment waits for a new approval: the last one held until then; the review came out
another way than the one that was approved; it is one of a fleet that another robot kept, or this
one before it lost its book of the fleet."""

NoticeKind = Literal[
    "missed",
    "missed_many",
    "overtaken",
    "waits",
    "ends_soon",
    "ended",
    "changed",
    "refused",
    "failed",
    "broken_off",
    "moved",
    "reminder_no",
    "reminder_unclear",
    "reminder_silent",
    "reminder_away",
    "reminder_gone",
    "trouble",
]
"""Trouble is one of our own sentences, about no appointment. Those of a reminder tell what somebody
has to see to; that it is done is only kept in the record (`nl2robot.schedule.reminders`)."""
NONE: Final = 0
"""The number of the appointment of what somebody had done at once."""

DAY: Final = 24 * 3600.0
ENDS_SOON: Final = 3 * DAY
"""Seconds before an approval ends in which that is told, once."""
HOLDS: Final = 30 * DAY
"""Seconds for which an appointment is approved, unless somebody says otherwise."""
MAKES_UP_AT_MOST: Final = 24 * 60
"""Minutes."""
PRIORITIES: Final = (0, 9)
ORDINARY: Final = 5


class Appointment(msgspec.Struct, frozen=True, kw_only=True):
    """An approved program with a time, a rhythm or an event at which it is done. Times are seconds
    since the epoch."""

    id: int
    program: str
    sha256: str
    """Of exactly this program, which is what was approved."""
    sentence: str
    """As somebody said it, for people to know it by."""
    plan: str | None
    """JSON, as the run log keeps it."""
    language: str
    rhythm: Rhythm | None
    """None for one that something else than the clock begins."""
    trigger: Trigger | None
    """What begins it instead; None for one by the clock."""
    robot: str
    """Its name, as its capabilities tell it; no other robot does it, unless it is the fleet's."""
    fleet: str | None = None
    """Of one that any robot of the fleet may do: the id in the fleet of the robot that keeps it,
    and hands it out. None: it is its robot's own."""
    approved_by: str
    approved_at: float
    approved_until: float
    """From then on it waits for a new approval."""
    reviewed: str
    """What the review found that was approved, see `nl2robot.schedule.findings`."""
    insists: bool
    """Whether it was approved though it did not come to its end when it was tried."""
    priority: int
    """0 to 9; of those that wait the highest begins first."""
    makes_up: int
    """Minutes after which it is still done, where it was due while nobody looked; 0: then it is
    left out."""
    paused: bool
    asked: Why | None
    """Why it waits for a new approval; None if it is approved."""
    added: float
    removed: float | None
    """It is only kept for what was done then."""
    looked: float
    """All times until then were looked at."""


class Occurrence(msgspec.Struct, frozen=True, kw_only=True):
    """A time at which an appointment was due."""

    id: int
    appointment: int
    due: float
    state: State
    run: int | None
    """Its number in the run log, if it was begun."""
    note: str | None
    """Why, in a sentence or a word: see `nl2robot/data/schedules.yaml`, "notes"."""
    process: int | None
    """That took it, see nl2robot/run/process.py."""
    began: float | None
    ended: float | None
    waited_for: str | None
    """What it last waited for, a word of `nl2robot.schedule.clerk.Waits`."""
    done_by: str | None = None
    """The name of the robot of the fleet that begins it, if that is another program's business than
    this one's: `run` is then None."""
    reminded: tuple[Outcome, ...] = ()
    """What that robot tells of it, if it reminded somebody."""


class Notice(msgspec.Struct, frozen=True, kw_only=True):
    """Something that somebody has to know who was not looking. `nl2robot.schedule.telling.told`
    makes a sentence of it."""

    id: int
    time: float
    kind: NoticeKind
    appointment: int
    """`NONE` if it is about a run without one, or none at all; `parts` then has the "robot"."""
    occurrence: int | None
    parts: dict[str, Any]
    """What the sentence is about: see `nl2robot/data/schedules.yaml`, "notices"."""
