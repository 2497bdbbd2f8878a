"""Who belongs to the fleet, as one robot has heard it. Without I/O; times are its own."""

from __future__ import annotations

from typing import Final

import msgspec

from nl2robot.fleet.messages import About, Standing

UNKNOWN_AFTER: Final = 4.0
"""Seconds without a word, after which nobody knows how a robot stands; it says something every
second."""


class Member(msgspec.Struct, kw_only=True):
    """A robot of the fleet, and what is known of it."""

    id: str
    session: str
    about: About | None = None
    standing: Standing | None = None
    heard: float
    """When it was heard of last, by the monotonic clock."""
    number: int = 0
    """Of the last message that said how it stands."""
    left: bool = False
    """Whether the network says that it is gone."""

    def known(self, now: float) -> bool:
        """Whether it is known how it stands."""
        heard_of = self.about is not None and self.standing is not None
        return heard_of and not self.left and now - self.heard < UNKNOWN_AFTER

    @property
    def name(self) -> str:
        return self.about.name if self.about is not None else self.id


class Roll:
    """All of them, by id. Whoever was heard of once stays on it: a robot that is gone is told of as
    such, and not forgotten."""

    def __init__(self) -> None:
        self.members: dict[str, Member] = {}

    def greet(self, id: str, session: str, now: float) -> Member:
        """It has proved that it is there."""
        member = self.members.get(id)
        if member is None or member.session != session:
            about = member.about if member is not None else None
            member = self.members[id] = Member(id=id, session=session, about=about, heard=now)
        member.heard, member.left = now, False
        return member

    def leaves(self, id: str, session: str) -> None:
        """The network says so; nobody vouches for that, and a word from it is worth more."""
        member = self.members.get(id)
        if member is not None and member.session == session:
            member.left = True

    def called(self, name: str) -> list[Member]:
        """Those of this name, or of this id."""
        return [each for each in self.members.values() if name in (each.name, each.id)]

    def twins(self) -> dict[str, list[str]]:
        """Names that several robots have, with their ids."""
        named: dict[str, list[str]] = {}
        for each in self.members.values():
            if each.about is not None:
                named.setdefault(each.name, []).append(each.id)
        return {name: sorted(ids) for name, ids in named.items() if len(ids) > 1}
