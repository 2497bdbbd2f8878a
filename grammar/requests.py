"""What people ask of the application instead of the robot: to learn a routine, to tell them what
they can say.

Such a request is read by the same rules as a command (the rule <request>), so that it may be put
as freely; what becomes of it is the application's business.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

from grammar.language import load_language
from grammar.standing_orders.happenings import Happening
from grammar.tokens import tokenise

Kind = Literal[
    "help",
    "learn",
    "list",
    "explain",
    "change",
    "rename",
    "forget",
    "schedule",
    "cancel",
    "undo",
    "pace",
    "planned",
    "appointments",
    "skip",
    "unschedule",
    "why",
    "doing",
    "done",
    "happened",
    "said",
    "who said",
    "how many said",
    "counted",
    "found",
]
ABOUT_RUNS: Final = frozenset(
    {"doing", "done", "happened", "said", "who said", "how many said", "counted", "found"}
)
"""Questions about what the robot is doing or has done."""


@dataclass(frozen=True)
class When:
    """At what times something is to be done, as the words say it: read without knowing what time
    it is, so that "tomorrow" is one day ahead, whenever that is."""

    times: tuple[str, ...] = ()
    """Times of day, "HH:MM" of 24 hours, as they were said one after the other, each as it is
    usually meant; empty if none was said."""
    bare: tuple[str, ...] = ()
    """Those of them that were said without their half of the day (`grammar.times.bare_hours`)."""
    half: Literal["am", "pm", "night"] | None = None
    """The half of the day, where no time was said."""
    weekdays: tuple[int, ...] = ()
    """The days on which, 0 = Monday; empty for any day."""
    days_ahead: int | None = None
    """How many days from now: today 0, tomorrow 1; None if no day was said."""
    date: str | None = None
    """A day, "2026-12-24", or "12-24" where no year was said."""
    minutes: float | None = None
    """Every so many minutes if it `repeats`, else in so many minutes."""
    repeats: bool = False
    """Whether it is to be done again and again."""
    count: int | None = None
    """How many times in all; None if that was not said."""
    since: str | None = None
    """Each day from this time of day on, "HH:MM" ("from nine to five every hour")."""
    until: str | None = None
    """Each day up to this time of day, "HH:MM"."""


@dataclass(frozen=True)
class Request:
    """Something asked of the application."""

    kind: Kind
    """What to do. "schedule" is to do something at set times; "appointments" asks what is done so,
    "skip" that it is not done on a day, "unschedule" that it is not done any more. "cancel",
    "undo", "planned", "why" and "pace" ("slower") are about the command before, those `ABOUT_RUNS`
    about what was done, "help" about what can be said; the others are about routines."""
    name: str = ""
    """The name of a routine or a person, as it was said."""
    new: str = ""
    """Of "rename", the new name."""
    sentence: str = ""
    """What the routine does, or what is to be done at those times, as it was said; to learn
    without a sentence is to keep the command before."""
    part: str = ""
    """The words that say at what times; of "help", what the help shall be about; of "who said" and
    "how many said", the answer."""
    when: When | None = None
    """Of "schedule", what those words say; None if they are not understood. Of "skip" the day, of
    "unschedule" the time of day, if one was said."""
    happening: Happening | None = None
    """Of "schedule", what it is to be done at instead, each time (`grammar.standing_orders`)."""


def agreed(text: str, language: str = "en") -> bool | None:
    """Whether an answer is a yes or a no; None if it is neither."""
    pack = load_language(language)
    fillers = {filler for filler in pack.fillers if len(filler) == 1}
    words = [token.norm for token in tokenise(text, pack.spelling) if token.kind != "mark"]
    said = tuple(word for word in words if (word,) not in fillers) or tuple(words)
    for answer, mark in ((True, "agree"), (False, "refuse")):
        if said in {pack.tokens_of(way) for way in pack.speech[mark]}:
            return answer
    return None
