"""The words of explanations: a data file for each language, `languages/<code>/explain.yaml`, and
what other files of the language say under `methods`, beside the rules for a robot method.

They are read once, and checked against the shapes below, so that a phrase missing in a new
language is noticed when it is loaded and not in front of a nurse.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import msgspec

from grammar.languages import registry

_GAP = re.compile(r"\{(\w+)(?:!(\w+))?\}")
_QUOTED = re.compile(r"(„[^“]*“|“[^”]*”|«[^»]*»|`[^`]*`)")


class Words(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What is said of one robot method; each list from the most to the least specific pattern."""

    do: tuple[str, ...]
    result: tuple[str, ...] = ()
    first: str | None = None
    value: tuple[str, ...] = ()
    negative: tuple[str, ...] = ()
    holds: tuple[str, ...] = ()
    fails: tuple[str, ...] = ()
    held: tuple[str, ...] = ()
    missed: tuple[str, ...] = ()
    fields: dict[str, str] = {}
    compared: dict[str, dict[str, str]] = {}
    choices: dict[str, dict[str, str]] = {}
    """What the values of a parameter are called that can have only a few: {"color": {"red":
    "rot"}}."""


class Times(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    number: str
    words: dict[int, str]
    value: str


class Durations(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How long something takes, as people say it."""

    units: tuple[tuple[int, str, str], ...]
    """(seconds, one of them, several), the longest first."""
    words: dict[int, str]
    """Lengths in seconds that have words of their own: "half an hour"."""
    two: str

    def told(self, seconds: float) -> str:
        """ "10 minutes", "1 hour and 20 minutes"."""
        if seconds in self.words:
            return self.words[int(seconds)]
        parts: list[str] = []
        for length, one, many in self.units:
            last = length == self.units[-1][0]
            number = seconds / length if last else seconds // length
            seconds -= number * length
            if number == 1:
                parts.append(one)
            elif number:
                whole = str(int(number)) if float(number).is_integer() else f"{number:g}"
                parts.append(fill(many, {"number": whole}))
        if not parts:
            return fill(self.units[-1][2], {"number": "0"})
        if len(parts) == 1:
            return parts[0]
        return fill(self.two, {"first": ", ".join(parts[:-1]), "last": parts[-1]})


class NumberWords(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The numbers that a program looks for in what was said."""

    names: tuple[str, ...]
    """What 0 to 19 and the tens from 20 to 90 are called, each with its other names: "un/une"."""
    rewritten: tuple[tuple[str, str], ...] = ()
    """What is to be replaced first, in turn, so that the words stand one by one."""


class Nouns(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    thing: tuple[str, ...]
    place: tuple[str, ...]
    bare: str
    definite: str
    vowels: str
    plural: tuple[tuple[str, str], ...]
    singular: tuple[tuple[str, str], ...]
    tail: str = "$^"
    """Where what is said about a noun begins, which stays as it is when there are several: "box on
    the middle shelf"."""
    articles: tuple[tuple[str, str, str], ...] = ()
    """Where nouns differ in gender: (nouns, with their definite, their indefinite article); the
    first that fits stands in the place of `place` and `thing`."""

    def indefinite(self, noun: str) -> str:
        if re.fullmatch(self.definite, noun):
            return self.the(noun)
        return self._with_article(noun, self.thing)

    def the(self, noun: str) -> str:
        return self._with_article(noun, self.place)

    def _with_article(self, noun: str, patterns: tuple[str, ...]) -> str:
        if re.fullmatch(self.bare, noun):
            return noun
        for nouns, definite, indefinite in self.articles:
            if re.match(nouns, noun):
                return fill(definite if patterns is self.place else indefinite, {"noun": noun})
        before_vowel = noun[:1].lower() in self.vowels
        return fill(patterns[-1 if before_vowel else 0], {"noun": noun})

    def one(self, pattern: str, gap: str) -> str:
        """A phrase for the number 1 in its gap."""
        for found, replacement in self.singular:
            escaped = found.replace("{gap}", re.escape(f"{{{gap}}}"))
            pattern = re.sub(escaped, replacement.replace("{gap}", f"{{{gap}}}"), pattern)
        return pattern

    def many(self, noun: str) -> str:
        said = re.search(self.tail, noun)
        head, tail = (noun[: said.start()], said[0]) if said else (noun, "")
        for pattern, replacement in self.plural:
            changed, times = re.subn(pattern, replacement, head, count=1)
            if times:
                return changed + tail
        return noun


class Kept(msgspec.Struct, frozen=True, forbid_unknown_fields=True, array_like=True):
    """What the robot keeps count or a list of, by the name that the program has for it."""

    name: str
    """A pattern for the name; what its group takes may stand in the phrases as ``\\1``."""
    what: str
    """Those who are counted or listed: "the people who say yes"."""
    value: str
    """The number or the list itself: "the number of people who said yes"."""

    def phrase(self, pattern: str, name: str) -> str | None:
        found = re.fullmatch(self.name, name)
        return found.expand(pattern) if found else None


class Speech(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """All phrases of a language."""

    sentences: dict[str, str]
    joining: dict[str, str]
    clauses: dict[str, str]
    times: Times
    steps: dict[str, str]
    values: dict[str, str]
    nouns: Nouns
    conditions: dict[str, str]
    elapsed: dict[str, str]
    """How it is said how much time has passed, by the operator it is compared with."""
    methods: dict[str, Words]
    durations: Durations
    numbers: NumberWords
    brief: dict[str, str]
    """What is said of a whole plan in a breath: `grammar.summary`."""
    languages: dict[str, str] = {}
    """What languages are called, by their codes."""
    counts: tuple[Kept, ...] = ()
    lists: tuple[Kept, ...] = ()
    names: dict[str, str] = {}
    """What else is remembered, by the name that the program has for it."""
    findings: dict[str, tuple[str, str]] = {}
    """Names for what is found out on the way: how it is said that it is so, and that it is not."""
    records: dict[str, str] = {}
    """Names for the highest number so far, and the like: how a number is said to be the next."""
    joined: tuple[tuple[str, str], ...] = ()
    """Little words that run together ("à le" -> "au"), as patterns and what stands for them."""

    inflected: tuple[tuple[str, str], ...] = ()
    """What the marks in the phrases of this language come to, such as ⟨dat⟩ before a noun."""

    def choice(self, parameter: str, value: str) -> str:
        """What a value of a parameter is called that can have only a few."""
        called = (words.choices.get(parameter, {}) for words in self.methods.values())
        return next((known[value] for known in called if value in known), value)

    def joined_up(self, text: str) -> str:
        """The text with its marks made endings, and the little words run together, but for what is
        quoted in it."""
        for pattern, replacement in self.inflected:
            text = re.sub(pattern, replacement, text)
        if not self.joined:
            return text
        parts = _QUOTED.split(text)  # every other part is a quotation
        for number in range(0, len(parts), 2):
            for pattern, replacement in self.joined:
                parts[number] = re.sub(pattern, replacement, parts[number])
        return "".join(parts)


def explained(language: str) -> dict[str, Any]:
    """What `explain.yaml` of a language says; what one that somebody added has no words for, in
    English. Raises `UnknownLanguage`; `msgspec.ValidationError` where something is of the wrong
    shape."""
    data = _read(registry.folder_of(language))
    if not registry.is_ours(language):
        data = under(data, _read(registry.folder_of(registry.ENGLISH)))
    msgspec.convert(data, Speech)
    return data


def _read(folder: Path) -> dict[str, Any]:
    import yaml

    path = folder / "explain.yaml"
    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    if not path.exists():
        return {}
    data: dict[str, Any] = yaml.load(path.read_text(encoding="utf-8"), Loader=loader)
    return data


def under(data: Any, english: Any) -> Any:
    """What stands in one, and what only the other has besides."""
    if not (isinstance(data, dict) and isinstance(english, dict)):
        return data
    return {**english, **{key: under(value, english.get(key)) for key, value in data.items()}}


def gaps(pattern: str) -> set[str]:
    """The names that a pattern has to be filled with."""
    return {match[1] for match in _GAP.finditer(pattern)}


def forms(pattern: str) -> dict[str, str]:
    """For each gap the form it wants: "the", "plural", or "" for the usual one."""
    return {match[1]: match[2] or "" for match in _GAP.finditer(pattern)}


def fill(pattern: str, values: Mapping[str, str]) -> str:
    """The pattern with its gaps filled. What is filled in is not looked at for gaps again."""
    return _GAP.sub(lambda match: values[match[1]], pattern)


def fitting(patterns: tuple[str, ...], given: set[str]) -> str | None:
    """The first pattern that needs nothing but what is given."""
    return next((pattern for pattern in patterns if gaps(pattern) <= given), None)
