"""Who has begun processes ends them with this one, and lets go of them in a copy of it."""

from __future__ import annotations

import atexit
import os
import weakref
from typing import Final, Protocol


class Parent(Protocol):
    def close_for_good(self) -> None:
        """When Python ends: end them, and begin none any more."""

    def forget(self) -> None:
        """In a copy of this process (`fork`): they work for the first."""


_ALL: Final[weakref.WeakSet[Parent]] = weakref.WeakSet()


def look_after(parent: Parent) -> None:
    """As long as there is somebody who needs it."""
    _ALL.add(parent)


@atexit.register
def _end_all() -> None:
    for each in list(_ALL):
        each.close_for_good()


def _forget_all() -> None:
    for each in list(_ALL):
        each.forget()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget_all)
