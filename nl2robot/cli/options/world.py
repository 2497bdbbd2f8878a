"""The world that the robot is in."""

from __future__ import annotations

import argparse
from pathlib import Path

from nl2robot.knowledge import DEFAULT_WORLD
from nl2robot.station.named_places import with_named_places
from sim.world.builtin import builtin_worlds
from sim.world.loading import load_world
from sim.world.model import World


def add_world(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--world",
        default=DEFAULT_WORLD,
        metavar="W",
        help=f"a built-in world's name or a YAML file (default: {DEFAULT_WORLD})",
    ).completer = _worlds  # type: ignore[attr-defined]


def _worlds(prefix: str, **_: object) -> list[str]:
    """For the completion by Tab in a shell: the built-in worlds, and files."""
    folder = prefix[: prefix.rfind("/") + 1]
    files = [
        f"{folder}{path.name}{'/' if path.is_dir() else ''}"
        for path in Path(folder or ".").glob("*")
        if path.is_dir() or path.suffix in (".yaml", ".yml")
    ]
    return [*builtin_worlds(), *files]


def names_of(options: argparse.Namespace) -> World:
    """The world as far as translating needs it: what goes by a name."""
    return with_named_places(load_world(options.world, names_only=True))


def world_of(options: argparse.Namespace) -> World:
    """The world, with the places that were named on its map."""
    return with_named_places(load_world(options.world))
