"""What changed from one version of a program to the next."""

from __future__ import annotations

from difflib import ndiff, unified_diff
from typing import Final, Literal

Kind = Literal["kept", "removed", "added"]
_KINDS: Final[dict[str, Kind]] = {"  ": "kept", "- ": "removed", "+ ": "added"}


def difference(before: str, now: str, before_is: str, now_is: str) -> str:
    """A unified diff, under these two names."""
    lines = unified_diff(
        before.strip().splitlines(), now.strip().splitlines(), before_is, now_is, lineterm=""
    )
    return "\n".join(lines)


def changes(before: str, now: str) -> list[tuple[Kind, str]]:
    """All lines of both, in order, each with what became of it."""
    compared = ndiff(before.rstrip().splitlines(), now.rstrip().splitlines())
    return [(_KINDS[line[:2]], line[2:]) for line in compared if line[:2] in _KINDS]
