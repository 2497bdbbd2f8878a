"""Which half of the day is meant by "at eight", by when it is said."""

from __future__ import annotations

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grammar.times.bare_hours import (
    Choice,
    choices,
    end_of,
    minutes_of,
    twelve_hours_off,
    usual_hour,
)

MOMENTS = st.integers(0, 24 * 60 - 1).map(lambda each: f"{each // 60:02}:{each % 60:02}")
USUAL = st.tuples(st.integers(1, 12), st.integers(0, 59)).map(
    lambda said: f"{usual_hour(said[0]):02}:{said[1]:02}"
)
"""A time on a clock's face, as it is usually meant: from 07:00 to 18:59."""


@pytest.mark.parametrize(
    "time, now, today, meant",
    [
        ("08:00", "10:00", False, ("20:00", "08:00")),  # this evening, or tomorrow: asked
        ("08:00", "05:00", False, ("08:00",)),
        ("08:00", "21:00", False, ("08:00",)),
        ("08:00", "10:00", True, ("20:00",)),  # "today at eight"
        ("15:00", "13:00", False, ("15:00",)),
        ("15:00", "23:00", False, ("03:00", "15:00")),
        ("18:00", "10:00", False, ("18:00",)),
        ("22:00", "10:00", True, ("22:00",)),
        ("12:00", "10:00", False, ("12:00",)),
        ("12:00", "13:00", False, ("00:00", "12:00")),
        ("08:00", "21:00", True, ("08:00",)),  # over: whoever asks is told so
    ],
)
def test_once(time: str, now: str, today: bool, meant: Choice) -> None:
    assert choices((time,), {time}, now, today) == tuple((each,) for each in meant)


@pytest.mark.parametrize(
    "times, meant",
    [
        (("08:00",), [("08:00",), ("20:00",)]),
        (("09:00",), [("09:00",)]),
        (("15:00",), [("15:00",)]),
        (("08:00", "14:00"), [("08:00", "14:00")]),
        (("08:00", "12:00", "18:00"), [("08:00", "12:00", "18:00")]),
        (("10:00", "16:00"), [("10:00", "16:00")]),
        (("09:00", "07:00"), [("09:00", "19:00")]),
        (("08:00", "08:00"), [("08:00", "20:00")]),
        (("10:00", "10:00"), [("10:00", "22:00")]),
        (("18:00", "08:00"), [("06:00", "08:00"), ("06:00", "20:00"), ("18:00", "20:00")]),
    ],
)
def test_again_and_again_or_on_another_day(times: Choice, meant: list[Choice]) -> None:
    assert choices(times, times) == tuple(meant)


@given(time=USUAL, now=MOMENTS)
def test_what_is_clear_comes_next_on_the_face_of_the_clock(time: str, now: str) -> None:
    """And it is asked exactly where the next is not in the day; the sooner one is offered first."""
    found = choices((time,), {time}, now)
    until = {
        each: (minutes_of(each) - minutes_of(now) - 1) % (24 * 60)
        for each in (time, twelve_hours_off(time))
    }
    assert found[0][0] == min(until, key=until.__getitem__)
    assert (len(found) == 1) == (found[0][0] == time)


@given(time=USUAL, now=MOMENTS)
def test_today_is_never_what_is_past(time: str, now: str) -> None:
    found = choices((time,), {time}, now, today=True)
    to_come = {each for each in (time, twelve_hours_off(time)) if each > now}
    assert {each for (each,) in found} <= to_come or not to_come


@given(time=MOMENTS, now=st.none() | MOMENTS, today=st.booleans())
def test_what_is_said_with_its_half_is_clear(time: str, now: str | None, today: bool) -> None:
    assert choices((time,), (), now, today) == ((time,),)


@given(times=st.lists(USUAL, min_size=2, max_size=5))
def test_several_are_in_the_order_of_the_day(times: list[str]) -> None:
    for each in choices(times, times):
        for meant, said in zip(each, times, strict=True):
            assert meant in (said, twelve_hours_off(said))
        assert each == tuple(times) or all(a < b for a, b in itertools.pairwise(each))


@given(since=MOMENTS, until=USUAL)
def test_a_window_lasts_no_longer_than_half_a_day(since: str, until: str) -> None:
    end = end_of(since, until, bare=True)
    assert 0 < (minutes_of(end) - minutes_of(since) - 1) % (24 * 60) + 1 <= 12 * 60
