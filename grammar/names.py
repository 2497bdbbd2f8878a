"""The names of a world and the lists of a language as tries: which words stand for what.

Names may be inflected, owned ("the office of Alice"), and shortened where their kind goes without
saying; kinds of places have a plural. `Slots` finds them in a sentence.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Iterable, Iterator
from typing import Any, Final

import msgspec

from grammar.language import Language
from grammar.lexicon import Lexicon, Name
from grammar.phrases import Phrases
from grammar.wordforms import kind_words, plural

CALLED: Final = frozenset({"person", "place", "object", "furniture", "contact", "routine"})
"""Slots of names that somebody or something goes by."""


class Trie(msgspec.Struct, gc=False):
    """There are thousands, none in a circle: nothing for the garbage collector to look through."""

    branches: dict[str, Trie] = {}
    values: tuple[Any, ...] = ()

    def add(self, words: Iterable[str], value: Any) -> None:
        node = self
        for word in words:
            node = node.branches.setdefault(word, Trie())
        if value not in node.values:
            node.values += (value,)


class Names:
    """The names that a language and a lexicon give together: a trie for each slot."""

    def __init__(self, language: Language, lexicon: Lexicon) -> None:
        self.language = language
        self.lexicon = lexicon
        self.tries: dict[str, Trie] = {}
        self.beginning: dict[str, set[str]] = {}
        """The slots whose names begin with a word."""
        self.words: set[str] = set()
        self.called: set[str] = set()
        """Those of them that people, places and things are called by."""
        self.spelled: set[str] = set()
        """The names as people write and speak them."""
        self._places()
        full = {self.language.tokens_of(each.name) for each in lexicon.people}
        for name in lexicon.people:
            self._add_name("person", name)
            for part in self._parts(name):
                if (part,) not in full:
                    self._add_words("person", (part,), name)
            for word in (name.kind or "", plural(name.kind or "", language)):
                if word and word not in language.words:  # "porter" carries things in French
                    self._add("person_kind", word, name.kind)
            for owner in self.language.speech.get("bare_possessive", ()):
                for text in (name.name, *name.aliases):
                    self._add_words("owner", language.tokens_of(f"{text}{owner}"), name)
        for thing in lexicon.objects:
            for text in (thing.name, *thing.aliases):
                for form in self._forms(text):
                    self._add("object", form, thing.name)
        for described in (*lexicon.objects, *lexicon.furniture):
            for attribute in described.attributes:
                self._add("quality", attribute, attribute)
        for furniture in lexicon.furniture:
            for text in (furniture.name, *furniture.aliases):
                for variant in self._variants(text):
                    self._add("furniture", variant, furniture.name)
            if furniture.kind:
                self._add("furniture", furniture.kind, furniture.kind)
        for contact in lexicon.contacts:
            self._add("contact", contact, contact)
        for contact_name in lexicon.contact_aliases:
            for text in contact_name.aliases:
                for variant in self._variants(text):
                    self._add("contact", variant, contact_name.name)
        for question in lexicon.questions:
            for text in (question.question, *question.aliases):
                for words in self._asked(language.tokens_of(text.rstrip("?"))):
                    self._add_words("question", words, question)
        for slot, known in (
            ("gesture", lexicon.gestures),
            ("emotion", lexicon.emotions),
            ("joint", lexicon.joints),
            ("skill", lexicon.skills),
        ):
            for each in known:
                self._add(slot, each.replace("_", " "), each)
        for routine in lexicon.routines:
            self._add("routine", routine.name, routine)
        if lexicon.robot_name:
            self._add("robot_name", lexicon.robot_name, lexicon.robot_name)
        for name_of_list, values in language.lists.items():
            for value, ways in values.items():
                for way in ways:
                    self._add_words(name_of_list, way, value)

    def _places(self) -> None:
        for place in self.lexicon.places:
            self._add_name("place", place)
            for text in (place.name, *place.aliases):
                self._shorter(place, text)
        for area in dict.fromkeys(place.inside for place in self.lexicon.places if place.inside):
            self._add("area", area, area)
        for kind in self.lexicon.place_kinds:
            one, many = kind_words(kind, self.language)
            for word in one:
                self._add("kind", word, kind)
            for word in many:
                self._add("kinds", word, kind)

    def _shorter(self, place: Name, text: str) -> None:
        """What is left of a place's name where its kind goes without saying: "supply" of "supply
        room", "b" of "ward b" after "ward a"."""
        *before, last = self.language.tokens_of(text)
        if not before:
            return
        kinds = {word for kind in kind_words(place.kind or "", self.language) for word in kind}
        if len(last) == 1 or last.isdigit():
            self._add_words("place_tail", (last,), place)
        elif last in kinds and not {*before} <= self.language.closed and len(before[-1]) > 2:
            self._add_words("place_short", tuple(before), place)

    def _parts(self, person: Name) -> Iterable[str]:
        """First and last name of "Dr. Eve Miller", where neither is a word of the language."""
        titles = self.language.speech.get("personal_titles", ())
        for text in (person.name, *person.aliases):
            words = self.language.tokens_of(text)
            bare = [word for word in words if word not in titles]
            for part in (bare[0], bare[-1]) if len(words) > 1 and bare else ():
                if part not in self.language.words and part not in self.language.closed:
                    yield part

    def _asked(self, words: tuple[str, ...]) -> Iterable[tuple[str, ...]]:
        """A question; without its articles; as it is put to others: "when visiting hours are"."""
        articles = self.language.speech.get("articles", ())
        bare = tuple(word for word in words if word not in articles)
        for form in dict.fromkeys((words, bare)):
            yield form
            if len(form) > 2 and form[1] in self.language.speech.get("turned_verbs", ()):
                for article in articles:
                    yield (*form[:2], article, *form[2:])
                yield (form[0], *form[2:], form[1])

    def _add_name(self, slot: str, name: Name) -> None:
        for text in (name.name, *name.aliases):
            for variant in self._variants(text):
                self._add(slot, variant, name)

    def _variants(self, text: str) -> Iterable[str]:
        """ "Alice's office" is also "the office of Alice", and written "Alices office";
        names may be inflected."""
        yield text
        for pattern, *others in self.language.speech.get("name_forms", ()):
            if re.search(pattern, text):
                yield from (re.sub(pattern, other, text) for other in others)
        mark = self.language.speech.get("possessive")
        if mark and mark in text:
            owner, _, owned = text.partition(mark)
            for pattern in self.language.speech.get("possessive_forms", ()):
                yield pattern.format(owner=owner, owned=owned.strip())

    @functools.cached_property
    def known(self) -> frozenset[str]:
        """All words that are spelled right: of the rules, of the names, and function words."""
        return frozenset(self.language.words | self.words | self.language.closed)

    @functools.cached_property
    def people(self) -> Phrases:
        """Whatever people are called by."""

        def ways(node: Trie) -> Iterator[tuple[str, ...]]:
            if node.values:
                yield ()
            for word, branch in node.branches.items():
                yield from ((word, *rest) for rest in ways(branch))

        return Phrases(ways(self.tries.get("person", Trie())))

    def _forms(self, text: str) -> tuple[str, ...]:
        forms = (text, plural(text, self.language))
        return tuple(dict.fromkeys(each for form in forms for each in self._variants(form)))

    def _add(self, slot: str, text: str, value: Any) -> None:
        self.spelled.add(text)
        self._add_words(slot, self.language.tokens_of(text), value)

    def _add_words(self, slot: str, words: tuple[str, ...], value: Any) -> None:
        if words:
            self.tries.setdefault(slot, Trie()).add(words, value)
            self.beginning.setdefault(words[0], set()).add(slot)
            self.words.update(words)
            if slot in CALLED:
                self.called.update(words)


@functools.lru_cache(maxsize=16)
def names_of(language: Language, lexicon: Lexicon) -> Names:
    """The names, made once for a language and a lexicon."""
    return Names(language, lexicon)
