"""At what times something is done: in words, by the rule, and whatever the clocks do."""

from __future__ import annotations

import itertools
from datetime import datetime, timedelta

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nl2robot.schedule.rhythm import (
    LONGEST_RULE,
    WEEKDAYS,
    BadRhythm,
    Rhythm,
    checked,
    local,
    moment_of,
    next_time,
    times,
)
from nl2robot.schedule.words import in_words
from tests.schedule.conftest import ZURICH, at, rhythm


def shown(found: Rhythm, number: int, after: float | None = None) -> list[str]:
    """The first times, as the clocks of Zurich show them."""
    first = itertools.islice(times(found, after), number)
    return [f"{local(each, ZURICH):%a %d %b %H:%M}" for each in first]


def test_every_weekday_at_eight_leaves_out_the_weekend() -> None:
    found = rhythm("FREQ=WEEKLY;BYDAY=MO,TU,WE,TH,FR")
    assert shown(found, 3, at("2026-12-03 12:00")) == [
        "Fri 04 Dec 08:00",
        "Mon 07 Dec 08:00",
        "Tue 08 Dec 08:00",
    ]


def test_medicine_at_ten_and_at_half_past_four() -> None:
    found = rhythm("FREQ=DAILY;BYHOUR=10,16;BYMINUTE=0,30;BYSETPOS=1,4")
    assert shown(found, 3) == ["Mon 30 Nov 10:00", "Mon 30 Nov 16:30", "Tue 01 Dec 10:00"]
    assert in_words(found) == "every day at 10:00 and 16:30"


def test_once_is_once() -> None:
    found = rhythm(None)
    assert shown(found, 5) == ["Mon 30 Nov 08:00"]
    assert next_time(found, at("2026-11-30 08:00")) is None


def test_eight_in_the_morning_is_eight_in_summer_and_in_winter() -> None:
    found = rhythm(begins="2026-10-24 08:00")
    first, second = itertools.islice(times(found), 2)
    assert second - first == 25 * 3600
    assert shown(found, 2) == ["Sat 24 Oct 08:00", "Sun 25 Oct 08:00"]


def test_a_time_that_the_clocks_leap_over_is_the_first_moment_after() -> None:
    found = rhythm(begins="2026-03-28 02:30")
    assert shown(found, 3) == ["Sat 28 Mar 02:30", "Sun 29 Mar 03:00", "Mon 30 Mar 02:30"]


def test_several_times_within_the_leap_are_one() -> None:
    found = rhythm("FREQ=DAILY;BYHOUR=2,3;BYMINUTE=0,30", "2026-03-29 01:00")
    assert shown(found, 3) == ["Sun 29 Mar 03:00", "Sun 29 Mar 03:30", "Mon 30 Mar 02:00"]


def test_a_time_that_the_clocks_show_twice_is_the_first_of_them() -> None:
    found = rhythm(begins="2026-10-25 02:30")
    [moment] = itertools.islice(times(found), 1)
    assert moment == datetime.fromisoformat("2026-10-25T02:30+02:00").timestamp()
    assert shown(found, 2) == ["Sun 25 Oct 02:30", "Mon 26 Oct 02:30"]


def test_every_hour_counts_hours_as_they_pass() -> None:
    found = rhythm("FREQ=HOURLY", "2026-10-25 01:30")
    assert shown(found, 4) == [
        f"Sun 25 Oct {each}" for each in ("01:30", "02:30", "02:30", "03:30")
    ]


def test_every_ten_minutes_three_times_in_all() -> None:
    found = rhythm("FREQ=MINUTELY;INTERVAL=10;COUNT=3")
    assert [each[-5:] for each in shown(found, 5)] == ["08:00", "08:10", "08:20"]
    assert shown(found, 5, at("2026-11-30 08:10")) == ["Mon 30 Nov 08:20"]


def test_three_times_are_counted_from_the_beginning() -> None:
    found = rhythm("FREQ=DAILY;COUNT=3")
    assert shown(found, 5, at("2026-12-01 12:00")) == ["Wed 02 Dec 08:00"]


@pytest.mark.parametrize("until", ["20261202", "20261202T0800", "20261202T080000Z"])
def test_until_a_day_is_with_that_day(until: str) -> None:
    assert len(shown(rhythm(f"FREQ=DAILY;UNTIL={until}"), 9)) == 3


@pytest.mark.parametrize(
    ("rule", "en", "de", "fr"),
    [
        (
            None,
            "once on Monday, 30 November 2026 at 08:00",
            "einmal am Montag, 30. November 2026, um 08:00",
            "une fois le lundi 30 novembre 2026 à 08:00",
        ),
        (
            "FREQ=DAILY",
            "every day at 08:00",
            "jeden Tag um 08:00",
            "tous les jours à 08:00",
        ),
        (
            "FREQ=WEEKLY;BYDAY=FR,TH,WE,TU,MO",
            "every weekday at 08:00",
            "montags bis freitags um 08:00",
            "du lundi au vendredi à 08:00",
        ),
        (
            "FREQ=WEEKLY",
            "every Monday at 08:00",
            "jeden Montag um 08:00",
            "chaque lundi à 08:00",
        ),
        (
            "FREQ=DAILY;BYHOUR=9,10,11,12,13;BYMINUTE=0",
            "every hour from 09:00 to 13:00",
            "jede Stunde von 09:00 bis 13:00",
            "toutes les heures de 09:00 à 13:00",
        ),
        (
            "FREQ=MINUTELY;INTERVAL=10;COUNT=3",
            "every 10 minutes, from 30 November 2026 at 08:00, 3 times in all",
            "alle 10 Minuten, ab 30. November 2026 um 08:00, insgesamt 3-mal",
            "toutes les 10 minutes, à partir du 30 novembre 2026 à 08:00, 3 fois en tout",
        ),
        (
            "FREQ=MONTHLY;BYDAY=1MO,-1FR",
            "every month on the first Monday and the last Friday at 08:00",
            "jeden Monat am ersten Montag und letzten Freitag um 08:00",
            "chaque mois, le premier lundi et le dernier vendredi à 08:00",
        ),
        (
            "FREQ=MONTHLY;BYMONTHDAY=1,-1",
            "every month on day 1 and the last day at 08:00",
            "jeden Monat am 1. und letzten Tag um 08:00",
            "chaque mois, le 1 et le dernier jour à 08:00",
        ),
        (
            "FREQ=YEARLY;UNTIL=20301130",
            "every year on 30 November at 08:00, until 30 November 2030",
            "jedes Jahr am 30. November um 08:00, bis 30. November 2030",
            "chaque année, le 30 novembre à 08:00, jusqu'au 30 novembre 2030",
        ),
        (
            "FREQ=WEEKLY;INTERVAL=2;BYDAY=MO",
            "every 2 weeks on Monday at 08:00, from 30 November 2026",
            "alle 2 Wochen am Montag um 08:00, ab 30. November 2026",
            "toutes les 2 semaines, le lundi à 08:00, à partir du 30 novembre 2026",
        ),
        (
            "FREQ=WEEKLY;BYMONTH=3",
            "by the rule FREQ=WEEKLY;BYMONTH=3, from 30 November 2026 at 08:00",
            "nach der Regel FREQ=WEEKLY;BYMONTH=3, ab 30. November 2026 um 08:00",
            "selon la règle FREQ=WEEKLY;BYMONTH=3, à partir du 30 novembre 2026 à 08:00",
        ),
    ],
)
def test_a_rhythm_in_words(rule: str | None, en: str, de: str, fr: str) -> None:
    found = rhythm(rule)
    assert [in_words(found, language) for language in ("en", "de", "fr")] == [en, de, fr]


@pytest.mark.parametrize(
    ("rule", "sentence"),
    [
        ("every morning", "RFC 5545"),
        ("FREQ=SECONDLY", "FREQ of a rule is one of"),
        ("BYDAY=MO", "FREQ of a rule is one of"),
        ("FREQ=DAILY;FREQ=WEEKLY", "RFC 5545"),
        ("FREQ=DAILY;BYSECOND=5", "cannot say BYSECOND"),
        ("FREQ=DAILY;BYHOUR=24", "BYHOUR of a rule cannot be 24"),
        ("FREQ=DAILY;BYHOUR=8.5", "BYHOUR of a rule cannot be"),
        ("FREQ=DAILY;INTERVAL=0", "INTERVAL of a rule cannot be 0"),
        ("FREQ=DAILY;INTERVAL=1,2", "INTERVAL of a rule cannot be"),
        ("FREQ=DAILY;BYDAY=XX", "BYDAY of a rule cannot be XX"),
        ("FREQ=WEEKLY;BYDAY=2MO", "Numbered days"),
        ("FREQ=MONTHLY;BYMONTHDAY=0", "BYMONTHDAY of a rule cannot be 0"),
        ("FREQ=DAILY;COUNT=3;UNTIL=20261224", "COUNT or UNTIL"),
        ("FREQ=DAILY;UNTIL=20261399", "UNTIL of a rule cannot be"),
        ("FREQ=DAILY;UNTIL=20251224", "no day on which this would ever be"),
        ("FREQ=YEARLY;BYMONTH=2;BYMONTHDAY=30", "no day on which this would ever be"),
        ("FREQ=HOURLY;INTERVAL=24;BYHOUR=9", "no day on which this would ever be"),
        ("FREQ=MINUTELY;BYMONTH=2", "BYMONTH goes with"),
        ("FREQ=MINUTELY", "more often than every 5 minutes"),
        ("FREQ=DAILY;BYHOUR=8;BYMINUTE=0,1", "more often than every 5 minutes"),
        ("FREQ=DAILY;" + "X" * LONGEST_RULE, "longer than"),
    ],
)
def test_a_rule_that_tells_no_times_is_refused_with_a_sentence(rule: str, sentence: str) -> None:
    with pytest.raises(BadRhythm, match=sentence):
        rhythm(rule)


def test_a_beginning_that_nobody_means_is_refused() -> None:
    with pytest.raises(BadRhythm, match="no time zone 'Mars/Olympus'"):
        checked(Rhythm(datetime(2026, 11, 30, 8), "Mars/Olympus"))
    with pytest.raises(BadRhythm, match="no time zone"):
        checked(Rhythm(datetime(2026, 11, 30, 8), "../../etc/passwd"))
    with pytest.raises(BadRhythm, match="year 9999"):
        checked(Rhythm(datetime(9999, 11, 30, 8), ZURICH))
    with pytest.raises(BadRhythm, match="local one"):
        checked(Rhythm(datetime.fromisoformat("2026-11-30T08:00Z"), ZURICH))


def test_a_house_may_allow_more() -> None:
    found = Rhythm(datetime(2026, 11, 30, 8), ZURICH, "FREQ=MINUTELY")
    assert checked(found, timedelta(minutes=1)) == found


RULES = st.one_of(
    st.none(),
    st.builds(
        "FREQ={};INTERVAL={}".format,
        st.sampled_from(("DAILY", "WEEKLY", "MONTHLY")),
        st.integers(1, 12),
    ),
    st.builds(
        "FREQ=DAILY;BYDAY={};BYHOUR={};BYMINUTE=0,30".format,
        st.lists(st.sampled_from(WEEKDAYS), min_size=1, max_size=7, unique=True).map(",".join),
        st.lists(st.integers(0, 23).map(str), min_size=1, max_size=6, unique=True).map(",".join),
    ),
    st.builds("FREQ=MINUTELY;INTERVAL={}".format, st.integers(60, 2000)),
    st.builds("FREQ=DAILY;COUNT={}".format, st.integers(1, 400)),
)
BEGINS = st.datetimes(datetime(2026, 1, 1), datetime(2027, 12, 31)).map(
    lambda each: each.replace(second=0, microsecond=0)
)


@given(begins=BEGINS, rule=RULES, days=st.floats(-3, 800))
def test_the_next_time_is_the_first_of_all_that_come_after(
    begins: datetime, rule: str | None, days: float
) -> None:
    """However many years were leapt over to find it, over both changes of the clocks."""
    found = Rhythm(begins, ZURICH, rule)
    moment = moment_of(begins, ZURICH) + days * 86_400
    all_after = itertools.dropwhile(lambda each: each <= moment, times(found))
    expected = list(itertools.islice(all_after, 3))
    assert list(itertools.islice(times(found, moment), len(expected))) == expected
    assert next_time(found, moment) == next(iter(expected), None)


@given(begins=BEGINS, rule=RULES)
def test_times_only_rise_and_show_the_time_that_was_meant(
    begins: datetime, rule: str | None
) -> None:
    found = Rhythm(begins, ZURICH, rule)
    some = list(itertools.islice(times(found), 60))
    assert all(before < after for before, after in itertools.pairwise(some))
    if rule is None or "BYHOUR" in rule or rule.startswith(("FREQ=DAILY", "FREQ=WEEKLY")):
        for each in some:
            there = local(each, ZURICH)
            meant = (
                there.minute in (0, 30)
                if rule and "BYHOUR" in rule
                else ((there.hour, there.minute) == (begins.hour, begins.minute))
            )
            leapt = (there.hour, there.minute) == (3, 0) and there.month == 3
            assert meant or leapt


@given(begins=BEGINS, rule=RULES)
def test_whatever_it_is_it_can_be_told_in_three_languages(
    begins: datetime, rule: str | None
) -> None:
    for language in ("en", "de", "fr"):
        told = in_words(Rhythm(begins, ZURICH, rule), language)
        assert told and "{" not in told
