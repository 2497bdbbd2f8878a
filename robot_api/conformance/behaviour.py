"""Whether a driver does what the method table says: results, errors, names, places, events."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import msgspec

from robot_api.conformance.limits import check_pace
from robot_api.conformance.samples import samples, strange_names
from robot_api.conformance.subject import UNDER_WAY, Subject
from robot_api.driver import EVENTS, Event
from robot_api.errors import NotPossible, NotSupported, RobotError
from robot_api.methods import CORE, METHODS, Method
from robot_api.schema import compiled, result_schema

_AT_ONCE = 4
"""Callers who ask the same robot at the same time."""


def check_declared(subject: Subject) -> None:
    """What it declares is of the table, and complete."""
    has, wrong = subject.has, subject.findings.wrong
    for name in has.methods:
        if name not in METHODS:
            wrong(CORE, name, "is declared, but the method table has no such method")
    for name, method in METHODS.items():
        if method.capability == CORE and name not in has.methods:
            wrong(CORE, name, "is not declared, but every robot has it")
    needed: Mapping[str, tuple[str, Any]] = {
        "say": ("languages", has.languages),
        "emotion": ("emotions", has.emotions),
        "gesture": ("gestures", has.gestures),
        "joint": ("joints", has.joints),
        "do": ("skills", has.skills),
        "grab": ("hands", has.hands),
    }
    for name, (field, value) in needed.items():
        if name in has.methods and not value:
            wrong(_part(name), name, f"is declared, but the capabilities name no {field}")
    for joint, (least, most) in has.joints.items():
        if least > most:
            wrong("joints", "joint", f"{joint} goes from {least} to {most}, which is backwards")
    if has.units not in ("m", "cm"):
        wrong(CORE, None, f"the unit of the map is {has.units!r}, not 'm' or 'cm'")
    if not has.name or not has.kind:
        wrong(CORE, None, "the robot has no name or no kind")
    if has.stop_within <= 0:
        wrong("stopping", None, f"it states to stand within {has.stop_within} s")


def check_methods(subject: Subject) -> None:
    """Each method gives a result of its kind, or one of its errors, or is not supported."""
    for name, arguments in samples(subject):
        if name not in subject.has.methods:
            subject.expect(_part(name), NotSupported, name, arguments)
        elif subject.can(name):
            check_call(subject, _part(name), name, arguments)


def check_call(subject: Subject, part: str, name: str, arguments: Mapping[str, Any]) -> None:
    method = METHODS[name]
    try:
        result = subject.call(name, arguments)
    except BaseException as error:  # noqa: BLE001 - whatever it is, it is reported
        check_error(subject, part, method, error)
    else:
        check_result(subject, part, method, result)


def check_error(subject: Subject, part: str, method: Method, error: BaseException) -> None:
    """It is one of those that the method names."""
    wrong, kind = subject.findings.wrong, type(error).__name__
    if not isinstance(error, RobotError):
        wrong(part, method.name, f"raised {kind}, which is no RobotError: {error}")
        return
    if kind not in {*method.errors, *(["NotPossible"] if method.moves else [])}:
        wrong(part, method.name, f"raised {kind}, which is none of its errors")
    subject.findings.check_sentence(part, method.name, error)


def check_result(subject: Subject, part: str, method: Method, result: Any) -> None:
    """It is of the kind that the table says."""
    try:
        data = msgspec.to_builtins(result)
    except TypeError as error:
        subject.findings.wrong(part, method.name, f"returned what JSON cannot carry: {error}")
        return
    for fault in compiled(result_schema(method)).iter_errors(data):
        subject.findings.wrong(part, method.name, f"returned {result!r}: {fault.message}")


def check_names(subject: Subject) -> None:
    """A name that it does not know is refused, not taken for another."""
    for kind, name, arguments in strange_names():
        if subject.can(name):
            subject.expect(_part(name), kind, name, arguments)


def check_places(subject: Subject) -> None:
    """The places are consistent: of a kind, those of that kind; driven to, there it is."""
    wrong = subject.findings.wrong
    known, of_kind = subject.places(), subject.try_to("places", kind="office")
    if isinstance(of_kind, list):
        for name in set(of_kind) - set(known):
            wrong(CORE, "places", f"lists {name!r} of a kind, but not among all places")
    if not subject.can("goto", "location"):
        return
    for place in dict.fromkeys((*known[1:2], *known[-1:], *known[:1])):  # it has to move for each
        if isinstance(subject.try_to("goto", place=place), BaseException):
            continue
        subject.been.append(place)
        location = subject.try_to("location")
        if getattr(location, "place", None) != place:
            wrong("navigation", "goto", f"went to {place!r}, but location() says {location!r}")


def check_at_once(subject: Subject) -> None:
    """Several may ask at the same time; but a second movement is refused."""
    wrong = subject.findings.wrong
    calls = [subject.begin("clock", {}) for _ in range(_AT_ONCE)]
    for call in calls:
        if not call.returned():
            wrong(CORE, "clock", f"does not come back if {_AT_ONCE} ask at the same time")
        elif call.error is not None:
            wrong(CORE, "clock", f"{call.outcome} while others asked at the same time")
    if not subject.can("goto", "turn"):
        return
    turning = subject.begin("turn", {"degrees": 36000})
    if turning.returned(UNDER_WAY):
        return
    second = subject.try_to("goto", x=0, y=0)
    if not isinstance(second, NotPossible) and not turning.returned(0):
        wrong("navigation", "goto", f"was not refused while the robot turned: {second!r}")
    if subject.can("emotion") and not turning.returned(0):
        shown = subject.try_to("emotion", name=subject.has.emotions[0])
        if shown is not None:
            wrong("face", "emotion", f"did not work while the robot turned: {shown!r}")
    subject.stop("The check stops the robot.", turning).returned()
    turning.returned()


def check_events(subject: Subject) -> None:
    """Every event is of a known kind with its fields, and what was done was told."""
    subject.findings.tried.add("events")
    heard = subject.heard.since()
    for kind, data in heard:
        check_event(subject, kind, data)
    told = {kind for kind, _ in heard}
    for name, method in METHODS.items():
        if method.tells is not None and subject.can(name) and method.tells not in told:
            subject.findings.wrong("events", name, f"sends no event {method.tells!r}")
    check_pace(subject, [data for kind, data in heard if kind == "pose"])


def check_event(subject: Subject, kind: str, data: Event) -> None:
    wrong = subject.findings.wrong
    if kind not in EVENTS:
        wrong("events", None, f"sent an event of the unknown kind {kind!r}")
        return
    missing = missing_fields(kind, data)
    if missing:
        wrong("events", None, f"sent the event {kind!r} without {missing}: {dict(data)!r}")
    try:
        msgspec.json.encode(data)
    except TypeError as error:
        wrong("events", None, f"sent the event {kind!r} with what JSON cannot carry: {error}")


def missing_fields(kind: str, data: Event) -> str:
    """The fields that an event of that kind lacks, as a text; empty if none. The fields are those
    that `EVENTS` names, before its first ":" or ";": parted by commas all, by "|" one of them."""
    plain = re.split("[:;]", re.sub(r"\(.*?\)", "", EVENTS[kind]))[0]
    if "|" in plain:
        choices = [field.strip() for field in plain.split("|")]
        return "" if any(field in data for field in choices) else " or ".join(choices)
    return ", ".join(field for field in map(str.strip, plain.split(",")) if field not in data)


def _part(method: str) -> str:
    return METHODS[method].capability
