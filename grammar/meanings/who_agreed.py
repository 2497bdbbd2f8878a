"""Those of several who said yes, where "them" means them: "ask who is hungry and bring them to the
cafeteria", "find out whether anybody there speaks French and ask them to come"."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from grammar.chart import Leaf, Node
from grammar.discourse import Discourse, Steps
from grammar.meanings.answers import yes
from grammar.meanings.one_round import Make, round_of_steps
from grammar.meanings.surveys import Survey, each_asked
from grammar.plan import If

LEADS: Final = frozenset({"guide", "guide_back", "guide_to_person", "fetch_person"})
"""What is done with nobody who has said no."""


def asks_for_some(d: Discourse, question: Leaf | Node | None) -> bool:
    """Whether a question to several looks for those of them of whom something is so: "who is
    hungry", "if anybody speaks French"."""
    if not isinstance(question, Node):
        return False
    data = d.language.speech.get("asked_pronouns", {})
    anybody = {*data.get("anybody", ()), *data.get("of_them", ())}
    parts = [question.parts[name] for name in ("rest", "verb", "aux") if name in question.parts]
    first = min((part.start for part in parts), default=question.start)
    said = d.norms(question.start, first)
    return "each" in question.production.fixed or bool(anybody & set(said))


def who_agreed(d: Discourse, node: Node, part: Node) -> bool:
    """Whether a pronoun stands for those who said yes to what was asked of several."""
    if part.means != "person_pronoun" or d.scene.thing_last or each_asked(d) is None:
        return False
    objects = d.language.speech.get("asked_pronouns", {}).get("objects", ())
    if d.tokens[part.start].norm not in objects or node.means == "report":
        return False  # "tell me their names"
    survey: Survey = d.answers.surveys[-1]
    agree = {d.language.phrase("yes"), d.language.phrase("no")}
    if set(survey.options) != agree or d.scene.with_person == survey.who:
        return False
    one = d.scene.person is not None and d.scene.person.known and d.scene.person.group is None
    if one and d.scene.person is not None and d.scene.person.value != survey.who:
        return False  # "find somebody who can help and bring them here"
    if d.answers.polled_for != "who" and node.means not in LEADS:
        return False
    named = d.one_called(part.start, part.end)
    return d.is_plural(part) or (d.answers.polled_for == "who" and named is None)


def for_who_agreed(d: Discourse, part: Node, make: Make) -> Make:
    """What makes the steps of a command for each of those who said yes."""

    def steps() -> Steps:
        survey: Survey = d.answers.surveys[-1]
        given = yes(d).given(survey)
        person = each_asked(d)
        d.scene = replace(d.scene, at=None)
        with d.bound(part, person):
            return [If(given, tuple(round_of_steps(d, make)))]

    return steps
