"""Where the languages are: our folders, and those that other packages add.

A package adds one by an entry point of the group `nl2robot.languages` that is called as the
language's code and names a folder with the same files as ours:

    [project.entry-points."nl2robot.languages"]
    nl = "robot_dutch.nl"

What it lacks of what is said (`phrases`, and the words of explanations), English says. Whether a
language can be used, its rules tell (`grammar.language.languages`); this knows folders only.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from robot_api.plugins import LANGUAGES, PluginError, left_out, plugins, remembered

FOLDER: Final = Path(__file__).parent
ENGLISH: Final = "en"
"""What stands in where a language that somebody added has no words."""
OTHERS: Final = frozenset({"explain", "methods", "robot"})
"""Files of a language that hold no rules: the words of explanations (`grammar.speech`), a command
for each robot method (`grammar.languages.checker`), and the words that a robot asks and is answered
with (`robot_api.capabilities.languages`)."""

_CODE: Final = re.compile(r"[a-z]{2}")
_TRIED: Final[dict[str, Path]] = {}


class UnknownLanguage(ValueError):
    """There is no such language."""


@dataclass(frozen=True)
class Added:
    """What other packages add."""

    folders: Mapping[str, Path]
    troubles: Mapping[str, str]
    """By code, a sentence each: languages that cannot be used."""


def ours() -> list[str]:
    """The codes of those that come with the project: folders with rules and explanations."""
    return _ours(FOLDER)


def added() -> Added:
    """Those of other packages, and of whoever tries one out."""
    found = _added()
    return Added({**found.folders, **_TRIED}, found.troubles)


def codes() -> tuple[str, ...]:
    """Of all of them, usable or not, English first."""
    return tuple(sorted({*ours(), *added().folders}, key=lambda code: (code != ENGLISH, code)))


def try_out(code: str, folder: Path) -> None:
    """Have a language in this process, from a folder that no package has added yet. Raises
    `UnknownLanguage` if it cannot be called so."""
    if code in ours() or not _CODE.fullmatch(code):
        raise UnknownLanguage(
            f"A language cannot be called {code!r} here. Name its folder by its code of two"
            f" letters (ISO 639-1) that is none of {', '.join(ours())}."
        )
    _TRIED[code] = folder


def folder_of(code: str) -> Path:
    """The folder of a language. Raises `UnknownLanguage`."""
    if code in ours():
        return FOLDER / code
    others = added()
    if code in others.folders:
        return others.folders[code]
    known = ", ".join(sorted((*ours(), *others.folders)))
    raise UnknownLanguage(
        others.troubles.get(code, f"There is no language {code!r}. There are: {known}.")
    )


def files_of(code: str) -> list[Path]:
    """The files with its rules. Raises `UnknownLanguage`."""
    return [path for path in sorted(folder_of(code).glob("*.yaml")) if path.stem not in OTHERS]


def is_ours(code: str) -> bool:
    """Whether a language comes with the project. One of ours is whole, as the tests see to; what
    another lacks, English lends."""
    return code in ours()


@functools.cache
def _ours(folder: Path) -> list[str]:
    return sorted(
        path.name
        for path in folder.iterdir()
        if (path / "control.yaml").exists() and (path / "explain.yaml").exists()
    )


@remembered
def _added() -> Added:
    folders: dict[str, Path] = {}
    troubles = left_out(LANGUAGES, ours())
    for code, plugin in plugins(LANGUAGES, ours()).items():
        try:
            if not _CODE.fullmatch(code):
                raise plugin.unusable("is not called by the two letters of its code (ISO 639-1).")
            folder = plugin.folder()
            if not any(folder.glob("*.yaml")):
                raise plugin.unusable(f"has no files: there is no .yaml in {folder}.")
            folders[code] = folder
        except PluginError as error:
            troubles[code] = str(error)
    return Added(folders, troubles)
