"""What computes for more than a moment, and who does it: a function that calls it, here or in
another process (`nl2robot.review.apart`)."""

from __future__ import annotations

from collections.abc import Callable
from typing import ParamSpec, Protocol, TypeVar

P = ParamSpec("P")
T = TypeVar("T")


class TookTooLong(Exception):
    """It was not done in its time."""


class Died(Exception):
    """The process ended before its work was done, twice."""


class Do(Protocol):
    """Calls a function, somewhere."""

    def __call__(self, function: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> T: ...


def here(function: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> T:
    """In this very process."""
    return function(*args, **kwargs)
