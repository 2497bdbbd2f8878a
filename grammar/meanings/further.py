"""Asking further: the same of somebody else, or one more question of those who were asked."""

from __future__ import annotations

from dataclasses import replace

from grammar.chart import Leaf, Node
from grammar.discourse import Discourse, Steps, Thing, Where
from grammar.errors import NotUnderstood
from grammar.meanings.absences import undelivered
from grammar.meanings.asking import Audience, audience, put, remember_answer
from grammar.meanings.questions import ask_one, worded
from grammar.meanings.references import nouns_of
from grammar.meanings.registry import MEANINGS, meaning
from grammar.meanings.surveys import Survey, in_line, in_loop, note
from grammar.meanings.verb_forms import base_form
from grammar.plan import Call, Items, Text, Value
from grammar.tidy import nodes
from grammar.tokens import COMMA


@meaning("ask_again")
def ask_again(d: Discourse, node: Node) -> Steps:
    """ "..., if not, ask Alice": the same question."""
    person: Thing = d.get(node, "person_ref")
    message = undelivered(d, person)
    if message is not None:
        return message
    if not d.answers.surveys:
        raise NotUnderstood(d.language.phrase("ask_what"))
    last: Survey = (in_line(d) or d.answers.surveys)[-1]
    if d.answers.wondered and last.call in d.answers.wondered and person.value == last.who:
        wondered = d.answers.wondered
        d.answers = replace(d.answers, wondered=())  # asked only now
        d.done[:] = [each for each in d.done if not any(each is other for other in wondered)]
        d.answers = replace(d.answers, surveys=d.answers.surveys[:-1])
        d.variables -= {str(last.call.save_as)}
        if d.scene.at is None:
            person = replace(person, here=False)
            d.scene = replace(d.scene, with_person=None)
    if not person.known and isinstance(last.who, Text):  # "ask them again"
        person = Thing(last.who, known=True, person=True)
    spot: Where | None = d.get(node, "from")
    if spot is not None and spot.place is not None:
        person = replace(person, place=spot.place, here=False)
    arguments = {key: value for key, value in last.call.arguments.items() if key != "person"}
    whom = audience(d, person)
    d.scene = replace(d.scene, person=d.scene.person if whom.many else person)
    name = remember_answer(d, last.options, "answer")
    return put(d, whom, Call("ask", arguments, save_as=name), last.options, last.nouns)


@meaning("ask_on")
def ask_on(d: Discourse, node: Node) -> Steps:
    """ "if she has none, go on to Bob": he is asked the same, if there is nothing else to do."""
    after = d.tokens[node.end].norm if node.end < len(d.tokens) else ""
    in_branch = d.depth > 1 and bool(d.answers.surveys)
    if in_branch and after not in {COMMA, *d.language.speech.get("joins", ())}:
        return ask_again(d, node)
    going: Steps = MEANINGS["go_person"](d, node)
    return going


@meaning("ask_more")
def ask_more(d: Discourse, node: Node) -> Steps:
    """ "ask her whether it hurts, and how much": one more question to the same person."""
    if not follows(d, node):
        words = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("not_understood", part=words))
    if d.answers.surveys and asked_just_now(d) and in_loop(d, d.answers.surveys[-1].call):
        return ask_each_more(d, node)
    one = d.scene.person is not None and d.scene.person.group is None and not d.scene.person.every
    if not d.answers.surveys or not one or about_others(d, node.parts["question"]):
        raise NotUnderstood(d.language.phrase("no_question"))
    assert d.scene.person is not None
    return ask_one(d, node, replace(d.scene.person, here=True))


def follows(d: Discourse, node: Node) -> bool:
    """Whether it is joined to the question before: not "go | where he tells you"."""
    before = d.tokens[node.start - 1] if node.start else None
    if before is None:
        return False
    if d.depth > 1 and not d.done:  # "if he has seen it, and if so where"
        return True
    return before.kind == "mark" or before.norm in d.language.speech.get("joins", ())


def asked_just_now(d: Discourse) -> bool:
    """Whether the step before is the last question, or the loop that puts it to several."""
    return bool(d.done) and any(each is d.answers.surveys[-1].call for each in nodes(d.done[-1]))


def ask_each_more(d: Discourse, node: Node) -> Steps:
    """One more question to each of several: it is put behind the first, in the same loop."""
    first: Survey = d.answers.surveys[-1]
    question = node.parts["question"]
    assert isinstance(question, Node)
    text, options = worded(d, question, Audience(None, [], several=True))
    arguments: dict[str, Value] = {"question": Text(text)}
    if options:
        arguments["options"] = Items(tuple(map(Text, options)))
    if "person" in first.call.arguments:
        arguments["person"] = first.call.arguments["person"]
    name = remember_answer(d, options, "answer")
    nouns = nouns_of(d, question, options)
    call = Call("ask", arguments, save_as=name)
    note(d, first.call, [call], [])
    survey = Survey(call, options, first.who, first.where, nouns)
    d.answers = replace(d.answers, surveys=(*d.answers.surveys, survey))
    return []


def about_others(d: Discourse, question: Leaf | Node) -> bool:
    """Whether the pronoun of a second question may mean somebody or something of the first:
    "whether she is in pain, and how strong they are"."""
    if not isinstance(question, Node) or "asked" not in question.parts:
        return False
    before = d.answers.surveys[-1].call.arguments["question"]
    words = d.language.tokens_of(before.value) if isinstance(before, Text) else ()
    if any(d.language.tokens_of(each.name)[0] in words for each in d.lexicon.people):
        return True
    verb = question.parts.get("verb")
    said = d.words(verb.start, verb.end) if verb is not None else ""
    several = base_form(d, said) == said  # "sind", of one who is asked
    return several and d.scene.person is not None and d.scene.person.known
