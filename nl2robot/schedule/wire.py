"""The methods on the wire for appointments: `schedule.list` to `schedule.reminders`."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import date, datetime
from typing import Any, Final, Protocol, get_args

import msgspec

from nl2robot.errors import UserError
from nl2robot.run.runlog import RunLog
from nl2robot.schedule.appointments import MAKES_UP_AT_MOST, PRIORITIES, Appointment
from nl2robot.schedule.reminders import Reminder, reminders
from nl2robot.schedule.rhythm import LONGEST_RULE, BadRhythm, Rhythm
from nl2robot.schedule.schedule import Came, Listed, Schedule, Told
from nl2robot.schedule.telling import happening
from nl2robot.schedule.triggers import LONGEST, SHORTEST, Trigger, What
from nl2robot.schedule.week import Week, week_of
from nl2robot.wire import LANGUAGE, NAME, NUMBER, SHA256, an_object, service
from robot_api.local_time import local_zone
from robot_api.methods import MAX_TEXT
from robot_api.server import Service

LONGEST_PROGRAM: Final = 65_536
_LAST: Final = {"type": "integer", "minimum": 1, "maximum": 1000}
_DATE: Final = {"type": "string", "pattern": "^[0-9]{4}-[0-9]{2}-[0-9]{2}$"}
_TIME: Final = {"type": ["number", "null"]}
_RHYTHM: Final = {
    **an_object(
        {
            "begins": {"type": "string", "maxLength": 40},
            "zone": {"type": "string", "maxLength": 60},
            "rule": {"type": ["string", "null"], "maxLength": LONGEST_RULE},
        },
        "begins",
    ),
    "type": ["object", "null"],
}
_TEXT: Final = {"type": "string", "maxLength": LONGEST}
_TRIGGER: Final = {
    **an_object(
        {
            "what": {"enum": list(get_args(What))},
            **dict.fromkeys(("text", "thing", "place", "topic"), _TEXT),
            "below": {"type": "integer", "minimum": 0, "maximum": 99},
            "every": {"type": "number", "minimum": SHORTEST},
        },
        "what",
    ),
    "type": ["object", "null"],
}


class Happens(msgspec.Struct, frozen=True):
    """An event that may begin a program."""

    trigger: Trigger
    when: str
    """In words."""


class Face(Protocol):
    """Whose buttons are triggers, see `nl2robot.schedule.service.Timekeeper`."""

    @property
    def buttons(self) -> list[str]: ...

    def press(self, button: str) -> bool: ...


def schedule_services(
    schedule: Schedule, face: Face | None = None, log: RunLog | None = None
) -> dict[str, Service]:
    """The methods to register with a `robot_api.server.Server`; `log` is for the reminders."""

    def pressed(p: Mapping[str, Any]) -> bool:
        if face is None or p["button"] not in face.buttons:
            raise UserError("There is no such button any more. Load the page anew.")
        return face.press(p["button"])

    def happens(p: Mapping[str, Any]) -> Happens:
        trigger = schedule.noticed(msgspec.convert(p["trigger"], Trigger))
        return Happens(trigger, happening(trigger, p.get("language", "en")))

    def added(p: Mapping[str, Any]) -> Appointment:
        given = dict(p)
        given["rhythm"] = _rhythm(given.pop("rhythm", None))
        trigger = given.pop("trigger", None)
        given["trigger"] = msgspec.convert(trigger, Trigger) if trigger is not None else None
        return schedule.add(**given)

    def paused(p: Mapping[str, Any], yes: bool) -> Appointment:
        return schedule.pause(p["id"], yes)

    def skipped(p: Mapping[str, Any]) -> list[float]:
        day = _day(p["date"]) if "date" in p else None
        if not p.get("back"):
            return schedule.skip(p["id"], day)
        if day is None:
            raise UserError("Say by `date` which day is to be done after all.")
        return schedule.call_back(p["id"], day)

    return {
        "schedule.list": service(
            lambda p: schedule.listed(p.get("language", "en")),
            "List the appointments of this robot: approved programs with the times at which they"
            " are done, when they come next, and which of those were called off.",
            {"language": LANGUAGE},
            observes=True,
            result=list[Listed],
        ),
        "schedule.add": service(
            added,
            "Approve exactly the program with this SHA-256 for a rhythm, or for a trigger, `until`"
            " then (seconds since the epoch; 30 days if it is not said). `rhythm`: `begins`, a"
            " local time as 2026-11-30T08:00, `zone` as Europe/Zurich (the server's if it is left"
            " out) and a `rule` of RFC 5545, or none for once. Of those that wait the one with the"
            " highest `priority` begins first. What was missed while the server was not running is"
            " made up for within `makes_up` minutes. Before each time it is reviewed again; if that"
            " finds something new, it waits for a new approval. With `fleet` any robot of the fleet"
            " may do it: this one keeps it, and has it handed out at its time.",
            {
                "program": {"type": "string", "maxLength": LONGEST_PROGRAM},
                "sha256": SHA256,
                "by": NAME,
                "sentence": {"type": "string", "minLength": 1, "maxLength": MAX_TEXT},
                "language": LANGUAGE,
                "rhythm": _RHYTHM,
                "trigger": _TRIGGER,
                "plan": {"type": ["string", "null"], "maxLength": 4 * LONGEST_PROGRAM},
                "priority": {
                    "type": "integer",
                    "minimum": PRIORITIES[0],
                    "maximum": PRIORITIES[1],
                },
                "makes_up": {"type": "integer", "minimum": 0, "maximum": MAKES_UP_AT_MOST},
                "until": _TIME,
                "insists": {"type": "boolean"},
                "fleet": {"type": "boolean"},
            },
            "program sha256 by sentence",
            result=Appointment,
        ),
        "schedule.approve": service(
            lambda p: schedule.approve(
                p["id"], p["sha256"], p["by"], p.get("until"), p.get("insists", False)
            ),
            "Approve an appointment anew, as its program is reviewed now: one whose approval has"
            " ended, or whose review came out another way.",
            {
                "id": NUMBER,
                "sha256": SHA256,
                "by": NAME,
                "until": _TIME,
                "insists": {"type": "boolean"},
            },
            "id sha256 by",
            result=Appointment,
        ),
        "schedule.pause": service(
            lambda p: paused(p, True),
            "Have an appointment skipped until it is resumed.",
            {"id": NUMBER},
            "id",
            result=Appointment,
        ),
        "schedule.resume": service(
            lambda p: paused(p, False),
            "Have a paused appointment done again from its next time on.",
            {"id": NUMBER},
            "id",
            result=Appointment,
        ),
        "schedule.remove": service(
            lambda p: schedule.remove(p["id"]),
            "Remove an appointment; what was done is still told. A run that goes on goes on.",
            {"id": NUMBER},
            "id",
            result=None,
        ),
        "schedule.skip": service(
            skipped,
            "Call off the next time of an appointment, or all of a day (`date`); with `back`, have"
            " them done after all. Returns the times, in seconds since the epoch.",
            {"id": NUMBER, "date": _DATE, "back": {"type": "boolean"}},
            "id",
            result=list[float],
        ),
        "schedule.buttons": service(
            lambda p: face.buttons if face is not None else [],
            "List the buttons that the robot's face shows: each begins an appointment.",
            right="face",
            result=list[str],
        ),
        "schedule.press": service(
            pressed,
            "Somebody presses one of `schedule.buttons`. Tells whether that counts: not if it was"
            " pressed lately.",
            {"button": _TEXT},
            "button",
            right="face",
            result=bool,
        ),
        "schedule.event": service(
            happens,
            "Tell how an event that shall begin a program is kept: its place by the name that it"
            " has in this house, and what it is in words. Refuses what this robot would never"
            " notice. Nothing is planned.",
            {"trigger": {**_TRIGGER, "type": "object"}, "language": LANGUAGE},
            "trigger",
            result=Happens,
        ),
        "schedule.history": service(
            lambda p: schedule.history(p.get("id"), p.get("last", 100), p.get("language", "en")),
            "List the latest times that came, of an appointment or all, and what became of each;"
            " the newest first. Times to come that were called off are among them.",
            {"id": NUMBER, "last": _LAST, "language": LANGUAGE},
            observes=True,
            result=list[Came],
        ),
        "schedule.week": service(
            lambda p: week_of(
                schedule, _day(p["date"]) if "date" in p else None, p.get("language", "en")
            ),
            "Tell the week with that day in it (this one, without a `date`), from Monday to Sunday:"
            " each time with what came of it or whether it will be done (coming, called off,"
            " paused, not approved), and when it is by the clocks of the house.",
            {"date": _DATE, "language": LANGUAGE},
            observes=True,
            result=Week,
        ),
        "schedule.reminders": service(
            lambda p: reminders(
                schedule, log, p.get("since", 0.0), p.get("language", "en"), p.get("last", 100)
            ),
            "List the latest reminders, or those since a moment (seconds since the epoch), the"
            " newest first: when each was due and said, to whom, where, and what came of it"
            " (yes, no, unclear, silent, away: not found, gone: not there any more when asked,"
            " broken_off, or what became of a time at which it was not said). A program reminds"
            " somebody if it keeps the answer to a question of its own as `reminder_done`.",
            {"since": {"type": "number"}, "last": _LAST, "language": LANGUAGE},
            observes=True,
            result=list[Reminder],
        ),
        "schedule.notices": service(
            lambda p: schedule.notices(
                p.get("after", 0), p.get("last", 100), p.get("language", "en")
            ),
            "List the newest notices, or those with a higher number than `after`: what somebody has"
            " to know of an appointment who was not looking. The newest is the last.",
            {
                "after": {"type": "integer", "minimum": 0},
                "last": _LAST,
                "language": LANGUAGE,
            },
            observes=True,
            result=list[Told],
        ),
    }


def _rhythm(given: Mapping[str, Any] | None) -> Rhythm | None:
    """Raises `BadRhythm`."""
    if given is None:
        return None
    try:
        begins = datetime.fromisoformat(given["begins"])
    except ValueError:
        raise BadRhythm(
            f"{given['begins']!r} is no time at which something begins. Write it as"
            " 2026-11-30T08:00."
        ) from None
    return Rhythm(begins, given.get("zone") or local_zone(), given.get("rule"))


def _day(written: str) -> date:
    try:
        return date.fromisoformat(written)
    except ValueError:
        raise UserError(f"There is no day {written}. Write it as 2026-11-30.") from None
