"""The planners there are: the rules, the language model, and whatever else is registered.

    --planner grammar|model|auto      auto: the rules for what they know, the model for the rest

To add one, write a class with `name` and `plan` (`grammar.planning.planner.Planner`) and register
it here or, from another package, as an entry point of the group `nl2robot.planners`.
"""

from __future__ import annotations

import atexit
import functools
import importlib.util
import os
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Final

from grammar.planning.model.request import Interrupted, Unavailable
from grammar.planning.planner import Planner
from grammar.planning.rules import RulesPlanner
from nl2robot.deliberation.sufficing import will_do
from nl2robot.errors import UserError
from nl2robot.models.catalogue import LARGE, PLANNER, find
from nl2robot.paths import PACKAGED
from robot_api.plugins import PLANNERS as GROUP
from robot_api.plugins import Plugin, PluginError, left_out, plugins

if TYPE_CHECKING:
    from nl2robot.language_model.client import Process

AUTO: Final = "auto"
CHOSEN: Final = "NL2ROBOT_LANGUAGE_MODEL"
"""The environment variable that names the model to use, or "none"."""


def _rules() -> Planner:
    return RulesPlanner()


def _model() -> Planner:
    from grammar.planning.model.planner import ModelPlanner

    return ModelPlanner(language_model(), will_do)


PLANNERS: Final[dict[str, Callable[[], Planner]]] = {"grammar": _rules, "model": _model}


def names() -> list[str]:
    """What `--planner` may be."""
    return [AUTO, *PLANNERS, *_others()]


@functools.cache
def planner(name: str) -> Planner:
    """The planner of this name, made once. Raises `UserError` if there is none, or none that can be
    used here."""
    if name in PLANNERS:
        return PLANNERS[name]()
    if name in _others():
        return _made(_others()[name])
    raise UserError(f"There is no planner “{name}”. There are: {', '.join(names())}.")


def troubles() -> dict[str, str]:
    """By name, a sentence on each planner of a package that cannot be used."""
    found = left_out(GROUP, (AUTO, *PLANNERS))
    for name in _others():
        try:
            planner(name)
        except UserError as error:
            found[name] = str(error)
    return found


def _others() -> dict[str, Plugin]:
    return plugins(GROUP, (AUTO, *PLANNERS))


def _made(plugin: Plugin) -> Planner:
    """A planner of another package. Raises `UserError`."""
    try:
        make = plugin.load()
        try:
            made: Planner = make()
        except (Exception, SystemExit) as error:
            raise plugin.broken(error) from error
        if not callable(getattr(made, "plan", None)):
            raise plugin.unusable(f"is no Planner: {type(made).__name__} is something else.")
    except PluginError as error:
        raise UserError(str(error)) from error
    return made


def available(name: str) -> bool:
    """Whether a planner can be used here."""
    return name != "model" or (installed_model() is not None and _has_runtime())


def _has_runtime() -> bool:
    return importlib.util.find_spec("tiktoken") is not None


def installed_model() -> Path | None:
    """The folder of the language model that is used here: the one that was chosen, else the largest
    that is installed and has learned what programs are."""
    chosen = os.environ.get(CHOSEN)
    if chosen == "none":
        return None
    codes = [chosen] if chosen else [code for code in (LARGE, PLANNER) if learned(code)]
    return next(_found(codes, find), None)


def _found(codes: list[str], find: Callable[[str], Path | None]) -> Iterator[Path]:
    for code in codes:
        folder = find(code)
        if folder is not None:
            yield folder


def learned(code: str) -> Path | None:
    """What this model has learned for this project: a file of `language_model.changes`."""
    path = PACKAGED / "learned" / f"{code}.npz"
    return path if path.exists() else None


def get_ready() -> None:
    """Load the language model, if there is one, in the background: the first sentence that needs it
    shall not wait for that."""

    def load() -> None:
        from grammar.planning.model.prompt import PREFIX

        with suppress(Interrupted, Unavailable, UserError):  # told when it is needed
            language_model().get_ready(PREFIX)

    if available("model"):
        threading.Thread(target=load, name="getting ready", daemon=True).start()


@functools.cache
def language_model() -> Process:
    """The language model's process, which begins when it is first asked to write."""
    folder = installed_model()
    if folder is None:
        raise UserError(
            "There is no language model here. Run `nl2robot models get planner-large` to fetch it"
            " (1.1 GB), or say it as in `nl2robot phrases`."
        )
    if not _has_runtime():
        raise UserError(
            "The language model is here, but not what runs it. Run `pip install"
            " 'nl2robot[planner]'`."
        )
    from nl2robot.language_model.client import Process

    process = Process(folder, learned(folder.name))
    atexit.register(process.close)
    return process
