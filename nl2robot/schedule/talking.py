"""What people ask of appointments in conversation: what is planned, "not tomorrow", "cancel the
round at eight". Nothing is called off before whoever asked has said yes."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import date, timedelta
from typing import TYPE_CHECKING, Any, Final, Literal

from grammar.requests import Request, When
from nl2robot.errors import UserError
from nl2robot.schedule.rhythm import local
from nl2robot.schedule.words import a_moment, on_date
from nl2robot.sentences import in_language
from nl2robot.texts import texts_in
from robot_api.local_time import local_zone

if TYPE_CHECKING:
    from nl2robot.schedule.schedule import Listed, Schedule

KINDS: Final = frozenset({"appointments", "skip", "unschedule"})
"""The requests that are answered here."""
_HALF_A_DAY: Final = 12 * 60


@dataclass(frozen=True)
class CallOff:
    """Appointments that are called off if somebody says yes."""

    language: str
    numbers: tuple[int, ...]
    day: date | None
    """Only on that day; None for good."""


@dataclass(frozen=True)
class Said:
    """An answer, and what waits for a yes."""

    status: Literal["ok", "clarify", "rejected"]
    message: str
    pending: CallOff | None = None


def answered(request: Request, schedule: Schedule | None, language: str) -> Said:
    """Answer a request of `KINDS`; changes nothing. Raises `UserError` where the book cannot be
    read."""
    texts = texts_in(language, "schedules")["talk"]
    if schedule is None:
        return Said("rejected", texts["nowhere"])
    listed = schedule.listed(language)
    if not listed:
        return Said("ok", texts["none"])
    match request.kind:
        case "skip":
            return _skipped(request.when or When(), schedule, listed, language)
        case "unschedule":
            return _removed(request, listed, language)
        case _:
            return Said("ok", " ".join(_told(each, language) for each in listed))


def settled(pending: CallOff, agreed: bool, schedule: Schedule | None) -> Said:
    """Call off what was waiting for a yes, or leave it."""
    texts = texts_in(pending.language, "schedules")["talk"]
    if not agreed or schedule is None:
        return Said("ok", texts["left"])
    try:
        for number in pending.numbers:
            if pending.day is not None:
                schedule.skip(number, pending.day)
            else:
                schedule.remove(number)
    except UserError as error:
        message = str(error)
        return Said("rejected", in_language(message, pending.language) or message)
    return Said("ok", texts["left_out" if pending.day is not None else "removed"])


def _told(listed: Listed, language: str) -> str:
    """An appointment in a sentence."""
    texts: Any = texts_in(language, "schedules")["talk"]
    kept = listed.appointment
    values = {"number": kept.id, "when": listed.when, "sentence": kept.sentence}
    if kept.asked is not None:
        return str(texts["asked"]).format(**values)
    if kept.paused:
        return str(texts["paused"]).format(**values)
    if not listed.next:
        return str(texts["planned"]).format(**values)
    zone = kept.rhythm.zone if kept.rhythm is not None else local_zone()
    moment = a_moment(listed.next[0], zone, language)
    return str(texts["planned_next"]).format(**values, next=moment)


def _skipped(when: When, schedule: Schedule, listed: list[Listed], language: str) -> Said:
    texts = texts_in(language, "schedules")["talk"]
    now = local(schedule.clock(), local_zone())
    ahead = when.days_ahead or 0
    if when.weekdays:
        ahead = (when.weekdays[0] - now.weekday()) % 7
    day = now + timedelta(days=ahead)
    on = on_date(day, language).rstrip(",")
    found = [each for each in listed if schedule.is_done_on(each.appointment.id, day.date())]
    if not found:
        return Said("ok", str(texts["nothing_then"]).format(day=on))
    names = ", ".join(_named(each, language) for each in found)
    numbers = tuple(each.appointment.id for each in found)
    question = str(texts["ask_skip"]).format(day=on, names=names)
    return Said("clarify", question, CallOff(language, numbers, day.date()))


def _removed(request: Request, listed: list[Listed], language: str) -> Said:
    texts = texts_in(language, "schedules")["talk"]
    found = [each for each in listed if request.when and _is_at(each, request.when)]
    alike = [each for each in found if _shares_a_word(request.name, each.appointment.sentence)]
    found = alike or found
    if not found:
        return Said("rejected", texts["none_at_that_time"])
    names = ", ".join(_named(each, language) for each in found)
    numbers = tuple(each.appointment.id for each in found)
    question = str(texts["ask_remove"]).format(names=names)
    return Said("clarify", question, CallOff(language, numbers, None))


def _named(listed: Listed, language: str) -> str:
    named = texts_in(language, "schedules")["talk"]["named"]
    return str(named).format(when=listed.when, sentence=listed.appointment.sentence)


def _is_at(listed: Listed, when: When) -> bool:
    """Whether it is done at such a time of day; at eight may be in the evening, too."""
    rhythm = listed.appointment.rhythm
    if rhythm is None or not when.times:
        return False
    said = {_minutes(each) % _HALF_A_DAY for each in when.times}
    there = (local(moment, rhythm.zone) for moment in (*listed.next, *listed.off))
    times = {(each.hour * 60 + each.minute) % _HALF_A_DAY for each in there}
    times.add((rhythm.begins.hour * 60 + rhythm.begins.minute) % _HALF_A_DAY)
    return bool(said & times)


def _minutes(time: str) -> int:
    hour, _, minute = time.partition(":")
    return int(hour) * 60 + int(minute)


def _shares_a_word(name: str, sentence: str) -> bool:
    return bool(set(name.lower().split()) & set(sentence.lower().split()))
