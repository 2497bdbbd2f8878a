"""Telling what the robot finds out, to whoever is to know it, and telling it again to others.

What is to be told is a `Report`: how to find it out and the phrase it is told with. A report about
somewhere else that is for the speaker is brought back to them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

from grammar.chart import Node
from grammar.discourse import START, Discourse, Steps, Thing, Where
from grammar.doubts import NotUnderstood
from grammar.meanings import news, polls
from grammar.meanings.about_guests import who_is_told
from grammar.meanings.absences import undelivered
from grammar.meanings.answered_numbers import of_answers
from grammar.meanings.arrivals import arrival, arrival_told
from grammar.meanings.finding import is_here, speak_to
from grammar.meanings.follow_ups import asked_one_after_the_other, said_in_all, said_one_by_one
from grammar.meanings.persons import is_me
from grammar.meanings.places import is_of, sought
from grammar.meanings.registry import meaning
from grammar.meanings.sent_to_tell import searched_before, sent_to
from grammar.meanings.surveys import (
    in_loop,
    moved,
    several_asked,
)
from grammar.plan import (
    Ask,
    Call,
    Holds,
    If,
    Recall,
    Remember,
    Step,
    Text,
    Value,
)
from grammar.tidy import mentions, nodes

IF_NONE: Final = {"people_seen": "nobody_there"}
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


@meaning("report")
def report(d: Discourse, node: Node) -> Steps:
    receiver, info = node.parts.get("person_ref"), node.parts["info"]
    found: Report | Steps | None = None
    if receiver is not None and info.start < receiver.start:
        found = d.get(node, "info")  # "their" is not whom it is told to after that
    person: Thing | None = d.get(node, "person_ref")
    person_at: Where | None = d.get(node, "person_at")
    if person is not None and person_at is not None:  # "tell Bob the time in the kitchen"
        person = replace(person, place=person_at.place, here=False)
    if person is not None and found is None:
        person = gone_to_tell(d, person)
    if found is None:
        found = d.get(node, "info")
    if isinstance(found, list):
        if receiver is not None and receiver.start < info.start:
            person = sent_to(d, person) or person
        steps = found_for(d, person, found)
        if is_me(person) and d.answer is not None and not mentions(steps, news.BACK):
            steps = [*news.back_to_speaker(d), *steps]
        d.told = steps[-1] if steps else None
        return steps
    fixed = node.production.fixed
    known = d.news is not None and d.news is d.round.present
    if known and isinstance(info, Node) and info.means == "names_here":
        return told_again(d, person)  # "see if Alice and Bob are in, and tell me who is there"
    if isinstance(info, Node) and info.production.fixed.get("total") and news.in_round(d):
        return told_in_total(d, found, person)
    d.report_open = person is None and bool(fixed.get("open", not fixed.get("to_me")))
    d.report_counts = person is None and bool(fixed.get("counted"))
    return found_out(d, found, person, back=bool(fixed.get("to_me")) or is_me(person))


def gone_to_tell(d: Discourse, person: Thing) -> Thing:
    """ "look at the lobby, then go to Bob's office and tell Bob how many are waiting": what is told
    there is of the place before, for he sees himself who is with him."""
    before, last = d.done[-2:] if len(d.done) > 1 else (None, None)
    if d.at is None or last != Call("goto", {"place": d.at}) or before == news.BACK:
        return person
    looked = isinstance(before, Call) and before.method == "goto"
    if not looked or person.place is not None or not is_their_place(d, d.at, person):
        return person
    assert isinstance(before, Call)
    d.done.pop()
    own, d.at = d.at, before.arguments["place"]
    d.place = d.at
    return replace(person, place=own)


def is_their_place(d: Discourse, place: Value | None, person: Thing) -> bool:
    return person.known and isinstance(place, Text) and is_of(d, place.value, person.text)


def found_for(d: Discourse, person: Thing | None, found: Steps) -> Steps:
    """A search whose end is told: to whom it is for, where they are, and not to the speaker."""
    search = found[-1] if found else None
    if (
        person is None
        or is_me(person)
        or not isinstance(search, If)
        or news.BACK not in search.then
    ):
        return speak_to(d, person, found)

    def told_there(steps: tuple[Step, ...]) -> tuple[Step, ...]:
        at = steps.index(news.BACK)
        d.at = d.with_person = None
        return (*steps[:at], *speak_to(d, person, list(steps[at + 1 :])))

    then, otherwise = told_there(search.then), told_there(search.otherwise)
    return [*found[:-1], If(search.condition, then, otherwise)]


def told_in_total(d: Discourse, found: Report, person: Thing | None) -> Steps:
    """ "go to every lab, count the chairs and tell me how many there are altogether"."""
    known = d.report is not None and d.report.name == "count"
    counted = known and any(each is d.report_step for each in nodes(tuple(d.done)))
    steps = [] if counted else told(d, replace(found, place=None), None)
    d.after_round = (person, "total")
    return steps


def found_out(d: Discourse, found: Report, person: Thing | None, *, back: bool) -> Steps:
    """Go where something is to be found out, and tell it to a person, or to the speaker."""
    asked_by_me = person is None or is_me(person)
    if asked_by_me and found == d.report_asked and d.done and d.done[-1] == d.report_step:
        return []  # "check who is there and tell me their names"
    if found is d.report_asked and not asked_by_me and d.done and d.done[-1] is d.report_step:
        return retold(d, person)  # "see what is on the desk and tell Alex what is there"
    d.report_asked = found
    if asked_by_me:
        not_yet_back(d, found)
    steps: Steps = []
    if found.place is not None and found.place != d.at:
        d.start()
        steps.append(Call("goto", {"place": found.place}))
        d.went(found.place)
        back = back or asked_by_me
    steps += found.before
    if (
        back
        and asked_by_me
        and d.at is not None
        and not d.in_loop
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
        return [*news.back_to_speaker(d), *told(d, found, None)]  # "the time" that somebody named
    seen_here = found.about_here and found.value is not None
    if back and asked_by_me and seen_here and news.in_round(d):
        steps += told(d, found, None)
        d.after_round = (None, "each")
        return steps
    far = person is not None and not is_here(d, person) and found.about_here
    if far and seen_here and news.in_round(d) and person is not None and person.known:
        steps += told(d, found, None)
        d.after_round = (person, "each")  # they are told when all places have been seen
        return steps
    if far and found.value is not None and not isinstance(found.value, Recall):
        name = d.variable(found.name)
        steps.append(Remember(name, found.value))  # found out here, told there
        found = replace(found, value=Recall(name))
        if person is not None and not is_their_place(d, d.at, person):
            d.done += steps  # whoever is to be told what is here is not here
            steps = []
    return [*steps, *told(d, found, person)]


def not_yet_back(d: Discourse, found: Report) -> None:
    """ "go to the lab, come back and tell me who is there", "look at the man in the lounge, come
    back and describe him": seen there, and told here."""
    if not found.about_here or found.value is None or d.done[-1:] != [news.BACK]:
        return
    looking: list[Call] = []
    for step in reversed(d.done[:-1]):
        if not isinstance(step, Call) or step.method not in ("goto", "find"):
            break
        looking.append(step)
    gone = [step for step in looking if "place" in step.arguments]
    place = gone[0].arguments["place"] if gone else None
    if place is not None and gone[0] != news.BACK and found.place in (None, place):
        d.done.pop()
        d.went(place)


def told(d: Discourse, found: Report, person: Thing | None) -> Steps:
    """Say it."""
    saying = saying_of(d, found)
    d.report, d.report_step = found, saying
    d.answer = d.news = d.counted = d.checked = None
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
    if found.value is not None and found.phrase in IF_NONE:
        return If(Holds(found.value), (said,), (d.say(IF_NONE[found.phrase]),))
    return said


def kept(d: Discourse) -> str | None:
    """The variable with what the last report told; the report itself is dropped."""
    found: Report | None = d.report
    at = next((at for at, step in enumerate(d.done) if step is d.report_step), None)
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
    if d.answer is not None:
        several = several_asked(d) or asked_one_after_the_other(d)
        if d.surveys and (several or in_loop(d, d.surveys[-1].call)):
            return polls.polled(d, d.polled_for or "answers", None).words
        return said_one_by_one(d) or [Call("say", {"text": said_in_all(d)})]
    if d.code is not None:
        return [d.say("code_is", value=Recall(d.code))]
    if (come := arrival(d)) is not None:
        return [come]
    raise NotUnderstood(d.language.phrase("say_what"))


@meaning("tell_that")
def tell_that(d: Discourse, node: Node) -> Steps:
    """ "and tell Alice how many there are": what was found out before, told to somebody else."""
    if sent := searched_before(d, node):
        return news.told_to_sent(d, *sent)
    search = news.searched_last(d, node, "person_ref")
    of_answers(d, node)
    person = who_is_told(d, node)
    if search is not None and (search.person or (person is not None and not is_me(person))):
        return news.where_it_is(d, search, person)  # "find Alice and tell Bob"
    if node.production.fixed.get("seen") and looks_around(d):
        from grammar.meanings.sights import seen_around

        return found_out(d, seen_around(d), person, back=person is None or is_me(person))
    if person is not None and is_me(person):
        return coming_back(d, node, told_again(d, person))
    return told_again(d, person)


@meaning("tell_why")
def tell_why(d: Discourse, node: Node) -> Steps:
    """ "and let Bob know, so that he can go with her": what was found out; why is left as it is."""
    why = node.parts["why"]
    d.background.append(d.words(why.start, why.end))
    d.resolved.update(range(why.start, why.end))
    return tell_that(d, node)


def looks_around(d: Discourse) -> bool:
    """ "look at the desk and tell Bob what you saw": sent there to look, with nothing told."""
    untold = d.report is None and d.answer is None and d.code is None and d.claim is None
    ways = [each for each in nodes(tuple(d.done)) if isinstance(each, Call)]
    return untold and isinstance(d.at, Text) and [each.method for each in ways] == ["goto"]


def told_again(d: Discourse, person: Thing | None) -> Steps:
    """Tell somebody what was told or answered last, or could not be told to somebody else."""
    message = undelivered(d, person)
    if message is not None:
        return message
    from grammar.meanings.lookouts import tell_lookout

    of_round = tell_lookout(d, person)
    if of_round is not None:
        return of_round
    if news.told_at_end(d, person):
        return []
    again = news.told_again(d, person)
    if again is not None:
        return again
    if person is None or is_me(person):
        return tell_speaker(d)
    if d.claim is not None and d.claim.known == d.known_by_now():
        return speak_to(d, person, [d.claim.saying])
    if d.report is None:
        return speak_to(d, person, known_words(d))
    return retold(d, person)


def retold(d: Discourse, person: Thing | None) -> Steps:
    """Tell the last report to somebody else, or somewhere else."""
    found: Report = d.report
    d.report_counts = d.report_counts and (person is None or is_me(person))
    at = next((at for at, step in enumerate(d.done) if step is d.report_step), None)
    if at is not None and not isinstance(found.value, Recall) and found.value is not None:
        name = d.variable(found.name)
        d.done[at] = Remember(name, found.value)
        found = replace(found, value=Recall(name))
    elif at is not None and at == len(d.done) - 1:
        d.done.pop()  # it is told to them and not to the speaker
        if d.done and d.done[-1] == Call("goto", {"place": Recall(START)}):
            d.done.pop()
            d.at = found.place
    elif at is not None and d.report_open and not (person is None or is_me(person)):
        del d.done[at]  # nobody else was to be told on the way to them
        if at and d.done[at - 1] == news.BACK:
            del d.done[at - 1]
    return told(d, found, person)


@meaning("report_told")
def report_told(d: Discourse, node: Node) -> news.Told:
    """ "how many people are in the lobby", "what time it is", as one of several things to tell."""
    found: Report | Steps = d.get(node, "info")
    return news.Told(found, []) if isinstance(found, list) else told_report(d, found)


def told_report(d: Discourse, found: Report) -> news.Told:
    from grammar.meanings.rounds import found_on_round

    if (of_round := found_on_round(d, found)) is not None:
        return of_round
    first: Steps = []
    if found.place is not None and found.place != d.at:
        first.append(Call("goto", {"place": found.place}))
        d.went(found.place)
    if found.about_here and found.value is not None:
        name = d.variable(found.name)
        first.append(Remember(name, found.value))
        found = replace(found, value=Recall(name))
    return news.Told([saying_of(d, found)], first)


@meaning("found_told")
def found_told(d: Discourse, node: Node | None = None) -> news.Told:
    """ "the result", "it", "what you found out": whatever was found out last."""
    from grammar.meanings.lookouts import told_of_lookout

    many = node is not None and bool(node.production.fixed.get("many"))
    of_round = told_of_lookout(d, many)
    if of_round is not None:
        return of_round
    told: news.News | None = d.news
    if told is not None:
        news.take_back(d, told)
        return news.Told(told.words, [])
    if d.report is not None:
        return _report_again(d)
    if d.answer is not None and d.surveys:
        each = "many" if many else d.polled_for or "each"
        return polls.polled(d, each if in_loop(d, d.surveys[-1].call) else "answers", None)
    return news.Told(known_words(d), [])


def _report_again(d: Discourse) -> news.Told:
    """The last report, which then is told only as is said now."""
    found: Report = d.report
    at = next((at for at, step in enumerate(d.done) if step is d.report_step), None)
    if at is None:
        return summed_or_said(d, found)
    if found.value is not None and not isinstance(found.value, Recall):
        name = d.variable(found.name)
        d.done[at] = Remember(name, found.value)
        found = replace(found, value=Recall(name))
    elif at == len(d.done) - 1:
        d.done.pop()
        not_back_yet(d)
    return news.Told([saying_of(d, found)], [])


def summed_at_end(d: Discourse) -> Steps:
    """What was counted in a round that nobody was told of: brought back to the speaker."""
    from grammar.meanings.gone_round import last_round

    at = last_round(d)
    found: Report | None = d.report
    if at is None and counted_alone(d):
        return tell_speaker(d)
    if at is None or at != len(d.done) - 1 or found is None or not d.report_counts:
        return []
    if found.name != "count" or not any(each is d.report_step for each in nodes(d.done[at])):
        return []
    told = summed_or_said(d, found)
    return [*told.first, *news.go_back(d, []), *told.words]


def counted_alone(d: Discourse) -> bool:
    """Whether the last step is to say a number where nobody is who asked for it: "go to the lab and
    count the people"."""
    found: Report | None = d.report
    counted = found is not None and found.name in ("count", "counts") and d.report_counts
    told_here = bool(d.done) and d.done[-1] is d.report_step
    return counted and told_here and d.at not in (None, Recall(START))


def summed_or_said(d: Discourse, found: Report) -> news.Told:
    """What was counted in each place of a round; else the report as it is."""
    from grammar.meanings.gone_round import last_round
    from grammar.meanings.rounds import summed_up

    if found.name == "count" and last_round(d) is not None:
        return summed_up(d, "each")
    return news.Told([saying_of(d, found)], [])


def not_back_yet(d: Discourse) -> None:
    """What was to be told to the speaker is told elsewhere: the way back comes to nothing."""
    if d.done and d.done[-1] == news.BACK:
        d.done.pop()
        d.at = None


@meaning("tell_me_that")
def tell_me_that(d: Discourse, node: Node) -> Steps:
    """ "and tell me": what was found out just before, brought back to the speaker."""
    if sent := searched_before(d, node):
        return news.told_to_sent(d, *sent)
    search = news.searched_last(d, node, "person_ref")
    of_answers(d, node)
    d.report_open = False
    if search is not None and search.person:
        return news.where_it_is(d, search, None)  # "find Alice and inform me"
    return coming_back(d, node, tell_speaker(d))


def coming_back(d: Discourse, node: Node, steps: Steps) -> Steps:
    """What the speaker is told; "otherwise come back to tell me" says the way back, too."""
    said = node.production.fixed.get("back") or "back" in node.parts
    if not said or not steps or news.BACK in steps:
        return steps
    d.came_back()
    return [news.BACK, *steps]


def tell_speaker(d: Discourse) -> Steps:
    from grammar.meanings.lookouts import tell_lookout

    of_round = tell_lookout(d, None)
    if of_round is not None:
        return of_round
    if news.told_at_end(d, None):
        return []
    again = news.told_again(d, None)
    if again is not None:
        return again
    last = d.done[-1] if d.done else None
    if last is not None and last is d.told:
        return []
    if d.claim is not None and d.claim.known == d.known_by_now():
        return [*news.back_to_speaker(d), d.claim.saying]
    if d.report is not None and d.report_step is last and d.at is not None:
        start = d.start()
        if d.at == start:
            return []
        told_there = retold(d, None)
        d.went(start)
        return [news.BACK, *told_there]
    if d.answer is None and d.code is None and (come := arrival_told(d)) is not None:
        return come
    if d.answer is None and d.code is None and d.thing is not None:
        if not (isinstance(last, Call) and last.method == "find"):
            raise NotUnderstood(d.language.phrase("say_what"))
        # "find the smallest cup and tell me what it is"
        what = Ask("describe", {"thing": sought(d, d.thing)})
        name = d.variable("description")
        d.went(d.start())
        return [Remember(name, what), news.BACK, Call("say", {"text": Recall(name)})]
    if d.answer is not None or d.code is not None:
        words = known_words(d)
        start = d.start()
        going = d.at is not None or moved([*(() if d.in_loop else d.around), *d.done])
        d.went(start)
        back = Call("goto", {"place": start})
        return [back, *words] if going and last != back else words
    if isinstance(last, Call) and last.method == "say":
        return []  # it is told already
    raise NotUnderstood(d.language.phrase("say_what"))
