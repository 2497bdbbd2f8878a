"""What later clauses mean by an answer: "that time", "the colour", "what she said", "that many".

An answer is a value. A noun phrase speaks of it that names what was asked for ("what time ..." is a
time, "where ..." a place, answers from one to five are numbers); so do the words that always do
("that many", "her answer"). What speaks of an answer inside a text is put into the text.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from grammar.chart import Leaf, Node
from grammar.discourse import Discourse
from grammar.errors import NotUnderstood
from grammar.meanings.news import Told
from grammar.meanings.polls import chosen_most, polled
from grammar.meanings.registry import meaning
from grammar.meanings.surveys import Survey, asked_before, in_loop
from grammar.plan import Call, Forever, Recall, Sentence, Text, Value
from grammar.tidy import nodes
from grammar.wordforms import singular


@meaning("answer_named")
def answer_named(d: Discourse, node: Node) -> Told:
    """ "the reason", "that time", "their favourite colour": what somebody has answered."""
    part = node.parts["noun"]
    survey = survey_named(d, part.start, part.end)
    if survey is None:
        words = d.words(node.start, node.end)
        raise NotUnderstood(
            d.language.phrase("not_understood", part=words), gap=(node.start, node.end)
        )
    value = answer_to(d, survey)
    d.resolve(range(part.start, part.end))
    if value is None:
        return polled(d, "answers", None)
    return Told([Call("say", {"text": value})], [])


def survey_named(d: Discourse, start: int, end: int) -> Survey | None:
    """The question whose answer a noun speaks of; the last one, if of several."""
    words = d.norms(start, end)
    noun = singular(words[-1], d.language)
    surveys: tuple[Survey, ...] = d.answers.surveys
    return next((each for each in reversed(surveys) if noun in each.nouns), None)


def answer_to(d: Discourse, survey: Survey) -> Value | None:
    """The one answer to a question; None if it was put to several who need not agree."""
    if d.answers.agreed is not None and d.answers.agreed[0] is survey.call:
        agreed: Value = d.answers.agreed[1]
        return agreed
    last = d.done[-1] if d.done else None
    each = isinstance(last, Forever) and any(node is survey.call for node in nodes(last))
    if survey.call.save_as is None or (in_loop(d, survey.call) and not each):
        return None  # what follows a loop without end belongs to each of its rounds
    return Recall(survey.call.save_as)


def nouns_of(d: Discourse, question: Node, options: tuple[str, ...]) -> frozenset[str]:
    """The nouns that the answer to a question may be spoken of with."""
    names: dict[str, list[str]] = d.language.speech.get("answer_nouns", {})
    found: set[str] = set()
    asking = question.parts.get("wh", question)
    said = d.norms(asking.start, asking.end if "wh" in question.parts else asking.start + 2)
    for word in (*said, " ".join(said[:2])):
        found.update(names.get(word, ()))
    if "wh" in question.parts and len(said) > 1 and said[-1] not in d.language.closed:
        found.add(singular(said[-1], d.language))
    found.update(question.production.fixed.get("called", ()))
    for part in (question.parts.get("noun"), _asked_for(d, question)):
        if part is not None:
            words = d.norms(part.start, part.end)
            joins = d.language.words_called("noun_joins")  # "the room number of the seminar"
            end = next((at for at, word in enumerate(words) if at and word in joins), len(words))
            found.add(singular(words[end - 1], d.language))
    return frozenset(found.union(*(names.get(kind, ()) for kind in _kinds(d, options))))


def _asked_for(d: Discourse, question: Node) -> Leaf | Node | None:
    """What "what their favourite colour is" asks for."""
    asking, subject = question.parts.get("wh"), question.parts.get("subject")
    if asking is None or subject is None or asking.end - asking.start > 1:
        return None
    return None if {"verb", "rest"} & question.parts.keys() else subject


def _kinds(d: Discourse, options: tuple[str, ...]) -> Iterator[str]:
    """What kinds of things all of some options are: "numbers", "places", "days", "times"."""
    if not options:
        return
    places = {each for place in d.lexicon.places for each in (place.name, d.called(place.name))}
    days = {" ".join(way) for ways in d.language.lists["weekday"].values() for way in ways}
    clock = set(d.language.speech.get("clock_words", ()))
    if all(each.isdigit() for each in options):
        yield "numbers"
    if all(each in places for each in options):
        yield "places"
    if all(each.lower() in days for each in options):
        yield "days"
    if any(":" in each or clock & set(d.language.tokens_of(each)) for each in options):
        yield "times"


# --- in texts


def answers_in(d: Discourse, text: str, start: int, end: int) -> Value:
    """A text made of some words, with the answers in it that these words speak of."""
    if d.round.such is not None and d.norms(end - 1, end)[0] in d.language.speech.get("there", ()):
        # "find an empty office and tell Bob to meet me there": he has to hear which one it is
        words = text.rstrip(".!")
        end_of_it = (Text(text[len(words) :]),) if text != words else ()
        return Sentence((Text(f"{words}: "), Recall(d.round.such), *end_of_it))
    parts: list[Value] = []
    rest = text
    for first, last, value in list(_spoken_of(d, start, end)):
        words = d.words(first, last)
        found = re.search(rf"\b{re.escape(words)}\b", rest, re.IGNORECASE)
        if found is None:
            raise NotUnderstood(d.language.phrase("not_understood", part=words))
        before = rest[: found.start()]
        if last == end:  # "welcome and their name"
            joins = "|".join(d.language.speech.get("joins", ()))
            before = re.sub(rf"(?:,? (?:{joins})|,) $", " ", before)
        if before:
            parts.append(Text(before))
        parts.append(value)
        rest = rest[found.end() :]
        d.resolve(range(first, last))
    if not parts:
        return Text(text)
    if rest:
        parts.append(Text(rest))
    return Sentence(tuple(parts))


def _spoken_of(d: Discourse, start: int, end: int) -> Iterator[tuple[int, int, Value]]:
    """Where among some tokens an answer is spoken of, and the answer."""
    if not d.answers.surveys:
        return
    always = [d.language.tokens_of(each) for each in d.language.speech.get("that_answer", ())]
    pointing = set(d.language.speech.get("that_noun", ()))
    theirs = set(d.language.speech.get("their_noun", ()))
    further = set(d.language.speech.get("noun_goes_on", ()))
    at = start
    while at < end:
        survey, last = None, at + 1
        most = next((each for each in _of_most(d) if _stand_here(d, each, at, end)), None)
        if most is not None:
            yield at, at + len(most), chosen_most(d, asked_before(d))
            at += len(most)
            continue
        for phrase in always:
            if _stand_here(d, phrase, at, end):
                survey, last = d.answers.surveys[-1], at + len(phrase)
        more = d.tokens[at + 2].norm if at + 2 < end else ""
        points = d.tokens[at].norm in pointing and at + 1 < end and more not in further
        points = points or (d.tokens[at].norm in theirs and at + 2 == end)
        if survey is None and points:
            survey, last = survey_named(d, at + 1, at + 2), at + 2
        value = answer_to(d, survey) if survey is not None else None
        if value is None:
            at += 1
            continue
        yield at, last, value
        at = last


def _of_most(d: Discourse) -> list[tuple[str, ...]]:
    """The phrases for what most of those who were asked have chosen."""
    return [d.language.tokens_of(each) for each in d.language.speech.get("most_answer", ())]


def _stand_here(d: Discourse, words: tuple[str, ...], at: int, end: int) -> bool:
    return tuple(d.norms(at, at + len(words))) == words and at + len(words) <= end
