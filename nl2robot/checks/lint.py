"""The names of a world, looked at by somebody who has to say them.

The loader refuses a world whose names contradict each other (`sim.world.model`). This finds what is
allowed and still goes wrong when people speak: names that sound alike, names that are words of
commands, names by which nothing can be reached, words that the speech model cannot hear.
"""

from __future__ import annotations

import itertools
import re
import unicodedata
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

import msgspec

from grammar.language import Language, languages, load_language
from grammar.lexicon import EMPTY, Lexicon, Name
from grammar.plan import Text
from grammar.samples import samples
from grammar.tidy import nodes
from grammar.understand import understand
from nl2robot.knowledge import Knowledge
from nl2robot.models import catalogue as models
from nl2robot.speech.hear.recogniser import Recogniser
from nl2robot.speech.hear.vocabulary import missing_words
from sim.world.builtin import BUILTIN, builtin_worlds
from sim.world.fields import compose
from sim.world.loading import load_world
from sim.world.model import World
from sim.world.yaml_nodes import MappingNode, Node, ScalarNode, SequenceNode

SHORTEST: Final = 4
"""Letters of words that may be one slip apart; in shorter ones a slip makes another word."""
LONG: Final = 8
"""Letters of words in which two slips are easily overheard."""
ALIKE: Final = 60
"""How much of the letters two words of the same sound must share, in percent."""


class Finding(msgspec.Struct, frozen=True):
    """Something about a name that somebody should mend."""

    file: str
    line: int
    """0 where it is not known."""
    severity: Literal["error", "warning"]
    """An error keeps a sentence from doing what it says; a warning makes mistakes likely."""
    code: str
    """sounds-alike | command-word | not-reached | same-name | not-heard"""
    language: str
    message: str


@dataclass(frozen=True)
class Called:
    """An entry of the world and one of the ways to call it."""

    section: str
    """ "places", "people", "objects", "furniture", "contacts"."""
    name: str
    text: str
    """The name itself or an alias."""

    @property
    def told(self) -> str:
        what = {
            "places": "place",
            "people": "person",
            "objects": "object",
            "furniture": "piece of furniture",
            "contacts": "contact",
        }[self.section]
        alias = "" if self.text == self.name else f" (a name of “{self.name}”)"
        return f"the {what} “{self.text}”{alias}"


def lint(name_or_path: str, languages: Sequence[str] | None = None) -> list[Finding]:
    """What is wrong with the names of a world in these languages (default: English and all in
    which the world has names), by line. Raises `WorldError` where the world cannot be read."""
    world = load_world(name_or_path, names_only=True)
    file = BUILTIN / f"{name_or_path}.yaml" if name_or_path in builtin_worlds() else name_or_path
    lines = lines_of(Path(file))
    found = [
        msgspec.structs.replace(finding, file=str(name_or_path), line=lines.get(where, 0))
        for language in languages or languages_of(world)
        for where, finding in _Linter(world, language).findings()
    ]
    return sorted(found, key=lambda each: (each.line, each.severity, each.message))


def languages_of(world: World) -> list[str]:
    """The languages that can be spoken here: English, and those in which things have names."""
    aliases = [
        *(place.aliases for place in world.places),
        *(person.aliases for person in world.people),
        *(thing.aliases for thing in world.objects),
        *(piece.aliases for piece in world.furniture),
    ]
    named = {code for each in aliases for code in each} | {"en"}
    return [code for code in languages() if code in named]


def lines_of(file: Path) -> dict[tuple[str, str], int]:
    """The line of each name and alias, by section of the file."""
    lines: dict[tuple[str, str], int] = {}

    def texts(node: Node) -> Iterator[ScalarNode]:
        match node:
            case ScalarNode():
                yield node
            case SequenceNode(value=children):
                for child in children:
                    yield from texts(child)
            case MappingNode(value=pairs):
                for _, child in pairs:
                    yield from texts(child)

    def fields(node: Node) -> dict[str, Node]:
        pairs = node.value if isinstance(node, MappingNode) else []
        return {key.value: value for key, value in pairs if isinstance(key, ScalarNode)}

    for section, entries in fields(compose(file)).items():
        for entry in entries.value if isinstance(entries, SequenceNode) else ():
            if isinstance(entry, ScalarNode):
                lines.setdefault((section, entry.value), entry.line)
            for key, value in fields(entry).items():
                for text in texts(value) if key in ("name", "aliases") else ():
                    lines.setdefault((section, text.value), text.line)
    return lines


class _Linter:
    """Looks at the names of a world in one language."""

    def __init__(self, world: World, language: str) -> None:
        self.world = world
        self.language: Language = load_language(language)
        self.lexicon: Lexicon = Knowledge(world).lexicon(language)
        self.names = list(dict.fromkeys(self._names()))

    def _names(self) -> Iterator[Called]:
        """Every name as it is said in this language: not the world's own name where those who
        speak the language have another."""
        foreign = self.language.speech.get("aliases_first", False)
        for section, entries in (
            ("places", self.lexicon.places),
            ("people", self.lexicon.people),
            ("objects", self.lexicon.objects),
            ("furniture", self.lexicon.furniture),
        ):
            for entry in entries:
                own = () if foreign and entry.aliases else (entry.name,)
                for text in (*own, *entry.aliases):
                    yield Called(section, entry.name, text)
        for contact in self.lexicon.contacts:
            yield Called("contacts", contact, contact)

    def findings(self) -> Iterator[tuple[tuple[str, str], Finding]]:
        """The findings, each with the section and the text that it is about."""
        for called in self.names:
            finding = self.not_reached(called) or self.command_word(called)
            if finding:
                yield (called.section, called.text), finding
        for one, other in itertools.combinations(self.names, 2):
            finding = self.same_name(one, other) or self.sounds_alike(one, other)
            if finding:
                yield (other.section, other.text), finding
        yield from self.not_heard()

    # --- one name

    def command_word(self, called: Called) -> Finding | None:
        """A name that is a command, or a word that commands are made of. Sentences reach it, but
        not all that people would say."""
        words = self.words(called.text)
        alone = understand(called.text, EMPTY, self.language.code)
        if alone.plan is not None or alone.request is not None:
            return self.warning(
                "command-word",
                f"“{called.text}” by itself is a command, so {called.told} is not meant by it."
                " Give it another name.",
            )
        silent = self.language.closed | {word for each in self.language.fillers for word in each}
        if words and all(word in silent for word in words):
            return self.warning(
                "command-word",
                f"“{called.text}” is one of the words that sentences are made of, so"
                f" {called.told} is easily missed. Give it another name.",
            )
        return None

    def not_reached(self, called: Called) -> Finding | None:
        """A name by which no sentence gets at its entry."""
        reasons = []
        for sentence in self.examples(called):
            understood = understand(sentence, self.lexicon, self.language.code)
            if understood.plan is not None:
                steps = nodes(understood.plan.steps)
                texts = [each.value for each in steps if isinstance(each, Text)]
                if any(called.name in text for text in texts):
                    return None
                reasons.append(f"“{sentence}” is understood otherwise: {', '.join(texts)}")
            else:
                why = (understood.message or "").split(". ")[0]
                reasons.append(f"“{sentence}” is not understood: {why}")
        if not reasons:
            return None
        return self.error(
            "not-reached",
            f"No sentence reaches {called.told}. {reasons[0].rstrip('.')}."
            " Give it another name, or an alias.",
        )

    def examples(self, called: Called) -> list[str]:
        """Example sentences with this name and no other."""
        names = (Name(called.text),)
        match called.section:
            case "places":
                only = Lexicon(places=names)
            case "people":
                only = Lexicon(people=names)
            case "objects":
                only = Lexicon(objects=names)
            case _:  # the help says nothing of furniture, and contacts are called by one sentence
                return []
        plain = {phrase for each in samples(EMPTY, self.language.code).values() for phrase in each}
        filled = samples(only, self.language.code).values()
        return [phrase for each in filled for phrase in each if phrase not in plain]

    def not_heard(self) -> Iterator[tuple[tuple[str, str], Finding]]:
        """Words that the speech model does not know, if it is installed."""
        recogniser = self.recogniser()
        if recogniser is None:
            return

        for missing in missing_words(recogniser, [called.text for called in self.names]):
            spoken = re.compile(rf"\b{re.escape(missing.word)}\b", re.IGNORECASE)
            where = next((each for each in self.names if spoken.search(each.text)), None)
            if where is not None and not self.heard_otherwise(recogniser, where):
                yield (where.section, where.text), self.warning("not-heard", missing.message)

    def heard_otherwise(self, recogniser: Recogniser, called: Called) -> bool:
        """Whether the entry has another name that can be heard."""
        return any(
            not recogniser.unknown_words([each.text])
            for each in self.names
            if (each.section, each.name) == (called.section, called.name)
        )

    def recogniser(self) -> Recogniser | None:
        try:
            folder = models.find(self.language.code)
        except models.ModelError:  # there is none for this language
            return None
        if folder is None:
            return None

        return Recogniser(folder, self.language.code)

    # --- two names

    def same_name(self, one: Called, other: Called) -> Finding | None:
        """One name for two things of different sorts."""
        if self.words(one.text) != self.words(other.text) or one.section == other.section:
            return None
        sections = {one.section, other.section}
        if "contacts" in sections or self.stands_there(one, other):
            return None  # who can be visited can be called
        harmless = sections == {"objects", "furniture"}
        message = (
            f"{_capital(other.told)} goes by the name of {one.told}, so it depends on the"
            " sentence which one is meant. Give one of them another name."
        )
        return self.warning("same-name", message) if harmless else self.error("same-name", message)

    def stands_there(self, one: Called, other: Called) -> bool:
        """Whether one is a piece of furniture in the place that is the other."""
        both = {one.section: one.name, other.section: other.name}
        return both.keys() == {"places", "furniture"} and any(
            piece.name == both["furniture"] and piece.inside == both["places"]
            for piece in self.lexicon.furniture
        )

    def sounds_alike(self, one: Called, other: Called) -> Finding | None:
        same = (one.section, one.name) == (other.section, other.name)
        if same or (one.section == "contacts") != (other.section == "contacts"):
            return None  # nobody calls a place, or goes to a contact
        first, second = self.words(one.text), self.words(other.text)
        differing = [(a, b) for a, b in zip(first, second, strict=False) if a != b]
        if len(first) != len(second) or len(differing) != 1:
            return None
        a, b = differing[0]
        if not alike(self.spelled(a), self.spelled(b)):
            return None
        return self.warning(
            "sounds-alike",
            f"{_capital(other.told)} sounds or looks like {one.told}. Give one of them a name"
            " that cannot be mistaken.",
        )

    def words(self, text: str) -> tuple[str, ...]:
        return self.language.tokens_of(text)

    def spelled(self, word: str) -> str:
        """A number as a word; two names often differ in nothing else."""
        if not word.isdigit():
            return word
        numbers = {f"{value:g}": name for name, value in self.language.spelling.numbers.items()}
        return numbers.get(word, word)

    # --- findings

    def error(self, code: str, message: str) -> Finding:
        return Finding("", 0, "error", code, self.language.code, message)

    def warning(self, code: str, message: str) -> Finding:
        return Finding("", 0, "warning", code, self.language.code, message)


# --- what sounds alike ---------------------------------------------------------------------------

_CLASSES: Final = (
    ("ph|f|v|w", "1"),
    ("b|p", "2"),
    ("sch|sh|ch|tz|c(?=[eiy])|[szxß]", "3"),
    ("[ckqg]+", "4"),
    ("d|th|t", "5"),
    ("l", "6"),
    ("m|n", "7"),
    ("r", "8"),
)
"""Letters that are taken for each other by ear, in English, German and French."""


def alike(one: str, other: str) -> bool:
    """Whether two words are easily taken for each other, by ear or by eye."""
    from rapidfuzz import fuzz
    from rapidfuzz.distance import OSA

    if min(len(one), len(other)) < 2 or one.isdigit() or other.isdigit():
        return False
    shortest = min(len(one), len(other))
    slips = 2 if shortest >= LONG else 1 if shortest >= SHORTEST else 0
    if OSA.distance(one, other) <= slips:
        return True
    first, second = sound(one), sound(other)
    if first == second:
        return fuzz.ratio(one, other) >= ALIKE
    # "thirteen" and "thirty" differ by the last sound, which is the first to be lost.
    longer, shorter = max(first, second, key=len), min(first, second, key=len)
    return longer[:-1] == shorter and longer[-1] == "7" and len(shorter) > 1 and one[0] == other[0]


def sound(word: str) -> str:
    """A word as a row of classes of consonants; vowels count at the beginning only."""
    letters = unicodedata.normalize("NFD", word.lower())
    plain = "".join(each for each in letters if each.isalpha() or each == "ß")
    silent = re.sub(r"(?<=[aeiouäöü])h|^h|^k(?=n)|^w(?=r)|gh(?=t)", "", plain)
    code = "0" if silent[:1] in "aeiouy" else ""
    at = 0
    while at < len(silent):
        for pattern, name in _CLASSES:
            match = re.compile(pattern).match(silent, at)
            if match:
                code += "" if code.endswith(name) and at and silent[at - 1] == silent[at] else name
                at = match.end()
                break
        else:
            at += 1
    return code


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def worst(findings: Iterable[Finding]) -> Literal["error", "warning"] | None:
    """The worst severity among the findings."""
    severities = {finding.severity for finding in findings}
    return "error" if "error" in severities else "warning" if severities else None
