"""Why a sentence becomes no plan: a part that is not understood, or may mean several things."""

from __future__ import annotations


class NotUnderstood(Exception):
    """A part of the sentence means nothing here; `message` is for the person who said it."""

    def __init__(
        self,
        message: str,
        nearest: tuple[str, ...] = (),
        span: tuple[int, int] = (0, 0),
        gap: tuple[int, int] = (0, 0),
    ) -> None:
        super().__init__(message)
        self.message = message
        self.nearest = nearest
        """Names that may have been meant."""
        self.span = span
        """The tokens that would then be replaced."""
        self.gap = gap
        """The tokens in whose place a name would do: "it", where nothing was spoken of."""


class Ambiguous(Exception):
    """A part of the sentence may mean several things; `question` asks which one."""

    def __init__(self, question: str, start: int, end: int, choices: tuple[str, ...]) -> None:
        super().__init__(question)
        self.question = question
        self.start, self.end = start, end
        """The tokens that may mean several things."""
        self.choices = choices
        """What could stand there instead."""
