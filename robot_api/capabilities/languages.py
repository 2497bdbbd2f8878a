"""What people answer and what the robot says while it asks, in each language: the data.

The words are in `languages.yaml`, those of a language that a package adds (`nl2robot.languages`) in
the file `robot.yaml` of its folder; this loads them, folded so that case, accents and punctuation
do not count.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import msgspec

from robot_api.plugins import LANGUAGES, PluginError, plugins, remembered

OURS: Final = Path(__file__).with_name("languages.yaml")
FILE: Final = "robot.yaml"
LENDER: Final = "en"
"""Its words stand in for those that a package's language lacks."""

Words = tuple[str, ...]
"""A phrase, word by word."""


class _Raw(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A language as `languages.yaml` writes it: phrases parted by commas."""

    name: str
    own_name: str
    again: str
    was_that: str
    choose: str
    follow_me: str
    no_answer: str
    plain_yes: str
    agreeing: str
    plain_no: str
    refusing: str
    unsure: str
    negations: str
    fillers: str
    question_fillers: str
    position: str
    last: str
    numbers: str
    number_variants: str
    ordinals: str
    ordinal_variants: str


@dataclass(frozen=True)
class Language:
    """The words of one language."""

    name: str = ""
    """What it is called in English: "German"."""
    own_name: str = ""
    """What it calls itself: "Deutsch"."""
    again: str = "?"
    """Said when an answer was not understood."""
    was_that: str = "{}?"
    """Asked about an answer that was heard badly, which stands for the braces."""
    choose: str = "?"
    """Said when the options are offered on the screen."""
    follow_me: str = "?"
    """Said to somebody who is to be led."""
    no_answer: str = "?"
    """Said to a question that nobody prepared an answer for."""
    plain_yes: frozenset[Words] = frozenset()
    """Plain yes: an option that reads so is the yes among the options."""
    agreeing: frozenset[Words] = frozenset()
    """Other ways of agreeing; they answer yes, but an option that reads so means itself."""
    plain_no: frozenset[Words] = frozenset()
    refusing: frozenset[Words] = frozenset()
    unsure: frozenset[Words] = frozenset()
    """Neither yes nor no, nor anything else."""
    negations: frozenset[Words] = frozenset()
    """What turns the rest of an answer round."""
    fillers: frozenset[str] = frozenset()
    """Words that add nothing to an answer."""
    question_fillers: frozenset[str] = frozenset()
    """Words that, besides those, add nothing to a question."""
    position: frozenset[str] = frozenset()
    """Words before a number that picks by position: "number two"."""
    last: frozenset[Words] = frozenset()
    numbers: dict[Words, int] = field(default_factory=dict)
    ordinals: dict[Words, int] = field(default_factory=dict)


def fold(text: str) -> Words:
    """The words of a text: lower case, without accents and punctuation.

    >>> fold("L'hôpital, s'il vous plaît!")
    ('l', 'hopital', 's', 'il', 'vous', 'plait')
    """
    bare = unicodedata.normalize("NFKD", text.casefold())
    return tuple(
        "".join(c if c.isalnum() else "" if unicodedata.combining(c) else " " for c in bare).split()
    )


def language_data(code: str) -> Language:
    """The words of the language of a code such as "de" or "de-CH"; of an unknown one, none."""
    return _languages().get(code[:2].lower(), Language())


def known_languages() -> tuple[str, ...]:
    """The codes of the languages that a robot can be asked in: ours first, then those added."""
    return tuple(_languages())


class Faulty(Exception):
    """The words of a language cannot be read: a sentence that says why."""


def read_added(file: Path) -> Language:
    """The words of a language that somebody adds; what it lacks but its names, English lends.
    Raises `Faulty`, `OSError`."""
    import yaml

    ours = yaml.safe_load(OURS.read_text("utf-8"))[LENDER]
    lent = {key: value for key, value in ours.items() if key not in ("name", "own_name")}
    try:
        theirs = yaml.load(file.read_text("utf-8"), Loader=yaml.BaseLoader)  # "no" is a word
        return _language(msgspec.convert({**lent, **theirs}, _Raw))
    except (TypeError, ValueError, yaml.YAMLError) as error:
        raise Faulty(f"{file.name}: {' '.join(str(error).split())}") from error


@remembered
def _languages() -> Mapping[str, Language]:
    import yaml  # needed only where the robot asks

    raw: dict[str, Any] = msgspec.convert(yaml.safe_load(OURS.read_text("utf-8")), dict[str, _Raw])
    known = {code: _language(words) for code, words in raw.items()}
    for code, plugin in plugins(LANGUAGES, known).items():
        with suppress(PluginError, Faulty, OSError):  # told by `nl2robot languages`
            known[code] = read_added(plugin.folder() / FILE)
    return known


def _language(raw: _Raw) -> Language:
    return Language(
        name=raw.name,
        own_name=raw.own_name,
        again=raw.again,
        was_that=raw.was_that,
        choose=raw.choose,
        follow_me=raw.follow_me,
        no_answer=raw.no_answer,
        plain_yes=_phrases(raw.plain_yes),
        agreeing=_phrases(raw.agreeing),
        plain_no=_phrases(raw.plain_no),
        refusing=_phrases(raw.refusing),
        unsure=_phrases(raw.unsure),
        negations=_phrases(raw.negations),
        fillers=frozenset(word for phrase in _phrases(raw.fillers) for word in phrase),
        question_fillers=frozenset(
            word for phrase in _phrases(raw.question_fillers) for word in phrase
        ),
        position=frozenset(word for phrase in _phrases(raw.position) for word in phrase),
        last=_phrases(raw.last),
        numbers=_counted(raw.numbers, 0) | _numbered(raw.number_variants),
        ordinals=_counted(raw.ordinals, 1) | _numbered(raw.ordinal_variants),
    )


def _phrases(text: str) -> frozenset[Words]:
    return frozenset(fold(phrase) for phrase in text.split(","))


def _counted(text: str, first: int) -> dict[Words, int]:
    """The number of each phrase, counting from `first`."""
    return {fold(phrase): number for number, phrase in enumerate(text.split(","), first)}


def _numbered(text: str) -> dict[Words, int]:
    """The number of each phrase, which stands behind it: "zwo 2"."""
    return {(*words[:-1],): int(words[-1]) for words in map(fold, text.split(","))}
