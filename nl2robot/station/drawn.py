"""What people draw on the map, kept for each world in a file of the data folder.

    worlds:
      city-hospital:
        - {name: wet floor, polygon: [[4, 1.5], [8, 1.5], [8, 6]]}

The file may be edited by hand while nothing is served.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, Generic, TypeVar

import msgspec

from nl2robot.errors import UserError
from nl2robot.paths import made
from robot_api.errors import cause
from sim.world.builtin import BUILTIN
from sim.world.model import World

T = TypeVar("T")


class Drawn(Generic[T]):
    """The entries of a file, by world. Raises `UserError` where the file cannot be used.

    `entry` is what each is read as; `what` they are called in sentences; `trouble` tells what is
    wrong with one, such as `"x" crosses itself`, or None.
    """

    def __init__(
        self, file: Path, entry: type[T], what: str, trouble: Callable[[T], str | None]
    ) -> None:
        self.file = file
        self.what = what
        self._type: Any = dict[str, dict[str, tuple[entry, ...]]]  # type: ignore[valid-type]
        msgspec.json.Decoder(self._type)  # learned before there are threads, see `robot_api.schema`
        self._trouble = trouble

    def of(self, world: World) -> tuple[T, ...]:
        """Those drawn on the map of this world."""
        return self._read().get(_whose(world), ())

    def keep(self, world: World, entries: tuple[T, ...]) -> None:
        """From now on those of this world are these; on disk when this returns."""
        worlds = {**self._read(), _whose(world): entries}
        kept = {name: drawn for name, drawn in worlds.items() if drawn}
        import yaml

        told = msgspec.to_builtins({"worlds": kept})
        text = yaml.safe_dump(told, allow_unicode=True, sort_keys=False)
        new = made(self.file.parent) / f".{self.file.name}.new"
        try:
            new.write_text(text, encoding="utf-8")
            new.replace(self.file)  # whoever reads sees the old file or the new one
        except OSError as error:
            raise UserError(
                f"The {self.what} cannot be kept in {self.file} ({error.strerror})."
                " Check its place, its rights and the disk."
            ) from error

    def _read(self) -> dict[str, tuple[T, ...]]:
        try:
            text = self.file.read_text(encoding="utf-8")
        except FileNotFoundError:
            return {}
        except (OSError, ValueError) as error:
            raise self._damaged(cause(error)) from error
        import yaml

        try:
            file = msgspec.convert(yaml.safe_load(text) or {}, self._type)
            unknown = next((name for name in file if name != "worlds"), None)
            if unknown is not None:
                raise ValueError(f'it has no field "{unknown}"')
        except (ValueError, RecursionError, yaml.YAMLError) as error:
            raise self._damaged(cause(error)) from error
        worlds: dict[str, tuple[T, ...]] = file.get("worlds", {})
        for entry in (entry for entries in worlds.values() for entry in entries):
            trouble = self._trouble(entry)
            if trouble:
                raise self._damaged(trouble)
        return worlds

    def _damaged(self, why: str) -> UserError:
        return UserError(
            f"The {self.what} that were drawn cannot be read from {self.file} ({why})."
            " Mend the file or move it away, then start again."
        )


def _whose(world: World) -> str:
    """What tells worlds apart, wherever the program is called and installed."""
    file = Path(world.file)
    return file.stem if file.parent == BUILTIN else str(file.absolute())
