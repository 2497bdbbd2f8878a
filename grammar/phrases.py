"""Rows of words that are looked for at every word of a sentence, found by their first word."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from typing import Final

ANY: Final = "*"
"""Stands for any word; no row begins with it."""


class Phrases:
    """Some rows of words."""

    def __init__(self, rows: Iterable[Sequence[str]]) -> None:
        self._rest: defaultdict[str, list[tuple[str, ...]]] = defaultdict(list)
        for first, *rest in rows:
            self._rest[first].append(tuple(rest))

    def lengths(self, norms: Sequence[str], at: int) -> Iterator[int]:
        """How many words each of the rows has that stands at this one of some words."""
        for rest in self._rest.get(norms[at], ()) if at < len(norms) else ():
            behind = norms[at + 1 : at + 1 + len(rest)]
            if len(behind) == len(rest) and all(
                word in (ANY, norm) for word, norm in zip(rest, behind, strict=True)
            ):
                yield 1 + len(rest)

    def longest(self, norms: Sequence[str], at: int) -> int:
        """How many words the longest of them has that stands here; 0 if none does."""
        return max(self.lengths(norms, at), default=0)
