"""Ctrl-C, where something has to be done to its end first."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def ctrl_c_later() -> Iterator[None]:
    """What is done here is done to its end; whoever pressed Ctrl-C meanwhile, however often, is
    heard then (`KeyboardInterrupt`). In the main thread only."""
    pressed: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, frame: pressed.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
    if pressed:
        raise KeyboardInterrupt


@contextmanager
def ctrl_c_unheard() -> Iterator[None]:
    """Ctrl-C is not heard meanwhile: whoever presses it twice wants no more than once, and what
    puts a terminal back as it was must not be left half done."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, lambda *_: None)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
