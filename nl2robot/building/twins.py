"""Two servers that go by one prefix: the house would take them for one robot."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

SERVER: Final = "server"
"""The topic below the prefix at which each server says who it is when it joins, and when it hears
another. Not kept: one that is gone is no twin."""
TWINS: Final = (
    "Another server goes by {prefix} at the house's broker, too: what is said to one of them is"
    " said to both. Give each robot a prefix of its own: --mqtt mqtt://HOST:PORT/PREFIX."
)
MOST: Final = 100
"""Others that are answered; somebody who makes up more is nobody's twin."""


class Twins:
    """Tells once that there is another. `say(text)` says it at `SERVER`, `tell(sentence)` tells the
    people here."""

    def __init__(
        self, me: str, prefix: str, say: Callable[[str], None], tell: Callable[[str], None]
    ) -> None:
        """`me`: what no other server is called."""
        self._me = me
        self._prefix = prefix
        self._say = say
        self._tell = tell
        self._others: set[str] = set()

    def joined(self) -> None:
        self._say(self._me)

    def heard(self, who: str) -> None:
        if who == self._me or who in self._others or len(self._others) >= MOST:
            return
        first = not self._others
        self._others.add(who)
        self._say(self._me)  # it may have joined after we said so
        if first:
            self._tell(TWINS.format(prefix=self._prefix))
