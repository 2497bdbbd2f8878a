"""What stands between a robot and its fleet, said once and again when it changes. Without I/O;
times are those of a clock that nobody sets."""

from __future__ import annotations

from collections.abc import Collection
from typing import Final

AFTER: Final = 5.0
"""Seconds in which it may come right by itself before it is said."""
APART: Final = (
    "The fleet cannot be reached at {endpoints}. Check that a robot listens there (--fleet-listen)"
    " and the network between; it is tried again and again."
)
STRANGERS: Final = (
    "There are robots with another key ({keys}), and none with this one's ({key}). Compare the"
    " keys by `nl2robot fleet key`, and copy fleet.key if they should be one fleet."
)
REACHED: Final = "The fleet is reached now."


class Trouble:
    """Of one robot."""

    def __init__(self, endpoints: Collection[str], key: str) -> None:
        """`endpoints` are those it connects to, `key` the fingerprint of its key."""
        self._endpoints = ", ".join(endpoints)
        self._key = key
        self._since: tuple[str | None, float] = (None, 0.0)
        """What it has been for some time, which need not be said yet."""
        self.said: str | None = None
        """What was said last and still is so."""

    def look(
        self, now: float, reached: bool, others: bool, strangers: Collection[str]
    ) -> str | None:
        """What is to be said now. `reached`: whether it is connected to anybody; `others`: whether
        it was heard of another robot of its fleet; `strangers`: the fingerprints of other keys."""
        sentence = None
        if self._endpoints and not reached:
            sentence = APART.format(endpoints=self._endpoints)
        elif strangers and not others:
            keys = ", ".join(sorted(strangers))
            sentence = STRANGERS.format(keys=keys, key=self._key)
        if sentence != self._since[0]:
            self._since = (sentence, now)
        if sentence == self.said or now - self._since[1] < (AFTER if sentence else 0.0):
            return None
        self.said = sentence
        return sentence or REACHED
