"""The words that free text is judged by: the `free_text` of a language."""

from __future__ import annotations

import functools
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from grammar.language import Language
from grammar.phrases import Phrases


@dataclass(frozen=True)
class Words:
    """The `free_text` of a language."""

    verbs: frozenset[str]
    """Forms that an order begins with: "peel", "bezahl"."""
    verb_forms: frozenset[str]
    """Forms that make a clause: "peels", "peeled"."""
    nouns_too: frozenset[str]
    """Of the verbs: those that are nouns as well ("coffee and water")."""
    finite: frozenset[str]
    finite_pattern: re.Pattern[str]
    """What words that make a clause look like, where they are too many to list."""
    subjects: frozenset[str]
    """Pronouns that are followed by a verb that looks like an order: "I love him and miss him"."""
    modals: frozenset[str]
    to: frozenset[str]
    """Words before an infinitive."""
    conditions: frozenset[str]
    """Words that a condition begins with: "and if so, ..."""
    settled: frozenset[str]
    """Answers that are complete in themselves: "yes", "no"."""
    objects: frozenset[str]
    """Articles and pronouns: what follows "and peel"."""
    addressed: frozenset[str]
    """Pronouns that cannot be the one who is asked to do it: "to leave and mop up behind them"."""
    no_order: re.Pattern[str]
    """Words that are no order even before an article: "and wants a ..."""
    between: frozenset[str]
    """What may stand between "and" and an order: "also", "then"."""
    asking: frozenset[str]
    """Words that an indirect question begins with: "who", "how many"."""
    exclaimed: Phrases
    """What begins so and asks nothing: "what a lovely day"."""
    addressing: frozenset[str]
    """Words that turn a question to the listener: "you"."""
    definite: frozenset[str]
    """Words that speak of something known: "the total", "his mind"."""
    that: frozenset[str]
    told: frozenset[str]
    """Of these: those with which, behind a comma, only a message begins."""
    messages: Phrases
    """How a message begins that is no whole sentence: "happy birthday"."""
    wishes: Phrases
    """What sounds like an order and is none: "sleep well", "welcome to"."""
    unsaid: Phrases
    """How what is not to be said begins: "rather not", "neither"."""
    instead: Phrases
    """What stands before what is not said: "rather than"."""
    greetings: Phrases
    """What is complete in itself, so that "to ...", "in ..." behind it are not spoken."""
    not_greeting: frozenset[str]
    """What goes with a greeting as little as with an order: "to", "in", "at"."""
    manners: frozenset[str]
    """Words that tell how, when or whether something is done: "without", "unless"."""
    manner_first: Phrases
    """Of those, and of others: what is no part of words that it stands before."""
    screens: frozenset[str]
    """What a text is shown on: no part of the text."""
    adverbs: frozenset[str]
    """Of the words that may stand anywhere: those that are no verbs for certain."""
    subordinating: frozenset[str]
    """Words that begin a clause which is no statement: "as Bob does"."""
    never_first: frozenset[str]
    """Pronouns that no statement begins with: "me"."""
    datives: frozenset[str]
    """Pronouns that a statement begins with only as its subject, right before a verb: "ihr"."""
    how: re.Pattern[str]
    """Ways to do something that no question is about: "without shouting"."""
    goes_on: frozenset[str]
    """Words that no text ends with: "except", "because"."""
    back: Phrases
    """Speaking of the robot's return: "when you are back"."""
    requests: frozenset[str]
    """Words before each thing that somebody is asked to do: "to wait and to call"."""
    reported: frozenset[str]
    """Pronouns for those who are told of, which they do not say of themselves: "he", "her"."""
    until: frozenset[str]
    asked_too: re.Pattern[str] | None
    """A clause that goes on with what somebody is asked to do; None where an order looks the same:
    "ask Bob to wait and call"."""
    asked_with: re.Pattern[str]
    """A clause that only goes on with the one before it: ", die Tür zu öffnen"."""
    receivers: frozenset[str]
    """Pronouns by which an order to the robot speaks of whom it told something before."""
    own: Phrases
    """What nobody but the robot is meant to do: "come back"."""
    clauses: bool
    """Whether a message that does not begin with "that" has to be a clause."""


@functools.cache
def words_for(language: Language) -> Words:
    """The words that the texts of a language are judged by."""
    data: Mapping[str, Any] = language.speech.get("free_text", {})

    def single(name: str) -> frozenset[str]:
        return frozenset(word for entry in data.get(name, ()) for word in _tokens(entry, language))

    def phrases(name: str) -> Phrases:
        return Phrases(language.tokens_of(entry) for entry in data.get(name, ()))

    def changed(words: frozenset[str], name: str) -> frozenset[str]:
        return frozenset(
            re.sub(pattern, ending, word)
            for word in words
            for pattern, *endings in data.get(name, ())
            for ending in endings
            if re.search(pattern, word)
        )

    verbs = single("verbs")
    forms = changed(verbs, "verb_forms")
    if "order_forms" in data:
        verbs = changed(verbs, "order_forms") | single("orders")
    return Words(
        verbs=verbs,
        verb_forms=verbs | forms | single("past"),
        nouns_too=single("nouns_too"),
        finite=single("finite"),
        finite_pattern=re.compile(data.get("finite_pattern", r"(?!)")),
        subjects=single("subjects"),
        modals=single("modals"),
        to=single("to"),
        conditions=single("conditions"),
        settled=single("settled"),
        objects=single("objects"),
        addressed=single("addressed"),
        no_order=re.compile(data.get("no_order", r"(?!)")),
        between=single("between"),
        asking=single("asking"),
        exclaimed=phrases("exclaimed"),
        addressing=single("addressing"),
        definite=single("definite"),
        that=single("that"),
        told=single("told"),
        messages=phrases("messages"),
        wishes=phrases("wishes"),
        unsaid=phrases("unsaid"),
        instead=phrases("instead"),
        greetings=phrases("greetings"),
        not_greeting=single("not_greeting"),
        manners=single("manners"),
        goes_on=single("goes_on"),
        manner_first=phrases("manner_first"),
        screens=single("screens"),
        adverbs=single("adverbs"),
        subordinating=single("subordinating"),
        never_first=single("never_first"),
        datives=single("datives"),
        how=re.compile(data.get("how", r"(?!)")),
        back=phrases("back"),
        requests=single("requests"),
        reported=frozenset(
            word
            for name in ("addressing", "addressing_last")
            for word in language.speech.get(name, {}).get("you", ())
        ),
        until=single("until"),
        asked_too=re.compile(data["asked_too"]) if "asked_too" in data else None,
        asked_with=re.compile(data.get("asked_with", r"(?!)")),
        receivers=single("receivers"),
        own=phrases("own"),
        clauses=bool(data.get("clauses", False)),
    )


def weighty_words(language: Language) -> frozenset[str]:
    """Words that turn the sense of a text: "no", "only", "without"."""
    negations = language.speech.get("free_text", {}).get("negations", ())
    return words_for(language).manners | frozenset(map(str, negations))


def _tokens(entry: str, language: Language) -> Iterator[str]:
    for word in str(entry).split():
        yield from language.tokens_of(word)
