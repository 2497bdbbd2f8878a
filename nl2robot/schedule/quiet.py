"""The hours of a ward in which no appointment begins: "22:00-06:00"."""

from __future__ import annotations

import re
from datetime import datetime, timedelta
from typing import Final

import msgspec

from nl2robot.errors import UserError
from nl2robot.schedule.rhythm import local, moment_of

_TIME: Final = r"([01]?\d|2[0-3]):([0-5]\d)"
_HOURS: Final = re.compile(rf"\s*{_TIME}\s*[-–]\s*{_TIME}\s*")


class QuietHours(msgspec.Struct, frozen=True):
    """From one time of day to another, over midnight if that is earlier. Minutes after midnight, by
    the clocks of `zone`."""

    begins: int
    ends: int
    zone: str

    def cover(self, moment: float) -> bool:
        there = local(moment, self.zone)
        minute = there.hour * 60 + there.minute
        if self.begins < self.ends:
            return self.begins <= minute < self.ends
        return minute >= self.begins or minute < self.ends

    def over(self, moment: float) -> float:
        """When those that cover the moment end, in seconds since the epoch."""
        there = local(moment, self.zone)
        day = datetime(there.year, there.month, there.day)
        if there.hour * 60 + there.minute >= self.ends:
            day += timedelta(days=1)
        return moment_of(day + timedelta(minutes=self.ends), self.zone)

    def __str__(self) -> str:
        return "-".join(f"{each // 60:02}:{each % 60:02}" for each in (self.begins, self.ends))


def quiet_hours(written: str, zone: str) -> QuietHours:
    """Raises `UserError` for what are no hours."""
    found = _HOURS.fullmatch(written)
    if found is None:
        raise UserError(f"{written!r} are no quiet hours. Write them like 22:00-06:00.")
    begins, ends = (int(found[at]) * 60 + int(found[at + 1]) for at in (1, 3))
    if begins == ends:
        raise UserError("Quiet hours that end when they begin are none, or the whole day.")
    return QuietHours(begins, ends, zone)
