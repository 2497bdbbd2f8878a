"""Sample sentences: the help ("what can I say?") and suggestions.

All are made from the language's own data and the names of the lexicon, so they parse.
"""

from __future__ import annotations

import functools
import re
from typing import Final

from grammar.language import Language, load_language
from grammar.lexicon import Lexicon
from grammar.naming import joined_up, naming, place_called, the

_SLOT: Final = re.compile(r"\{(\w+)(!the)?\}")
NAMED: Final = 2
"""How often each of the sayings is told, with other names."""
ALIKE: Final = 86
"""From where on, of 100, two words are the same but for an ending: "tie" is not "time"."""


def samples(lexicon: Lexicon, language: str = "en") -> dict[str, list[str]]:
    """Example phrases by topic for this world and robot; all of them are understood."""
    return _samples(lexicon, load_language(language))


@functools.lru_cache(maxsize=16)
def _samples(lexicon: Lexicon, language: Language) -> dict[str, list[str]]:
    result: dict[str, list[str]] = {}
    for topic, examples in language.help.items():
        phrases = [said for each in examples if (said := filled(each, lexicon, language))]
        if phrases:
            result[topic] = phrases
    return result


@functools.lru_cache(maxsize=16)
def all_samples(lexicon: Lexicon, code: str = "en") -> tuple[str, ...]:
    """The same examples with every name of this world in every slot, one after the other, and what
    else people say with some names: from whole sentences a recogniser learns which words stand
    together."""
    language = load_language(code)
    examples = [example for topic in language.help.values() for example in topic]
    slots = {slot for one in examples for slot, _ in _slots(one)}
    most = max((len(names_for(slot, lexicon)) for slot in slots), default=1)
    helpful = (filled(one, lexicon, language, shift) for shift in range(most) for one in examples)
    # Each with other names: those of the world get their turn all the same.
    said = (
        filled(one, lexicon, language, NAMED * number + shift)
        for number, one in enumerate(language.sayings)
        for shift in range(NAMED)
    )
    return tuple(dict.fromkeys(each for each in (*helpful, *said) if each))


def _slots(example: str) -> list[tuple[str, str]]:
    return _SLOT.findall(example)


def filled(example: str, lexicon: Lexicon, language: Language, shift: int = 0) -> str | None:
    """The example with names of the lexicon in its slots, from the one of this number on; None
    where there are none."""
    used: dict[str, int] = {}

    def fill(match: re.Match[str]) -> str:
        slot = match.group(1)
        names = names_for(slot, lexicon)
        number = used.get(slot, 0)
        used[slot] = number + 1
        if number >= len(names):
            raise LookupError(slot)
        name = names[(number + shift) % len(names)]
        if slot == "place":
            return place_called(name, lexicon, language)
        name = naming(lexicon, language).called(name)
        return the(name, language) if match.group(2) else name

    try:
        return joined_up(_SLOT.sub(fill, example), language)
    except LookupError:
        return None


def _chargers(lexicon: Lexicon) -> set[str]:
    return {place.name for place in lexicon.places if place.kind == "charger"}


def names_for(slot: str, lexicon: Lexicon) -> list[str]:
    return {
        # Nobody is led to a charging station, and no crowd is counted there.
        "place": sorted(
            (place.name for place in lexicon.places), key=_chargers(lexicon).__contains__
        ),
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


def nearest_phrases(text: str, whole: str, lexicon: Lexicon, language: Language) -> list[str]:
    """Up to three example phrases like a text, the nearest first: those that share at least half
    of their own words with it, and half of its words; and what they are about, their first word or
    two others, with the whole sentence that it is a part of."""
    from rapidfuzz import fuzz, process

    said = _telling_words(text, language)
    in_whole = _telling_words(whole, language)
    near: list[tuple[float, str]] = []
    for phrase in (phrase for each in _samples(lexicon, language).values() for phrase in each):
        words = _telling_words(phrase, language)
        shared = [
            process.extractOne(word, said, scorer=fuzz.ratio, score_cutoff=ALIKE) for word in words
        ]
        found = {each[0] for each in shared if each is not None}
        part = sum(each is not None for each in shared) / max(1, len(words))
        about = len(found) > 1 or fuzzy_in(words[:1], in_whole)
        if about and part >= 0.5 and 2 * len(found) >= len(set(said)):
            near.append((part + fuzz.token_sort_ratio(text.lower(), phrase) / 1000, phrase))
    return [phrase for _, phrase in sorted(near, key=lambda each: -each[0])[:3]]


def fuzzy_in(words: list[str], among: list[str]) -> bool:
    """Whether all these words are among others, but for a slip."""
    from rapidfuzz import fuzz, process

    return all(
        process.extractOne(each, among, scorer=fuzz.ratio, score_cutoff=ALIKE) for each in words
    )


def _telling_words(text: str, language: Language) -> list[str]:
    """The words of a text that say something."""
    return [
        word for word in language.tokens_of(text) if word.isalpha() and word not in language.closed
    ]
