"""Whether a driver stops: every long call comes back, the robot stands, and everybody is told."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from robot_api.conformance.samples import Sample, long_calls
from robot_api.conformance.subject import (
    ON_THE_WAY,
    UNDER_WAY,
    Attempt,
    Subject,
    confirmed,
    honest,
)
from robot_api.driver import StopFlag
from robot_api.errors import RobotError, Stopped
from robot_api.methods import METHODS

_TRIES = 6
"""How often it may be late before it counts: a busy machine is late at times, a bad driver always.
"""
_BUSY = 0.5
"""Seconds that a busy machine may be to blame for."""
_NEWS = 0.5
"""Seconds in which an event must have come."""
_DRIVES = frozenset({"navigation", "motion", "dock", "following", "guiding", "vision"})
"""Capabilities whose movements take the robot elsewhere: it is watched afterwards."""


def check_stopping(subject: Subject) -> None:
    """A stop brings every long call back at once, and is no exception a program can catch."""
    subject.findings.tried.add("stopping")
    for sample in long_calls(subject):
        for way in (_stopped, _cancelled):
            _check(subject, sample, way)
    _check_stopped_before(subject)
    _check_standing(subject)
    afterwards: tuple[Sample, ...] = (("stop", {}), ("wait", {"seconds": 0}))
    for name, arguments in afterwards:
        result = subject.try_to(name, **arguments)
        if result is not None:
            subject.findings.wrong("stopping", name, f"does not work after a stop: {result!r}")


@dataclass
class _Faults:
    wrong: list[str] = field(default_factory=list)
    late: list[str] = field(default_factory=list)
    """What a busy machine may be to blame for: it is tried again."""


_Way = Callable[[Subject, str, Mapping[str, Any], float], _Faults]
"""Stops a call in one way or another, when it has been under way for so many seconds."""


def _check(subject: Subject, sample: Sample, way: _Way) -> None:
    name, arguments = sample
    for trial in range(_TRIES):
        # A little earlier each time: a call that is done just then has not ignored the stop.
        faults = way(subject, name, arguments, UNDER_WAY / (1 + trial))
        if faults.wrong or not faults.late:
            break
    for message in (*faults.wrong, *faults.late):
        subject.findings.wrong("stopping", name, message)


def _stopped(
    subject: Subject, name: str, arguments: Mapping[str, Any], under_way: float
) -> _Faults:
    """The whole robot is stopped in the middle of the call."""
    faults = _Faults()
    call = subject.begin(name, arguments)
    if call.returned(under_way):
        return faults  # too short a call to be stopped
    start = len(subject.heard)
    stop = subject.stop("The check stops the robot.", call)
    _ended(subject, call, stop.began, "a stop", faults)
    _settled(subject, stop, start, faults)
    _stands(subject, name, "a stop", faults)
    return faults


def _cancelled(
    subject: Subject, name: str, arguments: Mapping[str, Any], under_way: float
) -> _Faults:
    """Only the call is broken off."""
    faults = _Faults()
    call = subject.begin(name, arguments)
    if call.returned(under_way):
        return faults
    began = Attempt(lambda flag: call.flag.set("The check cancels this call.")).began
    _ended(subject, call, began, "a cancel", faults)
    # It confirms nothing, as a stop does: the wheels may take their time to stand.
    _stands(subject, name, "a cancel", faults, patience=subject.has.stop_within + ON_THE_WAY)
    return faults


def _ended(subject: Subject, call: Attempt, began: float, what: str, faults: _Faults) -> None:
    if not call.returned():
        faults.wrong.append(f"did not come back after {what}")
        subject.stop("The check gives this call up.", call).returned()
        return
    if call.ended <= began:
        return  # it was done when nobody had told it anything yet
    _in_time(subject, call.ended - began, f"came back {{}} ms after {what}", faults)
    if call.error is None:  # it may just have been done
        faults.late.append(f"returned after {what} as if nothing had been, and raised no Stopped")
    elif not isinstance(call.error, Stopped):
        # It may just have failed, as it may at any time.
        counts = faults.late if isinstance(call.error, RobotError) else faults.wrong
        counts.append(f"{call.outcome} at {what}, not Stopped")


def _settled(subject: Subject, stop: Attempt, start: int, faults: _Faults) -> None:
    """The stop itself returned in time, and the events say so."""
    if not stop.returned():
        faults.wrong.append("a stop did not return")
        return
    _in_time(subject, stop.ended - stop.began, "a stop took {} ms", faults)
    if honest(stop):
        faults.late.append(f"a stop was not confirmed: {stop.error}")
    elif not confirmed(stop):
        faults.wrong.append(f"a stop {stop.outcome}, not StopNotConfirmed")
    else:
        subject.heard.wait_for("stopped", start, _NEWS)
        told = [kind for kind, _ in subject.heard.since(start) if kind in ("stopping", "stopped")]
        if told != ["stopping", "stopped"]:
            said = ", ".join(told) or "nothing"
            faults.wrong.append(f"a stop sent the events {said}, not stopping, stopped")


def _in_time(subject: Subject, took: float, message: str, faults: _Faults) -> None:
    late = took - subject.has.stop_within - ON_THE_WAY
    if late > 0:
        counts = faults.wrong if late > _BUSY else faults.late
        counts.append(message.format(f"{took * 1000:.0f}"))


def _stands(subject: Subject, name: str, what: str, faults: _Faults, patience: float = 0.0) -> None:
    """It stands, at the latest after so many seconds."""
    method, until = METHODS[name], time.monotonic() + patience
    if method.moves and method.capability in _DRIVES:
        moves = subject.moves_on()
        while moves and time.monotonic() < until:
            moves = subject.moves_on()
        if moves:
            faults.wrong.append(f"{moves} after {what}")


def _check_stopped_before(subject: Subject) -> None:
    flag = StopFlag()
    flag.set()
    wrong = subject.findings.wrong
    try:
        subject.driver.call("wait", {"seconds": 0}, flag)
    except Stopped:
        return
    except BaseException as error:  # noqa: BLE001 - whatever it is, it is reported
        raised = type(error).__name__
        wrong("stopping", "wait", f"raised {raised} when stopped before it began")
    else:
        wrong("stopping", "wait", "went on though it was stopped before it began")


def _check_standing(subject: Subject) -> None:
    """A robot that stands already is stopped like any other, and says so."""
    for _ in range(_TRIES):
        faults = _Faults()
        start = len(subject.heard)
        _settled(subject, subject.stop("The check stops the robot."), start, faults)
        if faults.wrong or not faults.late:
            break
    for message in (*faults.wrong, *faults.late):
        subject.findings.wrong("stopping", None, message)
