"""People who are only known by what is theirs: whoever has "Arthur's office" is called Arthur.

A world need not list everybody who works in the house. A place that is called after somebody says
enough for "ask Arthur" to be understood, and where to look for him.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from typing import Final

from grammar.language import Language, load_language
from grammar.lexicon import Lexicon, Name

NAME: Final = r"(?:(?:Dr|Mr|Mrs|Ms|Prof)\.? )?\w[\w-]+(?: [A-Z][\w-]+)?"
"""What somebody may be called: "Arthur", "Dr. Weber", "Eve Miller"."""


def with_owners(lexicon: Lexicon, code: str) -> Lexicon:
    """The same names, and those of the people after whom places are called."""
    language = load_language(code)
    known = {each.lower() for one in lexicon.people for each in (one.name, *one.aliases)}
    owners = dict.fromkeys(
        owner
        for place in lexicon.places
        for text in (place.name, *place.aliases)
        for owner in _owners(text, language)
        if owner.lower() not in known
    )
    return replace(lexicon, people=(*lexicon.people, *map(Name, owners))) if owners else lexicon


def _owners(place: str, language: Language) -> Iterator[str]:
    """The name in a place's name. Words of the language are no names: nobody is called Children
    because of the children's ward."""
    for form in language.speech.get("named_after", ()):
        found = re.search(form.format(owner=f"({NAME})"), place)
        if found and _is_name(found[1], language):
            yield found[1]


def _is_name(words: str, language: Language) -> bool:
    titles = language.speech.get("personal_titles", ())
    *_, last = norms = language.tokens_of(words)
    return last not in titles and not any(
        word in language.words or word in language.closed for word in norms if word not in titles
    )
