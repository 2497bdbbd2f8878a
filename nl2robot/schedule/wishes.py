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
from nl2robot.schedule.rhythm import NEVER, WEEKDAYS, BadRhythm, Rhythm, checked, local, next_time

_MINUTE: Final = timedelta(minutes=1)
_A_DAY: Final = 24 * 60


class Unclear(msgspec.Struct, frozen=True):
    """It may be at several times of day; without any, no time was said."""

    times: tuple[str, ...]


def rhythm_of(when: When, now: float, zone: str, *, time: str | None = None) -> Rhythm | Unclear:
    """The rhythm that is meant by words said at that moment (seconds since the epoch). `time` is
    the time of day that was chosen of those it may be, or said afterwards. Raises `BadRhythm`."""
    if time is not None:
        when = replace(when, times=(time,), unclear=())
    if when.unclear:
        return Unclear(when.unclear)
    here = local(now, zone).replace(tzinfo=None, second=0, microsecond=0)
    if when.minutes is not None and not when.repeats:
        return checked(Rhythm(here + _MINUTE * (when.minutes + 1), zone))
    day = _first_day(when, here)
    if when.minutes is not None:
        return checked(_every(when, day, here, now, zone))
    if not when.times:
        return Unclear(())
    if not when.repeats and len(when.times) == 1:
        return checked(Rhythm(_once(when, day, here), zone))
    parts = ["FREQ=DAILY", *_days(when), *_of_day([_minutes(each) for each in when.times])]
    if not when.repeats:
        parts += [f"COUNT={len(when.times)}"]
    return checked(_counted(when, Rhythm(day, zone, ";".join(parts)), now))


def _first_day(when: When, here: datetime) -> datetime:
    """The first minute of the day that is meant, of today if none is."""
    today = here.replace(hour=0, minute=0)
    if when.days_ahead is not None:
        return today + timedelta(days=when.days_ahead)
    if when.date is not None:
        return _date(when.date, today)
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


def _once(when: When, day: datetime, here: datetime) -> datetime:
    """The next such time of day, if no day was said."""
    at = day + _MINUTE * _minutes(when.times[0])
    if at > here:
        return at
    if when.weekdays:
        return at + timedelta(days=7)
    return at + timedelta(days=1) if when.days_ahead is None and when.date is None else at


def _every(when: When, day: datetime, here: datetime, now: float, zone: str) -> Rhythm:
    """Every so many minutes: as they pass, or from one time of day to another."""
    assert when.minutes is not None
    if when.since is None and when.until is None and not when.weekdays:
        begins = here + _MINUTE if day <= here else day
        count = f";COUNT={when.count}" if when.count else ""
        return Rhythm(begins, zone, f"FREQ=MINUTELY;INTERVAL={when.minutes}{count}")
    first = _minutes(when.since) if when.since else 0
    last = _minutes(when.until) if when.until else _A_DAY - 1
    if last < first:
        last += _A_DAY  # over midnight
    moments = sorted({each % _A_DAY for each in range(first, last + 1, when.minutes)})
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


def _minutes(time: str) -> int:
    hour, _, minute = time.partition(":")
    return int(hour) * 60 + int(minute)
