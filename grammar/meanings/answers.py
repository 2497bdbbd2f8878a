"""Which answer the speaker means: "wants tea", "would come", "said no", "is not ready"."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from grammar.chart import Node
from grammar.discourse import Discourse
from grammar.errors import NotUnderstood
from grammar.meanings.registry import meaning
from grammar.meanings.surveys import Survey
from grammar.plan import Condition, Either, Not, Text

ALIKE: Final = 4
"""Letters that two forms of a word share: "recommended" and "recommend"."""


@dataclass(frozen=True)
class Said:
    """The words for an answer, as tokens of the sentence."""

    start: int
    end: int


@dataclass(frozen=True)
class Wanted:
    """An answer that is counted or reported."""

    options: tuple[str, ...]
    no: bool = False
    """Whether every other answer is meant."""

    def given(self, survey: Survey) -> Condition:
        """Whether this is what was answered."""
        each = tuple(survey.said(option) for option in self.options)
        condition = each[0] if len(each) == 1 else Either(each)
        return Not(condition) if self.no else condition

    def label(self, d: Discourse) -> str:
        """How it is told."""
        words = d.listed(self.options)
        return d.language.phrase("other_than", answer=words) if self.no else words


@meaning("said_so")
def said_so(d: Discourse, node: Node) -> Said:
    """The words themselves; what they mean depends on what was asked."""
    return Said(node.start, node.end)


@meaning("option_words")
def option_words(d: Discourse, node: Node) -> str:
    return str(d.get(node, "text"))


def yes(d: Discourse) -> Wanted:
    return Wanted((d.language.phrase("yes"),))


def wanted(d: Discourse, survey: Survey, said: Said, *, strict: bool = False) -> Wanted:
    """The answer to this question that is spoken of. Raises `NotUnderstood` where the words have
    nothing to do with it; `strict` where they say anything besides."""
    norms = [token.norm for token in d.tokens[said.start : said.end]]
    negative = bool(_words(d, "negations") & set(norms))
    agree, refuse = d.language.phrase("yes"), d.language.phrase("no")
    if set(survey.options) == {agree, refuse}:
        answered = agree in norms or refuse in norms
        besides = [norm for norm in norms if norm not in (agree, refuse)]
        if not (answered and not strict) and not is_about(d, survey, besides):
            raise NotUnderstood(
                d.language.phrase("not_understood", part=d.words(said.start, said.end))
            )
        return Wanted((refuse if negative or refuse in norms else agree,))
    chosen = tuple(each for each in survey.options if names_option(d, norms, each))
    named = {word for each in chosen for word in d.language.tokens_of(each)}
    if strict and not is_about(d, survey, [norm for norm in norms if norm not in named]):
        chosen = ()
    if chosen:
        return Wanted(chosen, negative and not any(_is_none(d, each) for each in chosen))
    none = tuple(each for each in survey.options if _is_none(d, each))
    if none and negative and not strict:
        return Wanted(none)
    if survey.options:
        raise NotUnderstood(d.language.phrase("not_understood", part=d.words(said.start, said.end)))
    if negative:  # of what was not said in so many words nobody can tell
        raise NotUnderstood(d.language.phrase("not_understood", part=d.words(said.start, said.end)))
    telling = [norm for norm in norms if norm not in silent_words(d)] or norms
    return Wanted((" ".join(telling),), negative)


def names_option(d: Discourse, norms: Sequence[str], option: str) -> bool:
    """Whether the words of an option stand among others."""
    words = [word for word in d.language.tokens_of(option) if word not in d.language.closed]
    words = words or list(d.language.tokens_of(option))
    return any(
        all(_alike(d, norms[at + more], word) for more, word in enumerate(words))
        for at in range(len(norms) - len(words) + 1)
    )


def _is_none(d: Discourse, option: str) -> bool:
    return bool(_words(d, "negations") & set(d.language.tokens_of(option)))


def is_about(d: Discourse, survey: Survey, norms: Sequence[str]) -> bool:
    """Whether some words speak of what was asked, or say no more than that somebody agreed."""
    question = survey.call.arguments["question"]
    asked = d.language.tokens_of(question.value) if isinstance(question, Text) else ()
    silent = silent_words(d) | _words(d, "negations")
    return all(norm in silent or any(_alike(d, norm, word) for word in asked) for norm in norms)


def silent_words(d: Discourse) -> set[str]:
    """Words that name no answer: function words, fillers, and verbs such as "agree"."""
    fillers = {filler[0] for filler in d.language.fillers if len(filler) == 1}
    ones = _words(d, "one_words")
    return {*d.language.closed, *fillers, *_words(d, "answering"), *ones, ",", "."}


def _alike(d: Discourse, one: str, other: str) -> bool:
    """Whether two words are forms of one: "recommended" and "recommend", "coming" and "come"."""
    if one == other or (len(one) >= ALIKE and one[:ALIKE] == other[:ALIKE]):
        return True
    return _base(d, one) == _base(d, other)


def _base(d: Discourse, word: str) -> str:
    """A word without the ending that verbs have."""
    endings = d.language.speech.get("verb_endings", ())
    return next((word.removesuffix(each) for each in endings if word.endswith(each)), word)


def _words(d: Discourse, name: str) -> set[str]:
    return set(d.language.words_called(name))
