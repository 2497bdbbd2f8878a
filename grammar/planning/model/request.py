"""What a language model is asked to write, and what comes back: plain data, so that it can run in
another process."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, Protocol

import msgspec

from grammar.planning.model.vocabulary import Vocabulary

SECONDS: Final = 20.0
"""How long people wait for a program."""


class Piece(msgspec.Struct, frozen=True):
    """A part of what a model is told."""

    text: str
    marks: bool = False
    """Whether words such as "<|im_start|>" are marks in it: never in what people have said."""


class Request(msgspec.Struct, frozen=True, kw_only=True):
    """A program to be written."""

    prefix: str
    """What the model is told first, the same for every sentence, so that it is remembered."""
    said: tuple[Piece, ...] = ()
    """What it is told then; nothing, if it shall only get ready."""
    words: Vocabulary = Vocabulary()
    most: int = 1
    """Programs that are wanted at most."""
    seconds: float = SECONDS
    """After how long no further token is written."""


class Written(msgspec.Struct, frozen=True):
    """A program that was written."""

    text: str
    """In the dialect."""
    score: float
    """The logarithm of its probability, among all programs that could have been written."""
    surest: float
    """The probability of its least probable token."""
    tokens: int
    """How many tokens the model has chosen for it."""


class Writer(Protocol):
    """A language model at work, wherever it runs. Asked for more programs of the same sentence, it
    goes on from where it was."""

    def write(
        self, request: Request, on_text: Callable[[str], None] | None = None
    ) -> list[Written]:
        """The programs, the likeliest first; none if it could write none. `on_text` is told the
        first one as it grows. Raises `Unavailable`, `TooLate`, and `Interrupted` after `cancel`."""
        ...

    def cancel(self) -> None:
        """End what is being written; from any thread, at any time."""
        ...


class Unavailable(Exception):
    """There is no model, or it does not run here; the message is a sentence that says why and what
    to do."""


class TooLate(Exception):
    """The time for writing was over before there was a program."""


class Interrupted(Exception):
    """Writing was cancelled."""
