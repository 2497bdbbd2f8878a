"""Whether something is so, as what is to be told, and for "if so" and "if not" behind it."""

from __future__ import annotations

from dataclasses import replace

from grammar.chart import Node, what_it_means
from grammar.discourse import Discourse
from grammar.meanings.news import Told, not_back_yet, take_back
from grammar.meanings.polls import how_many_words
from grammar.meanings.registry import meaning
from grammar.meanings.reports import Report
from grammar.meanings.surveys import asked_before, in_loop, of_one_question
from grammar.plan import Holds, If, Recall, Remember, Truth, Value
from grammar.wordorder import direct_clause


@meaning("whether_told")
def whether_told(d: Discourse, node: Node) -> Told:
    """ "whether there are five chairs in the lobby", "whether the kitchen is empty": of any
    condition, found out there and told elsewhere."""
    part = node.parts["condition"]
    condition = d.get(node, "condition")
    before = d.command.pending
    d.command = replace(d.command, pending=())
    so = d.variable("so")
    d.reports = replace(d.reports, checked=so)
    no, yes = Remember(so, Truth(False)), Remember(so, Truth(True))
    clause = direct_clause(d, part.start, part.end)
    told_yes, told_no = d.say("so_it_is", clause=clause), d.say("not_so", clause=clause)
    if node.production.fixed.get("asked"):  # "is meeting room 2 free?"
        told_yes, told_no = d.say("so_yes"), d.say("so_no")
    told = If(Holds(Recall(so)), (told_yes,), (told_no,))
    d.reports = replace(d.reports, last=None)
    return Told([told], [*before, no, If(condition, (yes,))])


@meaning("poll_whether")
def poll_whether(d: Discourse, node: Node) -> Told:
    """ "whether all agree", "if anybody said no": also how many have said so."""
    surveys = of_one_question(asked_before(d))
    counted = what_it_means(node.parts["condition"]) == "answers_many"
    if not counted or (len(surveys) == 1 and not in_loop(d, surveys[0].call)):
        return whether_told(d, node)
    condition = d.get(node, "condition")
    counts = how_many_words(d, surveys, d.answers.said)
    so, not_so = d.say("yes_so", counts=counts), d.say("no_so", counts=counts)
    return Told([If(condition, (so,), (not_so,))], [])


def checked(d: Discourse) -> Value | None:
    """What was checked last, for "if so" and "if not"; that nobody was named to tell it to is then
    no reason to tell the speaker."""
    if d.reports.checked is not None and d.reports.news is not None:
        take_back(d, d.reports.news)
        return Recall(d.reports.checked)
    found: Report | None = d.reports.last
    if found is None or found.otherwise is None or found.value is None:
        return None
    if not d.reports.open:
        return found.value if isinstance(found.value, Recall) else None
    name = found.value.name if isinstance(found.value, Recall) else None
    at = next((at for at, step in enumerate(d.done) if step is d.reports.step), None)
    if at is None:
        return None
    if name is None:
        name = d.variable(found.name)
        d.done[at] = Remember(name, found.value)
    else:
        d.done.pop(at)
        not_back_yet(d)
    d.reports = replace(d.reports, last=replace(found, value=Recall(name)))
    return Recall(name)
