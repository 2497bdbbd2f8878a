"""Which half of the day is meant by an hour that is said without it: "at eight".

People say the hours of a house's day so, and what they leave out is plain to whoever is there:

- From 1 to 6 is the afternoon, from 7 to 11 the morning, 12 is noon: by day there are rounds and
  visits, and who means the night says so. That reading is the `usual` one.
- What is to be done once, and no day was said, is done when the clock's face shows it next. If that
  is the usual reading ("at three", said at one o'clock), it is clear. If it is the other one ("at
  eight", said at ten in the morning), either may be meant, this evening or tomorrow: it is asked.
- Of today only what is still to come can be meant: "today at eight", said at ten, is this evening.
- On another day, or again and again, nothing tells which but the hour itself, and from 6 to 8 there
  is as much to do in the evening as in the morning (meals, medicine, the change of shifts): asked.
- Several times are said in the order of the day, which decides most of them: "at eight and at two"
  is eight in the morning, "at ten and at four" ends in the afternoon.

Times are "HH:MM" of 24 hours. Nothing here knows a language, or what time it is.
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Sequence
from typing import Final

LAST_HOUR_MEANT_PM: Final = 6
"""Up to "six o'clock" is in the afternoon where nothing else is said."""
LAST_HOUR_AFTER_MIDNIGHT: Final = 5
"""Up to here "at night" is after midnight, later ones are before it."""
EITHER_HALF: Final = range(6, 9)
"""What o'clock people say of mornings and of evenings alike."""
HALF_A_DAY: Final = 12 * 60
A_DAY: Final = 24 * 60

NIGHT: Final = "night"
"""A half of the day with midnight in it, beside "am" and "pm"."""

Choice = tuple[str, ...]


def usual_hour(hour: int) -> int:
    """The hour of 24 that an hour of a clock's face is taken for."""
    return hour + 12 if 1 <= hour <= LAST_HOUR_MEANT_PM else hour


def hour_at_night(hour: int) -> int:
    """ "At two at night" is after midnight, "at ten at night" before, "twelve" is midnight."""
    if hour == 12:
        return 0
    return hour + 12 if LAST_HOUR_AFTER_MIDNIGHT < hour < 12 else hour


def is_late(time: str) -> bool:
    """Whether it is not in the hours after midnight."""
    return int(time[:2]) > LAST_HOUR_AFTER_MIDNIGHT


def twelve_hours_off(time: str) -> str:
    """What the clock's face shows as well."""
    return f"{(int(time[:2]) + 12) % 24:02}{time[2:]}"


def minutes_of(time: str) -> int:
    """From midnight on."""
    return int(time[:2]) * 60 + int(time[3:])


def end_of(since: str | None, until: str, bare: bool) -> str:
    """When what begins at one time ends, at another: the next that it is, "from nine to five" as
    well as "from ten in the evening to six"."""
    if not bare or since is None:
        return until
    return min(until, twelve_hours_off(until), key=lambda each: _minutes_after(each, since))


def choices(
    times: Sequence[str], bare: Collection[str], now: str | None = None, today: bool = False
) -> tuple[Choice, ...]:
    """The times that may be meant by those that were said, each in its usual reading and in their
    order; `bare` are those that were said without their half of the day. A single choice is clear;
    several are to be asked. `now` is given for what is done once on no day that was said, or
    `today`."""
    if not times:
        return ((),)
    if now is not None and len(times) == 1:
        return tuple((each,) for each in _once(times[0], times[0] in bare, now, today))
    found = _in_the_order_of_the_day([_on_a_day(each, each in bare) for each in times])
    if not found:
        both = [(each, twelve_hours_off(each)) if each in bare else (each,) for each in times]
        found = _in_the_order_of_the_day(both)
    if now is not None:
        to_come = [choice for choice in found if minutes_of(choice[0]) > minutes_of(now)]
        found = to_come or found
    return tuple(found) or (tuple(times),)


def _once(time: str, bare: bool, now: str, today: bool) -> Choice:
    other = twelve_hours_off(time)
    if not bare or other == time:
        return (time,)
    if today:
        to_come = sorted(each for each in (time, other) if each > now)
        if len(to_come) < 2:
            return tuple(to_come) or (time,)
    usual_first = _minutes_after(time, now) < _minutes_after(other, now)
    return (time,) if usual_first else (other, time)


def _minutes_after(time: str, before: str) -> int:
    """Until it is that late for the next time; a whole day if it is just then."""
    return (minutes_of(time) - minutes_of(before) - 1) % A_DAY + 1


def _on_a_day(time: str, bare: bool) -> Choice:
    if bare and int(time[:2]) % 12 in EITHER_HALF:
        return tuple(sorted((time, twelve_hours_off(time))))
    return (time,)


def _in_the_order_of_the_day(readings: Sequence[Choice]) -> list[Choice]:
    found = itertools.product(*readings)
    return [each for each in found if all(a < b for a, b in itertools.pairwise(each))]
