"""The sentences of appointments: what has to be told, and what came of each time."""

from __future__ import annotations

import time
from typing import Any, Final

import msgspec

from grammar.language import languages
from nl2robot.schedule.appointments import Appointment, Notice, Occurrence
from nl2robot.schedule.rhythm import Rhythm
from nl2robot.schedule.triggers import ANYBODY, MINUTE, Trigger
from nl2robot.schedule.words import a_moment, in_words, passing
from nl2robot.sentences import in_language
from nl2robot.texts import texts_in

_UTC: Final = "UTC"


def trouble(sentence: str) -> dict[str, Any]:
    """The event `notice` about no appointment: one of our own sentences, in each language, where
    there is no book in which it could be numbered. `Schedule.trouble` is the same with a number."""
    said = {code: in_language(sentence, code) or sentence for code in languages()}
    about = {"id": None, "time": time.time(), "kind": "trouble", "appointment": None}
    return {**about, "occurrence": None, "parts": {}, "told": said}


def told(notice: Notice, language: str = "en", zone: str = _UTC) -> str:
    """A notice as a sentence. `zone`: whose clocks tell the time of what has no rhythm."""
    texts = texts_in(language, "schedules")
    parts: dict[str, Any] = dict(notice.parts)
    if notice.kind == "trouble":
        return _sentence(parts["sentence"], language)
    zone = parts.get("zone", zone)
    if "due" in parts:
        parts["due"] = a_moment(parts["due"], zone, language)
    if "first" in parts:
        parts["first"] = a_moment(parts["first"], zone, language, weekday=False)
    if "ends" in parts:
        parts["ends"] = a_moment(parts["ends"], zone, language)
    if "why" in parts:
        named = texts["waits_for" if notice.kind == "waits" else "whys"]
        parts["why"] = named.get(parts["why"], parts["why"])
        refused = (
            f"{name}: {_sentence(said, language)}"
            for name, said in parts.get("refused", {}).items()
        )
        if told := " ".join(refused):
            parts["why"] = f"{parts['why']} ({told.rstrip('.')})"
    if "news" in parts:
        found = (
            str(texts["news"][each["kind"]]).format(text=_sentence(each["text"], language))
            for each in parts["news"]
        )
        parts["news"] = " ".join(each.strip() for each in found)
    if not parts.get("person", "somebody"):
        parts["person"] = texts["reminders"]["somebody"]
    if "because" in parts:
        because = parts["because"] or texts["notes"].get(parts.get("status"), "")
        parts["because"] = _ended(_sentence(because, language))
    return str(texts["notices"][notice.kind]).format(**parts)


def outcome(occurrence: Occurrence, language: str = "en") -> str:
    """What came of a time: "missed: nl2robot was not running"."""
    texts = texts_in(language, "schedules")
    state, note = str(texts["states"][occurrence.state]), occurrence.note
    if occurrence.state == "due":
        note = texts["waits_for"].get(occurrence.waited_for)
    elif occurrence.state == "missed":
        note = texts["whys"].get(note, note)
    elif note is not None:
        note = texts["notes"].get(note) or _sentence(note, language)
    if occurrence.done_by is not None:
        by = str(texts["by_robot"]).format(robot=occurrence.done_by)
        state = f"{state}, {by}"
    return f"{state}: {note}" if note else state


def when(appointment: Appointment, language: str = "en") -> str:
    """At what times it is done, in words."""
    return when_of(appointment.rhythm, appointment.trigger, language)


def when_of(rhythm: Rhythm | None, trigger: Trigger | None, language: str = "en") -> str:
    """As `when`; one of the two is given."""
    if rhythm is None:
        assert trigger is not None
        return happening(trigger, language)
    return in_words(rhythm, language)


def happening(trigger: Trigger, language: str = "en") -> str:
    """What begins it, in words: "when the battery falls below 20 %"."""
    texts = texts_in(language, "schedules")
    named: str = trigger.what
    if trigger.what == "seen":
        named += "_anybody" if trigger.thing == ANYBODY else ""
        named += "_there" if trigger.place else ""
    elif trigger.what in ("scanned", "message") and trigger.text:
        named += "_so"
    said = str(texts["happenings"][named]).format(**msgspec.structs.asdict(trigger))
    if trigger.every == MINUTE:
        return said
    whole = trigger.every % MINUTE == 0
    every = passing(
        "minutes" if whole else "seconds",
        round(trigger.every / MINUTE if whole else trigger.every),
        language,
    )
    return str(texts["happenings"]["rarely"]).format(happening=said, every=every)


def _sentence(text: str, language: str) -> str:
    return in_language(text, language) or text


def _ended(text: str) -> str:
    return text if text.endswith((".", "!", "?")) else f"{text}."
