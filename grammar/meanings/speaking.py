"""Saying what the speaker wants said; what the robot refuses to do."""

from __future__ import annotations

import math
import re
from typing import Final

from grammar.chart import Leaf, Node
from grammar.discourse import Discourse, Steps, capital
from grammar.errors import NotUnderstood
from grammar.language import Language, languages, load_language
from grammar.meanings.finding import speak_to
from grammar.meanings.references import answers_in
from grammar.meanings.registry import meaning
from grammar.plan import Call, ForEach, Items, Number, Recall, Text, Value
from grammar.texts.words import words_for
from grammar.tidy import nodes


@meaning("say")
def say(d: Discourse, node: Node) -> Steps:
    """Speak a text, in the speaker's own words."""
    text = spoken(d, node)
    language = d.get(node, "language")
    said: Steps = []
    for code in d.get(node, "languages") or [language]:
        arguments: dict[str, Value] = {"text": text}
        if code:
            arguments = {"text": in_language(d, node, text, str(code)), "language": Text(code)}
        said.append(Call("say", arguments))
    return speak_to(d, d.get(node, "person_ref"), said)


@meaning("languages")
def several_languages(d: Discourse, node: Node) -> list[str]:
    """ "say hello in German, French and English"."""
    return [str(d.get(node, "first")), *(d.get(node, "rest") or [])]


SAYINGS: Final = (
    *("hello", "good_bye", "thanks", "sorry", "welcome", "please_come_in"),
    *(
        "good_morning",
        "good_day",
        "good_evening",
        "good_night",
        "happy_birthday",
        "merry_christmas",
    ),
)
"""What every language has ready: "say good morning in German"."""


def in_language(d: Discourse, node: Node, text: Value, code: str) -> Value:
    """The text in another language: what that has ready, else words that are in it already. Nothing
    is translated, so that words of the own language are refused."""
    if code == d.language.code or not isinstance(text, Text):
        return text
    said = d.language.tokens_of(text.value.rstrip(".!"))
    for key in SAYINGS:
        if said == d.language.tokens_of(d.language.phrase(key).rstrip(".!")):
            return Text(load_language(code).phrase(key))
    other = load_language(code)
    own = d.language.words | d.language.closed | words_for(d.language).verb_forms
    foreign = set(said) - own or set(said) <= other.words | other.closed
    if "quote" not in node.parts and not foreign:
        part = node.parts["text"]
        raise NotUnderstood(
            d.language.phrase("cannot_translate", what=d.words(part.start, part.end)),
            gap=(part.start, part.end),
        )
    return text


def spoken(d: Discourse, node: Node) -> Value:
    """What is to be said: a quotation word for word, other text as a sentence."""
    quote = node.parts.get("quote")
    if quote is not None:
        return Text(str(d.build(quote)))
    part = node.parts["text"]
    return answers_in(d, sentence_form(d.words(part.start, part.end)), part.start, part.end)


def sentence_form(text: str) -> str:
    text = text.strip().strip('"“”„«»').strip()
    return capital(text) if text[-1:] in ".!?…" else capital(text) + "."


def clause_of(d: Discourse, part: Leaf | Node) -> str:
    """What is or is not so, of a condition that is checked: "Bob is asleep" of "see whether Bob is
    asleep"."""
    opens = d.language.speech.get("whether", ())
    norms = d.norms(part.start, part.end)
    at = next((at for at, word in enumerate(norms[:-1]) if word in opens), -1)
    return d.words(part.start + at + 1, part.end)


def put_for(d: Discourse, words: str, text: str) -> str:
    """A text with some words in the place of others, as a list of the language says."""
    instead: dict[str, str] = d.language.speech.get(words, {})
    if not instead:
        return text
    either = "|".join(rf"\b{re.escape(each)}\b" for each in instead)
    return re.sub(either, lambda found: instead[found[0].lower()], text, flags=re.IGNORECASE)


MOST_COUNTED: Final = 100
"""Numbers said one after the other."""


@meaning("count_aloud")
def count_aloud(d: Discourse, node: Node) -> Steps:
    """ "count to ten", "count down from five"."""
    last = d.get(node, "last")
    first = d.get(node, "first", 1)
    last = 1 if last is None else last
    if math.inf in (first, last):
        raise NotUnderstood(d.language.phrase("too_long"))
    last = int(last)
    numbers = range(int(first), last + 1) if last >= first else range(int(first), last - 1, -1)
    if len(numbers) > MOST_COUNTED:
        raise NotUnderstood(d.language.phrase("too_long"))
    number = Recall(d.variable("number"))
    each = Call("say", {"text": number})
    return [ForEach(number.name, Items(tuple(map(Number, numbers))), (each,))]


@meaning("phrase")
def phrase(d: Discourse, node: Node) -> Steps:
    """Say what the language holds ready: "introduce yourself", "thank them"."""
    words = ready_made(d, str(node.production.fixed["phrase"]))
    return speak_to(d, d.get(node, "person_ref"), [words])


def ready_made(d: Discourse, phrase: str, **values: Value | str) -> Call:
    """What a language has ready to say, in the one that the robot was told to speak before; in that
    of the command where the other lacks it."""
    text = language_spoken(d).phrases.get(phrase) or d.language.phrases[phrase]
    return Call("say", {"text": d.filled(text, **values)})


def language_spoken(d: Discourse) -> Language:
    """The language that the robot was told to speak, if it is one whose phrases are known; else
    that of the command."""
    code = d.language.code
    for each in nodes(tuple(d.done)):
        if isinstance(each, Call) and each.method == "set_language":
            told = each.arguments["code"]
            code = told.value if isinstance(told, Text) else code
    return load_language(code) if code in languages() else d.language


@meaning("set_volume")
def set_volume(d: Discourse, node: Node) -> Steps:
    percent = round(float(d.get(node, "percent")))
    if not 0 <= percent <= 100:
        raise NotUnderstood(d.language.phrase("volume_range"))
    return [Call("set_volume", {"percent": Number(percent)})]


@meaning("refused")
def refused(d: Discourse, node: Node) -> Steps:
    """A sentence that is understood as something this robot must not or cannot do."""
    raise NotUnderstood(d.language.phrase(str(node.production.fixed["phrase"])))


@meaning("unknown_part")
def unknown_part(d: Discourse, node: Node) -> Steps:
    """ "tell me the colour of the sky": a request that is understood up to a part of it."""
    part = node.parts["part"]
    words = d.words(part.start, part.end)
    raise NotUnderstood(d.language.phrase("not_understood", part=words))


@meaning("unknown_contact")
def unknown_contact(d: Discourse, node: Node) -> Steps:
    words = d.words(node.parts["unknown"].start, node.parts["unknown"].end)
    raise NotUnderstood(d.language.phrase("unknown_contact", name=words))
