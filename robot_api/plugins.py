"""What other packages add to the project, by entry points: found by name, loaded when asked for.

A package says in its `pyproject.toml` what it adds, in the group of its kind:

    [project.entry-points."nl2robot.robots"]
    dog = "robot_dog.driver:DOG"

What is ours wins over a package's of the same name, and so does the package that comes first. A
package that is broken is a sentence for people, and stands in nobody's way.
"""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable, Collection
from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final, TypeVar

from robot_api.errors import cause

ROBOTS: Final = "nl2robot.robots"
PLANNERS: Final = "nl2robot.planners"
LANGUAGES: Final = "nl2robot.languages"
VOICES: Final = "nl2robot.voices"
PAGES: Final = "nl2robot.pages"
GROUPS: Final = {
    ROBOTS: "driver",
    PLANNERS: "planner",
    LANGUAGES: "language",
    VOICES: "voice",
    PAGES: "page",
}
"""The groups of entry points, each with what people call what is in it."""


class PluginError(Exception):
    """A package's addition cannot be used: a sentence that says why, and what to do."""


@dataclass(frozen=True)
class Plugin:
    """What a package adds under a name; not loaded yet."""

    name: str
    group: str
    package: str
    """Whose it is, as `pip` calls it."""
    _point: EntryPoint

    @property
    def value(self) -> str:
        """What the entry point names: "robot_dog.driver:DOG"."""
        return self._point.value

    def load(self) -> Any:
        """What the entry point names. Raises `PluginError`."""
        try:
            return self._point.load()
        except (Exception, SystemExit) as error:
            raise self.broken(error) from error

    def folder(self) -> Path:
        """The folder of the package that the entry point names, without running any of it where
        that is no package inside another. Raises `PluginError`."""
        try:
            spec = find_spec(self.value)
        except (Exception, SystemExit) as error:
            raise self.broken(error) from error
        for place in (spec and spec.submodule_search_locations) or ():
            if Path(place).is_dir():
                return Path(place)
        raise self.unusable(f"is no package with a folder: {self.value}.")

    def broken(self, error: BaseException) -> PluginError:
        """It has raised this when it was loaded, or begun."""
        return self.unusable(f"cannot be loaded ({type(error).__name__}: {cause(error)}).")

    def unusable(self, why: str) -> PluginError:
        """It cannot be used; `why` goes on after its name."""
        return PluginError(
            f"The {GROUPS[self.group]} {self.name!r} of the package {self.package} {why}"
            f" Tell whoever made it, or remove it: pip uninstall {self.package}."
        )


_Found = TypeVar("_Found")


def remembered(find: Callable[[], _Found]) -> Callable[[], _Found]:
    """What is looked for in packages, looked for once: until Python looks for them elsewhere."""
    found: dict[tuple[str, ...], _Found] = {}

    @functools.wraps(find)
    def once() -> _Found:
        where = tuple(sys.path)
        if where not in found:
            found[where] = find()
        return found[where]

    return once


def plugins(group: str, ours: Collection[str] = ()) -> dict[str, Plugin]:
    """What packages add to a group, by name, without what is called as one of `ours` is."""
    return {name: plugin for name, plugin in _named(group).items() if name not in ours}


def left_out(group: str, ours: Collection[str]) -> dict[str, str]:
    """A sentence for each that is called as one of `ours` is, and cannot be used for that."""
    return {
        name: str(plugin.unusable("is left out: one of ours has this name."))
        for name, plugin in _named(group).items()
        if name in ours
    }


def _named(group: str) -> dict[str, Plugin]:
    found: dict[str, Plugin] = {}
    for point in _points():
        if point.group == group:
            package = point.dist.name if point.dist is not None else point.value
            found.setdefault(point.name, Plugin(point.name, group, package, point))
    return dict(sorted(found.items()))


@remembered
def _points() -> tuple[EntryPoint, ...]:
    """All of our groups; looking through the packages takes 50 ms."""
    everything = entry_points()
    return tuple(point for group in GROUPS for point in everything.select(group=group))
