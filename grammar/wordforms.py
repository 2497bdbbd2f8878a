"""Singular and plural of nouns, by the endings that a language lists."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping

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


def head_word(noun: str, language: Language) -> str:
    """The noun itself in a noun phrase: "cup" of "red cup", "glass" of "glass of water"."""
    words = noun.split() or [""]
    before = next(
        (
            at
            for at, word in enumerate(words)
            if at and word in language.speech.get("noun_joins", ())
        ),
        None,
    )
    if language.plurals.get("until"):
        return words[0]
    return words[-1 if before is None else before - 1]


def _changed(noun: str, language: Language, change: Callable[[str, Language], str]) -> str:
    """A noun phrase with the words changed that have a number: the last one, or, where the
    language says what ends them ("bouteilles d'eau"), all before that."""
    words = noun.split() or [""]
    ends = language.plurals.get("until")
    if ends is None:  # "boxes of gloves" is several boxes
        joins = language.speech.get("noun_joins", ())
        head = next((at - 1 for at, word in enumerate(words) if at and word in joins), -1)
        if head >= 0 and change is _singular:  # "glasses of water" are no spectacles
            words[head] = _by_endings(words[head], language)
        else:
            words[head] = change(words[head], language)
        return " ".join(words)
    last = next(
        (at for at, word in enumerate(words) if f"{word} ".startswith(tuple(ends))), len(words)
    )
    return " ".join((*(change(word, language) for word in words[:last]), *words[last:]))


def _last_part(
    word: str, table: Mapping[str, object], language: Language
) -> tuple[str | None, str]:
    """The word of the table that this is or, where the language writes compounds in one, ends in;
    and what stands before it: "Besucherstuhl" is a chair."""
    low = word.lower()
    if low in table:
        return low, ""
    if language.plurals.get("compounds"):
        for ending in sorted(table, key=len, reverse=True):
            if len(ending) > 3 and low.endswith(ending) and len(low) > len(ending) + 2:
                return ending, word[: len(word) - len(ending)]
    return None, ""


def _plural(word: str, language: Language) -> str:
    table = language.plurals.get("irregular", {})
    one, head = _last_part(word, table, language)
    if one is not None:
        many = str(table[one])
        return head + (many.lower() if head else many)
    if _singular(word, language) != word:
        return word  # "gloves" are several already
    for one_ending, many_ending in language.plurals.get("endings", ()):
        if word.lower().endswith(one_ending):
            return word[: len(word) - len(one_ending)] + str(many_ending)
    return word


@functools.lru_cache(maxsize=4096)
def _singular(word: str, language: Language) -> str:
    low = word.lower()
    if low in language.plurals.get("unchanged", ()):
        return word
    for one, many in language.plurals.get("irregular", {}).items():
        if low == many:
            return str(one)
    ones = {str(many).lower(): one for one, many in language.plurals.get("irregular", {}).items()}
    last, head = _last_part(word, ones, language)
    if last is not None:
        one = str(ones[last])
        return head + one if head else (one.capitalize() if word[:1].isupper() else one)
    return _by_endings(word, language)


def _by_endings(word: str, language: Language) -> str:
    low = word.lower()
    for one_ending, many_ending in language.plurals.get("singular_endings", ()):
        if low.endswith(many_ending) and len(low) > len(many_ending) + 1:
            return word[: len(word) - len(many_ending)] + str(one_ending)
    return word
