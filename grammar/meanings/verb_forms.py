"""The forms of the verbs of questions: "has sorted" -> "have you sorted", "liked" -> "like"."""

from __future__ import annotations

from typing import Any, Final

from grammar.chart import Node
from grammar.discourse import Discourse, capital
from grammar.wordforms import singular

SHORT: Final = 4
"""Letters of what ends like a verb and is none: "seed", "bed"."""


def perfect_form(d: Discourse, form: str, verb: str, rest: str) -> str | None:
    """The form of a question after what somebody has done: "has sorted the post" -> "Have you
    sorted the post?", "where he has hidden it" -> "Where have you hidden it?"."""
    data: dict[str, Any] | None = d.language.speech.get("perfect_questions")
    if data is None or verb.lower() not in data["verbs"] or not form.endswith("{verb} {rest}?"):
        return None
    words = [word for word in rest.strip().split() if word not in data["between"]]
    done = bool(words) and (words[0] in data["participles"] or past_base(d, words[0]) is not None)
    if not done:
        return None
    if len(words) == 1 and len(words[0]) <= SHORT:  # "a bed", and no verb
        return None
    for do in data["do"]:
        before, found, after = form.partition(do)
        who = after.removesuffix("{verb} {rest}?").removesuffix("{adverb} ").strip()
        if found and who:
            have = data["with_you"].get(verb.lower(), verb.lower()) if who == "you" else verb
            return f"{before}{have if before else capital(have)} {who} {{adverb}} {{rest}}?"
    return None


def past_base(d: Discourse, verb: str) -> str | None:
    """ "liked" -> "like"; None for what is no past form."""
    low = verb.lower()
    irregular: dict[str, str] = d.language.speech.get("past_forms", {})
    if low in irregular:
        return irregular[low] if irregular[low] != low else None
    for ending, base in d.language.speech.get("past_endings", ()):
        if low.endswith(ending) and len(low) > len(ending):
            return low[: len(low) - len(ending)] + str(base)
    return None


def in_past(d: Discourse, node: Node, verb: str) -> bool:
    """Whether a verb whose past is like its base has no ending though its subject is "she"."""
    alike = d.language.speech.get("past_alike", ())
    subject = d.tokens[node.parts["verb"].start - 1].norm
    return verb.lower() in alike and subject in d.language.speech.get("pronoun_genders", ())


def base_form(d: Discourse, verb: str) -> str:
    """ "wants" -> "want", "has" -> "have"."""
    forms = d.language.speech.get("base_forms", {})
    low = verb.lower()
    if low in forms:
        return str(forms[low])
    for ending, base in d.language.speech.get("base_endings", ()):
        if low.endswith(ending):
            return verb[: len(verb) - len(ending)] + str(base)
    return verb


def one_each(d: Discourse, form: str, noun: str) -> tuple[str, str]:
    """The form of a question for several things of somebody, or for one, where each has but one:
    "their names" -> "What is your name?", "their hobbies" -> "What are your hobbies?"."""
    data = d.language.speech.get("one_each")
    one = singular(noun, d.language)
    if data is None or "your {noun}" not in form or one == noun:
        return form, noun
    if one.split()[-1] in data["nouns"]:
        return form, one
    return form.replace(data["is"], data["are"]), noun
