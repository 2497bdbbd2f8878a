"""What the robot knows of itself and its house, to tell: the time, the battery, a joke."""

from __future__ import annotations

from typing import Final

from grammar.chart import Node
from grammar.discourse import Discourse, Steps, as_value
from grammar.errors import Ambiguous, NotUnderstood
from grammar.meanings.finding import speak_to
from grammar.meanings.places import kind_places
from grammar.meanings.references import answer_to, survey_named
from grammar.meanings.registry import meaning
from grammar.meanings.reports import Report, told
from grammar.meanings.speaking import language_spoken
from grammar.naming import place_called
from grammar.plan import (
    Ask,
    Choice,
    Compare,
    If,
    Items,
    Number,
    Step,
    Text,
    Value,
    Weekday,
)

WEEK: Final = ("Monday", "Tuesday", "Wednesday", "Thursday", "Friday", "Saturday", "Sunday")
"""As the clock of a robot names the days."""


@meaning("about_robot")
def about_robot(d: Discourse, node: Node) -> Report:
    fixed = node.production.fixed
    survey = survey_named(d, node.end - 1, node.end) if d.answers.surveys else None
    answer = answer_to(d, survey) if survey is not None else None
    asked = asked_for_that(d, node)
    if asked is not None:
        return Report("only", asked, about_here=False)
    if answer is not None and node.end - node.start == 2:
        return Report(
            "only", answer, about_here=False
        )  # "the time", after somebody was asked for one
    value: Value = Ask(str(fixed["method"]), {}, fixed.get("field"))
    if fixed.get("field") == "weekday" and names_of_days(d) != WEEK:
        value = Weekday(names_of_days(d))
    return Report(str(fixed["phrase"]), value, about_here=False)


def asked_for_that(d: Discourse, node: Node) -> Value | None:
    """ "which day it is", after somebody was asked for a day, and not what day it is now."""
    norms = d.norms(node.start, node.end)
    if not d.answers.surveys or set(norms) & set(d.language.speech.get("of_now", ())):
        return None
    survey = next(
        (each for at in range(node.start, node.end) if (each := survey_named(d, at, at + 1))), None
    )
    if survey is None:
        return None
    question = survey.call.arguments["question"]
    words = d.language.tokens_of(question.value) if isinstance(question, Text) else ()
    return answer_to(d, survey) if survey.options or set(norms) & survey.nouns & {*words} else None


def names_of_days(d: Discourse) -> tuple[str, ...]:
    """The days of the week in the language spoken."""
    called = d.language.speech.get("names", {})
    return tuple(called.get(day, day) for day in WEEK)


@meaning("tomorrow")
def tomorrow(d: Discourse, node: Node) -> Steps:
    """ "what day is tomorrow": the one after what the clock says."""
    chain: tuple[Step, ...] = ()
    names = names_of_days(d)
    for today, next_day in reversed(list(zip(WEEK, (*names[1:], names[0]), strict=True))):
        is_today = Compare(Ask("clock", field="weekday"), "==", Text(today))
        chain = (If(is_today, (d.say("tomorrow_is", value=Text(next_day)),), chain),)
    return list(chain)


@meaning("fixed_phrase")
def fixed_phrase(d: Discourse, node: Node) -> Report:
    return Report(str(node.production.fixed["phrase"]), about_here=False)


@meaning("some_joke")
def some_joke(d: Discourse, node: Node) -> Report:
    return joke(d)


@meaning("tell_joke")
def tell_joke(d: Discourse, node: Node) -> Steps:
    return told(d, joke(d), d.get(node, "person_ref"))


def joke(d: Discourse) -> Report:
    jokes = [text for name, text in language_spoken(d).phrases.items() if name.startswith("joke_")]
    return Report(
        "only", Choice(Items(tuple(Text(each) for each in jokes))), name="joke", about_here=False
    )


@meaning("known_places")
def known_places(d: Discourse, node: Node) -> Report:
    return Report("places_are", kind_places(d, d.get(node, "kind")), about_here=False)


@meaning("last_log")
def last_log(d: Discourse, node: Node) -> Report:
    lines = d.get(node, "lines")
    arguments: dict[str, Value] = {} if lines is None else {"lines": as_value(lines)}
    return Report("log_says", Ask("log", arguments), about_here=False)


@meaning("tell")
def tell(d: Discourse, node: Node) -> Steps:
    """Say a phrase with the result of a robot method in it."""
    fixed = node.production.fixed
    method = str(fixed["method"])
    value = Ask(method, d.call_of(node, method).arguments)
    return speak_to(d, d.get(node, "person_ref"), [d.say(str(fixed["phrase"]), value=value)])


@meaning("battery_low")
def battery_low(d: Discourse, node: Node) -> object:
    fixed = node.production.fixed
    return Compare(Ask("battery"), str(fixed["operator"]), Number(int(fixed["percent"])))


@meaning("offer_guide")
def offer_guide(d: Discourse, node: Node) -> Steps:
    """ "where is the lift?": the robot can show the way, if that is wanted."""
    place = d.get(node, "place")
    if not isinstance(place, Text):
        raise NotUnderstood(d.language.phrase("where_is_there"))
    name = place_called(place.value, d.lexicon, d.language)
    question = d.language.phrase("offer_guide", place=name)
    yes = d.language.phrase("take_me_to", place=name)
    raise Ambiguous(question, 0, len(d.tokens), (yes,))
