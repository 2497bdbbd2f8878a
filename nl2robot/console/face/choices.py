"""What the answers that people choose from are called in the languages of the face.

A program's own words are shown as they stand. "Yes" and "no", and what the world has names for, are
ours: somebody who has chosen French reads "oui" and "pharmacie", and the program still gets the
option that it wrote.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import msgspec

from grammar.language import load_language
from nl2robot.console.visitor import LANGUAGES
from nl2robot.run.runlog import LogError
from sim.world.model import name_in

if TYPE_CHECKING:
    from nl2robot.run.runner import Runner
    from sim.world.model import World

_PLAIN = ("yes", "no")
"""Names of phrases."""


def called(options: Sequence[str], world: World, language: str) -> list[str]:
    """The options as they are called in a language; as they stand, if two were called the same."""
    names = [_called(option, world, language) for option in options]
    return names if len({*names}) == len({*options}) else list(options)


def language_of_program(runner: Runner) -> str | None:
    """In which language the program that runs was asked for, and so speaks; None if no sentence
    says it."""
    status = runner.state()
    try:
        run = runner.log.run(status.run) if status is not None else None
    except LogError:  # whoever is asked can answer all the same
        return None
    if run is None:
        return None
    plan = msgspec.json.decode(run.plan) if run.plan else {}
    code = plan.get("language", run.language if run.utterance else None)
    return code if code in LANGUAGES else None


def _called(option: str, world: World, language: str) -> str:
    if language not in LANGUAGES:
        return option
    known = world.place(option) or world.person(option)
    if known is not None:
        own = [*known.aliases.get(language, ()), *([known.name] if language == "en" else [])]
        # What is a name in this language already stays as the program has it.
        return option if option in own else name_in(known, language)
    for plain in _PLAIN:
        if any(option.casefold() == load_language(code).phrase(plain) for code in LANGUAGES):
            name = load_language(language).phrase(plain)
            return name.capitalize() if option[:1].isupper() else name
    return option
