"""Errors towards the user, and the exit statuses that scripts can rely on."""

from __future__ import annotations

import enum


class ExitStatus(enum.IntEnum):
    OK = 0
    FAILED = 1  # it ran and failed: the robot could not do it, a canned utterance changed
    BAD_INPUT = 2  # wrong usage, a missing or broken file, an unknown name
    NOT_UNDERSTOOD = 3
    NOT_APPROVED = 4
    NO_ROBOT = 5  # not to be reached, or the connection was lost
    INTERNAL = 70  # a fault of this software
    INTERRUPTED = 130  # Ctrl-C


class UserError(Exception):
    """Something the user can mend; the message says what happened and what to do next."""

    def __init__(self, message: str, status: ExitStatus = ExitStatus.BAD_INPUT) -> None:
        super().__init__(message)
        self.status = status
