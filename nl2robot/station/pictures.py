"""Runs as pictures in files."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from nl2robot.errors import UserError
from sim.record import Record
from sim.world.model import World


def check_picture(file: Path) -> None:
    """Raise `UserError` if no picture can be saved there, before anything runs for it."""
    if file.suffix.lower() not in (".svg", ".png", ".webp", ".gif"):
        raise UserError(
            f"A picture cannot be saved as {str(file)!r}. Choose a name that ends in"
            " .svg, .png, .webp or .gif."
        )
    with _saving(file):
        file.parent.mkdir(parents=True, exist_ok=True)
        if file.is_dir() or not os.access(file if file.exists() else file.parent, os.W_OK):
            raise PermissionError(errno.EACCES, "it may not be written")


def draw(record: Record, world: World, file: Path) -> None:
    """Draw a run; the file's ending says how. Raises `UserError`."""
    from sim.pictures import drawing as pictures

    check_picture(file)
    with _saving(file):
        match file.suffix.lower():
            case ".svg":
                file.write_text(pictures.svg(world, record), encoding="utf-8")
            case ".png":
                pictures.png(world, record, file)
            case _:
                pictures.animate(world, record, file)


@contextmanager
def _saving(file: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise UserError(
            f"The picture {file} cannot be saved ({error.strerror}). Choose another place for it."
        ) from error
