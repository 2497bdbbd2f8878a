"""What is measured, and how it is shown."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from pathlib import Path

import msgspec


class Figure(msgspec.Struct, frozen=True):
    """One thing measured."""

    part: str
    what: str
    value: float
    unit: str
    aim: str = ""

    @property
    def shown(self) -> str:
        digits = f"{self.value:,.0f}" if self.value >= 1000 else f"{self.value:.3g}"
        return f"{digits} {self.unit}"


def megabytes(pid: int) -> float:
    """Resident memory of a process, where the system tells (Linux)."""
    try:
        status = Path(f"/proc/{pid}/status").read_text(encoding="ascii")
    except OSError:
        return float("nan")
    return int(status.split("VmRSS:")[1].split()[0]) / 1024


def percentile(values: Sequence[float], percent: int) -> float:
    return statistics.quantiles(values, n=100)[percent - 1]
