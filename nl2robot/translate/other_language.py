"""Whether a sentence that was not understood is in another language: by the words of the grammars.

    language_of("fahr zur Apotheke", "en")    # "de"
    question("de", "en")                      # "You wrote in German. Shall I go on in German? ..."

A word counts for a language if it stands in its rules and lists, and not in those of the language
that is spoken; names of places and people stand in neither, and what is quoted counts for none. The
other languages are loaded the first time that somebody is not understood.
"""

from __future__ import annotations

import functools
import re

from grammar.language import languages, load_language
from grammar.requests import agreed
from grammar.tokens import without_quotations
from nl2robot.words import words_in
from robot_api.capabilities.languages import language_data

_WORD = re.compile(r"[^\W\d_]+")
_SURE = 2
"""Words of the other language that there must be, and how many times as many as of the one that is
spoken; of one or two words, all."""


def language_of(text: str, language: str) -> str | None:
    """The code of the language that a text seems to be in, if it is not the one that is spoken;
    None if that is not sure."""
    words = _WORD.findall(without_quotations(text).casefold())
    found: list[tuple[int, str]] = []
    for code in languages():
        if code == language:
            continue
        theirs, ours = _words(code), _words(language)
        other = sum(word in theirs and word not in ours for word in words)
        own = sum(word in ours and word not in theirs for word in words)
        if (other >= _SURE and other > _SURE * own) or 0 < other == len(words) <= _SURE:
            found.append((other - own, code))
    return max(found)[1] if found else None


def question(code: str, language: str) -> str:
    """Whether to go on in the other language, asked in both."""
    return f"{offer(code, language)}\n{offer(code, code)}"


def offer(code: str, language: str) -> str:
    """The same in one of them."""
    words = words_in(language)
    return str(words["offer_language"]).format(name=_called(code, language))


def hint(code: str, language: str) -> str:
    """What whoever cannot be asked may do."""
    words = words_in(language)
    return str(words["other_language"]).format(name=_called(code, language), code=code)


def _called(code: str, language: str) -> str:
    """What a language is called in another: as it calls itself, where nothing is known."""
    names: dict[str, str] = words_in(language)["language_names"]
    return names.get(code) or language_data(code).own_name or code


def accepted(answer: str, code: str, language: str) -> bool:
    """Whether that was a yes, in either language."""
    return any(agreed(answer, each) for each in (code, language))


def declined(answer: str, code: str, language: str) -> bool:
    """Whether that was a no, in either language."""
    return any(agreed(answer, each) is False for each in (code, language))


@functools.cache
def _words(code: str) -> frozenset[str]:
    pack = load_language(code)
    return pack.words | pack.closed | pack.spelled_words
