"""The corpus: what people say, with the program that does it; one YAML file for each author.

    author: night nurse
    world: seaview.yaml             # in worlds/, or a built-in one
    items:
      - de: Sag Bob bitte, dass seine Schwester angerufen hat.
        do: |
          find("Bob")
          say("Ihre Schwester hat angerufen.")
      - en: and tell Clara too
        after:
          say: Tell Bob that lunch is ready.
          do: "find(\\"Bob\\")\\nsay(\\"Lunch is ready.\\")"
        do: ...

The programs are in the dialect of `grammar.planning.model`.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Final

import yaml

from grammar.language import languages, load_language
from grammar.planning.model.expansion import program_of
from grammar.planning.turn import Turn
from grammar.program_parser import parse_program
from grammar.understanding import Context
from nl2robot.errors import UserError
from nl2robot.knowledge import Knowledge
from sim.world.loading import load_world

FOLDER: Final = Path(__file__).parent
CORPUS: Final = FOLDER / "corpus"
WORLDS: Final = FOLDER / "worlds"


@dataclass(frozen=True)
class Before:
    """What was said and done before."""

    say: str
    do: str


@dataclass(frozen=True)
class Item:
    where: str
    """File and line."""
    author: str
    world: str
    language: str
    say: str
    do: str
    after: Before | None = None

    @property
    def turn(self) -> Turn:
        """The sentence as a planner gets it."""
        lexicon = knowledge(self.world).lexicon(self.language)
        language, context = load_language(self.language), Context()
        if self.after is not None:
            plan = parse_program(program_of(self.after.do, language), self.language)
            context = Context(plan=plan, text=self.after.say)
        return Turn(self.say, lexicon, language, context)


@cache
def knowledge(world: str) -> Knowledge:
    file = WORLDS / world
    return Knowledge(load_world(file if file.is_file() else world, names_only=True))


def load(files: Iterable[Path]) -> Iterator[Item]:
    """The items of some files. Raises `UserError` where one is not as it should be."""
    for file in files:
        content = yaml.safe_load(file.read_text("utf-8"))
        for number, entry in enumerate(content["items"], 1):
            yield _item(file, number, content, entry)


def _item(file: Path, number: int, content: dict[str, Any], entry: dict[str, Any]) -> Item:
    where = f"{file.name} item {number}"
    spoken = [code for code in languages() if code in entry]
    extra = entry.keys() - {*languages(), "do", "after", "id"}
    if len(spoken) != 1 or "do" not in entry or extra:
        raise UserError(f"{where}: it needs one of en, de, fr, and do; after may be there.")
    after = Before(**entry["after"]) if "after" in entry else None
    say = str(entry[spoken[0]]).strip()
    do = str(entry["do"]).strip("\n")
    return Item(where, content["author"], content["world"], spoken[0], say, do, after)


def files() -> list[Path]:
    return sorted(CORPUS.glob("*.yaml"))


def digest() -> str:
    """SHA-256 of the whole corpus: of its files and the worlds that they speak of, with their
    names."""
    hashed = hashlib.sha256()
    for file in (*files(), *sorted(WORLDS.glob("*.yaml"))):
        hashed.update(f"{file.name} {hashlib.sha256(file.read_bytes()).hexdigest()}\n".encode())
    return hashed.hexdigest()
