"""Singular and plural of nouns, by the endings that a language lists."""

from __future__ import annotations

from grammar.language import Language


def plural(noun: str, language: Language) -> str:
    """The plural of a noun phrase in the singular: its last word changes."""
    *before, last = noun.split() or [""]
    irregular = language.plurals.get("irregular", {})
    many = irregular.get(last.lower())
    if many is None:
        for one_ending, many_ending in language.plurals.get("endings", ()):
            if last.lower().endswith(one_ending):
                many = last[: len(last) - len(one_ending)] + many_ending
                break
        else:
            many = last
    return " ".join((*before, many))


def singular(noun: str, language: Language) -> str:
    """The singular of a noun phrase; unchanged if it is none of the plurals the language knows."""
    *before, last = noun.split() or [""]
    low = last.lower()
    if low in language.plurals.get("unchanged", ()):
        return noun
    for one, many in language.plurals.get("irregular", {}).items():
        if low == many:
            return " ".join((*before, one))
    for one_ending, many_ending in language.plurals.get("singular_endings", ()):
        if low.endswith(many_ending) and len(low) > len(many_ending) + 1:
            return " ".join((*before, last[: len(last) - len(many_ending)] + one_ending))
    return noun
