"""From what words say of times to a rhythm: "every weekday at eight" becomes a rule.

What the words leave open is asked back: which of two times of day, or at what time at all.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from datetime import datetime, timedelta
from typing import Final

import msgspec

from grammar.requests import When
from grammar.times.bare_hours import A_DAY, Choice, choices, minutes_of
from nl2robot.schedule.rhythm import NEVER, WEEKDAYS, BadRhythm, Rhythm, checked, local, next_time

_MINUTE: Final = timedelta(minutes=1)
OTHER_WEEKDAY: Final = "That date is another day of the week. Say only one of the two."
PAST: Final = "That time is past. Say one that is still to come."


class Unclear(msgspec.Struct, frozen=True):
    """It may be at several times of day; without any, no time was said."""

    choices: tuple[Choice, ...]
    """Of each, all times of day that were said, in that reading."""


def rhythm_of(
    when: When, now: float, zone: str, *, times: Choice | None = None
) -> Rhythm | Unclear:
    """The rhythm that is meant by words said at that moment (seconds since the epoch). `times` are
    those of day that were chosen of what it may be, or said afterwards. Raises `BadRhythm`."""
    here = local(now, zone).replace(tzinfo=None, second=0, microsecond=0)
    if times is not None:
        when = replace(when, times=times, bare=())
    found = _choices(when, here)
    if len(found) > 1:
        return Unclear(found)
    when = replace(when, times=tuple(sorted(set(found[0]))))
    if when.minutes is not None and not when.repeats:
        exactly = local(now + when.minutes * 60 - 1e-6, zone).replace(tzinfo=None)
        return checked(Rhythm(exactly.replace(second=0, microsecond=0) + _MINUTE, zone))
    day = _first_day(when, here)
    if when.minutes is not None:
        return checked(_every(when, day, here, now, zone))
    if not when.times:
        return Unclear(())
    if not when.repeats:
        return checked(_once(when, day, here, zone))
    parts = ["FREQ=DAILY", *_days(when), *_of_day([minutes_of(each) for each in when.times])]
    return checked(_counted(when, Rhythm(day, zone, ";".join(parts)), now))


def first_time(when: When, now: float, zone: str) -> float | None:
    """When that is for the first time, in seconds since the epoch; None where it is to be asked
    first. Raises `BadRhythm`."""
    found = rhythm_of(when, now, zone)
    return next_time(found, now) if isinstance(found, Rhythm) else None


def _choices(when: When, here: datetime) -> tuple[Choice, ...]:
    """The times of day that may be meant. What time it is now tells of today only."""
    today = when.days_ahead == 0
    once_today = not when.repeats and not when.weekdays and when.date is None
    now = f"{here:%H:%M}" if once_today and (today or when.days_ahead is None) else None
    return choices(when.times, when.bare, now, today)


def _first_day(when: When, here: datetime) -> datetime:
    """The first minute of the day that is meant, of today if none is."""
    today = here.replace(hour=0, minute=0)
    if when.days_ahead is not None:
        return today + timedelta(days=when.days_ahead)
    if when.date is not None:
        day = _date(when.date, today)
        if when.weekdays and day.weekday() not in when.weekdays:
            raise BadRhythm(OTHER_WEEKDAY)
        return day
    if when.weekdays and not when.repeats:
        ahead = min((day - today.weekday()) % 7 for day in when.weekdays)
        return today + timedelta(days=ahead)
    return today


def _date(written: str, today: datetime) -> datetime:
    """ "2026-12-24", or the next "12-24"."""
    try:
        if written.count("-") == 2:
            return datetime.fromisoformat(written)
        for year in range(today.year, today.year + 9):  # 29 February comes again
            found = _day_of(f"{year}-{written}")
            if found is not None and found >= today:
                return found
    except ValueError:
        pass
    raise BadRhythm(f"There is no day {written}. Write it as 2026-11-30.")


def _day_of(written: str) -> datetime | None:
    try:
        return datetime.fromisoformat(written)
    except ValueError:
        return None


def _once(when: When, day: datetime, here: datetime, zone: str) -> Rhythm:
    """Once at each such time of day, the next that there are if no day was said. Of a day that was
    said, what is past is left out; raises `BadRhythm` if that is all of it."""
    said = [day + _MINUTE * minutes_of(each) for each in when.times]
    open_day = when.days_ahead is None and when.date is None
    if open_day and when.weekdays:
        moments = said if said[-1] > here else [each + timedelta(days=7) for each in said]
    elif open_day:
        moments = sorted(each if each > here else each + timedelta(days=1) for each in said)
    else:
        moments = said
    to_come = [each for each in moments if each > here]
    if not to_come:
        raise BadRhythm(PAST)
    first = to_come[0]
    if len(to_come) == 1:
        return Rhythm(first, zone)
    parts = ["FREQ=DAILY", *_of_day(sorted(minutes_of(f"{each:%H:%M}") for each in to_come))]
    return Rhythm(first, zone, ";".join([*parts, f"COUNT={len(to_come)}"]))


def _every(when: When, day: datetime, here: datetime, now: float, zone: str) -> Rhythm:
    """Every so many minutes: as they pass, or from one time of day to another."""
    assert when.minutes is not None
    if when.since is None and when.until is None and not when.weekdays:
        begins = here + _MINUTE if day <= here else day
        count = f";COUNT={when.count}" if when.count else ""
        return Rhythm(begins, zone, f"FREQ=MINUTELY;INTERVAL={int(when.minutes)}{count}")
    first = minutes_of(when.since) if when.since else 0
    last = minutes_of(when.until) if when.until else A_DAY - 1
    if last < first:
        last += A_DAY  # over midnight
    moments = sorted({each % A_DAY for each in range(first, last + 1, int(when.minutes))})
    parts = ["FREQ=DAILY", *_days(when), *_of_day(moments)]
    return _counted(when, Rhythm(day, zone, ";".join(parts)), now)


def _counted(when: When, rhythm: Rhythm, now: float) -> Rhythm:
    """Begun with the first time that is still to come, and with how many there are in all."""
    first = next_time(rhythm, now)
    if first is None:
        raise BadRhythm(NEVER)
    begins = local(first, rhythm.zone).replace(tzinfo=None)
    count = f";COUNT={when.count}" if when.count is not None and when.repeats else ""
    return Rhythm(begins, rhythm.zone, f"{rhythm.rule}{count}")


def _days(when: When) -> Iterator[str]:
    if when.weekdays and when.repeats:
        yield f"BYDAY={','.join(WEEKDAYS[day] for day in when.weekdays)}"


def _of_day(minutes: Sequence[int]) -> Iterator[str]:
    """The times of each day, as a rule says them: hours times minutes, and which of those."""
    hours = sorted({each // 60 for each in minutes})
    past = sorted({each % 60 for each in minutes})
    yield f"BYHOUR={','.join(map(str, hours))}"
    yield f"BYMINUTE={','.join(map(str, past))}"
    whole = [60 * hour + minute for hour in hours for minute in past]
    if len(whole) > len(minutes):
        places = (str(place) for place, each in enumerate(whole, 1) if each in minutes)
        yield f"BYSETPOS={','.join(places)}"
