"""Telling what the robot finds out, to whoever is to know it, and telling it again to others.

What is to be told is a `Report`: how to find it out and the phrase it is told with. A report about
somewhere else that is for the speaker is brought back to them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

from grammar.discourse import START, Discourse, Steps, Thing
from grammar.errors import NotUnderstood
from grammar.meanings.arrivals import arrival
from grammar.meanings.finding import is_here, speak_to
from grammar.meanings.follow_ups import asked_one_after_the_other, said_in_all, said_one_by_one
from grammar.meanings.news import BACK, back_to_speaker, in_round
from grammar.meanings.persons import is_me
from grammar.meanings.places import is_of
from grammar.meanings.polls import polled
from grammar.meanings.surveys import (
    in_loop,
    several_asked,
)
from grammar.plan import (
    Call,
    Holds,
    If,
    Recall,
    Remember,
    Step,
    Text,
    Value,
)
from grammar.tidy import nodes

IF_NONE: Final = {"people_seen": "nobody_there", "objects_seen": "nothing_seen"}
"""What is said instead where there is none to be told of."""


@dataclass(frozen=True)
class Report:
    """Something to tell."""

    phrase: str
    value: Value | None = None
    """What the phrase tells, found out when it is spoken."""
    place: Value | None = None
    """Where to find it out."""
    words: tuple[tuple[str, Value | str], ...] = ()
    """Fixed words of the phrase."""
    otherwise: str | None = None
    """The phrase for a value that is false; then `phrase` is for one that is true."""
    name: str = "result"
    """What the value is called when it is remembered."""
    before: tuple[Step, ...] = ()
    """Steps that find it out, where one value is not enough."""
    thing: Thing | None = None
    """What it says to be there or not."""
    about_here: bool = True
    """Whether it is about where the robot is, and so has to be found out there."""
    looked: bool = False
    """Whether it tells all that there is."""


def gone_to_tell(d: Discourse, person: Thing) -> Thing:
    """ "look at the lobby, then go to Bob's office and tell Bob how many are waiting": what is told
    there is of the place before, for he sees himself who is with him."""
    before, last = d.done[-2:] if len(d.done) > 1 else (None, None)
    if d.scene.at is None or last != Call("goto", {"place": d.scene.at}) or before == BACK:
        return person
    looked = isinstance(before, Call) and before.method == "goto"
    if not looked or person.place is not None or not is_their_place(d, d.scene.at, person):
        return person
    assert isinstance(before, Call)
    d.done.pop()
    own = d.scene.at
    d.scene = replace(d.scene, at=before.arguments["place"])
    d.scene = replace(d.scene, place=d.scene.at)
    return replace(person, place=own)


def is_their_place(d: Discourse, place: Value | None, person: Thing) -> bool:
    return person.known and isinstance(place, Text) and is_of(d, place.value, person.text)


def found_for(d: Discourse, person: Thing | None, found: Steps) -> Steps:
    """A search whose end is told: to whom it is for, where they are, and not to the speaker."""
    search = found[-1] if found else None
    if person is None or is_me(person) or not isinstance(search, If) or BACK not in search.then:
        return speak_to(d, person, found)

    def told_there(steps: tuple[Step, ...]) -> tuple[Step, ...]:
        at = steps.index(BACK)
        d.scene = d.scene.wandered()
        return (*steps[:at], *speak_to(d, person, list(steps[at + 1 :])))

    then, otherwise = told_there(search.then), told_there(search.otherwise)
    return [*found[:-1], If(search.condition, then, otherwise)]


def told_in_total(d: Discourse, found: Report, person: Thing | None) -> Steps:
    """ "go to every lab, count the chairs and tell me how many there are altogether"."""
    known = d.reports.last is not None and d.reports.last.name == "count"
    counted = known and any(each is d.reports.step for each in nodes(tuple(d.done)))
    steps = [] if counted else told(d, replace(found, place=None), None)
    d.reports = replace(d.reports, after_round=(person, "total"))
    return steps


def found_out(d: Discourse, found: Report, person: Thing | None, *, back: bool) -> Steps:
    """Go where something is to be found out, and tell it to a person, or to the speaker."""
    asked_by_me = person is None or is_me(person)
    if asked_by_me and found == d.reports.asked and d.done and d.done[-1] == d.reports.step:
        return []  # "check who is there and tell me their names"
    if found is d.reports.asked and not asked_by_me and d.done and d.done[-1] is d.reports.step:
        return retold(d, person)  # "see what is on the desk and tell Alex what is there"
    d.reports = replace(d.reports, asked=found)
    if asked_by_me:
        not_yet_back(d, found)
    steps: Steps = []
    if found.place is not None and found.place != d.scene.at:
        d.start()
        steps.append(Call("goto", {"place": found.place}))
        d.went(found.place)
        back = back or asked_by_me
    steps += found.before
    if (
        back
        and asked_by_me
        and d.scene.at is not None
        and not d.loops.in_loop
        and found.about_here
        and found.value is not None
    ):
        start = d.start()
        if not isinstance(found.value, Recall):
            name = d.variable(found.name)
            steps.append(Remember(name, found.value))
            found = replace(found, value=Recall(name))
        steps.append(Call("goto", {"place": start}))
        d.came_back()
        return [*steps, *told(d, found, None)]
    if back and asked_by_me and not found.about_here and isinstance(found.value, Recall):
        return [*back_to_speaker(d), *told(d, found, None)]  # "the time" that somebody named
    seen_here = found.about_here and found.value is not None
    if back and asked_by_me and seen_here and in_round(d):
        steps += told(d, found, None)
        d.reports = replace(d.reports, after_round=(None, "each"))
        return steps
    far = person is not None and not is_here(d, person) and found.about_here
    if far and seen_here and in_round(d) and person is not None and person.known:
        steps += told(d, found, None)
        d.reports = replace(
            d.reports, after_round=(person, "each")
        )  # they are told when all places have been seen
        return steps
    if far and found.value is not None and not isinstance(found.value, Recall):
        name = d.variable(found.name)
        steps.append(Remember(name, found.value))  # found out here, told there
        found = replace(found, value=Recall(name))
        if person is not None and not is_their_place(d, d.scene.at, person):
            d.done += steps  # whoever is to be told what is here is not here
            steps = []
    return [*steps, *told(d, found, person)]


def not_yet_back(d: Discourse, found: Report) -> None:
    """ "go to the lab, come back and tell me who is there", "look at the man in the lounge, come
    back and describe him": seen there, and told here."""
    if not found.about_here or found.value is None or d.done[-1:] != [BACK]:
        return
    looking: list[Call] = []
    for step in reversed(d.done[:-1]):
        if not isinstance(step, Call) or step.method not in ("goto", "find"):
            break
        looking.append(step)
    gone = [step for step in looking if "place" in step.arguments]
    place = gone[0].arguments["place"] if gone else None
    if place is not None and gone[0] != BACK and found.place in (None, place):
        d.done.pop()
        d.went(place)


def told(d: Discourse, found: Report, person: Thing | None) -> Steps:
    """Say it."""
    saying = saying_of(d, found)
    d.reports = replace(d.reports, last=found, step=saying)
    d.answers = replace(d.answers, last=None)
    d.reports = replace(d.reports, news=None, counted=None, checked=None)
    return speak_to(d, person, [saying])


def saying_of(d: Discourse, found: Report) -> Call | If:
    """What tells a report."""
    words = dict(found.words)
    if found.otherwise is not None:
        assert found.value is not None
        yes, no = d.say(found.phrase, **words), d.say(found.otherwise, **words)
        return If(Holds(found.value), (yes,), (no,))
    values: dict[str, Value | str] = {**words}
    if found.value is not None:
        values["value"] = found.value
    said = d.say(found.phrase, **values)
    looked_before = found.phrase == "people_seen" or isinstance(found.value, Recall)
    if found.value is not None and found.phrase in IF_NONE and looked_before:
        return If(Holds(found.value), (said,), (d.say(IF_NONE[found.phrase]),))
    return said


def kept(d: Discourse) -> str | None:
    """The variable with what the last report told; the report itself is dropped."""
    found: Report | None = d.reports.last
    at = next((at for at, step in enumerate(d.done) if step is d.reports.step), None)
    if found is None or found.value is None or at is None:
        return None
    if isinstance(found.value, Recall):
        del d.done[at]
        return found.value.name
    name = d.variable(found.name)
    d.done[at] = Remember(name, found.value)
    return name


def known_words(d: Discourse) -> Steps:
    """Say the last answer, those of all who were asked, or what the last code says."""
    if d.answers.last is not None:
        several = several_asked(d) or asked_one_after_the_other(d)
        if d.answers.surveys and (several or in_loop(d, d.answers.surveys[-1].call)):
            return polled(d, d.answers.polled_for or "answers", None).words
        return said_one_by_one(d) or [Call("say", {"text": said_in_all(d)})]
    if d.answers.code is not None:
        return [d.say("code_is", value=Recall(d.answers.code))]
    if (come := arrival(d)) is not None:
        return [come]
    raise NotUnderstood(d.language.phrase("say_what"))


def retold(d: Discourse, person: Thing | None) -> Steps:
    """Tell the last report to somebody else, or somewhere else."""
    found: Report = d.reports.last
    d.reports = replace(d.reports, counts=d.reports.counts and (person is None or is_me(person)))
    at = next((at for at, step in enumerate(d.done) if step is d.reports.step), None)
    if at is not None and not isinstance(found.value, Recall) and found.value is not None:
        name = d.variable(found.name)
        d.done[at] = Remember(name, found.value)
        found = replace(found, value=Recall(name))
    elif at is not None and at == len(d.done) - 1:
        d.done.pop()  # it is told to them and not to the speaker
        if d.done and d.done[-1] == Call("goto", {"place": Recall(START)}):
            d.done.pop()
            d.scene = replace(d.scene, at=found.place)
    elif at is not None and d.reports.open and not (person is None or is_me(person)):
        del d.done[at]  # nobody else was to be told on the way to them
        if at and d.done[at - 1] == BACK:
            del d.done[at - 1]
    return told(d, found, person)


def counted_alone(d: Discourse) -> bool:
    """Whether the last step is to say a number where nobody is who asked for it: "go to the lab and
    count the people"."""
    found: Report | None = d.reports.last
    counted = found is not None and found.name in ("count", "counts") and d.reports.counts
    told_here = bool(d.done) and d.done[-1] is d.reports.step
    return counted and told_here and d.scene.at not in (None, Recall(START))
