"""What words say of times becomes a rhythm; what they leave open is asked back."""

from __future__ import annotations

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grammar.requests import When
from nl2robot.schedule.rhythm import BadRhythm, Rhythm, local, times
from nl2robot.schedule.wishes import Unclear, rhythm_of
from nl2robot.schedule.words import in_words
from tests.schedule.conftest import ZURICH, at

NOW = at("2026-11-30 09:15")  # a Monday


@pytest.mark.parametrize(
    ("when", "words", "first"),
    [
        (When(times=("08:00",), repeats=True), "every day at 08:00", "Tue 01 Dec 08:00"),
        (
            When(times=("08:00",), weekdays=(0, 1, 2, 3, 4), repeats=True),
            "every weekday at 08:00",
            "Tue 01 Dec 08:00",
        ),
        (
            When(times=("10:00", "16:30"), repeats=True),
            "every day at 10:00 and 16:30",
            "Mon 30 Nov 10:00",
        ),
        (
            When(times=("08:00",), days_ahead=1),
            "once on Tuesday, 1 December 2026 at 08:00",
            "Tue 01 Dec 08:00",
        ),
        (
            When(times=("08:00",)),
            "once on Tuesday, 1 December 2026 at 08:00",
            "Tue 01 Dec 08:00",
        ),
        (
            When(times=("08:00",), weekdays=(0,)),
            "once on Monday, 7 December 2026 at 08:00",
            "Mon 07 Dec 08:00",
        ),
        (
            When(times=("10:00",), date="12-24"),
            "once on Thursday, 24 December 2026 at 10:00",
            "Thu 24 Dec 10:00",
        ),
        (
            When(times=("10:00",), date="03-01"),
            "once on Monday, 1 March 2027 at 10:00",
            "Mon 01 Mar 10:00",
        ),
        (
            When(minutes=150),
            "once on Monday, 30 November 2026 at 11:45",
            "Mon 30 Nov 11:45",
        ),
        (
            When(minutes=60, repeats=True, since="09:00", until="17:00"),
            "every hour from 09:00 to 17:00",
            "Mon 30 Nov 10:00",
        ),
        (
            When(minutes=10, repeats=True, count=3),
            "every 10 minutes, from 30 November 2026 at 09:16, 3 times in all",
            "Mon 30 Nov 09:16",
        ),
        (
            When(times=("08:00",), repeats=True, count=5),
            "every day at 08:00, 5 times in all",
            "Tue 01 Dec 08:00",
        ),
    ],
)
def test_what_is_meant(when: When, words: str, first: str) -> None:
    found = rhythm_of(when, NOW, ZURICH)
    assert isinstance(found, Rhythm)
    assert in_words(found) == words
    [moment] = itertools.islice(times(found, NOW), 1)
    assert f"{local(moment, ZURICH):%a %d %b %H:%M}" == first


@pytest.mark.parametrize(
    ("when", "now", "words"),
    [
        (When(times=("08:00",)), "2026-11-30 10:00", "tomorrow, Tuesday, 1 December 2026, at"),
        (When(times=("08:00",)), "2026-11-30 07:00", "today, Monday, 30 November 2026, at 08:00"),
        (
            When(times=("10:00", "16:00")),
            "2026-12-31 12:00",
            "today, Thursday, 31 December 2026, at 16:00"
            " and tomorrow, Friday, 1 January 2027, at 10:00",
        ),
        (
            When(times=("10:00", "16:00"), days_ahead=0),
            "2026-12-31 12:00",
            "today, Thursday, 31 December 2026, at 16:00",
        ),
    ],
)
def test_the_review_says_which_day_it_will_be(when: When, now: str, words: str) -> None:
    found = rhythm_of(when, at(now), ZURICH)
    assert isinstance(found, Rhythm)
    assert in_words(found, "en", at(now)).startswith(f"once {words}")


def test_the_hours_of_a_night_are_told_as_such() -> None:
    when = When(minutes=120, repeats=True, since="22:00", until="06:00", weekdays=(5, 6))
    found = rhythm_of(when, NOW, ZURICH)
    assert isinstance(found, Rhythm)
    assert in_words(found) == "every 2 hours from 22:00 to 06:00 on weekends"
    assert in_words(found, "de") == "alle 2 Stunden von 22:00 bis 06:00, samstags und sonntags"


def test_tomorrow_at_ten_and_at_four_is_twice() -> None:
    found = rhythm_of(When(times=("10:00", "16:00"), days_ahead=1), NOW, ZURICH)
    assert isinstance(found, Rhythm)
    assert [f"{local(each, ZURICH):%d %H:%M}" for each in times(found, NOW)] == [
        "01 10:00",
        "01 16:00",
    ]


def test_what_may_be_two_times_of_day_is_asked_back() -> None:
    when = When(times=("08:00",), bare=("08:00",), repeats=True)
    assert rhythm_of(when, NOW, ZURICH) == Unclear((("08:00",), ("20:00",)))
    found = rhythm_of(when, NOW, ZURICH, times=("20:00",))
    assert isinstance(found, Rhythm) and in_words(found) == "every day at 20:00"


def test_a_day_without_a_time_is_asked_back() -> None:
    assert rhythm_of(When(repeats=True), NOW, ZURICH) == Unclear(())
    assert rhythm_of(When(days_ahead=1), NOW, ZURICH) == Unclear(())


@pytest.mark.parametrize(
    ("when", "sentence"),
    [
        (When(times=("10:00",), date="02-30"), "There is no day 02-30"),
        (When(times=("10:00",), date="2026-02-30"), "There is no day 2026-02-30"),
        (When(minutes=1, repeats=True), "more often than"),
        (When(times=("10:00",), date="12-24", weekdays=(0,)), "another day of the week"),
        (When(times=("09:00",), days_ahead=0), "That time is past"),
        (When(times=("09:00",), date="2026-11-30"), "That time is past"),
    ],
)
def test_what_never_comes_or_too_often_is_told(when: When, sentence: str) -> None:
    with pytest.raises(BadRhythm, match=sentence):
        rhythm_of(when, NOW, ZURICH)


@pytest.mark.parametrize(
    ("now", "first"),
    [
        ("2026-03-28 12:00", "Sun 29 Mar 03:00"),  # the clocks leap over two o'clock
        ("2026-10-24 12:00", "Sun 25 Oct 02:30"),  # and show it twice: the first of them
        ("2026-02-28 12:00", "Sun 01 Mar 02:30"),
        ("2026-12-31 12:00", "Fri 01 Jan 02:30"),
    ],
)
def test_tomorrow_at_half_past_two_in_the_night(now: str, first: str) -> None:
    found = rhythm_of(When(times=("02:30",), days_ahead=1), at(now), ZURICH)
    assert isinstance(found, Rhythm)
    [moment] = times(found)
    assert f"{local(moment, ZURICH):%a %d %b %H:%M}" == first
    assert moment - at(now) == pytest.approx(14.5 * 3600, abs=1800)


CLOCKS = st.integers(0, 24 * 12 - 1).map(lambda each: f"{each // 12:02}:{each % 12 * 5:02}")


@given(
    said=st.lists(CLOCKS, min_size=1, max_size=6, unique=True),
    days=st.lists(st.integers(0, 6), unique=True),
    now=st.integers(int(at("2026-01-01 00:00")), int(at("2027-12-31 23:59"))),
)
def test_each_time_that_was_said_comes_on_each_day_that_was_said(
    said: list[str], days: list[int], now: int
) -> None:
    """Whatever hours and minutes they have; but for the hour that the clocks leap over."""
    when = When(times=tuple(sorted(said)), weekdays=tuple(sorted(days)), repeats=True)
    found = rhythm_of(when, now, ZURICH)
    assert isinstance(found, Rhythm)
    week = itertools.takewhile(lambda each: each < now + 8 * 86_400, times(found, now))
    there = [local(each, ZURICH) for each in week]
    assert {f"{each:%H:%M}" for each in there} - {"03:00"} <= set(said)
    assert {each.weekday() for each in there} == set(days or range(7))
