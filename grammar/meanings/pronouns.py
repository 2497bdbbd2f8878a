"""Whom the pronouns of a question stand for: the one who is asked, or others.

"Ask Bob if he can pick her up" asks "Can you pick Alice up?"; "ask Bob whether she is coming" asks
"Is Alice coming?". A pronoun is one for others where its gender says so, where it is of several
and one is asked, and where it stands beside a subject that it would be a reflexive of.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from grammar.chart import Node
from grammar.discourse import Discourse, Thing
from grammar.meanings.options import people_named
from grammar.names import names_of
from grammar.plan import Text


@dataclass(frozen=True)
class Meant:
    """Whom the pronouns of a question stand for."""

    words: Mapping[int, str] = field(default_factory=dict)
    """What is said in the place of the words that speak of others."""
    subject: str = ""
    """Whom the question is about, if that is not the one who is asked."""
    several: bool = False
    """Whether these are several."""


NOBODY_ELSE = Meant()


def meant_in(d: Discourse, node: Node, person: Thing | None) -> Meant:
    """What the pronouns of a question stand for that a person is asked."""
    data: Mapping[str, Any] | None = d.language.speech.get("asked_pronouns")
    if data is None:
        return NOBODY_ELSE
    form = str(node.production.fixed.get("form", ""))
    you = "you" in form.lower().replace("?", "").split() and "subject" not in node.parts
    subject = next(_outside(d, node, set(data["subjects"])), None)
    other = _about(d, node, person, subject) if you else ""
    several = other in data["several"]
    one = subject is not None and d.gender(subject, subject + 1) is not None
    named = subject is None and person is not None and person.known
    words: dict[int, str] = {}
    for at in _inside(d, node, {*data["several"], *d.language.speech["pronoun_genders"]}):
        of_several = d.tokens[at].norm in data["several"]
        beside = you and not other and _object_beside(d, node, at, data)
        if of_several:
            apart = several or (you and (one or named)) or beside
        else:
            apart = beside or _of_another(
                d, node.start, at, person, subject if you and not other else None
            )
        if apart:
            words[at] = _instead(d, node, at, person, other)
    return Meant(words, other, several)


def called_as_asked(d: Discourse, node: Node, person: Thing) -> None:
    """The pronoun that is the subject of a question tells whether the one asked is "he" or "she":
    "ask Robin whether she has time", but not "whether Robin likes her"."""
    data: Mapping[str, Any] | None = d.language.speech.get("asked_pronouns")
    if data is None:
        d.called_so(person, node.start, node.end)
        return
    subject = next(_outside(d, node, set(data["subjects"])), None)
    if subject is not None and not none_for(d, subject, person):
        d.called_so(person, subject, subject + 1)


def _outside(d: Discourse, node: Node, wanted: set[str]) -> Iterator[int]:
    """The tokens of some words that are in none of the parts of a question."""
    inside = {at for part in node.parts.values() for at in range(part.start, part.end)}
    return (at for at in range(node.start, node.end) if at not in inside and _is(d, at, wanted))


def _inside(d: Discourse, node: Node, wanted: set[str]) -> Iterator[int]:
    spans = (part for name, part in node.parts.items() if name not in ("person_ref", "asked_one"))
    return (at for part in spans for at in range(part.start, part.end) if _is(d, at, wanted))


def _is(d: Discourse, at: int, wanted: set[str]) -> bool:
    return d.tokens[at].norm in wanted


def _about(d: Discourse, node: Node, person: Thing | None, subject: int | None) -> str:
    """Whom a question is about, if the pronoun that is its subject cannot be the one asked."""
    if person is None or subject is None:
        return ""
    before = _about_before(d) if node.production.rule == "reported_more" else None
    pronoun = d.tokens[subject].norm
    if pronoun in d.language.speech["asked_pronouns"]["anybody"]:  # "ask Bob if anyone has called"
        return pronoun
    if d.gender(subject, subject + 1) is None:
        return pronoun if before == "several" else ""
    if not none_for(d, subject, person):
        return ""
    return d.one_before(person, subject) or (pronoun if before == "one" else "")


def _about_before(d: Discourse) -> str | None:
    """Whether the question just before was about one or several others: "if the guests are here and
    where they are waiting". None if it was about the one who was asked."""
    before = d.answers.surveys[-1].call.arguments["question"] if d.answers.surveys else None
    words = d.language.tokens_of(before.value) if isinstance(before, Text) else ()
    data = d.language.speech["asked_pronouns"]
    if words and words[0] in d.language.words_called("who"):
        return "several"
    for at, word in enumerate(words[:3]):
        if word not in data["verbs"] or at + 1 >= len(words):
            continue
        if words[at + 1] == "you" or words[at + 1] not in d.language.closed:
            return None
        return "several" if word in data["verbs_of_several"] else "one"
    return None


def none_for(d: Discourse, at: int, person: Thing) -> bool:
    gender = d.gender(at, at + 1)
    return gender is not None and person.known and not d.may_have(person, gender)


def _of_another(
    d: Discourse, start: int, at: int, person: Thing | None, subject: int | None
) -> bool:
    """Whether "her" is none of the one asked, whom the pronoun that is the subject stands for."""
    if person is not None and none_for(d, at, person):
        return True
    gender = d.gender(at, at + 1)
    if subject is None:  # "who could help Alice with her computer"
        return d.answers.asking_each and _named_before(d, start, at, str(gender))
    return gender != d.gender(subject, subject + 1)


def _named_before(d: Discourse, start: int, at: int, gender: str) -> bool:
    """Whether somebody of whom a pronoun may be is named before it in the same question."""
    return any(d.gender_of(name) == gender for name in people_named(d, start, at))


def _object_beside(d: Discourse, node: Node, at: int, data: Mapping[str, Any]) -> bool:
    """Whether a pronoun is an object of a verb whose subject is the one who is asked: it would be
    "himself". "If he has them with him" and "if he wants me to help him" speak of himself."""
    norm = d.tokens[at].norm
    if norm not in data["objects"] or d.tokens[at - 1].norm in data["of_oneself_after"]:
        return False
    if norm in data["possessives"] and not _phrase_ends(d, at + 1):
        return False
    people = names_of(d.language, d.lexicon).tries
    start = min(part.start for name, part in node.parts.items() if name != "wh")
    for before in range(start, at):
        word = d.tokens[before].norm
        if word in data["other_subjects"] or d.tokens[before].kind == "mark":
            return False
        for slot in ("person", "person_kind"):
            if slot in people and word in people[slot].branches:
                return False
    return True


def _phrase_ends(d: Discourse, at: int) -> bool:
    """Whether no noun follows here that something would be theirs of: "pick her up"."""
    if at >= len(d.tokens) or d.tokens[at].kind == "mark":
        return True
    word = d.tokens[at].norm
    after = d.language.speech.get("addressing", {}).get("after_object", ())
    return word in d.language.closed or word in after


def _instead(d: Discourse, node: Node, at: int, person: Thing | None, other: str) -> str:
    """The name of somebody else, where nobody of that gender is spoken of before in the same
    question; else the pronoun."""
    word = d.tokens[at].norm
    name = d.one_before(person or Thing(Text("")), at)
    before = {norm for each in range(node.start, at) for norm in (d.tokens[each].norm,)}
    if name is None or name == other or set(d.language.tokens_of(name)) & before:
        return word
    possessives = d.language.speech["addressing"]["possessives"]
    if word in possessives and not _phrase_ends(d, at + 1):
        return str(d.language.speech["addressing"]["owned"].format(name=name))
    return name


def named_themselves(
    d: Discourse, options: tuple[str, ...], person: Thing | None
) -> tuple[str, ...]:
    """The choices with the name of the one asked: "whether she or Bob opens the door"."""
    subjects = d.language.speech.get("asked_pronouns", {}).get("subjects", ())
    if person is None or not person.known or not person.text:
        return options
    return tuple(d.called(person.text) if each in subjects else each for each in options)


def of_each(d: Discourse, node: Node) -> bool:
    """Whether a question about anybody is put to each of several: "ask them if anyone has a pen"
    asks "Do you have a pen?"."""
    anybody = d.language.speech.get("asked_pronouns", {}).get("anybody", ())
    subject = node.parts.get("subject")
    return (
        d.answers.asking_each
        and subject is not None
        and subject.end - subject.start == 1
        and d.tokens[subject.start].norm in anybody
    )


def about_another(d: Discourse, form: str, meant: Meant) -> str:
    """The form of a question about somebody else: "Are you {rest}?" -> "Is Alice {rest}?"."""
    data = d.language.speech["asked_pronouns"]
    turned = {} if meant.several else data["of_one"]
    for pair, singular in turned.items():
        form = form.replace(pair, singular)
    who = meant.subject
    return form.replace("your ", _owned(d, who)).replace("you", who)


def _owned(d: Discourse, who: str) -> str:
    pronouns = d.language.speech["asked_pronouns"]["several"]
    if who in pronouns:
        return "their "
    return str(d.language.speech["addressing"]["owned"].format(name=who)) + " "
