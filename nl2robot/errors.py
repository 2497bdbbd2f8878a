"""Errors towards the user, and the exit statuses that scripts can rely on."""

from __future__ import annotations

import enum
from typing import Final


class ExitStatus(enum.IntEnum):
    OK = 0
    FAILED = 1
    BAD_INPUT = 2
    NOT_UNDERSTOOD = 3
    NOT_APPROVED = 4
    NO_ROBOT = 5
    INTERNAL = 70
    INTERRUPTED = 130


MEANINGS: Final = {
    ExitStatus.OK: "done; of `translate`: a program or an answer for every sentence",
    ExitStatus.FAILED: "it ran and failed: the robot could not do it, a canned utterance changed",
    ExitStatus.BAD_INPUT: "wrong usage, a missing or broken file, an unknown name",
    ExitStatus.NOT_UNDERSTOOD: (
        "not understood, or to be asked about (`translate --json`: 0, as its object says so)"
    ),
    ExitStatus.NOT_APPROVED: "the program was not approved",
    ExitStatus.NO_ROBOT: "the robot is not to be reached, or the connection was lost",
    ExitStatus.INTERNAL: "a fault of this software",
    ExitStatus.INTERRUPTED: "interrupted by Ctrl-C; the robot stands",
}


class UserError(Exception):
    """Something the user can mend; the message says what happened and what to do next."""

    def __init__(self, message: str, status: ExitStatus = ExitStatus.BAD_INPUT) -> None:
        super().__init__(message)
        self.status = status
