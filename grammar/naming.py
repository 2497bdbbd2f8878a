"""What the names of a plan are called in the language spoken.

A plan has the world's own names in it, and the canonical words for kinds and looks ("nurse",
"red"). In a language whose speakers call them otherwise (`speech: {aliases_first: true}`) they go
by their first alias, and by the words that the language lists under `speech: {names: ...}`.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from grammar.language import Language, speech, spoken_name
from grammar.lexicon import Lexicon
from grammar.speech import Speech, fill


@dataclass(frozen=True)
class Naming:
    """The words of one language for the names of one lexicon."""

    names: Mapping[str, str] = field(default_factory=dict)
    """The world's name or canonical word -> what speakers say."""
    looks: Mapping[str, str] = field(default_factory=dict)
    """The same for what tells one thing from others: "red", "waving"."""
    relations: Mapping[str, str] = field(default_factory=dict)
    """The same for what stands between two nouns: "behind", "derrière {the}" where an article
    follows."""
    with_article: Callable[[str], str] = str
    """Puts its definite article before a noun."""
    before_noun: bool = False
    """Whether what stands before a noun stays there."""

    def called(self, text: str) -> str:
        """A name, or a noun phrase around one ("red cup" -> "tasse de couleur rouge"): what stands
        before the noun is said after it."""
        if text in self.relations:
            return self.relations[text].removesuffix(" {the}")
        for known in (self.names, self.looks):
            if text in known:
                return known[text]
        words = text.split()
        for start in range(len(words) - 1):
            for length in range(len(words) - 1 - start, 0, -1):
                relation = self.relations.get(" ".join(words[start : start + length]))
                if relation is None:
                    continue
                if start:
                    first = self.called(" ".join(words[:start]))
                    return f"{first} {self.called(' '.join(words[start:]))}"
                noun = self.called(" ".join(words[length:]))
                if "{the}" in relation:
                    return relation.format(the=self.with_article(noun))
                return f"{relation} {noun}"
        for known in (self.names, self.looks):
            for length in range(len(words), 0, -1):
                for start in range(len(words) - length + 1):
                    called = known.get(" ".join(words[start : start + length]))
                    if called is not None:
                        first = " ".join(words[:start])
                        before = [self.called(first)] if first else []
                        after = words[start + length :]
                        if known is self.looks and after and not (before or self.before_noun):
                            # "red apron", a noun that has no other name
                            return f"{self.called(' '.join(after))} {called}"
                        stays = self.before_noun or first in self.relations
                        told = [*before, called] if stays else [called, *before]
                        return " ".join((*told, *([self.called(" ".join(after))] if after else [])))
        return text


@functools.lru_cache(maxsize=16)
def naming(lexicon: Lexicon, language: Language) -> Naming:
    """The naming of a lexicon, made once."""
    if not language.speech.get("aliases_first"):
        return Naming()
    names: dict[str, str] = dict(language.speech.get("names", {}))
    known = (
        *lexicon.contact_aliases,
        *lexicon.objects,
        *lexicon.furniture,
        *lexicon.people,
        *lexicon.places,
    )
    names |= {name.name: name.aliases[0] for name in known if name.aliases}
    looks: dict[str, str] = language.speech.get("looks", {})
    relations: dict[str, str] = language.speech.get("relations", {})
    return Naming(
        names,
        looks,
        relations,
        functools.partial(the, language=language),
        bool(language.speech.get("adjectives_first")),
    )


def _words(language: Language) -> Speech | None:
    """How the language puts nouns into sentences, if it says so for single nouns."""
    return speech(language.code) if language.speech.get("aliases_first") else None


def the(noun: str, language: Language) -> str:
    """The noun with its definite article, as the phrases of the application have it."""
    words = _words(language)
    return words.joined_up(words.nouns.the(noun)) if words else language.phrase("the", noun=noun)


def some(noun: str, language: Language) -> str:
    """The noun with its indefinite article."""
    words = _words(language)
    if words is not None:
        return words.joined_up(words.nouns.indefinite(noun))
    for pattern, form in language.speech.get("indefinite", ()):
        if re.match(pattern, noun, re.IGNORECASE):
            return str(form).format(noun=noun)
    return language.phrase("a", noun=noun)


def person_called(called: str, language: Language) -> str:
    """Somebody as they are spoken of: "Alice", but "le docteur Martin"."""
    return the(called, language) if called[:1].islower() and _words(language) else called


def place_called(name: str, lexicon: Lexicon, language: Language) -> str:
    """A place as it stands in a sentence: "the kitchen", "la cuisine"."""
    called = naming(lexicon, language).called(name)
    words = _words(language)
    return words.joined_up(words.nouns.the(called)) if words else spoken_name(called, language)


def listed(names: Sequence[str], language: Language) -> str:
    """ "ward a, ward b and ward c"."""
    *first, last = names
    two = speech(language.code).durations.two
    return fill(two, {"first": ", ".join(first), "last": last}) if first else last


def joined_up(text: str, language: Language) -> str:
    """A text put together from parts, its little words run together as people do: "au bureau"."""
    words = _words(language)
    return words.joined_up(text) if words else text
