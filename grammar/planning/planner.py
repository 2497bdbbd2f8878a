"""What makes plans of words: a protocol, so that there may be several, and a third one is a class.

    turn -> planner -> drafts, a question back, a refusal, or a request to the application

A planner only proposes. Whether a draft may be shown as understood is for `grammar.checking` to
say, whoever made it; which of several is meant, for the application.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Protocol

from grammar.plan import Plan
from grammar.planning.turn import Turn
from grammar.requests import Request
from grammar.trace import Read
from grammar.understanding import Context


@dataclass(frozen=True)
class Draft:
    """A plan that may be what was meant."""

    plan: Plan
    planner: str
    probability: float
    """How sure the planner is, from 0 to 1; comparable between drafts of the same planner."""
    context: Context
    """What the conversation remembers if this is what was meant."""
    exact: bool = False
    """Whether the planner understands a sentence as a whole or not at all."""
    score: float = 0.0
    """The logarithm of how likely a language model found it, for all of its tokens."""
    surest: float = 1.0
    """How likely it found the least likely of them."""
    reading: tuple[Read, ...] = ()
    """Which words rules have read as what."""


@dataclass(frozen=True)
class Drafts:
    """At least one, the likeliest first."""

    drafts: tuple[Draft, ...]


@dataclass(frozen=True)
class Question:
    """Something is unclear, and asked back."""

    message: str
    suggestions: tuple[str, ...] = ()
    """Sentences that would be clear."""
    context: Context = field(default_factory=Context)


@dataclass(frozen=True)
class Refusal:
    """There is no plan for this."""

    message: str
    suggestions: tuple[str, ...] = ()
    """Sentences that would be understood."""
    final: bool = False
    """Whether another planner need not be asked: this must not be done, or it is known that it
    cannot."""
    context: Context = field(default_factory=Context)
    absent: bool = False
    """Whether the planner could not think, or not to the end: the message says why."""


@dataclass(frozen=True)
class Service:
    """Something that the application is asked for, and not the robot."""

    request: Request
    context: Context = field(default_factory=Context)


Answer = Drafts | Question | Refusal | Service


class Planner(Protocol):
    """Makes plans of words."""

    @property
    def name(self) -> str:
        """As `--planner` calls it."""
        ...

    def plan(self, turn: Turn, watch: Watch) -> Answer:
        """What can be made of a turn. Never raises for any words. Raises `Interrupted` if
        `watch.cancelled` becomes true meanwhile."""
        ...


class Interrupted(Exception):
    """Planning was cancelled."""


class Watch:
    """What somebody who waits for a plan is told, and how they end it.

    `thinking` is called when it takes longer than a moment, `writing` with the program as far as it
    is written. Both come from the thread that plans.
    """

    def __init__(
        self,
        thinking: Callable[[], None] | None = None,
        writing: Callable[[str], None] | None = None,
    ) -> None:
        self.thinking = thinking or _nothing
        self.writing = writing or _nothing_of
        self.cancelled = False
        self._on_cancel: list[Callable[[], None]] = []
        # Held while a cancellation is at work, so that none comes late and hits who is next.
        self._cancelling = threading.RLock()

    def cancel(self) -> None:
        """From any thread: who plans ends at once."""
        with self._cancelling:
            self.cancelled = True
            for each in tuple(self._on_cancel):
                each()

    @contextmanager
    def cancelling(self, what: Callable[[], None]) -> Iterator[None]:
        """While this lasts, a cancellation does this."""
        with self._cancelling:
            self._on_cancel.append(what)
        try:
            if self.cancelled:
                what()
            yield
        finally:
            with self._cancelling:
                self._on_cancel.remove(what)


def _nothing() -> None:
    """Nobody waits."""


def _nothing_of(text: str) -> None:
    """Nobody looks on."""
