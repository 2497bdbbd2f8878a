"""The languages there are: what each has of all that one can have, and whether it is as it should
be."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from grammar.language import languages, load_language
from grammar.languages import registry
from grammar.languages.checker import Finding, check_language, few, unreadable
from grammar.lexicon import Lexicon
from grammar.samples import samples
from nl2robot.knowledge import Knowledge
from nl2robot.models import catalogue
from nl2robot.paths import PACKAGED
from nl2robot.speech.speak.voices import voices
from nl2robot.texts import BY_LANGUAGE, CONSOLE, ENGLISH, FOLDER, brought
from robot_api.capabilities.languages import FILE, Faulty, language_data, read_added
from robot_api.drivers import simulated
from sim.simulation import Simulation
from sim.world.model import World


@dataclass(frozen=True)
class Has:
    """What a language has."""

    code: str
    name: str
    """What it calls itself."""
    samples: int
    """Sentences that people are shown in a world."""
    texts: int
    """Percent of what the application says in it, and not in English."""
    asked: bool
    """Whether a robot asks, and understands answers, in it."""
    model: str
    """Of speech: "installed", "missing" or "none"."""
    voices: tuple[str, ...]


def names(world: World, code: str) -> Lexicon:
    """The names that a simulated robot in a world understands in a language."""
    robot = simulated(Simulation(world))
    try:
        return Knowledge(world, robot.capabilities()).lexicon(code)
    finally:
        robot.close()


def overview(world: World) -> list[Has]:
    """What each language that can be used has."""
    return [_has(code, names(world, code)) for code in languages()]


def _has(code: str, lexicon: Lexicon) -> Has:
    return Has(
        code=code,
        name=language_data(code).own_name or code,
        samples=sum(len(each) for each in samples(lexicon, load_language(code).code).values()),
        texts=100 if registry.is_ours(code) else _percent(code),
        asked=bool(language_data(code).name),
        model=_model(code),
        voices=tuple(voice.name for voice in voices(code)),
    )


def _model(code: str) -> str:
    known = {model.code: model.state for model in catalogue.list_models()}
    return known.get(code, "none")


def _percent(code: str) -> int:
    every = [(name, key) for name, texts in _english().items() for key in texts]
    theirs = [(name, key) for name, key in every if key in brought(code, name)]
    return round(100 * len(theirs) / len(every))


def _english() -> dict[str, Mapping[str, Any]]:
    """All that the application says in English, by the name of its file."""
    data = {name: _read(PACKAGED / f"{name}.yaml")[ENGLISH] for name in BY_LANGUAGE}
    pages = {f"console/{path.stem}": _read(path) for path in sorted(CONSOLE.glob("*.yaml"))}
    return {**data, **pages}


def _read(path: Path) -> dict[str, Any]:
    read: dict[str, Any] = yaml.safe_load(path.read_text(encoding="utf-8"))
    return read


# --- the check


def check(code: str, world: World) -> list[Finding]:
    """What is wrong with a language, and what it lacks. Raises `UnknownLanguage`."""
    found = check_language(code, lambda: names(world, code))
    if not registry.is_ours(code):
        folder = registry.folder_of(code)
        found += [*_of_robot(folder / FILE), *_of_texts(code, folder)]
    return found


def _of_robot(path: Path) -> Iterator[Finding]:
    """The words that a robot asks and is answered with."""
    if not path.exists():
        message = "There is no such file: a robot cannot speak this language, nor ask in it."
        yield Finding("note", path.name, None, message)
        return
    try:
        words = read_added(path)
    except Faulty as error:
        yield Finding("error", path.name, None, str(error).removeprefix(f"{path.name}: ") + ".")
        return
    english = language_data(ENGLISH)
    lent = [
        name
        for name in ("again", "choose", "follow_me", "plain_yes", "plain_no", "numbers")
        if getattr(words, name) == getattr(english, name)
    ]
    if lent:
        yield Finding("note", path.name, None, f"English lends these: {few(lent)}.")


def _of_texts(code: str, folder: Path) -> Iterator[Finding]:
    """What the application says: files that nothing reads, names that nothing asks for."""
    english = _english()
    for path in sorted((folder / FOLDER).rglob("*.yaml")):
        name = path.relative_to(folder / FOLDER).with_suffix("").as_posix()
        shown = f"{FOLDER}/{name}.yaml"
        if name not in english:
            known = few(f"{each}.yaml" for each in english)
            message = f"Nothing reads this file. There could be: {known}."
            yield Finding("error", shown, None, message)
            continue
        try:
            root = yaml.compose(path.read_bytes(), Loader=yaml.SafeLoader)
        except (yaml.YAMLError, UnicodeDecodeError) as error:
            told = unreadable(path, error)
            yield Finding("error", shown, told.line, told.message)
            continue
        for key, _ in root.value if isinstance(root, yaml.MappingNode) else ():
            if key.value not in english[name]:
                message = f"Nothing is said by the name {key.value!r}."
                yield Finding("error", shown, key.start_mark.line + 1, message)
    if percent := 100 - _percent(code):
        message = f"{percent} % of what the application says is said in English."
        yield Finding("note", f"{FOLDER}/", None, message)
