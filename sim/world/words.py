"""The words that the robot's eyes know whatever the world: read once from words.yaml."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import msgspec
import yaml


class Words(msgspec.Struct, frozen=True):
    """The words of all languages together: a phrase need not say which language it is in."""

    fillers: frozenset[str]
    person: frozenset[str]
    male: frozenset[str]
    female: frozenset[str]
    thing: frozenset[str]
    slow: frozenset[str]
    big: frozenset[str]
    small: frozenset[str]
    postures: Mapping[str, frozenset[str]]
    superlatives: Mapping[str, str]
    """By word, which measure it means: {"closest": "nearest"}."""
    plurals: Mapping[str, str]
    plural_endings: tuple[tuple[str, str], ...]
    ordinals: Mapping[str, int]
    """What may stand before a superlative: {"second": 2}."""
    several: frozenset[str]
    """Words for all things or people that are there."""
    relations: tuple[str, ...]
    """Those of several words first."""
    sides: Mapping[str, str]
    """The relations that are about where one looks from: {"à gauche de": "left"}."""
    joins: frozenset[str]
    """What stands between two things that something is between."""
    yes: Mapping[str, str]
    """By language."""
    furniture_for: Mapping[str, frozenset[str]]
    """By what it is for, kinds of furniture."""
    public: frozenset[str]
    """Kinds of places where people come in from outside."""

    def singulars(self, word: str) -> Iterable[str]:
        """The word, and what it may be the plural of."""
        yield word
        if word in self.plurals:
            yield self.plurals[word]
        for ending, instead in self.plural_endings:
            if word.endswith(ending) and len(word) > len(ending) + 1:
                yield word.removesuffix(ending) + instead


@functools.cache
def words() -> Words:
    data: dict[str, Any] = yaml.safe_load(
        Path(__file__).with_name("words.yaml").read_text(encoding="utf-8")
    )
    furniture_for, public = data.pop("furniture_for"), data.pop("public")
    languages = data.values()

    def together(field: str) -> frozenset[str]:
        return frozenset(word for language in languages for word in language[field])

    def by_key(field: str) -> dict[str, frozenset[str]]:
        keys = {key for language in languages for key in language[field]}
        return {
            key: frozenset(w for language in languages for w in language[field].get(key, ()))
            for key in sorted(keys)
        }

    relations = {relation for language in languages for relation in language["relations"]}
    return Words(
        **{
            field: together(field)
            for field in (
                "fillers",
                "person",
                "male",
                "female",
                "thing",
                "slow",
                "big",
                "small",
                "several",
            )
        },
        ordinals={k: v for language in languages for k, v in language["ordinals"].items()},
        sides={k: v for language in languages for k, v in language["sides"].items()},
        joins=frozenset(language["and"] for language in languages),
        postures=by_key("postures"),
        superlatives={
            word: measure for measure, group in by_key("superlatives").items() for word in group
        },
        plurals={k: v for language in languages for k, v in language["plurals"].items()},
        plural_endings=tuple(
            (ending, instead)
            for language in languages
            for ending, instead in language["plural_endings"]
        ),
        relations=tuple(sorted(relations, key=lambda relation: (-len(relation.split()), relation))),
        yes={code: language["yes"] for code, language in data.items()},
        furniture_for={use: frozenset(kinds) for use, kinds in furniture_for.items()},
        public=frozenset(public),
    )
