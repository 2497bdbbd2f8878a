"""A conversation: what is remembered from one sentence to the next."""

from __future__ import annotations

import time
from copy import copy
from typing import TYPE_CHECKING

from grammar.understanding import Context
from nl2robot.schedule import talking as appointments
from nl2robot.schedule.asking import Timeless
from nl2robot.schedule.standing import Doubtful

if TYPE_CHECKING:
    from nl2robot.deliberation.deciding import Offer
    from nl2robot.run.history import Record
    from nl2robot.translate.outcome import Translation
    from nl2robot.translate.teaching import Pending


class Talk:
    """A conversation: "no, the pharmacy" refers to what was said before in it."""

    context: Context | None = None
    pending: Pending | appointments.CallOff | None = None
    """What waits for a yes."""
    offers: tuple[Offer, ...] = ()
    """Programs of which one was asked whether it was meant."""
    last: Translation | None = None
    """The last one with a program."""
    last_at: float = 0.0
    """When that was: seconds since the epoch."""
    refused: str = ""
    """The words that no program was made of last. Said again, they are meant as they stand:
    whatever language they seem to be in, and whatever the robot remembers."""
    timeless: Timeless | None = None
    """What is to be done at a time of day that was asked back."""
    doubtful: Doubtful | None = None
    """An order of which it was asked whether it is meant each time."""
    who: str = ""
    """Who speaks; noted with the routines that they teach."""

    def copy(self) -> Talk:
        """For a translation that may be given up: only what comes of it is to be remembered."""
        return copy(self)

    def adopt(self, other: Talk) -> None:
        """Remember what a copy does."""
        vars(self).update(vars(other))

    def note(self, translation: Translation) -> None:
        """Remember a program, so that it is known when it was carried out."""
        self.last, self.last_at = translation, time.time()

    def carried_out(self, record: Record | None) -> bool:
        """Whether the last program has been run since."""
        return (
            record is not None
            and self.last is not None
            and record.run.started >= self.last_at
            and (
                record.run.program == self.last.program
                or record.run.utterance == self.last.utterance
            )
        )
