"""What a program may use up. A program that waits minutes for a robot is normal; one that computes
for seconds is not."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Limits:
    """Limits of one run. Time spent in robot calls does not count as computing."""

    computing: float = 3.0
    """Seconds of computing between one robot call and the next."""
    total_computing: float = 60.0
    """Seconds of computing in the whole run."""
    rounds: int | None = None
    """Rounds of loops and calls of functions in the whole run: unlike seconds the same on every
    machine. None: they are not counted."""
    memory: int = 64_000_000
    """Bytes of the program's own data."""
    calls: int = 100_000
    """Robot calls in the whole run."""
    output: int = 1_000_000
    """Bytes of `print` output in the whole run."""
    depth: int = 300
    """How deeply functions may call each other."""


MAX_PROGRAM = 64_000
"""The longest program, in bytes."""
