"""The conversations of a server: what was said before in each, by name."""

from __future__ import annotations

from collections import OrderedDict
from typing import Final

from nl2robot.translate.talk import Talk

TALKS_KEPT: Final = 100
"""Conversations whose context is kept; the one unused longest is forgotten first."""


class Talks:
    """Conversations by name; typed and spoken words of one share it."""

    def __init__(self) -> None:
        self._talks: OrderedDict[str, Talk] = OrderedDict()

    def of(self, name: str | None) -> Talk:
        """The conversation of this name; a new one that nobody shares for None."""
        if name is None:
            return Talk()
        talk = self._talks.setdefault(name, Talk())
        self._talks.move_to_end(name)
        while len(self._talks) > TALKS_KEPT:
            self._talks.popitem(last=False)
        return talk
