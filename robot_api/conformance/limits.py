"""Whether a driver refuses, at the call, what the robot may not do."""

from __future__ import annotations

from robot_api.conformance.samples import beyond_limits, within_limits
from robot_api.conformance.subject import Subject
from robot_api.errors import InvalidCall


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
