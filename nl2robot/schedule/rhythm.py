"""At what times something is done: once, or again and again by a rule of RFC 5545.

A rhythm is kept as people mean it, in the time of day of a place: "every weekday at 08:00" is eight
o'clock in Zurich in summer and in winter. A time of day that the clocks leap over in spring happens
at the first moment after it; one that they show twice in autumn happens once, at the first. A bare
"every ten minutes" counts minutes as they pass, whatever the clocks do.

`next_time` and `times` are what others need. Nothing here knows what time it is now.
"""

from __future__ import annotations

import functools
import itertools
import re
from calendar import monthrange
from collections.abc import Iterator, Mapping
from datetime import datetime, timedelta
from typing import TYPE_CHECKING, Final, Literal
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

import msgspec

from nl2robot.errors import UserError
from robot_api.local_time import local_zone
from robot_api.moments import first_shown

if TYPE_CHECKING:
    from dateutil.rrule import rrule

WEEKDAYS: Final = ("MO", "TU", "WE", "TH", "FR", "SA", "SU")
"""As rules name them; the place of each is Python's `weekday()`."""
SHORTEST: Final = timedelta(minutes=5)
"""Between two times of a rhythm, unless a house says otherwise."""
LOOKED_AHEAD: Final = timedelta(days=5 * 366)
"""Times are told for so long: a rule that names none within it has none."""
LONGEST_RULE: Final = 500
"""Characters."""
MOST_TIMES: Final = 10_000
"""That a rule may count."""
NEVER: Final = "There is no day on which this would ever be. Choose another one."
_LEAP_YEAR: Final = 2024
_SAMPLE: Final = 300
"""Times of a rhythm that are looked at to see how fast it is: days of it, or years."""
_YEARS: Final = (2000, 2199)
_STEPS: Final = {
    "MINUTELY": timedelta(minutes=1),
    "HOURLY": timedelta(hours=1),
    "DAILY": timedelta(days=1),
    "WEEKLY": timedelta(weeks=1),
}
"""What is always equally long by the clock on the wall."""
_INTERVALS: Final = {
    "MINUTELY": 10_000,
    "HOURLY": 1_000,
    "DAILY": 366,
    "WEEKLY": 53,
    "MONTHLY": 12,
    "YEARLY": 4,
}
"""The frequencies, and how many of each may lie between two times."""
_RANGES: Final[Mapping[str, tuple[int, int]]] = {
    "INTERVAL": (1, 10_000),
    "COUNT": (1, MOST_TIMES),
    "BYMONTH": (1, 12),
    "BYMONTHDAY": (-31, 31),
    "BYHOUR": (0, 23),
    "BYMINUTE": (0, 59),
    "BYSETPOS": (-366, 366),
}
_SINGLE: Final = ("INTERVAL", "COUNT")
_DAY: Final = re.compile(r"([+-]?[1-5])?(MO|TU|WE|TH|FR|SA|SU)")
_UNTIL: Final = re.compile(r"(\d{8})(?:T(\d{4})(\d{2})?)?")


class BadRhythm(UserError):
    """No times can be told by it; says why."""


class Rhythm(msgspec.Struct, frozen=True):
    """When something is done. `checked` says whether times can be told by it."""

    begins: datetime
    """The first time it may happen, and the time of day of a rule that names none: local, without
    a zone, to the minute."""
    zone: str
    """ "Europe/Zurich", of the IANA's time zones."""
    rule: str | None = None
    """What RFC 5545 writes after "RRULE:", such as "FREQ=WEEKLY;BYDAY=MO,TU": all of it but
    seconds, weeks of the year and days of the year; times in it are local. None for once."""


def checked(rhythm: Rhythm, shortest: timedelta = SHORTEST) -> Rhythm:
    """The rhythm, to the minute. Raises `BadRhythm`: what is wrong with it, or that it happens more
    often than `shortest` allows."""
    begins = rhythm.begins
    if begins.tzinfo is not None:
        raise BadRhythm(
            "The time at which it begins is to be a local one, without what it is ahead of UTC:"
            " 2026-11-30T08:00."
        )
    if not _YEARS[0] <= begins.year <= _YEARS[1]:
        raise BadRhythm(f"It begins in the year {begins.year}. Choose one from {_YEARS[0]} on.")
    zone_of(rhythm.zone)
    rhythm = msgspec.structs.replace(rhythm, begins=begins.replace(second=0, microsecond=0, fold=0))
    if rhythm.rule is not None:
        parts_of(rhythm.rule)
        found = list(itertools.islice(times(rhythm), _SAMPLE))
        if not found:
            raise BadRhythm(NEVER)
        pairs = itertools.pairwise(found)
        closest = min((after - before for before, after in pairs), default=float("inf"))
        if closest < shortest.total_seconds():
            raise BadRhythm(
                f"That is more often than every {shortest.total_seconds() / 60:g} minutes. Let more"
                " time pass in between."
            )
    return rhythm


def next_time(rhythm: Rhythm, after: float) -> float | None:
    """When it is done next after that moment, both in seconds since the epoch; None for never."""
    return next(times(rhythm, after), None)


def next_begin(rhythm: Rhythm | None, after: float) -> datetime | None:
    """The same by the clocks there: what a dry run as of its next time begins at. None for never,
    and for what no clock begins."""
    due = next_time(rhythm, after) if rhythm is not None else None
    return shown_at(due, rhythm) if due is not None else None


def shown_at(moment: float, rhythm: Rhythm | None) -> datetime:
    """What the clocks of a rhythm show at that moment; those here, for what has none."""
    return local(moment, rhythm.zone if rhythm is not None else local_zone())


def times(rhythm: Rhythm, after: float | None = None) -> Iterator[float]:
    """The moments at which it is done, in seconds since the epoch, in order, each once; those after
    a moment, or all."""
    last = -float("inf") if after is None else after
    for moment in _moments(rhythm, after):
        if moment > last:
            last = moment
            yield moment


def local(moment: float, zone: str) -> datetime:
    """What calendar and clock show there at that moment."""
    return datetime.fromtimestamp(moment, zone_of(zone))


def moment_of(local: datetime, zone: str) -> float:
    """When the clocks there show that, in seconds since the epoch; the first moment after, where
    they leap over it, the first time where they show it twice."""
    return first_shown(local.replace(tzinfo=zone_of(zone))).timestamp()


@functools.lru_cache(maxsize=64)
def zone_of(name: str) -> ZoneInfo:
    """Raises `BadRhythm` for one that there is not."""
    try:
        return ZoneInfo(name)
    except (ZoneInfoNotFoundError, ValueError, OSError):
        raise BadRhythm(
            f"There is no time zone {name!r}. Name one as Europe/Zurich is named."
        ) from None


# --- rules ---------------------------------------------------------------------------------------


@functools.lru_cache(maxsize=256)
def parts_of(rule: str) -> Mapping[str, str]:
    """The parts of a rule by their names, in capitals. Raises `BadRhythm`."""
    if len(rule) > LONGEST_RULE:
        raise BadRhythm(f"The rule is longer than {LONGEST_RULE} characters. Make it shorter.")
    parts: dict[str, str] = {}
    for part in rule.upper().removeprefix("RRULE:").strip().split(";"):
        name, equals, value = part.partition("=")
        if not equals or not value or name in parts:
            raise BadRhythm(f"The rule {rule!r} is not one of RFC 5545: FREQ=DAILY;INTERVAL=2.")
        parts[name] = value
    _check_parts(parts)
    return parts


def _check_parts(parts: Mapping[str, str]) -> None:
    if parts.get("FREQ") not in _INTERVALS:
        raise BadRhythm(f"FREQ of a rule is one of {', '.join(_INTERVALS)}.")
    for name, value in parts.items():
        fits = True
        if name in _RANGES:
            low, high = _RANGES[name]
            if name == "INTERVAL":
                high = _INTERVALS[parts["FREQ"]]
            numbers = value.split(",")
            fits = all(re.fullmatch(r"[+-]?\d{1,5}", each) for each in numbers)
            fits = fits and all(low <= int(each) <= high for each in numbers)
            fits = fits and (low >= 0 or all(int(each) for each in numbers))
            fits = fits and (len(numbers) == 1 or name not in _SINGLE)
        elif name == "BYDAY":
            fits = all(_DAY.fullmatch(each) for each in value.split(","))
        elif name == "UNTIL":
            fits = _until(value) is not None
        elif name == "WKST":
            fits = value in WEEKDAYS
        elif name != "FREQ":
            raise BadRhythm(f"A rule cannot say {name} here. Leave it out.")
        if not fits:
            raise BadRhythm(f"{name} of a rule cannot be {value}. Write it as RFC 5545 does.")
    if "COUNT" in parts and "UNTIL" in parts:
        raise BadRhythm("A rule says COUNT or UNTIL, not both. Leave one of them out.")
    for name in ("BYSETPOS", "BYMONTH", "BYMONTHDAY"):
        if parts["FREQ"] in ("MINUTELY", "HOURLY") and name in parts:
            raise BadRhythm(f"{name} goes with FREQ=DAILY or longer alone. Choose another FREQ.")
    months = [int(each) for each in parts.get("BYMONTH", "1").split(",")]
    days = [abs(int(each)) for each in parts.get("BYMONTHDAY", "1").split(",")]
    if not any(day <= monthrange(_LEAP_YEAR, month)[1] for month in months for day in days):
        raise BadRhythm(NEVER)
    numbered = any(each[0] not in "MTWFS" for each in parts.get("BYDAY", "MO").split(","))
    if numbered and parts["FREQ"] not in ("MONTHLY", "YEARLY"):
        raise BadRhythm("Numbered days (1MO) go with FREQ=MONTHLY or FREQ=YEARLY alone.")


def _until(value: str) -> datetime | None:
    """The last moment of a rule: of a day without a time, its last minute. A Z is overread, as
    rules here are local."""
    found = _UNTIL.fullmatch(value.removesuffix("Z"))
    if found is None:
        return None
    try:
        return datetime.strptime(found[1] + (found[2] or "2359"), "%Y%m%d%H%M")
    except ValueError:
        return None


# --- moments -------------------------------------------------------------------------------------


def _moments(rhythm: Rhythm, after: float | None) -> Iterator[float]:
    """Those of a rhythm in order, some maybe more than once, some maybe before `after`."""
    if rhythm.rule is None:
        return iter((moment_of(rhythm.begins, rhythm.zone),))
    parts = parts_of(rhythm.rule)
    bare = not any(name.startswith("BY") for name in parts)
    if parts["FREQ"] in ("MINUTELY", "HOURLY") and bare:
        return _passing(rhythm, parts, after)
    return _of_the_calendar(rhythm, parts, after)


def _passing(rhythm: Rhythm, parts: Mapping[str, str], after: float | None) -> Iterator[float]:
    """Every so many minutes, as they pass."""
    begins = moment_of(rhythm.begins, rhythm.zone)
    step = _STEPS[parts["FREQ"]].total_seconds() * int(parts.get("INTERVAL", "1"))
    count = int(parts["COUNT"]) if "COUNT" in parts else None
    until = _until(parts["UNTIL"]) if "UNTIL" in parts else None
    last = moment_of(until, rhythm.zone) if until is not None else None
    number = 0 if after is None else max(0, int((after - begins) // step))
    while count is None or number < count:
        moment = begins + number * step
        if last is not None and moment > last:
            return
        yield moment
        number += 1


def _of_the_calendar(
    rhythm: Rhythm, parts: Mapping[str, str], after: float | None
) -> Iterator[float]:
    begins = rhythm.begins
    from_there = begins
    if after is not None:
        # The clocks may have been set back by an hour since, or a time leapt over lies behind it.
        from_there = max(begins, local(after, rhythm.zone).replace(tzinfo=None) - timedelta(days=1))
        step = _STEPS.get(parts["FREQ"])
        if step is not None and "COUNT" not in parts:
            step *= int(parts.get("INTERVAL", "1"))
            # Years of it need not be counted through; it stays in step.
            begins += step * max(0, (from_there - begins) // step - 1)
    rule = _rule(msgspec.structs.replace(rhythm, begins=begins), parts, from_there + LOOKED_AHEAD)
    count = int(parts["COUNT"]) if "COUNT" in parts else None
    for each in itertools.islice(rule, count):
        if each >= max(from_there, rhythm.begins):
            yield moment_of(each, rhythm.zone)


def _rule(rhythm: Rhythm, parts: Mapping[str, str], horizon: datetime) -> rrule:
    """What counts through the days, but for the number of times in all."""
    from dateutil import rrule as rules

    def numbers(name: str) -> list[int] | None:
        return [int(each) for each in parts[name].split(",")] if name in parts else None

    days = [_DAY.fullmatch(each) for each in parts["BYDAY"].split(",")] if "BYDAY" in parts else ()
    weekdays = [
        rules.weekday(WEEKDAYS.index(day[2]), int(day[1]) if day[1] else None)
        for day in days
        if day is not None
    ]
    until = _until(parts["UNTIL"]) if "UNTIL" in parts else None
    try:
        return rules.rrule(
            _OF_DATEUTIL[parts["FREQ"]],
            dtstart=rhythm.begins,
            interval=int(parts.get("INTERVAL", "1")),
            wkst=WEEKDAYS.index(parts.get("WKST", "MO")),
            until=min(until or horizon, horizon),
            bysetpos=numbers("BYSETPOS"),
            bymonth=numbers("BYMONTH"),
            bymonthday=numbers("BYMONTHDAY"),
            byweekday=weekdays or None,
            byhour=numbers("BYHOUR"),
            byminute=numbers("BYMINUTE"),
            bysecond=0,
        )
    except ValueError:  # hours that no step of its interval ever meets
        raise BadRhythm(NEVER) from None


_OF_DATEUTIL: Final[Mapping[str, Literal[0, 1, 2, 3, 4, 5]]] = {
    "YEARLY": 0,
    "MONTHLY": 1,
    "WEEKLY": 2,
    "DAILY": 3,
    "HOURLY": 4,
    "MINUTELY": 5,
}
