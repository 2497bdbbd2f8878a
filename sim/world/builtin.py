"""The worlds that come with the simulator."""

from __future__ import annotations

from pathlib import Path

BUILTIN = Path(__file__).parents[1] / "worlds"


def builtin_worlds() -> list[str]:
    """The names of the worlds that come with the simulator."""
    return sorted(path.stem for path in BUILTIN.glob("*.yaml"))
