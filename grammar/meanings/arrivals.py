"""Whoever was waited for: told to somebody, or told from others who may have come instead."""

from __future__ import annotations

from collections.abc import Iterable

from grammar.chart import Leaf, Node
from grammar.discourse import Discourse, Steps
from grammar.meanings.deliveries import inside
from grammar.meanings.news import BACK, back_to_speaker
from grammar.naming import some
from grammar.plan import Ask, Call, Compare, If, Number, Repeat, Step, Text, Value, While
from grammar.wordforms import plural


def arrival_told(d: Discourse) -> Steps | None:
    """What the step before waited for, as a sentence, at the speaker's: "wait until Bob comes, then
    come back and tell me"; None if it waited for nobody."""
    saying = arrival(d)
    return None if saying is None else [*back_to_speaker(d), saying]


def arrival(d: Discourse) -> Step | None:
    """What the step before waited for, as a sentence."""
    last = last_done(d.done)
    match last:
        case Call(method="wait_for", arguments={"thing": Text() as who, **more}) if not more:
            return d.say("has_come", thing=called_here(d, who))
        case Repeat(Number() as number, (Call(method="wait_for", arguments={"thing": who}),)):
            return so_many(d, number, who)
        case While(Compare(Ask("count", {"thing": who}), "<", Number() as number)):
            return so_many(d, number, who)
        case _:
            return None


def last_done(done: Iterable[Step]) -> Step | None:
    """The last step but for the way back to the speaker."""
    return next((each for each in reversed([*done]) if each != BACK), None)


def called_here(d: Discourse, who: Text) -> str:
    """Somebody as they are spoken of: by name, or as "a visitor"."""
    named = any(each.name == who.value for each in d.lexicon.people)
    return d.called(who.value) if named else some(d.called(who.value), d.language)


def so_many(d: Discourse, number: Number, who: Value) -> Step | None:
    if not isinstance(who, Text):
        return None
    people = plural(d.called(who.value), d.language)
    return d.say("have_come", number=f"{number.value:g}", people=people)


def names_somebody(part: Leaf | Node) -> bool:
    """Whether some words speak of somebody by name."""
    return any(each.production.means == "person_name" for each in inside(part))


def may_be_another(d: Discourse, condition: Leaf | Node) -> bool:
    """Whether somebody has come of whom it is not said who they are, so that "if Bob comes" asks
    whether it is Bob."""
    if not names_somebody(condition):
        return False
    asked = [each for each in d.done if not isinstance(each, If)]
    last = last_done(asked)
    if not isinstance(last, Call) or last.method != "wait_for" or "timeout" in last.arguments:
        return False
    return last.arguments["thing"] not in {Text(each.name) for each in d.lexicon.people}
