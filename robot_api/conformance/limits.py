"""Whether a driver refuses, at the call, what the robot may not do, and drives no faster than it
may."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from robot_api.conformance.samples import beyond_limits, within_limits
from robot_api.conformance.subject import Subject
from robot_api.driver import Event
from robot_api.errors import InvalidCall

_TOO_FAST: Final = 1.1
"""How much faster than its limit a robot may be measured, by a factor, ..."""
_SHAKES: Final = 0.05
"""... and by how many m/s what it measures may be wrong."""
_APART: Final = (0.15, 0.6)
"""Seconds between two poses that tell an acceleration."""


def check_limits(subject: Subject) -> None:
    """Speed, turn rate and each joint: what is beyond is refused, what is not is done. A voice that
    is too loud may be refused or turned down."""
    subject.findings.tried.add("limits")
    for name, arguments in beyond_limits(subject.has):
        if subject.can(name):
            subject.expect("limits", InvalidCall, name, arguments)
    for name, arguments in within_limits(subject.has):
        if subject.can(name):
            result = subject.try_to(name, **arguments)
            if isinstance(result, InvalidCall):
                message = f"refused {arguments}, which is not beyond its limit"
                subject.findings.wrong("limits", name, message)


def check_pace(subject: Subject, poses: Sequence[Event]) -> None:
    """What the robot measured itself on its ways, the events "pose" in their order, is within its
    speed and its acceleration. How fast it comes to rest is not limited."""
    speed, acceleration = map(subject.has.limits.get, ("speed", "acceleration"))
    fastest = max((abs(pose.get("speed", 0.0)) for pose in poses), default=0.0)
    if speed is not None and fastest > speed * _TOO_FAST + _SHAKES:
        message = f"drove at {fastest:.2f} m/s, faster than its limit of {speed:g}"
        subject.findings.wrong("limits", None, message)
    most = max(_accelerations(poses), default=0.0)
    if acceleration is not None and most > acceleration * _TOO_FAST:
        message = f"accelerated by {most:.2f} m/s², more than its limit of {acceleration:g}"
        subject.findings.wrong("limits", None, message)


def _accelerations(poses: Sequence[Event]) -> Iterator[float]:
    """What any two poses tell at least, m/s²."""
    timed = [pose for pose in poses if pose.get("time") is not None and "speed" in pose]
    for number, one in enumerate(timed):
        for other in timed[number + 1 :]:
            seconds = other["time"] - one["time"]
            if not 0 <= seconds <= _APART[1]:
                break
            if seconds >= _APART[0]:
                yield (abs(other["speed"]) - abs(one["speed"]) - _SHAKES) / seconds
