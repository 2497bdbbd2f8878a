"""How many want what they were asked about: "how many teas are needed" is how many have said yes to
"Would you like tea?", and nothing that the robot could see and count."""

from __future__ import annotations

from dataclasses import replace

from grammar.chart import Node
from grammar.discourse import Discourse
from grammar.errors import NotUnderstood
from grammar.meanings.answers import Said, is_about, names_option, silent_words
from grammar.meanings.news import Told
from grammar.meanings.polls import polled
from grammar.meanings.registry import meaning
from grammar.meanings.surveys import Survey, asked_so_far


@meaning("asked_number")
def asked_number(d: Discourse, node: Node) -> Told:
    """ "how many teas we need": of those who were asked whether they want one."""
    told = number_answered(d, node)
    if told is None:
        words = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("not_understood", part=words))
    return told


def number_answered(d: Discourse, node: Node) -> Told | None:
    """How many gave the answer that the parts of "how many ..." speak of, if all of them are about
    what was asked last and nothing says that it is to be seen."""
    surveys = asked_so_far(d)
    seen = d.language.words_called("seen_there")
    if not surveys or not surveys[-1].options or seen & set(d.norms(node.start, node.end)):
        return None
    start = min(part.start for part in node.parts.values())
    end = max(part.end for part in node.parts.values())
    telling = [norm for norm in d.norms(start, end) if norm not in silent_words(d)]
    if not telling or not _answered(d, surveys[-1], telling):
        return None
    return polled(d, "many", Said(start, end))


def _answered(d: Discourse, survey: Survey, telling: list[str]) -> bool:
    """Whether words say no more than was asked and, of several answers, which one."""
    yes_no = d.language.phrase("yes") in survey.options
    chosen = yes_no or any(names_option(d, telling, each) for each in survey.options)
    return chosen and is_about(d, survey, telling)


def of_answers(d: Discourse, node: Node) -> None:
    """Of those who were asked, only a number is told: "ask who wants tea and tell me how many"."""
    yes_no = {d.language.phrase("yes"), d.language.phrase("no")}
    if node.production.fixed.get("many") and d.answers.last is not None and d.answers.surveys:
        d.answers = replace(
            d.answers, polled_for="many" if set(d.answers.surveys[-1].options) == yes_no else "each"
        )
