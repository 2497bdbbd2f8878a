"""When a time comes next: over midnight and the year's end, in the nights when clocks are set."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from zoneinfo import ZoneInfo

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot_api.errors import InvalidCall, NotPossible
from robot_api.methods import WEEKDAYS
from robot_api.moments import later, next_moment, seconds_until, zone_name

ZURICH = ZoneInfo("Europe/Zurich")
ZONES = st.sampled_from(
    [ZURICH, ZoneInfo("Australia/Lord_Howe"), ZoneInfo("America/St_Johns"), ZoneInfo("UTC")]
)
"""Clocks that are set by an hour, by half an hour, that go half an hour beside, that never are."""
INSTANTS = st.datetimes(datetime(2020, 1, 1), datetime(2036, 12, 31), timezones=st.just(UTC))
TIMES = st.times().map(lambda time: f"{time:%H:%M}")


def at(written: str, zone: ZoneInfo = ZURICH) -> datetime:
    return datetime.fromisoformat(written).replace(tzinfo=zone)


def shown(moment: datetime) -> str:
    return f"{moment:%a %Y-%m-%d %H:%M %Z}"


@pytest.mark.parametrize(
    "now, time, on, then",
    [
        # the night shift, at a quarter past six in the evening
        ("2026-11-20 18:15", "22:00", {}, "Fri 2026-11-20 22:00 CET"),
        ("2026-11-20 18:15", "00:00", {}, "Sat 2026-11-21 00:00 CET"),
        ("2026-11-20 18:15", "06:00", {}, "Sat 2026-11-21 06:00 CET"),
        # the very minute that is said is over: the next is tomorrow's
        ("2026-11-20 06:00:00", "06:00", {}, "Sat 2026-11-21 06:00 CET"),
        ("2026-11-20 05:59:59.5", "06:00", {}, "Fri 2026-11-20 06:00 CET"),
        ("2026-12-31 23:30", "00:15", {}, "Fri 2027-01-01 00:15 CET"),
        ("2028-02-28 20:00", "08:00", {}, "Tue 2028-02-29 08:00 CET"),
        ("2027-02-28 20:00", "08:00", {}, "Mon 2027-03-01 08:00 CET"),
        # over a weekend, and from a Monday to the next
        ("2026-11-20 18:15", "08:00", {"weekday": "Monday"}, "Mon 2026-11-23 08:00 CET"),
        ("2026-11-23 07:00", "08:00", {"weekday": "Monday"}, "Mon 2026-11-23 08:00 CET"),
        ("2026-11-23 09:00", "08:00", {"weekday": "Monday"}, "Mon 2026-11-30 08:00 CET"),
        ("2026-11-20 18:15", "18:00", {"day": "2026-12-24"}, "Thu 2026-12-24 18:00 CET"),
        ("2026-12-24 18:00:40", "18:00", {"day": "2026-12-24"}, "Thu 2026-12-24 18:00 CET"),
        # half past two is left out in one night, and comes twice in another
        ("2026-03-28 22:00", "02:30", {}, "Sun 2026-03-29 03:00 CEST"),
        ("2026-03-29 03:10", "02:30", {}, "Mon 2026-03-30 02:30 CEST"),
        ("2026-10-24 22:00", "02:30", {}, "Sun 2026-10-25 02:30 CEST"),
        ("2026-10-25 02:45", "02:30", {}, "Mon 2026-10-26 02:30 CET"),
    ],
)
def test_it_is_the_next_such_moment(now: str, time: str, on: dict[str, str], then: str) -> None:
    assert shown(next_moment(at(now), time, **on)) == then


def test_in_the_second_of_the_doubled_hours_the_first_is_over() -> None:
    again = at("2026-10-25 02:10").replace(fold=1)
    assert shown(next_moment(again, "02:30")) == "Mon 2026-10-26 02:30 CET"


def test_a_whole_day_that_a_country_left_out_is_over_when_it_begins() -> None:
    samoa = ZoneInfo("Pacific/Apia")
    then = next_moment(at("2011-12-29 20:00", samoa), "08:00")
    assert f"{then:%Y-%m-%d %H:%M}" == "2011-12-31 00:00"


@given(instant=INSTANTS, zone=ZONES, time=TIMES)
def test_it_comes_within_a_day_and_shows_the_time_or_is_the_end_of_a_gap(
    instant: datetime, zone: ZoneInfo, time: str
) -> None:
    now = instant.astimezone(zone)
    then = next_moment(now, time)
    assert 0 < seconds_until(then, now) <= 25 * 3600
    assert then == then.astimezone(UTC).astimezone(zone)
    if f"{then:%H:%M}" != time:
        before = (then.astimezone(UTC) - timedelta(minutes=1)).astimezone(zone)
        assert before.utcoffset() != then.utcoffset()  # clocks were set this very minute
        assert f"{before:%H:%M}" < time < f"{then:%H:%M}"


@given(instant=INSTANTS, zone=ZONES, time=TIMES)
def test_none_comes_before_it(instant: datetime, zone: ZoneInfo, time: str) -> None:
    """Looked for minute by minute, as somebody would who stands before the clock."""
    now = instant.astimezone(zone)
    then = next_moment(now, time)
    minute = instant.replace(second=0, microsecond=0) + timedelta(minutes=1)
    while minute < then.astimezone(UTC):
        local = minute.astimezone(zone)
        assert f"{local:%H:%M}" != time or local.fold == 1
        minute += timedelta(minutes=1)


@given(instant=INSTANTS, zone=ZONES, time=TIMES, weekday=st.sampled_from(WEEKDAYS))
def test_a_weekday_comes_within_a_week(
    instant: datetime, zone: ZoneInfo, time: str, weekday: str
) -> None:
    now = instant.astimezone(zone)
    then = next_moment(now, time, weekday)
    assert 0 < seconds_until(then, now) <= 7 * 86400 + 3600
    assert WEEKDAYS[then.weekday()] == weekday


@given(instant=INSTANTS, zone=ZONES, time=TIMES, days=st.integers(1, 800))
def test_a_date_is_that_day_whatever_lies_between(
    instant: datetime, zone: ZoneInfo, time: str, days: int
) -> None:
    now = instant.astimezone(zone)
    day = now.date() + timedelta(days=days)
    then = next_moment(now, time, day=f"{day}")
    assert then.date() == day
    with pytest.raises(NotPossible, match="is past"):
        next_moment(then + timedelta(days=2), time, day=f"{day}")


@given(instant=INSTANTS, zone=ZONES, time=TIMES)
def test_who_waits_that_long_sees_that_time(instant: datetime, zone: ZoneInfo, time: str) -> None:
    now = instant.astimezone(zone)
    then = next_moment(now, time)
    seen = later(now, seconds_until(then, now))
    assert (f"{seen}", seen.fold) == (f"{then}", then.fold)


@pytest.mark.parametrize(
    "on, error, sentence",
    [
        ({"day": "2026-11-19"}, NotPossible, "18:00 on 2026-11-19 is past: now it is 18:15 on 20"),
        ({"day": "2026-11-20"}, NotPossible, "is past"),
        ({"day": "2027-02-29"}, InvalidCall, 'no day "2027-02-29" in the calendar'),
        ({"day": "2026-12-24", "weekday": "Friday"}, InvalidCall, "is a Thursday, not a Friday"),
    ],
)
def test_a_day_that_never_comes_is_refused(
    on: dict[str, str], error: type[Exception], sentence: str
) -> None:
    with pytest.raises(error, match=sentence):
        next_moment(at("2026-11-20 18:15"), "18:00", **on)


def test_a_zone_goes_by_its_name() -> None:
    assert zone_name(at("2026-11-20 18:15")) == "Europe/Zurich"
    assert zone_name(datetime.fromisoformat("2026-11-20T18:15+01:00")) == "UTC+01:00"
