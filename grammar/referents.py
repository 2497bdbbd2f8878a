"""What clauses speak of: things, people, where they are, and what is so in a branch."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from grammar.plan import Step, Text, Value


@dataclass(frozen=True)
class Thing:
    """What a noun phrase speaks of: a thing, or a person by kind or name."""

    value: Value
    """As the robot is asked for it: "red cup"; a variable if it is not known before the run."""
    place: Value | None = None
    """The place that the phrase mentions: "the cup in the kitchen"."""
    furniture: str | None = None
    known: bool = False
    """Whether the world knows it by name."""
    plural: bool = False
    person: bool = False
    here: bool = False
    """Whether it was pointed at ("this box") or is somebody here: no search needed."""
    me: bool = False
    """Whether it is the speaker."""
    pronoun: bool = False
    """Whether it was spoken of before: "it"."""
    group: Value | None = None
    """The names of several people who are meant one by one."""
    coming: bool = False
    """Whether it is whoever comes: each of them, without end."""
    first: bool = False
    """Whether it is whoever comes first, and so has to be waited for."""
    count: int | None = None
    """How many of them, whichever they are: "three visitors", "two cups"."""
    preposition: str = ""
    """How it stands to the furniture, where that is told: "next to"."""
    noun: str = ""
    """The noun alone: "cup" of "red cup"."""
    but: Value | None = None
    """Those of a group who are left out."""
    every: bool = False
    """Whether all of them are meant that are there: "all the visitors", "every cup"."""
    listed: tuple[Thing, ...] = ()
    """All things of the list that it was the last of: "both" are these."""

    @property
    def several(self) -> bool:
        """Whether it is to be done with one after the other."""
        return self.count is not None or self.every

    @property
    def single(self) -> Thing:
        """One of them, whichever."""
        return replace(self, count=None, every=False, plural=False, pronoun=False)

    @property
    def text(self) -> str:
        return self.value.value if isinstance(self.value, Text) else ""


@dataclass(frozen=True)
class Where:
    """A place, a piece of furniture, or both: "on the table in the kitchen"."""

    place: Value | None = None
    furniture: str | None = None
    words: str = ""
    """What else tells the thing: "behind the cup"."""
    preposition: str = ""
    """How something stands to the furniture: "under"; as far as that is no matter of course."""


@dataclass(frozen=True)
class Meeting:
    """Somebody or something that is here if a condition holds, or if it does not."""

    thing: Thing
    holds: bool = True
    """Whether it is here if the condition holds."""
    sought: bool = False
    """Whether it was looked for in order to be had, and not only checked to be in its place."""


@dataclass(frozen=True)
class Claim:
    """What is so in a branch of a condition, for "if there is a cup, tell me"."""

    saying: Step
    known: tuple[Any, ...]
    """What was known besides (`known_by_now`): where more is found out, that is told instead."""
