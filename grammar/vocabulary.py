"""All words that the grammar and the world can say, for the speech recogniser."""

from __future__ import annotations

import re

from grammar.language import load_language
from grammar.lexicon import Lexicon
from grammar.names import names_of
from grammar.tokens import plain

_WORD = re.compile(r"[^\W\d_]+(?:'[^\W\d_]+)*")

_MARK = re.compile(r"⟨[^⟩]*⟩")
"""Marks of cases in examples, which nobody says."""


def vocabulary(lexicon: Lexicon, language: str = "en") -> list[str]:
    """The words, in lower case and in order, each once."""
    pack = load_language(language)
    texts: list[str] = [*pack.spelled_words, *pack.spelling.contractions]
    examples = [example for topic in pack.help.values() for example in topic]
    texts += [_MARK.sub("", example) for example in (*examples, *pack.sayings)]
    for name in (*lexicon.places, *lexicon.people, *lexicon.objects, *lexicon.furniture):
        texts += [name.name, *name.aliases, *name.attributes, name.kind or ""]
    texts += [*lexicon.contacts, *lexicon.gestures, *lexicon.emotions, *lexicon.skills]
    texts += [joint.replace("_", " ") for joint in lexicon.joints]
    texts += [routine.name for routine in lexicon.routines]
    for question in lexicon.questions:
        texts += [question.question, *question.aliases]
    texts += names_of(pack, lexicon).spelled
    words = {word for text in texts for word in _WORD.findall(plain(text))}
    return sorted(words)
