"""Sample sentences: the help ("what can I say?"), suggestions, and sentences for tests.

All are made from the language's own data and the names of the lexicon, so they parse.
"""

from __future__ import annotations

import functools
import random
import re
from collections.abc import Iterable, Mapping
from typing import Final

from grammar.language import Language, load_language
from grammar.lexicon import Lexicon
from grammar.naming import joined_up, naming, place_called, the
from grammar.network import parts_of
from grammar.templates import Choice, Part, Sequence, Template, Word
from grammar.wordforms import kind_words

_SLOT: Final = re.compile(r"\{(\w+)(!the)?\}")
ALIKE: Final = 86
"""From where on, of 100, two words are the same but for an ending: "tie" is not "time"."""
SHORTER_FROM: Final = 2
QUICKEST_FROM: Final = 6
"""How deep in the rules a random sentence is to come to an end soon, and as fast as it can."""
DEEPEST: Final = 20
PARTS_OF_NAMES: Final = {"place_tail", "place_short", "owner"}
"""Slots that take a part of a name only: "ward a, b and c"."""
UNSAID: Final = PARTS_OF_NAMES | {"routine"}
_SPACE_BEFORE: Final = re.compile(r" (?=[,.:]|'s\b)")


def samples(lexicon: Lexicon, language: str = "en") -> dict[str, list[str]]:
    """Example phrases by topic for this world and robot; all of them are understood."""
    return _samples(lexicon, load_language(language))


@functools.lru_cache(maxsize=16)
def _samples(lexicon: Lexicon, language: Language) -> dict[str, list[str]]:
    result: dict[str, list[str]] = {}
    for topic, examples in language.help.items():
        phrases = [filled for each in examples if (filled := _filled(each, lexicon, language))]
        if phrases:
            result[topic] = phrases
    return result


def _filled(example: str, lexicon: Lexicon, language: Language) -> str | None:
    """The example with names of the lexicon in its slots; None where there are none."""
    used: dict[str, int] = {}

    def fill(match: re.Match[str]) -> str:
        slot = match.group(1)
        names = _names(slot, lexicon)
        number = used.get(slot, 0)
        used[slot] = number + 1
        if number >= len(names):
            raise LookupError(slot)
        name = names[number]
        if slot == "place":
            return place_called(name, lexicon, language)
        name = naming(lexicon, language).called(name)
        return the(name, language) if match.group(2) else name

    try:
        return joined_up(_SLOT.sub(fill, example), language)
    except LookupError:
        return None


def _names(slot: str, lexicon: Lexicon) -> list[str]:
    return {
        "place": [place.name for place in lexicon.places],
        "person": [person.name for person in lexicon.people],
        "object": list(dict.fromkeys(thing.name for thing in lexicon.objects)),
        "contact": list(lexicon.contacts),
        "kind": [kind for kind, places in lexicon.place_kinds.items() if len(places) > 1],
        "joint": [joint.replace("_", " ") for joint in lexicon.joints],
        "skill": list(lexicon.skills),
        "routine": [routine.name for routine in lexicon.routines],
        "question": [question.question.rstrip("?") for question in lexicon.questions],
        "robot_name": [lexicon.robot_name] if lexicon.robot_name else [],
    }.get(slot, [])


def nearest_phrases(text: str, lexicon: Lexicon, language: Language) -> list[str]:
    """Up to three example phrases like a text, the nearest first: those that share at least half
    of their own words with it, and half of its words."""
    from rapidfuzz import fuzz, process

    said = _telling_words(text, language)
    near: list[tuple[float, str]] = []
    for phrase in (phrase for each in _samples(lexicon, language).values() for phrase in each):
        words = _telling_words(phrase, language)
        shared = [
            process.extractOne(word, said, scorer=fuzz.ratio, score_cutoff=ALIKE) for word in words
        ]
        found = {each[0] for each in shared if each is not None}
        part = sum(each is not None for each in shared) / max(1, len(words))
        if part >= 0.5 and 2 * len(found) >= len(set(said)):
            near.append((part + fuzz.token_sort_ratio(text.lower(), phrase) / 1000, phrase))
    return [phrase for _, phrase in sorted(near, key=lambda each: -each[0])[:3]]


def _telling_words(text: str, language: Language) -> list[str]:
    """The words of a text that say something."""
    return [
        word for word in language.tokens_of(text) if word.isalpha() and word not in language.closed
    ]


def random_sentence(lexicon: Lexicon, language: str = "en", seed: int = 0) -> str:
    """A sentence made at random from the rules; the same one for the same seed."""
    pack = load_language(language)
    return _Sampler(lexicon, pack, random.Random(seed)).sentence()


class _Sampler:
    """Walks the rules at random; ever shorter the deeper it is."""

    def __init__(self, lexicon: Lexicon, language: Language, chance: random.Random) -> None:
        self.lexicon = lexicon
        self.language = language
        self.chance = chance
        self.likely = _likely(language, bool(lexicon.routines))
        self.depths = _depths(language, bool(lexicon.routines))

    def sentence(self) -> str:
        return _SPACE_BEFORE.sub("", " ".join(self.rule("steps", 0)))

    def rule(self, name: str, depth: int) -> list[str]:
        each = self.likely[name]
        if depth > SHORTER_FROM:
            quickest = min(map(self.depth, (way for ways in each for way in ways)))
            more = 1 if depth < QUICKEST_FROM else 0
            short = [[way for way in ways if self.depth(way) <= quickest + more] for ways in each]
            each = [ways for ways in short if ways]
        return self.template(self.chance.choice(self.chance.choice(each)), depth + 1)

    def template(self, template: Template, depth: int) -> list[str]:
        match template:
            case Word(text):
                return [text]
            case Sequence(parts):
                return [word for part in parts for word in self.template(part, depth)]
            case Choice(alternatives):
                empty = [each for each in alternatives if each == Sequence(())]
                if empty and (depth > SHORTER_FROM or self.chance.random() < 0.7):
                    return []
                if depth > SHORTER_FROM:
                    quickest = min(map(self.depth, alternatives))
                    alternatives = tuple(a for a in alternatives if self.depth(a) == quickest)
                return self.template(self.chance.choice(alternatives), depth)
            case Part(name, _, True):
                return self.rule(name, depth)
            case Part(name, _, _):
                return self.slot(name).split()

    def slot(self, name: str) -> str:
        names = _names("kind" if name == "kinds" else name, self.lexicon)
        if name in ("kind", "kinds"):
            ways = [kind_words(kind, self.language) for kind in names]
            names = [word for one, many in ways for word in (one if name == "kind" else many)]
        listed = self.language.lists.get(name)
        if listed:
            names = [*names, *(" ".join(way) for ways in listed.values() for way in ways)]
        plain: dict[str, list[str]] = {
            "number": ["2", "10", "45"],
            "count": ["2", "3", "5"],
            "clock": ["9:30", "14:05"],
            "url": ["https://example.org"],
            "selector": ["#name"],
            "quote": ['"good morning"'],
            "text": ["lunch is ready", "good morning"],
            "noun": ["banana", "green bottle"],
            "word": ["like"],
            "verb": ["kommt"],
            "zu_infinitive": ["anzurufen"],
            "located": self.language.speech.get("located", {}).get("words", []),
            "remark": ["lunch is ready"],
            "unknown": ["pharmacy"],
            "stranger": ["Zorro"],
        }
        return self.chance.choice(names or plain.get(name) or self.known(name) or ["robot"])

    def known(self, name: str) -> list[str]:
        """What a slot matches that only the names of the world fill, such as {place_tail}."""
        from grammar.slots import names_of

        found: list[str] = []
        trie = names_of(self.language, self.lexicon).tries.get(name)
        todo = [("", trie)] if trie else []
        while todo:
            words, node = todo.pop()
            found += [words] if node.values else []
            todo += [(f"{words} {word}".strip(), each) for word, each in node.branches.items()]
        return sorted(each for each in found if any(map(str.isalnum, each)))

    def depth(self, template: Template) -> int:
        """How deep the shortest sentence of a template goes into the rules."""
        return _depth(template, self.depths)


@functools.cache
def _likely(language: Language, routines: bool) -> dict[str, list[list[Template]]]:
    """For each rule the templates of its likely entries; without routines, none that speak of
    them."""
    unsaid = PARTS_OF_NAMES if routines else UNSAID
    likely: dict[str, list[list[Template]]] = {}
    for name, productions in language.rules.items():
        usual = [each.templates for each in productions if each.cost < 2]
        sayable = [each for each in usual if not _slots(each) & unsaid]
        likely[name] = [list(each) for each in sayable or usual]
    return likely


def _slots(templates: Iterable[Template]) -> set[str]:
    return {part.name for each in templates for part in parts_of(each) if not part.is_rule}


@functools.cache
def _depths(language: Language, routines: bool) -> dict[str, int]:
    """How deep the shortest sentence of each rule goes."""
    likely = _likely(language, routines)
    depths: dict[str, int] = {}
    for _ in range(DEEPEST):
        for name, entries in likely.items():
            each = [_depth(way, depths) for ways in entries for way in ways]
            depths[name] = 1 + min(each, default=DEEPEST)
    return depths


def _depth(template: Template, depths: Mapping[str, int]) -> int:
    match template:
        case Sequence(parts):
            return max((_depth(part, depths) for part in parts), default=0)
        case Choice(alternatives):
            return min(_depth(each, depths) for each in alternatives)
        case Part(name, _, True):
            return depths.get(name, DEEPEST)
    return 0
