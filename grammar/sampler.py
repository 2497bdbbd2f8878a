"""Sentences made at random from the rules, for tests and measurements.

A sentence is made *towards* an entry of a rule: the shortest way through the rules that leads to
it, with everything beside that way kept short. So each draw says one thing that somebody could say,
and every entry gets its turn. Much of that means nothing by itself ("put it there", "who said
yes?"); where the discourse does not know what it speaks of, something that could have been said
before stands before it, and if that does not help either, another sentence is drawn.
"""

from __future__ import annotations

import functools
import random
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Final

from grammar.language import Language, load_language
from grammar.lexicon import Lexicon
from grammar.names import names_of
from grammar.network import Production, parts_of
from grammar.plan import Plan
from grammar.samples import names_for, samples
from grammar.templates import NOTHING, Choice, Part, Sequence, Template, Word
from grammar.understand import understand
from grammar.understanding import Understanding
from grammar.wordforms import kind_words

START: Final = "steps"
DEEPEST: Final = 20
LIKELY: Final = 2.0
"""Entries that cost more than this are read, but nobody is expected to say them."""
SPARING: Final = 0.85
"""How often words that may be left out are left out."""
ROOM: Final = 25
"""Rules that a sentence may use before it is kept as short as may be."""
PREFERRED: Final = 5
"""How much likelier a name is than a word that stands for one ("her", "that one")."""
MOST_DRAWS: Final = 40
BEFORE: Final = 3
"""Sentences that are put before one that speaks of something, and how often others are tried."""
PARTS_OF_NAMES: Final = {"place_tail", "place_short", "owner"}
"""Slots that take a part of a name only: "ward a, b and c"."""
LOCATED: Final = {"located", "towards"}
"""Slots for words that the language lists elsewhere."""
NAMES: Final = {"place", "person", "object"}
UNSAID: Final = PARTS_OF_NAMES | {"routine"}
_SPACE_BEFORE: Final = re.compile(r" (?=[,.:;?]|'s\b)|(?<=\b[ldnjmtsc]') ")

FILLED: Final = {
    "number": ["2", "5", "10"],
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
    "infinitive": ["kommen"],
    "remark": ["lunch is ready"],
    "unknown": ["pharmacy"],
    "stranger": ["Zorro"],
}
"""What stands in the open slots, in any language."""


@dataclass(frozen=True)
class Sampled:
    """A sentence that makes sense, and what was understood of it."""

    sentence: str
    plan: Plan
    refused: tuple[Understanding, ...]
    """What was drawn before it and made no sense, as it was answered."""


def random_sentence(lexicon: Lexicon, language: str = "en", seed: int = 0) -> str:
    """A sentence made at random from the rules, whether it makes sense or not; the same one for
    the same seed."""
    return _Sampler(lexicon, load_language(language), random.Random(seed)).sentence()


def sensible(lexicon: Lexicon, language: str = "en", seed: int = 0) -> Sampled:
    """A sentence made at random that can be made a program of; the same one for the same seed."""
    chance = random.Random(seed)
    sampler = _Sampler(lexicon, load_language(language), chance)
    refused: list[Understanding] = []
    for _ in range(MOST_DRAWS):
        drawn = sampler.sentence()
        answers: list[Understanding] = []
        for sentence in (drawn, *(f"{before}. {drawn}" for before in sampler.befores())):
            understood = understand(sentence, lexicon, language)
            if understood.status == "clarify" and understood.suggestions:
                understood = understand(understood.suggestions[0], lexicon, language)
            if understood.plan is not None:
                return Sampled(understood.utterance, understood.plan, tuple(refused))
            answers.append(understood)
            if understood.request is not None:
                break  # it is for the application, with nothing for the robot to do
        if answers[-1].request is None:
            refused.append(answers[0])
    raise LookupError(f"No sentence of {MOST_DRAWS} drawn with seed {seed} means anything.")


class _Sampler:
    """Walks the rules at random."""

    def __init__(self, lexicon: Lexicon, language: Language, chance: random.Random) -> None:
        self.lexicon = lexicon
        self.language = language
        self.chance = chance
        self.rules = _rules(language, bool(lexicon.routines))
        self.used = 0

    def sentence(self) -> str:
        self.used = 0
        goal = self.chance.choice(self.rules.goals)
        return _SPACE_BEFORE.sub("", " ".join(self.towards(START, goal)))

    def befores(self) -> Iterator[str]:
        """What may have been said before: a sentence each of some topics."""
        topics = _orders(self.lexicon, self.language)
        for _ in range(BEFORE):
            few = self.chance.sample(topics, min(BEFORE, len(topics)))
            yield ". ".join(map(self.chance.choice, few))

    def towards(self, name: str, goal: Production) -> list[str]:
        """Words for a rule that lead to an entry of it or of a rule further in."""
        if name == goal.rule:
            return self.template(self.chance.choice(goal.templates))
        distance = self.rules.distances(goal.rule)
        nearer = distance[name] - 1

        def leads(template: Template) -> bool:
            return any(
                part.is_rule and distance.get(part.name, DEEPEST) == nearer
                for part in parts_of(template)
            )

        def lead(template: Template) -> list[str]:
            match template:
                case Sequence(parts):
                    through = self.chance.choice([part for part in parts if leads(part)])
                    return [
                        word
                        for part in parts
                        for word in (lead(part) if part is through else self.template(part))
                    ]
                case Choice(alternatives):
                    return lead(self.chance.choice([each for each in alternatives if leads(each)]))
                case Part(part):
                    return self.towards(part, goal)
                case _:
                    raise AssertionError(template)

        ways = [way for way in self.rules.ways[name] if leads(way)]
        return lead(self.chance.choices(ways, list(map(_ease, ways)))[0])

    def rule(self, name: str) -> list[str]:
        """Words for a rule: short ones, and rather a name than a word that stands for one."""
        self.used += 1
        deepest = self.rules.depths[name] - (1 if self.used > ROOM else 0)
        ways = [way for way in self.rules.ways[name] if self.depth(way) <= deepest]
        return self.template(self.chance.choices(ways, list(map(_ease, ways)))[0])

    def template(self, template: Template) -> list[str]:
        match template:
            case Word(text):
                return [text]
            case Sequence(parts):
                return [word for part in parts for word in self.template(part)]
            case Choice(alternatives):
                if NOTHING in alternatives and self.chance.random() < SPARING:
                    return []
                sayable = [each for each in alternatives if self.depth(each) < DEEPEST]
                return self.template(self.chance.choice(sayable or alternatives))
            case Part(name, _, True):
                return self.rule(name)
            case Part(name):
                return self.slot(name).split()

    def slot(self, name: str) -> str:
        names = names_for("kind" if name == "kinds" else name, self.lexicon)
        if name in ("kind", "kinds"):
            ways = [kind_words(kind, self.language) for kind in names]
            names = [word for one, many in ways for word in (one if name == "kind" else many)]
        listed = self.language.lists.get(name)
        if listed:
            names = [*names, *(" ".join(way) for ways in listed.values() for way in ways)]
        words: list[str] = (
            self.language.speech.get(name, {}).get("words", []) if name in LOCATED else []
        )
        return self.chance.choice(
            names or words or FILLED.get(name) or self.known(name) or ["robot"]
        )

    def known(self, name: str) -> list[str]:
        """What a slot matches that only the names of the world fill, such as {place_tail}."""
        found: list[str] = []
        trie = names_of(self.language, self.lexicon).tries.get(name)
        todo = [("", trie)] if trie else []
        while todo:
            words, node = todo.pop()
            found += [words] if node.values else []
            todo += [(f"{words} {word}".strip(), each) for word, each in node.branches.items()]
        return sorted(each for each in found if any(map(str.isalnum, each)))

    def depth(self, template: Template) -> int:
        return _depth(template, self.rules.depths)


class _Rules:
    """The sayable entries of the rules and how far each is from another."""

    def __init__(self, language: Language, routines: bool) -> None:
        unsaid = PARTS_OF_NAMES if routines else UNSAID
        self.ways: dict[str, list[Template]] = {}
        """The likely templates of each rule; without routines, none that speak of them."""
        entries: dict[str, list[Production]] = {}
        for name, productions in language.rules.items():
            usual = [each for each in productions if each.cost < LIKELY]
            sayable = [each for each in usual if not _slots(each.templates) & unsaid]
            entries[name] = sayable or usual
            self.ways[name] = [way for each in entries[name] for way in each.templates]
        self.depths = self._depths()
        reached = {
            name for name in self.ways if self.depths[name] < DEEPEST and self._leads_to(name)
        }
        self.goals: tuple[Production, ...] = tuple(
            each for name in sorted(reached) for each in entries[name] if each.means
        )

    def _depths(self) -> dict[str, int]:
        """How deep the shortest sentence of each rule goes into the rules."""
        depths: dict[str, int] = {}
        for _ in range(DEEPEST):
            for name, ways in self.ways.items():
                shortest = min((_depth(way, depths) for way in ways), default=DEEPEST)
                depths[name] = min(DEEPEST, 1 + shortest)
        return depths

    def _leads_to(self, name: str) -> bool:
        return START in self.distances(name)

    @functools.cache  # noqa: B019 - the rules of a language live as long as the language
    def distances(self, goal: str) -> Mapping[str, int]:
        """How many rules lie between each rule and the goal."""
        found = {goal: 0}
        todo = [goal]
        for name in todo:
            for user in self.users.get(name, ()):
                if user not in found:
                    found[user] = found[name] + 1
                    todo.append(user)
        return found

    @functools.cached_property
    def users(self) -> Mapping[str, set[str]]:
        """For each rule the rules that name it."""
        users: dict[str, set[str]] = {}
        for name, ways in self.ways.items():
            for way in ways:
                for part in parts_of(way):
                    if part.is_rule:
                        users.setdefault(part.name, set()).add(name)
        return users


@functools.lru_cache(maxsize=16)
def _orders(lexicon: Lexicon, language: Language) -> list[list[str]]:
    """For each topic of the help the phrases that are for the robot, not for the application."""
    return [
        orders
        for phrases in samples(lexicon, language.code).values()
        if (orders := [each for each in phrases if understand(each, lexicon, language.code).plan])
    ]


@functools.cache
def _rules(language: Language, routines: bool) -> _Rules:
    return _Rules(language, routines)


def _slots(templates: Iterable[Template]) -> set[str]:
    return {part.name for each in templates for part in parts_of(each) if not part.is_rule}


@functools.cache
def _ease(template: Template) -> float:
    """How readily a template is taken: what takes less, and what names somebody."""
    return (PREFERRED if _slots([template]) & NAMES else 1) / max(1, _least(template)) ** 4


def _least(template: Template) -> int:
    """How many rules and slots a template uses at least."""
    match template:
        case Sequence(parts):
            return sum(map(_least, parts))
        case Choice(alternatives):
            return min(map(_least, alternatives))
    return int(isinstance(template, Part))


def _depth(template: Template, depths: Mapping[str, int]) -> int:
    match template:
        case Sequence(parts):
            return max((_depth(part, depths) for part in parts), default=0)
        case Choice(alternatives):
            return min(_depth(each, depths) for each in alternatives)
        case Part(name, _, True):
            return depths.get(name, DEEPEST)
    return 0
