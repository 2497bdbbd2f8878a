"""What a rhythm and a moment are called: "every weekday at 08:00"."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from datetime import date, datetime
from typing import Any, Final, Literal

from grammar.times.bare_hours import A_DAY, minutes_of
from nl2robot.schedule.rhythm import WEEKDAYS, Rhythm, local, parts_of, times
from nl2robot.texts import texts_in

_A_ROW: Final = 4
"""So many times of a day, equally far apart, are told by how far."""
_WORKING: Final = {0, 1, 2, 3, 4}
_WEEKEND: Final = {5, 6}
_SETTLED: Final = {"FREQ", "INTERVAL", "COUNT", "UNTIL", "WKST"}
_KNOWN: Final[Mapping[str, set[str]]] = {
    "DAILY": {"BYDAY", "BYHOUR", "BYMINUTE", "BYSETPOS"},
    "WEEKLY": {"BYDAY", "BYHOUR", "BYMINUTE"},
    "MONTHLY": {"BYDAY", "BYMONTHDAY", "BYHOUR", "BYMINUTE"},
    "YEARLY": {"BYMONTH", "BYMONTHDAY", "BYHOUR", "BYMINUTE"},
    "HOURLY": set(),
    "MINUTELY": set(),
}
"""What there are words for; the rest is told as the rule that it is."""


def in_words(rhythm: Rhythm, language: str = "en", now: float | None = None) -> str:
    """A checked rhythm as a nurse says it, without a full stop. Seen from `now` (seconds since the
    epoch) today is told as today, and tomorrow as tomorrow."""
    texts = texts_in(language, "schedules")
    if rhythm.rule is None:
        return str(texts["once"]).format(moments=_moments([rhythm.begins], rhythm, language, now))
    parts = parts_of(rhythm.rule)
    if "COUNT" in parts and parts["FREQ"] == "DAILY" and "BYDAY" not in parts:
        pairs = len(list(_times(rhythm, parts)))
        if 1 < pairs >= int(parts["COUNT"]):  # not a rhythm, but some times of a day or two
            listed = [local(each, rhythm.zone) for each in times(rhythm)]
            return str(texts["once"]).format(moments=_moments(listed, rhythm, language, now))
    told = _told(rhythm, parts, texts)
    if "COUNT" in parts:
        number = int(parts["COUNT"])
        told = _counted(texts["count"], number).format(rhythm=told, number=number)
    if "UNTIL" in parts:
        until = datetime.strptime(parts["UNTIL"][:8], "%Y%m%d")
        told = str(texts["until"]).format(rhythm=told, date=a_date(until, language))
    return told


def times_in_words(moments: Sequence[str], language: str) -> str:
    """ "08:00 and 14:00"."""
    return _listed(moments, texts_in(language, "schedules"))


def _moments(moments: Sequence[datetime], rhythm: Rhythm, language: str, now: float | None) -> str:
    """ "on Monday, 30 November 2026 at 10:00 and 16:00"."""
    texts = texts_in(language, "schedules")
    told = []
    for day, group in itertools.groupby(moments, lambda each: each.date()):
        at = _at([f"{each:%H:%M}" for each in group], texts)
        noon = datetime(day.year, day.month, day.day, 12)
        near = texts["near_days"].get(_ahead(day, rhythm, now))
        on = on_date(noon, language)
        if near is not None:
            weekday = texts["weekdays"][day.weekday()]
            on = str(texts["near_date"]).format(near=near, weekday=weekday, date=_date(noon, texts))
        told.append(f"{on} {at}")
    return _listed(told, texts)


def near_moment(rhythm: Rhythm, language: str, now: float) -> str:
    """Of what is once: "tomorrow at 08:00"."""
    texts = texts_in(language, "schedules")
    near = texts["near_days"].get(_ahead(rhythm.begins.date(), rhythm, now))
    return f"{near or on_date(rhythm.begins, language)} {_at([f'{rhythm.begins:%H:%M}'], texts)}"


def _ahead(day: date, rhythm: Rhythm, now: float | None) -> int | None:
    return (day - local(now, rhythm.zone).date()).days if now is not None else None


def on_date(day: datetime, language: str) -> str:
    """ "on Monday, 30 November 2026"."""
    texts = texts_in(language, "schedules")
    return str(texts["on_date"]).format(
        weekday=texts["weekdays"][day.weekday()], date=a_date(day, language)
    )


def a_date(day: datetime, language: str) -> str:
    """ "30 November 2026"."""
    texts = texts_in(language, "schedules")
    month = texts["months"][day.month - 1]
    return str(texts["date"]).format(day=day.day, month=month, year=day.year)


def a_moment(moment: float, zone: str, language: str, weekday: bool = True) -> str:
    """ "on Monday, 30 November 2026 at 08:00", by the clocks there."""
    there = local(moment, zone)
    date = on_date(there, language) if weekday else a_date(there, language)
    return f"{date} {_at([f'{there:%H:%M}'], texts_in(language, 'schedules'))}"


def _told(rhythm: Rhythm, parts: Mapping[str, str], texts: Mapping[str, Any]) -> str:
    """A rule without its end."""
    begins, frequency = rhythm.begins, parts["FREQ"]
    date = _date(begins, texts)
    interval = int(parts.get("INTERVAL", "1"))
    known = parts.keys() - _SETTLED <= _KNOWN[frequency]
    if frequency in ("MINUTELY", "HOURLY") and known:
        every = _every(frequency, interval, texts)
        return str(texts["from_time"]).format(rhythm=every, date=date, time=f"{begins:%H:%M}")
    clocks = list(_times(rhythm, parts))
    passing = _passing(clocks, texts)
    time = passing or _at(clocks, texts)
    days = [_day(each) for each in parts["BYDAY"].split(",")] if "BYDAY" in parts else []
    weekdays = sorted({day for _, day in days})
    told = ""
    if known and frequency in ("DAILY", "WEEKLY"):
        if frequency == "WEEKLY" and not days:
            weekdays = [begins.weekday()]
        called = _listed([texts["weekdays"][day] for day in weekdays], texts) if weekdays else ""
        kind = _of_days(frequency, weekdays, interval)
        if passing and kind in texts["passing_on"]:
            called = _listed([texts["on_weekdays"][day] for day in weekdays], texts) if days else ""
            return str(texts["passing_on"][kind]).format(time=time, days=called)
        values = {"time": time, "days": called, "number": interval, "date": date}
        told = str(texts[kind]).format(**values)
    elif known and interval == 1 and not (days and "BYMONTHDAY" in parts):
        several = parts.get("BYMONTH", str(begins.month))
        if frequency == "MONTHLY":
            called = _listed(list(_days_of_month(begins, parts, days, texts)), texts)
            told = str(texts["every_month"]).format(days=called, time=time)
        elif "," not in several and "-" not in parts.get("BYMONTHDAY", ""):
            numbers = parts.get("BYMONTHDAY", str(begins.day)).split(",")
            month = texts["months"][int(several) - 1]
            called = _listed(
                [str(texts["day_of_year"]).format(day=int(n), month=month) for n in numbers], texts
            )
            told = str(texts["every_year"]).format(days=called, time=time)
    return told or str(texts["of_its_own"]).format(rule=rhythm.rule, date=date, time=time)


def _of_days(frequency: str, weekdays: Sequence[int], interval: int) -> str:
    """Which text tells of these days of each week, or of every so many."""
    if interval > 1:
        return "every_weeks" if frequency == "WEEKLY" else "every_days"
    if not weekdays or len(weekdays) == 7:
        return "every_day"
    whole = {frozenset(_WORKING): "every_weekday", frozenset(_WEEKEND): "every_weekend"}
    return whole.get(frozenset(weekdays), "on_days")


def _days_of_month(
    begins: datetime,
    parts: Mapping[str, str],
    days: Sequence[tuple[int | None, int]],
    texts: Mapping[str, Any],
) -> Iterator[str]:
    for ordinal, day in days:
        weekday = texts["weekdays"][day]
        named = texts["ordinals"].get(ordinal, ordinal)
        yield str(texts["the_ordinal"]).format(ordinal=named, weekday=weekday)
    if not days:
        for number in parts.get("BYMONTHDAY", str(begins.day)).split(","):
            if int(number) == -1:
                yield str(texts["the_last_day"])
            else:
                yield str(texts["the_day"]).format(number=int(number))


def _times(rhythm: Rhythm, parts: Mapping[str, str]) -> Iterator[str]:
    """The times of day of a rule of days, in order."""
    hours = parts.get("BYHOUR", str(rhythm.begins.hour)).split(",")
    minutes = parts.get("BYMINUTE", str(rhythm.begins.minute)).split(",")
    pairs = sorted({(int(hour), int(minute)) for hour in hours for minute in minutes})
    chosen = parts.get("BYSETPOS")
    if chosen is not None:
        places = [int(each) for each in chosen.split(",")]
        indices = sorted({place - 1 if place > 0 else len(pairs) + place for place in places})
        pairs = [pairs[index] for index in indices if 0 <= index < len(pairs)]
    for hour, minute in pairs:
        yield f"{hour:02}:{minute:02}"


def _at(moments: Sequence[str], texts: Mapping[str, Any]) -> str:
    return str(texts["at"]).format(times=_listed(moments, texts))


def _passing(moments: Sequence[str], texts: Mapping[str, Any]) -> str | None:
    """Times of day that are equally far apart by how far, also over midnight; None for others."""
    if len(moments) < _A_ROW:
        return None
    minutes = [minutes_of(each) for each in moments]
    gaps = [
        (after - before) % A_DAY
        for before, after in zip(minutes, [*minutes[1:], minutes[0]], strict=True)
    ]
    pause = max(range(len(gaps)), key=lambda at: (gaps[at], at))
    steps = {gap for at, gap in enumerate(gaps) if at != pause}
    if len(steps) != 1:
        return None
    first, last = moments[(pause + 1) % len(moments)], moments[pause]
    every = _every("MINUTELY", steps.pop(), texts)
    return str(texts["passing"]).format(every=every, first=first, last=last)


def passing(unit: Literal["minutes", "seconds"], number: int, language: str = "en") -> str:
    """ "every 10 minutes", "every 2 hours", "every 30 seconds"."""
    texts = texts_in(language, "schedules")
    if unit == "minutes":
        return _every("MINUTELY", number, texts)
    return _counted(texts["seconds"], number).format(number=number)


def _every(frequency: str, interval: int, texts: Mapping[str, Any]) -> str:
    """So many minutes or hours."""
    if frequency == "MINUTELY" and interval % 60 == 0:
        frequency, interval = "HOURLY", interval // 60
    named = texts["hours" if frequency == "HOURLY" else "minutes"]
    return _counted(named, interval).format(number=interval)


def _day(written: str) -> tuple[int | None, int]:
    return int(written[:-2]) if written[:-2] else None, WEEKDAYS.index(written[-2:])


def _date(day: datetime, texts: Mapping[str, Any]) -> str:
    month = texts["months"][day.month - 1]
    return str(texts["date"]).format(day=day.day, month=month, year=day.year)


def _listed(names: Sequence[str], texts: Mapping[str, Any]) -> str:
    *before, last = names
    return f"{', '.join(before)} {texts['and']} {last}" if before else last


def _counted(forms: Mapping[str, str], number: int) -> str:
    return forms["one"] if number == 1 else forms["other"]
