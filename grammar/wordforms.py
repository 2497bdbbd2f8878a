"""Singular and plural of nouns, by the endings that a language lists."""

from __future__ import annotations

from collections.abc import Callable

from grammar.language import Language


def plural(noun: str, language: Language) -> str:
    """The plural of a noun phrase in the singular."""
    return _changed(noun, language, _plural)


def singular(noun: str, language: Language) -> str:
    """The singular of a noun phrase; unchanged if it is none of the plurals the language knows."""
    return _changed(noun, language, _singular)


def kind_words(kind: str, language: Language) -> tuple[list[str], list[str]]:
    """The words for a kind of place: for one, and for several."""
    entry = language.kinds.get(kind, {})
    one = entry.get("one", [kind])
    return one, entry.get("many") or [plural(word, language) for word in one]


def _changed(noun: str, language: Language, change: Callable[[str, Language], str]) -> str:
    """A noun phrase with the words changed that have a number: the last one, or, where the
    language says what ends them ("bouteilles d'eau"), all before that."""
    words = noun.split() or [""]
    ends = language.plurals.get("until")
    if ends is None:
        return " ".join((*words[:-1], change(words[-1], language)))
    last = next(
        (at for at, word in enumerate(words) if f"{word} ".startswith(tuple(ends))), len(words)
    )
    return " ".join((*(change(word, language) for word in words[:last]), *words[last:]))


def _plural(word: str, language: Language) -> str:
    many = language.plurals.get("irregular", {}).get(word.lower())
    if many is not None:
        return str(many)
    for one_ending, many_ending in language.plurals.get("endings", ()):
        if word.lower().endswith(one_ending):
            return word[: len(word) - len(one_ending)] + str(many_ending)
    return word


def _singular(word: str, language: Language) -> str:
    low = word.lower()
    if low in language.plurals.get("unchanged", ()):
        return word
    for one, many in language.plurals.get("irregular", {}).items():
        if low == many:
            return str(one)
    for one_ending, many_ending in language.plurals.get("singular_endings", ()):
        if low.endswith(many_ending) and len(low) > len(many_ending) + 1:
            return word[: len(word) - len(many_ending)] + str(one_ending)
    return word
