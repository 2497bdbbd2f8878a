"""What the application says, by language: the files of `data/` and of the console that have a part
for each.

A language that somebody adds may bring its part of any of them: `texts/terminal.yaml` in its folder
is what `data/terminal.yaml` has under "de". English stands in for what it does not bring.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from grammar.languages import registry
from nl2robot.paths import PACKAGED
from robot_api.capabilities.languages import language_data

ENGLISH: Final = registry.ENGLISH
FOLDER: Final = "texts"
"""In the folder of a language that is added."""
CONSOLE: Final = Path(__file__).parent / "console" / "texts"
"""The texts of the pages, by page and name."""
BY_LANGUAGE: Final = (
    *("answers", "courtesies", "going_on", "risks", "schedules", "sightings", "terminal"),
)
"""The files of `data/` that may be brought so."""


@functools.cache
def texts_in(language: str, name: str) -> Mapping[str, Any]:
    """What the file of this name in `data/` says in a language, else in English."""
    ours = _ours(name)
    return ours.get(language) or {**ours[ENGLISH], **brought(language, name)}


def stand_in(language: str) -> str | None:
    """What to tell somebody who speaks a language that English lends words; None for ours."""
    if registry.is_ours(language):
        return None
    called = language_data(language).own_name or language
    return (
        f"English stands in for what {called} has no words for."
        f" `nl2robot languages check {language}` tells what that is."
    )


def brought(language: str, name: str) -> Mapping[str, Any]:
    """What the folder of an added language has of a file; nothing where that cannot be read, which
    `nl2robot languages check` tells."""
    import yaml

    folder = registry.added().folders.get(language)
    path = folder / FOLDER / f"{name}.yaml" if folder is not None else None
    if path is None or not path.exists():
        return {}
    try:
        read = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, yaml.YAMLError):
        return {}
    return read if isinstance(read, dict) else {}


@functools.cache
def _ours(name: str) -> Mapping[str, Mapping[str, Any]]:
    import yaml

    path = PACKAGED / f"{name}.yaml"
    read: dict[str, dict[str, Any]] = yaml.safe_load(path.read_text(encoding="utf-8"))
    return read
