"""The next moment that a clock shows some time: over midnight, on a weekday, on a date, and over
the hours that daylight saving leaves out or has twice.

Nothing here looks at a clock. Moments are `datetime`s with a time zone; two of them are compared
and subtracted in UTC, since Python does so by what the clocks show where both have the same zone.
"""

from __future__ import annotations

from datetime import UTC, date, datetime, time, timedelta
from typing import Final

from robot_api.errors import InvalidCall, NotPossible
from robot_api.methods import WEEKDAYS

_A_MINUTE: Final = timedelta(minutes=1)
_A_SECOND: Final = timedelta(seconds=1)
_DAYS_AHEAD: Final = 9
"""A weekday comes within seven days, a time that is over today on the next; and one day may be left
out, as the Samoans' was when they changed sides of the date line."""


def next_moment(
    now: datetime, clock: str, weekday: str | None = None, day: str | None = None
) -> datetime:
    """The first moment after `now` at which clocks in its zone show `clock` ("06:00"), on that
    weekday ("Monday") or on that day ("2026-12-24") if they are given.

    A time that clocks leave out that day is the first moment after the gap; of one that they show
    twice, it is the first. Of a day that is given, the minute that has just begun still counts.
    Raises `InvalidCall` for a day that no calendar has or that is not that weekday, and
    `NotPossible` if it is past.
    """
    hour, minute = (int(part) for part in clock.split(":"))
    shown = time(hour, minute)
    if day is not None:
        return _on_a_date(now, shown, weekday, day)
    for ahead in range(_DAYS_AHEAD):
        that_day = now.date() + timedelta(days=ahead)
        if weekday is not None and WEEKDAYS[that_day.weekday()] != weekday:
            continue
        moment = first_shown(datetime.combine(that_day, shown, now.tzinfo))
        if seconds_until(moment, now) > 0:
            return moment
    raise AssertionError(f"no {clock} within {_DAYS_AHEAD} days of {now}")


def seconds_until(moment: datetime, now: datetime) -> float:
    """Below zero if it is past."""
    return (moment.astimezone(UTC) - now.astimezone(UTC)).total_seconds()


def in_a_zone(moment: datetime) -> datetime:
    """One without a zone is in UTC."""
    return moment if moment.tzinfo is not None else moment.replace(tzinfo=UTC)


def later(moment: datetime, seconds: float) -> datetime:
    """What the clock shows so many seconds after that: where it is set meanwhile, an hour more or
    less than the seconds make."""
    return (moment.astimezone(UTC) + timedelta(seconds=seconds)).astimezone(moment.tzinfo)


def zone_name(moment: datetime) -> str:
    """What its time zone is called: "Europe/Zurich", or "UTC+01:00" where nobody gave it a name."""
    return str(getattr(moment.tzinfo, "key", None) or moment.tzname() or "UTC")


def first_shown(wanted: datetime) -> datetime:
    """The first moment at which clocks show that date and time, or are beyond it, where they leap
    over it; of one that they show twice, it is the first."""
    wanted = wanted.replace(fold=0)
    before, after = wanted.utcoffset(), wanted.replace(fold=1).utcoffset()
    if before is None or after is None or before >= after:
        return wanted
    # What is read with the offset before the leap lies after it, and the other way round.
    low, high = wanted.replace(fold=1).astimezone(UTC), wanted.astimezone(UTC)
    while high - low > _A_SECOND:
        middle = low + (high - low) / 2
        if middle.astimezone(wanted.tzinfo).utcoffset() == before:
            low = middle
        else:
            high = middle
    return datetime.fromtimestamp(round(high.timestamp()), wanted.tzinfo)


def _on_a_date(now: datetime, shown: time, weekday: str | None, day: str) -> datetime:
    try:
        that_day = date.fromisoformat(day)
    except ValueError:
        raise InvalidCall(
            f'There is no day "{day}" in the calendar. Write year, month and day, as in'
            ' "2026-12-24".'
        ) from None
    called = WEEKDAYS[that_day.weekday()]
    if weekday not in (None, called):
        raise InvalidCall(f"{day} is a {called}, not a {weekday}. Leave one of the two out.")
    moment = first_shown(datetime.combine(that_day, shown, now.tzinfo))
    if seconds_until(moment + _A_MINUTE, now) <= 0:
        raise NotPossible(
            f"{shown:%H:%M} on {day} is past: now it is {now:%H:%M} on {now:%Y-%m-%d}."
            " Say a time that is still to come."
        )
    return moment
