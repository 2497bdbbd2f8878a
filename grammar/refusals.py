"""What the robot must not or cannot do, by the words that give it away: `refusals`, `forbidden`,
`no_things` and `not_said` in a language's data."""

from __future__ import annotations

import functools
import itertools
import re
from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from typing import Final

from grammar.inference import form_for
from grammar.language import Language
from grammar.lexicon import Lexicon
from grammar.plan import Ask, Call, Number, Plan, Text
from grammar.texts.words import words_for
from grammar.tidy import nodes
from grammar.tokens import Token
from grammar.wordforms import singular
from robot_api.methods import METHODS

HARM: Final = frozenset({"no_harm", "no_medicine"})
"""Phrases for what must not be done."""
IN_HAND: Final = frozenset({"grab", "give", "put"})
SPOKEN: Final = frozenset({"say", "ask", "show"})
SEEN: Final = frozenset({"find", "sees", "count", "wait_for", "describe"})
MAY_HOLD_MEDICINE: Final = frozenset(
    {None, "anaesthetist", "carer", "doctor", "midwife", "nurse", "paramedic", "pharmacist"}
    | {"physiotherapist", "porter", "radiologist", "receptionist", "surgeon", "therapist"}
)
"""Kinds of people who care for others; None: somebody of whom only the name is known."""


def forbidden(tokens: Sequence[Token], language: Language) -> str | None:
    """The phrase for a sentence that is refused however well it was understood: words that stand
    for harm or for the computer wherever they are said, other than in quotation marks."""
    words = tuple(token.norm for token in tokens)
    return next(_found(words, _signs(language, "forbidden")), None)


def no_thing(plan: Plan, lexicon: Lexicon, language: Language) -> tuple[str, str] | None:
    """What is said to a plan that deals with what is no thing, or is nobody here, and the name of
    it; None if there is nothing of that."""
    found = _no_thing(plan, lexicon, language)
    if found is None:
        return None
    phrase, thing = found
    message = language.phrase(phrase, thing=thing, name=thing)
    if phrase == "unknown_person":
        message = f"{message} {language.phrase('say_who')}"
    return message, thing


def _no_thing(plan: Plan, lexicon: Lexicon, language: Language) -> tuple[str, str] | None:
    """The phrase for a plan that takes in the hand what is no thing ("take her temperature"), or
    looks for what is in no house ("wait for the full moon"), and the name of it. What the world
    lists is a thing, whatever it is called."""
    known = {each.name for each in lexicon.objects}
    people = tuple(each.name for each in lexicon.people)
    for step in nodes(plan.steps):
        if not isinstance(step, Call | Ask):
            continue
        thing = step.arguments.get("thing")
        if not isinstance(thing, Text) or thing.value in known:
            continue
        listed = language.speech.get("no_things", {}) if step.method in IN_HAND else {}
        if step.method in SEEN:
            listed = {"out_of_sight": language.speech.get("out_of_sight", ())}
        words = tuple(_without_harmless(list(language.tokens_of(thing.value)), language))
        if len(words) == 1 and words[0] in language.words_called("qualities"):
            return "no_quality", thing.value  # "which lab is quieter"
        titles = language.speech.get("personal_titles", ())
        stranger = step.method in IN_HAND or not thing.value.startswith(people)
        if len(words) > 1 and words[0] in titles and stranger:  # "take Mrs Jones to radiology"
            return "unknown_person", thing.value.title()
        if step.method in IN_HAND and _is_somebody(thing.value, lexicon, language):
            return "cannot_carry", thing.value  # "pick the visitor up in the lobby"
        if step.method in IN_HAND and _is_dangerous(words, language):
            return "no_harm", thing.value
        if step.method == "give" and _treats(step, lexicon, language):
            return "no_medicine", thing.value
        for phrase, names in listed.items():
            if any(_headed(words, language.tokens_of(name), language) for name in names):
                return str(phrase), thing.value
    return None


def not_said(plan: Plan, lexicon: Lexicon, language: Language) -> str | None:
    """The phrase for a plan that says or asks what a robot among patients must not: a threat, an
    insult, a diagnosis, a question for a password. What the world lets it answer, it may say."""
    answers = {each.answer for each in lexicon.questions}
    signs_of = _signs(language, "not_said")
    for step in nodes(plan.steps):
        if not isinstance(step, Call | Ask) or step.method not in SPOKEN:
            continue
        for text in nodes(step.arguments):
            if not isinstance(text, Text) or text.value in answers:
                continue
            phrase = next(_found(language.tokens_of(text.value), signs_of), None)
            if phrase is not None:
                return phrase
    return None


def misturned(plan: Plan, language: Language, text: str) -> str | None:
    """A text of the plan that nobody says so, for a pronoun or a verb in it was not turned to who
    hears it (`misturned` in the language's data). What the sentence has word by word is not
    judged."""
    patterns = language.speech.get("misturned", ())
    for step in nodes(plan.steps):
        if not isinstance(step, Call | Ask) or step.method not in SPOKEN:
            continue
        for said in nodes(step.arguments):
            if not isinstance(said, Text) or f'"{said.value}"' in text:
                continue
            if any(re.search(pattern, said.value) for pattern in patterns):
                return said.value
    return None


def _found(words: tuple[str, ...], signs: Mapping[tuple[str, ...], str]) -> Iterator[str]:
    """The phrases for the signs that stand among words, in the order of the signs."""
    for sign, phrase in signs.items():
        if sign[0] in words and any(
            words[at : at + len(sign)] == sign for at, word in enumerate(words) if word == sign[0]
        ):
            yield phrase


def _is_somebody(name: str, lexicon: Lexicon, language: Language) -> bool:
    """Whether something is a person by name, or as the language calls them."""
    named = any(each.name == name for each in lexicon.people)
    kinds = language.lists.get("person_kind", {})
    called = language.tokens_of(name)
    *before, last = called or ("",)
    if before and language.lists.get("superlative", {}).keys() >= {*before}:  # "tallest person"
        called, name = (last,), last
    return named or name in kinds or any(called in ways for ways in kinds.values())


def _is_dangerous(words: Sequence[str], language: Language) -> bool:
    """Whether a thing is dangerous or holds something that is: "a bottle of acid". Only its whole
    name counts: a "Waffel" is no "Waffe"."""
    dangers = {language.tokens_of(each) for each in language.speech.get("dangerous", ())}
    named = {(form,) for word in words for form in (word, singular(word, language))}
    return not dangers.isdisjoint(named)


def _treats(giving: Call | Ask, lexicon: Lexicon, language: Language) -> bool:
    """Whether medicine is to be given to somebody who might take it: that is not for a robot. To
    those who care for others it is brought, to colleagues of whom no more is known, and to the
    speaker."""
    thing, person = giving.arguments.get("thing"), giving.arguments.get("person")
    if not isinstance(thing, Text) or person is None:
        return False
    words, medicine = language.tokens_of(thing.value), language.speech.get("medicine", ())
    if not any(_headed(words, language.tokens_of(each), language) for each in medicine):
        return False
    if not isinstance(person, Text):
        return True
    kinds = {each.kind for each in lexicon.people if each.name == person.value}
    return not (kinds or {person.value.split()[0]}) <= MAY_HOLD_MEDICINE


def out_of_range(plan: Plan, language: Language) -> str | None:
    """Why a number is too large or too small for what the robot is to do with it, if one is."""
    for step in nodes(plan.steps):
        if not isinstance(step, Call | Ask):
            continue
        for parameter in form_for(METHODS[step.method], step.arguments) or ():
            number = step.arguments.get(parameter.name)
            low = parameter.kind.schema.get("minimum")
            high = parameter.kind.schema.get("maximum")
            if not isinstance(number, Number) or low is None or high is None:
                continue
            if not low <= number.value <= high:
                own = f"range_{step.method}_{parameter.name}"
                phrase = own if own in language.phrases else "out_of_range"
                return language.phrase(phrase, number=number.value, low=low, high=high)
    return None


def _headed(words: tuple[str, ...], name: tuple[str, ...], language: Language) -> bool:
    """Whether a noun phrase speaks of this: "blood pressure of Bob" of blood pressure. Only whole
    words count: pasta is no past."""
    ends = language.closed | set(language.speech.get("beside", ()))
    head = next((at for at, word in enumerate(words) if at and word in ends), len(words))
    first = 0 if language.speech.get("head_first") else max(0, head - len(name))
    return len(words) >= first + len(name) and all(
        each in (word, singular(word, language))
        for word, each in zip(words[first:], name, strict=False)
    )


def why_not(tokens: Sequence[Token], language: Language, names: Set[str]) -> str:
    """The phrase for a sentence of which nothing was understood: why it is none of its business.
    Words of names say nothing about that: who goes to the blood lab gives no blood."""
    said = _without_harmless([token.norm for token in tokens], language)
    words = {word for word in said if word not in names}
    as_asked = language.speech.get("refused_as_asked", ())
    for sign, phrase in _signs(language, "refusals").items():
        if sign[0] not in said:
            continue
        if phrase in as_asked:
            found = tuple(said[: len(sign)]) == sign
        elif len(sign) > 1:  # several words are no name by chance: "blood pressure"
            found = any(tuple(said[at : at + len(sign)]) == sign for at in range(len(said)))
        else:
            found = words.issuperset(sign)
        if found:
            return phrase
    return "not_understood_at_all"


def harmful(
    tokens: Sequence[Token], language: Language, names: Set[str]
) -> Iterator[tuple[int, str]]:
    """The tokens that stand for harm, or for treating somebody, with the phrase for that. Whoever
    leaves such a word out of a plan has not understood what must not be done."""
    words = [token.norm for token in tokens]
    harmless = {
        place
        for phrase in map(language.tokens_of, language.speech.get("harmless", ()))
        for at in range(len(words))
        if tuple(words[at : at + len(phrase)]) == phrase
        for place in range(at, at + len(phrase))
    }
    for sign, phrase in _signs(language, "refusals").items():
        if phrase not in HARM:
            continue
        for at in range(len(words)):
            spoken = tuple(words[at : at + len(sign)]) == sign and at not in harmless
            if spoken and not (len(sign) == 1 and sign[0] in names):
                yield at, phrase


def _without_harmless(said: list[str], language: Language) -> list[str]:
    """Words without things that are only called so: a fire extinguisher is no fire."""
    for phrase in map(language.tokens_of, language.speech.get("harmless", ())):
        for at in range(len(said) - len(phrase), -1, -1):
            if tuple(said[at : at + len(phrase)]) == phrase:
                del said[at : at + len(phrase)]
    return said


def is_half(tokens: Sequence[Token], language: Language, names: Set[str]) -> bool:
    """Whether a sentence ends with a word that no sentence ends with, "go to the", or is no more
    than the beginning of one: "tell"."""
    if not tokens:
        return False
    last = tokens[-1].norm
    begun = len(tokens) == 1 and last in words_for(language).verbs
    lettered = len(last) == 1 and len(tokens) > 1 and tokens[-2].norm in names  # "ward a"
    return begun or (not lettered and last in language.speech.get("half_ends", ()))


def strange(tokens: Sequence[Token], known: Callable[[Token], bool]) -> tuple[int, int] | None:
    """The first words in a row that no rule and no name has."""
    row = itertools.groupby(range(len(tokens)), lambda at: known(tokens[at]))
    found = next((list(group) for is_known, group in row if not is_known), None)
    return None if found is None else (found[0], found[-1] + 1)


@functools.cache
def signs(language: Language) -> frozenset[str]:
    """All words that give a refusal away; they are never misspellings of other words."""
    return frozenset(word for sign in _signs(language, "refusals") for word in sign)


@functools.cache
def _signs(language: Language, name: str) -> dict[tuple[str, ...], str]:
    """The words that a phrase goes with, in the order of the data."""
    found: dict[tuple[str, ...], str] = {}
    for phrase, listed in language.speech.get(name, {}).items():
        for sign in map(language.tokens_of, listed):
            found.setdefault(sign, str(phrase))
    return found
