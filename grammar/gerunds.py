"""Verbs that another word puts in a form of their own: "keep greeting visitors" -> "keep greet
visitors", so that the rules need to name a verb only once.

A language says in its data after which words that happens, and with which ending; only what is
then a word that a command can begin with is taken for a verb.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from grammar.language import Language
from grammar.tokens import Token


def as_verbs(
    tokens: tuple[Token, ...], language: Language, command_words: frozenset[str]
) -> tuple[Token, ...]:
    """The tokens with such verbs as commands say them."""
    data = language.speech.get("gerunds")
    if not data:
        return tokens
    after, joins, ending = set(data["after"]), set(data["joins"]), str(data["ending"])
    found: list[Token] = []
    earlier = False  # "keep greeting them and asking ..."
    for at, token in enumerate(tokens):
        before = tokens[at - 1].norm if at else ""
        verb = None
        if token.norm.endswith(ending) and (before in after or (earlier and before in joins)):
            bases = _bases(token.norm[: -len(ending)])
            verb = next((base for base in bases if base in command_words), None)
        earlier = earlier or verb is not None
        found.append(token if verb is None else replace(token, norm=verb, kind="verb"))
    return tuple(found)


def _bases(stem: str) -> Iterator[str]:
    """ "greet", "giv" -> "give", "runn" -> "run"."""
    yield stem
    yield f"{stem}e"
    if len(stem) > 2 and stem[-1] == stem[-2]:
        yield stem[:-1]
