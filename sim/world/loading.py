"""Worlds by name, or from a file."""

from __future__ import annotations

from pathlib import Path

from sim.world.builtin import BUILTIN, builtin_worlds
from sim.world.model import World
from sim.world.reader import read_world


def load_world(name_or_path: str | Path, *, names_only: bool = False) -> World:
    """The built-in world of that name, or the one in that file: a world's YAML, or the YAML that
    ROS's map_server writes.

    Raises `WorldError` with everything that is wrong, and on which line. With `names_only`, for
    translating, a map is not read, and what is wrong with where things are does not matter.
    """

    if isinstance(name_or_path, str) and name_or_path in builtin_worlds():
        return read_world(BUILTIN / f"{name_or_path}.yaml", names_only)
    return read_world(Path(name_or_path), names_only)
