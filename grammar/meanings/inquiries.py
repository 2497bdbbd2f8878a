"""Questions that are put first and asked then ("What does Alice want? Ask her."), and answers that
say how much is to be brought.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from grammar.chart import Node
from grammar.discourse import ANYONE, Discourse, Steps, Thing, Where
from grammar.errors import NotUnderstood
from grammar.meanings.carrying import deliver
from grammar.meanings.finding import speak_to
from grammar.meanings.news import go_back
from grammar.meanings.orders_to_tell import tell_speaker
from grammar.meanings.places import only_taken_apart
from grammar.meanings.questions import ask_one
from grammar.meanings.registry import meaning
from grammar.meanings.surveys import Survey, each_asked, in_loop
from grammar.meanings.whom_asked import several_of_a_kind
from grammar.plan import Call, Recall, Repeat, Text, Value
from grammar.tidy import mentions, nodes
from grammar.wordforms import head_word, singular


@meaning("ask_topic")
def ask_topic(d: Discourse, node: Node) -> Steps:
    """ "What does Alice want for dinner? Go and ask her.", "Which of them want tea? Ask them."."""
    question = node.parts["question"]
    assert isinstance(question, Node)
    person: Thing | None = d.get(question, "person_ref") or d.get(node, "person_ref")
    place: Value | None = d.get(question, "asked_at")
    kind = question.production.fixed.get("kind")
    person = several_of_a_kind(d, question, person)
    if person is None:  # "how many people in the lobby want coffee?"
        person = Thing(Text(ANYONE), person=True, plural=True)
    if person.text == ANYONE and not person.known:  # "does anybody in the lounge have a charger?"
        person = replace(person, plural=True)
        kind = question.production.fixed.get("kind", "who")
    steps = ask_one(d, node, replace(person, place=place or person.place))
    d.answers = replace(d.answers, put=d.answers.surveys[-1], polled_for=kind)
    if node.production.fixed.get("told"):  # "I wonder whether Bob has time, go and ask him"
        d.done.extend(steps)
        d.done.extend(tell_speaker(d))
        return []
    return steps


@meaning("wondered")
def wondered(d: Discourse, node: Node) -> Steps:
    """ "I want to know whether Bob has time", "Alice wants to know whether ...": he is asked; where
    it is said next how ("go to his office and ask him"), then so."""
    whom: Thing | None = d.get(node, "whom")
    steps = ask_topic(d, node)
    if whom is not None:
        d.answers = replace(d.answers, put=None)
    if d.answers.last is not None:
        d.answers = replace(d.answers, wondered=tuple(steps), wonder=(d.answers.last, whom))
    return steps


def wonder_told(d: Discourse) -> Steps:
    """What somebody wants to know, if nobody is told of it."""
    if d.answers.wonder is None or mentions(tuple(d.done), Recall(d.answers.wonder[0])):
        return []
    answer, whom = d.answers.wonder
    saying = Call("say", {"text": Recall(answer)})
    return [*go_back(d, []), saying] if whom is None else speak_to(d, whom, [saying])


def owed(d: Discourse) -> Steps:
    """The answers to a question that the speaker put, where nothing else is done with them."""
    put: Survey | None = d.answers.put
    if put is None or put.call.save_as is None:
        return []
    asked = any(each is put.call for each in nodes(tuple(d.done)))
    if not asked or mentions(d.done, Recall(put.call.save_as)):
        return []
    return tell_speaker(d)


@meaning("bring_many")
def bring_many(d: Discourse, node: Node) -> Steps:
    """ "and bring that many": as many as was answered, to whoever was asked."""
    if d.answers.last is None or not d.answers.surveys:
        raise NotUnderstood(d.language.phrase("no_question"))
    survey: Survey = d.answers.surveys[-1]
    if survey.options and not all(each.isdigit() for each in survey.options):
        raise NotUnderstood(d.language.phrase("not_understood", part=d.words(node.start, node.end)))
    thing: Thing | None = d.get(node, "thing") or d.scene.thing
    if thing is None or thing.value == Recall(d.answers.last):  # so many of what?
        raise NotUnderstood(d.language.phrase("what_is_it", word=d.words(node.start, node.end)))
    source: Where | None = d.get(node, "from")
    if source is not None:
        thing = replace(thing, place=source.place, furniture=source.furniture)
    person: Thing | None = d.get(node, "person_ref")
    if person is None and survey.who is not None and survey.where is None:
        person = Thing(survey.who, known=True, person=True)
    d.scene = d.scene.wandered()
    fetching = deliver(d, replace(thing, pronoun=False), person, d.get(node, "where"))
    so_many = Repeat(Recall(d.answers.last), tuple(fetching))
    d.deliveries = replace(d.deliveries, so_many=so_many)
    return [so_many]


def as_many_as_answered(d: Discourse, node: Node) -> Steps | None:
    """ "ask David how many chairs he needs and bring them to him": so many; None if "them" are no
    such things. "Get them from the lounge and bring them to him" is one errand."""
    survey: Survey | None = d.answers.surveys[-1] if d.answers.surveys else None
    part, asked_of = node.parts.get("thing"), d.scene.thing
    if survey is None or asked_of is None or not isinstance(part, Node) or not d.is_plural(part):
        return None
    question = survey.call.arguments["question"]
    if (
        part.means not in ("thing_it", "person_pronoun")
        or survey.call.save_as != d.answers.last
        or not d.answers.last
    ):
        return None
    words = d.language.tokens_of(question.value) if isinstance(question, Text) else ()
    number = any(
        tuple(words[: len(sign)]) == sign
        for sign in map(d.language.tokens_of, d.language.speech.get("asks_number", ()))
    )
    if not number or head_word(asked_of.text, d.language) not in {
        singular(word, d.language) for word in words
    }:
        return None
    if d.done and d.done[-1] is d.deliveries.so_many:
        person: Thing | None = d.get(node, "person_ref")
        return [] if person is not None and person.value == survey.who else None
    rest = {name: each for name, each in node.parts.items() if name != "thing"}
    return bring_many(d, replace(node, parts=rest))


@meaning("thing_answered")
def thing_answered(d: Discourse, node: Node) -> Thing:
    """ "what he wanted", "the one she chose": the thing that an answer names."""
    person: Thing | None = d.get(node, "person_ref")
    surveys: Sequence[Survey] = d.answers.surveys
    if person is not None and person.known:
        surveys = [each for each in surveys if each.who in (person.value, None)] or surveys
    survey = surveys[-1] if surveys else None
    agree = {d.language.phrase("yes"), d.language.phrase("no")}
    if survey is None or survey.call.save_as is None:
        raise NotUnderstood(d.language.phrase("no_question"))
    if agree & set(survey.options) or (
        survey.options and all(each.isdigit() for each in survey.options)
    ):
        raise NotUnderstood(d.language.phrase("not_understood", part=d.words(node.start, node.end)))
    found = Thing(Recall(survey.call.save_as))
    source: Where | None = d.get(node, "from")
    if source is not None:
        found = replace(found, place=source.place, furniture=source.furniture)
    d.scene = d.scene.speaking_of(found)
    return found


@meaning("person_said")
def person_said(d: Discourse, node: Node) -> Thing:
    """ "each one who said yes": whoever was asked; whether they said so is a condition of what is
    done for them (`grammar.meanings.quantifiers`)."""
    only_taken_apart(d, node)
    if not d.answers.surveys:
        raise NotUnderstood(d.language.phrase("no_question"))
    survey: Survey = d.answers.surveys[-1]
    asked = each_asked(d)
    if asked is not None:
        return asked
    if survey.who is None and d.scene.person is not None and in_loop(d, survey.call):
        return replace(
            d.scene.person, here=True, place=None, count=None
        )  # whoever comes, in their turn
    if not isinstance(survey.who, Text):
        raise NotUnderstood(d.language.phrase("not_understood", part=d.words(node.start, node.end)))
    return Thing(survey.who, known=True, person=True)
