"""The times that options name: `--at 08:00 --every weekday`."""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import date, datetime, timedelta
from typing import Final

import msgspec

from nl2robot.errors import UserError
from nl2robot.schedule.rhythm import WEEKDAYS, Rhythm, checked, moment_of
from nl2robot.texts import texts_in

DAYS: Final = {
    "day": "FREQ=DAILY",
    "weekday": "FREQ=WEEKLY;BYDAY=MO,TU,WE,TH,FR",
    "weekend": "FREQ=WEEKLY;BYDAY=SA,SU",
    "week": "FREQ=WEEKLY",
    "month": "FREQ=MONTHLY",
    "year": "FREQ=YEARLY",
}
_PASSING: Final = re.compile(r"(\d{1,4})\s*(m|min|minutes?|h|hours?)")
_AT: Final = re.compile(r"(?:(\d{4}-\d{2}-\d{2})[ T])?([01]?\d|2[0-3]):([0-5]\d)")


def rhythm_of_options(
    at: str | None, every: str | None, until: str | None, zone: str, now: datetime
) -> Rhythm:
    """What `--at`, `--every` and `--until` say; `now` is local. Raises `UserError`."""
    begins = _begins(at, every, now)
    rule = _rule(every) if every is not None else None
    if rule is not None and until is not None:
        rule += f";UNTIL={day_of(until):%Y%m%d}"
    if rule is None and at is not None and " " not in at and "T" not in at and begins <= now:
        begins += timedelta(days=1)
    return checked(Rhythm(begins, zone, rule))


def day_of(written: str) -> date:
    """Raises `UserError`."""
    try:
        return date.fromisoformat(written)
    except ValueError:
        raise UserError(f"There is no day {written}. Write it as 2026-11-30.") from None


def end_of(written: str, zone: str) -> float:
    """When that day is over there, in seconds since the epoch. Raises `UserError`."""
    day = day_of(written) + timedelta(days=1)
    return moment_of(datetime(day.year, day.month, day.day), zone)


def _begins(at: str | None, every: str | None, now: datetime) -> datetime:
    if at is None:
        if every is None or not _PASSING.fullmatch(every):
            raise UserError("Say at what time of day: --at 08:00.")
        return now.replace(second=0, microsecond=0) + timedelta(minutes=1)
    found = _AT.fullmatch(at.strip())
    if found is None:
        raise UserError(f"{at!r} is no time. Write it as 08:00 or 2026-12-24 08:00.")
    day = day_of(found[1]) if found[1] else now.date()
    return datetime(day.year, day.month, day.day, int(found[2]), int(found[3]))


def _rule(every: str) -> str:
    said = every.strip().lower()
    if said in DAYS:
        return DAYS[said]
    passing = _PASSING.fullmatch(said)
    if passing is not None:
        frequency = "HOURLY" if passing[2].startswith("h") else "MINUTELY"
        return f"FREQ={frequency};INTERVAL={int(passing[1])}"
    days = [_weekday(each.strip()) for each in said.split(",")]
    return f"FREQ=WEEKLY;BYDAY={','.join(WEEKDAYS[day] for day in sorted(set(days)))}"


def _weekday(name: str) -> int:
    known = [_names(language) for language in ("en", "de", "fr")]
    for names in known:
        if name in names:
            return names.index(name)
    raise UserError(
        f"{name!r} is no rhythm. Choose one of {', '.join(DAYS)}, a weekday (monday,thursday),"
        " or how many minutes or hours pass (30m, 2h)."
    )


def _names(language: str) -> Sequence[str]:
    weekdays = msgspec.convert(texts_in(language, "schedules")["weekdays"], list[str])
    return [each.lower() for each in weekdays]
