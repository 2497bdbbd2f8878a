"""What may happen and begin something each time, as words say it: "somebody comes in"."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

What = Literal["battery", "place", "seen", "heard", "scanned", "pressed"]


@dataclass(frozen=True)
class Happening:
    """What is waited for. What it has besides `what` is empty where it does not matter."""

    what: What
    text: str = ""
    """Words that are heard, a code, the name of a button."""
    thing: str = ""
    """Who is seen, as the robot looks for them: "person", "visitor", a name."""
    place: str = ""
    """A place of the world, by its name."""
    below: int = 0
    """Percent of the battery."""
    rate: float | None = None
    """Seconds that lie between two times at least, where that was said."""
    once: bool = False
    """Whether it may be meant for the next time alone: "when somebody comes, ..."."""
    named: bool = False
    """Whether `thing` is the name of somebody."""
