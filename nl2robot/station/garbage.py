"""Python's search for garbage, when nobody waits: it goes through all there is, and for that long
no thread of the process does anything, nor hears a stop: 175 ms were measured, where a stop has 50.

    with swept(lambda: server.dispatcher.moves): ...

The short searches, through what is new, take a few milliseconds and stay as they are.
"""

from __future__ import annotations

import gc
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Final

LOOKS: Final = 1.0
"""Seconds between two looks."""
DUE: Final = 10
"""Short searches after which Python makes a long one."""
OVERDUE: Final = 50 * DUE
"""Of them, after which one is made though the robot moves: a few million things more, say 500 MB,
if all of them were garbage."""
_NEVER: Final = 1_000_000_000


@contextmanager
def swept(moves: Callable[[], bool]) -> Iterator[None]:
    """While this lasts, long searches are made while the robot does not move. They spare what there
    is now, for good."""
    before = gc.get_threshold()
    gc.freeze()
    gc.set_threshold(*before[:2], _NEVER)
    over = threading.Event()

    def sweep() -> None:
        while not over.wait(LOOKS):
            made = gc.get_count()[2]
            if made >= OVERDUE or (made >= DUE and not moves()):
                gc.collect()

    thread = threading.Thread(target=sweep, name="sweeps", daemon=True)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()
        gc.set_threshold(*before)
