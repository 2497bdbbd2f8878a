"""The sentences of the robot's software in other languages.

Drivers, simulator and server say in English what went wrong, each where it is known best. As with
gettext the English sentence is the key: `data/sentences/` has every one with gaps for what it is
about, and the same in other languages. So a sentence carries its values whatever way it takes,
over the wire, through a program and out of an old log. Whose driver says something of its own is
told in its own words.

A gap says by its name what stands in it: `the_...` a name that goes with its article, `thing` what
is called by its name alone, `number` a number, `names` a list, `choice` what may be written in a
program, with "or" between, `part` another of these sentences; all else stands as it is. An entry
may stand in such a gap as well: "the door of the pharmacy".
"""

from __future__ import annotations

import functools
import re
from dataclasses import dataclass
from typing import Final

from grammar.language import Language, UnknownLanguage, load_language
from grammar.lexicon import Lexicon
from grammar.naming import joined_up, listed, naming, the
from nl2robot.paths import PACKAGED
from nl2robot.words import words_in

DATA: Final = PACKAGED / "sentences"
GAP: Final = re.compile(r"\{(\w+)\}")
_OF_A_FILE: Final = re.compile(r"(\s*(?:\S+?:(?:\d+:)? )?)(.*)", re.DOTALL)
DEEPEST: Final = 6
"""Sentences within each other."""
_NUMBER: Final = re.compile(r"[-0-9.]+")
_EITHER: Final = re.compile(r", | or ")
_LISTED: Final = re.compile(r", | and ")


@dataclass(frozen=True)
class Entry:
    fixed: tuple[str, ...]
    """What of the English sentence stands around its gaps, the first and the last maybe empty."""
    gaps: tuple[str, ...]
    said: dict[str, str]

    def values(self, sentence: str) -> dict[str, str] | None:
        """What stands in the gaps of such a sentence; None if it is another.

        Each gap ends where what is fixed behind it comes first, and nothing is tried again: with a
        regular expression a sentence made for it by somebody on the wire took a minute, in which
        nobody's stop was heard.
        """
        first, *between = self.fixed
        if not sentence.startswith(first):
            return None
        if not between:
            return {} if sentence == first else None
        *between, last = between
        at, end = len(first), len(sentence) - len(last)
        if end < at or not sentence.endswith(last):
            return None
        found = []
        for fixed in between:
            behind = sentence.find(fixed, at, end)
            if behind < 0:
                return None
            found.append(sentence[at:behind])
            at = behind + len(fixed)
        values = dict(zip(self.gaps, (*found, sentence[at:end]), strict=True))
        return values if all(map(_fits, values, values.values())) else None


def in_language(sentence: str, language: str, lexicon: Lexicon | None = None) -> str | None:
    """An English sentence of the robot's software in another language, with the names of the
    lexicon as they are called there; None for a sentence of somebody else's."""
    if language == "en":
        return sentence
    try:
        told = _told(sentence, load_language(language), lexicon or Lexicon())
    except UnknownLanguage:
        return None
    return told and _capital(told)


def told(sentence: str, language: str) -> str:
    """The same for whoever reads errors at a terminal: as it is where it is somebody else's. What
    is said of a file may have its name and the line before it: "ward.yaml:3: ..."."""
    before, bare = _OF_A_FILE.fullmatch(sentence).groups()  # type: ignore[union-attr]
    return in_language(sentence, language) or before + (in_language(bare, language) or bare)


def _told(sentence: str, pack: Language, lexicon: Lexicon, depth: int = 0) -> str | None:
    """The same, as it stands within so many sentences."""
    if depth > DEEPEST:
        return None
    for entry in entries():
        found = entry.values(sentence) if pack.code in entry.said else None
        if found is None:
            continue
        values = {
            name: _value(name, text, pack, lexicon, depth + 1) for name, text in found.items()
        }
        if None not in values.values():
            told = entry.said[pack.code].format(**values)
            has_nouns = any(
                name.partition("_")[0] in ("the", "thing", "names", "choice") for name in values
            )
            return joined_up(told, pack) if has_nouns else told
    return None


def _value(name: str, text: str, pack: Language, lexicon: Lexicon, depth: int) -> str | None:
    """What stands in a gap of this name; None for a part that is not known."""
    called = naming(lexicon, pack).called
    match name.partition("_")[0]:
        case "number":
            return text.replace(".", words_in(pack.code)["decimal_point"])
        case "part":
            return text and _told(text, pack, lexicon, depth)
        case "thing":
            return called(text)
        case "names":
            names = [
                _told(each, pack, lexicon, depth) or called(each) for each in _LISTED.split(text)
            ]
            return listed(names, pack)
        case "choice":
            # In a program names stay as the world spells them.
            *first, last = [
                _told(each, pack, lexicon, depth) or each for each in _EITHER.split(text)
            ]
            return f"{', '.join(first)} {pack.phrase('or')} {last}" if first else last
        case "the":
            bare = text.removeprefix("the ")
            # People who have a name of their own go without an article.
            noun = the(called(bare), pack) if bare[:1].islower() else called(bare)
            return _told(text, pack, lexicon, depth) or noun
        case _:
            return text


@functools.cache
def entries() -> tuple[Entry, ...]:
    """All sentences that are known; those that say most by themselves first."""
    import yaml

    known: list[dict[str, str]] = [
        said
        for file in sorted(DATA.glob("*.yaml"))
        for said in yaml.safe_load(file.read_text(encoding="utf-8"))
    ]
    known.sort(key=lambda said: (said["en"].startswith("{"), len(GAP.findall(said["en"]))))
    return tuple(_entry(said) for said in known)


def _entry(said: dict[str, str]) -> Entry:
    pieces = GAP.split(said["en"])
    return Entry(tuple(pieces[::2]), tuple(pieces[1::2]), said)


def _fits(name: str, text: str) -> bool:
    """Whether that can stand in a gap of this name."""
    return name.partition("_")[0] != "number" or _NUMBER.fullmatch(text) is not None


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]
