"""Telling what was found out on the way, at the end: who said yes and what share that is, what each
of them said, the total, which labs have no stapler.

What is to be told is a `Told`; several of them can be told together, to anybody, anywhere, spoken
or on the screen. What is told of a poll goes back into the steps made for the asking: a note behind
each question, and before everything the empty list or the zero that it is noted in.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, Final

import msgspec

from grammar.chart import Node
from grammar.discourse import START, Discourse, NotUnderstood, Steps, Thing, Where
from grammar.meanings.answers import Said, Wanted, is_about, wanted, yes
from grammar.meanings.finding import go, speak_to
from grammar.meanings.nouns import is_me
from grammar.meanings.registry import meaning
from grammar.meanings.surveys import (
    Survey,
    asked_before,
    asked_so_far,
    before_all,
    in_loop,
    moved,
    note,
    several_asked,
)
from grammar.plan import (
    Ask,
    Call,
    Collect,
    Compare,
    Condition,
    Holds,
    If,
    Increase,
    Items,
    Length,
    Not,
    Number,
    Recall,
    Remember,
    Sentence,
    Share,
    Step,
    Text,
    Value,
)
from grammar.tidy import BODIES, nodes

BACK: Final = Call("goto", {"place": Recall(START)})


@dataclass(frozen=True)
class Told:
    """Something to tell."""

    words: Steps
    """What says it."""
    first: Steps
    """What finds it out, before the robot goes to those whom it tells."""


@dataclass(frozen=True)
class News:
    """What was told last, so that it can be told to others."""

    words: Steps
    to_all: bool
    """Whether nobody was named whom to tell, so that whoever is named next is who was meant."""
    waiting: bool = False
    """Whether it is not told yet."""
    whom: Thing | None = None
    """Who wants to know it, if that was said before it was said to tell them."""


# --- telling


@meaning("news")
def news(d: Discourse, node: Node) -> Steps:
    """ "come back and tell me who said yes", "announce the result in the lobby"."""
    search = None if {"told", "back"} & node.parts.keys() else searched_last(d, node, "whom")
    person: Thing | None = d.get(node, "whom")
    if d.thing is not None and d.delivered == d.thing.value and _speaks_of_it(d, node):
        return []  # "get the key from Alice and come back with it": it is here by now
    if d.asked_for is not None and d.thing is not None and _speaks_of_it(d, node):
        from grammar.meanings.things import deliver

        return deliver(d, replace(d.thing, pronoun=True), person, None)
    if search is not None:
        return where_it_is(d, search, person)
    told: list[Told] = d.get(node, "told") or [last_found(d)]
    first = [step for each in told for step in each.first]
    words = [step for each in told for step in each.words]
    fixed = node.production.fixed
    steps: Steps = list(first)
    place: Value | None = d.get(node, "at_place")
    if "back" in node.parts or (
        (person is None or is_me(person)) and place is None and not fixed.get("screen")
    ):
        steps += go_back(d, first)
    if place is not None:
        steps += go(d, place)
    if fixed.get("screen"):
        words = [_shown(each) for each in words]
    if person is not None and not is_me(person):
        steps += speak_to(d, person, words)
    else:
        steps += words
    if steps:
        d.told = steps[-1]
    d.news = News(words, person is None and place is None)
    return steps


@meaning("wants_to_know")
def wants_to_know(d: Discourse, node: Node) -> Steps:
    """ "Bob wants to know which labs are free, so go and tell him": told to him at last."""
    person: Thing = d.get(node, "whom")
    told: list[Told] = d.get(node, "told")
    words = [step for each in told for step in each.words]
    d.news = News(words, False, waiting=True, whom=person)
    d.person, d.thing_last = person, False
    return [step for each in told for step in each.first]


def _speaks_of_it(d: Discourse, node: Node) -> bool:
    """Whether it is "it" that is brought: "ask her for the key and come back with it"."""
    told = node.parts.get("told")
    words = d.norms(told.start, told.end) if told is not None else []
    return len(words) == 1 and words[0] in d.language.speech.get("things_too", ())


def searched_last(d: Discourse, node: Node, whom: str) -> Thing | None:
    """What the last step looks for, if nothing else was found out: "find Bob and let me know", but
    not "and tell me the answer"."""
    last = d.done[-1] if d.done else None
    told_to = node.parts.get(whom)
    if told_to is not None and told_to.end < node.end - 1:
        return None
    known = (d.report, d.answer, d.code, d.claim, d.news)
    if not (isinstance(last, Call) and last.method == "find") or any(each for each in known):
        return None
    return d.thing if d.thing_last else d.person


def where_it_is(d: Discourse, sought: Thing, person: Thing | None) -> Steps:
    from grammar.meanings.reports import found_for
    from grammar.meanings.sights import located

    return found_for(d, person, located(d, sought))


def last_found(d: Discourse) -> Told:
    """What "report back" speaks of."""
    from grammar.meanings.reports import found_told

    return found_told(d)


def go_back(d: Discourse, more: Steps) -> Steps:
    """Back to who gave the command, unless the robot is there."""
    before = () if d.in_loop else d.around
    if not moved([*before, *d.done, *more]) or (d.done and not more and d.done[-1] == BACK):
        return []
    d.came_back()
    return [BACK]


def back_to_speaker(d: Discourse) -> Steps:
    """The way to who gave the command, who is to be told something: "if he has no time, tell me
    that he has none". Whoever came along is there already."""
    steps = nodes((*d.around, d.done))
    led = any(isinstance(each, Call) and each.method in ("guide", "follow") for each in steps)
    if led or d.in_loop or d.at == Recall(START):
        return []
    if d.at is None and not d.away:
        return go_back(d, [])
    d.came_back()
    return [BACK]


def _shown(step: Any) -> Any:
    """What was to be said, on the screen."""
    if isinstance(step, Call) and step.method == "say":
        return Call("show", {"text": step.arguments["text"]})
    inner = {name: tuple(map(_shown, body)) for name in BODIES if (body := getattr(step, name, ()))}
    return msgspec.structs.replace(step, **inner) if inner else step


def on_screen(d: Discourse) -> Steps:
    """What was found out last, on the screen."""
    return [_shown(each) for each in last_found(d).words]


def told_again(d: Discourse, person: Thing | None) -> Steps | None:
    """The last news told to somebody else, too; None if there are none."""
    found: News | None = d.news
    if found is None:
        return None
    if person is None or is_me(person):
        if not found.waiting and d.done[len(d.done) - len(found.words) :] == found.words:
            return []  # it is told already
        d.news = replace(found, waiting=False)
        return [*go_back(d, []), *found.words]
    take_back(d, found)
    d.news = replace(d.news, waiting=False)
    return speak_to(d, person, found.words)


def in_round(d: Discourse) -> bool:
    """Whether the robot is at one of the places that it goes round."""
    return d.in_loop and isinstance(d.at, Recall) and d.at == d.place


def told_at_end(d: Discourse, person: Thing | None) -> bool:
    """Whether what was just counted or seen is told when the round of places is done, for nobody is
    told of it at any of them: "go to every ward, count the patients and tell me how many"."""
    found = d.report
    if found is None or not in_round(d):
        return False
    if not found.about_here or found.value is None:
        return False
    if not any(each is d.report_step for each in nodes(tuple(d.done))):
        return False
    d.after_round = (person, "each")
    return True


def take_back(d: Discourse, found: News) -> None:
    """What was to be told to the speaker, because nobody else was named, is told elsewhere; the way
    back then comes to nothing."""
    if found.to_all and d.done[len(d.done) - len(found.words) :] == found.words:
        del d.done[len(d.done) - len(found.words) :]
        if d.done and d.done[-1] == BACK:
            d.done.pop()
            d.at = None
        d.news = replace(found, to_all=False, waiting=True)
    else:
        d.news = replace(found, to_all=False)


@meaning("told_list")
def told_list(d: Discourse, node: Node) -> list[Told]:
    """ "who said yes and what share that is"."""
    first: Told = d.get(node, "first")
    rest: list[Told] = d.get(node, "rest") or []
    return [first, *rest]


# --- what people answered


@meaning("poll")
def poll(d: Discourse, node: Node) -> Told:
    """What was answered: of all, or of those who gave one answer."""
    kind, said = str(node.production.fixed["kind"]), said_in(d, node)
    if kind in ("each", "answers") and (d.report is not None or d.counted is not None):
        return last_found(d)  # "the numbers": what was counted
    if said is not None and kind in ("who", "many", "share") and not asked_yet(d):
        return polled_now(d, kind, said)
    return polled(d, kind, said)


def asked_yet(d: Discourse) -> bool:
    """Whether anybody was asked anything in this sequence."""
    calls = [each for each in nodes(tuple(d.done)) if isinstance(each, Call)]
    return any(survey.call is each for survey in d.surveys for each in calls)


def polled_now(d: Discourse, kind: str, said: Said) -> Told:
    """ "find out who wants coffee": everybody here is asked."""
    from grammar.meanings.questions import ask_everybody_here

    d.done += ask_everybody_here(d, said.start, said.end)
    return polled(d, kind, None)


def said_in(d: Discourse, node: Node) -> Said | None:
    """The words for an answer, if there are any."""
    said: Said | None = d.get(node, "said")
    return said


def polled(d: Discourse, kind: str, said: Said | None) -> Told:
    surveys = asked_before(d)
    if said is not None:
        d.said = _meant(d, surveys, said)
    answer: Wanted = d.said or yes(d)
    if kind == "list":  # of those who said yes, or of what they said
        agree, refuse = d.language.phrase("yes"), d.language.phrase("no")
        kind = "who" if set(surveys[-1].options) == {agree, refuse} else "answers"
    made = {
        "who": _who,
        "where": _where,
        "many": _many,
        "share": _share,
        "each": _each,
        "answers": _answers,
        "most": _most,
        "fewest": _most,
        "missing": _missing,
        "asked": _asked,
        "sum": _sum,
    }[kind]
    return Told(made(d, surveys, answer, kind), [])


def _meant(d: Discourse, surveys: list[Survey], said: Said) -> Wanted:
    """The answer that some words speak of, as any of the questions that go together puts it."""
    same = [each for each in surveys if each.options == surveys[-1].options]
    for survey in reversed(same[:-1]):
        with suppress(NotUnderstood):
            return wanted(d, same[-1], said)
        with suppress(NotUnderstood):
            return wanted(d, survey, said)
    return wanted(d, surveys[-1], said)


def _kept(d: Discourse, key: tuple[Any, ...], name: str) -> tuple[Recall, bool]:
    """A variable for what is noted of a poll, and whether it is new."""
    key = (*key, *(id(survey.call) for survey in asked_before(d)))
    if key in d.notes:
        return Recall(d.notes[key]), False
    d.notes[key] = d.variable(name)
    return Recall(d.notes[key]), True


def _before_all(d: Discourse, name: Recall, value: Value) -> None:
    before_all(d, [Remember(name.name, value)])


def _name_for(answer: Wanted) -> str:
    return f"{'not' if answer.no else 'said'}_{'_'.join(answer.options)}"


def _who(d: Discourse, surveys: list[Survey], answer: Wanted, kind: str) -> Steps:
    return _named(d, surveys, answer, [survey.who for survey in surveys])


def _where(d: Discourse, surveys: list[Survey], answer: Wanted, kind: str) -> Steps:
    return _named(d, surveys, answer, [survey.where for survey in surveys])


def _named(d: Discourse, surveys: list[Survey], answer: Wanted, names: list[Value | None]) -> Steps:
    """Those who gave an answer, or the places where it was given, each once."""
    found, new = _kept(d, ("who", answer, *names), _name_for(answer))
    if new:
        for survey, name in zip(surveys, names, strict=True):
            if name is None:
                raise NotUnderstood(d.language.phrase("who_unknown"))
            given = answer.given(survey)
            if name != survey.who and isinstance(name, Recall):
                given = _and_not(given, Compare(name, "in", found))
            note(d, survey.call, [If(given, (Collect(found.name, name),))], [])
        _before_all(d, found, Items(()))
    label = answer.label(d)
    nobody = d.say("nobody_said", answer=label)
    some = d.say("who_said", answer=label, names=found)
    return [If(Compare(Length(found), "==", Number(0)), (nobody,), (some,))]


def _and_not(condition: Condition, other: Condition) -> Condition:
    from grammar.plan import Both

    return Both((condition, Not(other)))


def how_many(d: Discourse, surveys: list[Survey], answer: Wanted) -> Value:
    """How many gave an answer: those whose names are kept, or a number of its own."""
    key = ("who", answer, *(survey.who for survey in surveys))
    ids = tuple(id(survey.call) for survey in surveys)
    named = d.notes.get((*key, *ids))
    return counted(d, surveys, answer) if named is None else Length(Recall(named))


def counted(d: Discourse, surveys: list[Survey], answer: Wanted | None) -> Recall:
    """A variable that counts how often this was answered, or how often anybody was asked."""
    name = "asked" if answer is None else _name_for(answer)
    found, new = _kept(d, ("count", answer), name)
    if new:
        for survey in surveys:
            count: Step = Increase(found.name)
            if answer is not None:
                count = If(answer.given(survey), (count,))
            note(d, survey.call, [count], [])
        _before_all(d, found, Number(0))
    return found


def _many(d: Discourse, surveys: list[Survey], answer: Wanted, kind: str) -> Steps:
    said, asked = how_many(d, surveys, answer), counted(d, surveys, None)
    return [d.say("how_many_said", number=said, asked=asked, answer=answer.label(d))]


def _share(d: Discourse, surveys: list[Survey], answer: Wanted, kind: str) -> Steps:
    said, asked = how_many(d, surveys, answer), counted(d, surveys, None)
    return [d.say("share_said", share=Share(said, asked), answer=answer.label(d))]


def _asked(d: Discourse, surveys: list[Survey], answer: Wanted, kind: str) -> Steps:
    return [d.say("so_many_asked", number=counted(d, surveys, None))]


def _each(d: Discourse, surveys: list[Survey], answer: Wanted, kind: str) -> Steps:
    options = surveys[-1].options
    if not options:
        return _answers(d, surveys, answer, kind)
    parts: list[Value] = []
    for each in options:
        number = counted(d, surveys, Wanted((each,)))
        parts += [Text(f"{', ' if parts else ''}{each}: "), number]
    return [d.say("answers_were", answers=Sentence(tuple(parts)))]


def _most(d: Discourse, surveys: list[Survey], answer: Wanted, kind: str) -> Steps:
    best = chosen_most(d, surveys, kind)
    nobody = d.say("nobody_answered")
    some = d.say("most_chose" if kind == "most" else "fewest_chose", answer=best)
    return [If(Compare(best, "==", Text("")), (nobody,), (some,))]


def chosen_most(d: Discourse, surveys: list[Survey], kind: str = "most") -> Recall:
    """The answer that most gave, or the fewest; it is found out behind all that was done."""
    options = surveys[-1].options
    if not options:
        raise NotUnderstood(d.language.phrase("no_options"))
    best, new = _kept(d, (kind,), "choice")
    if not new:
        return best
    number = Recall(d.variable(kind))
    counts = [counted(d, surveys, Wanted((each,))) for each in options]
    if kind == "most":
        d.done += [Remember(number.name, Number(0)), Remember(best.name, Text(""))]
        todo = list(zip(options, counts, strict=True))
    else:
        d.done += [Remember(number.name, counts[0]), Remember(best.name, Text(options[0]))]
        todo = list(zip(options[1:], counts[1:], strict=True))
    for option, count in todo:
        better = Compare(count, ">" if kind == "most" else "<", number)
        d.done.append(If(better, (Remember(number.name, count), Remember(best.name, Text(option)))))
    return best


@meaning("thing_chosen")
def thing_chosen(d: Discourse, node: Node) -> Thing:
    """ "whatever most of them want"."""
    spot: Where | None = d.get(node, "from")
    found = Thing(chosen_most(d, asked_before(d)))
    if spot is not None:
        found = replace(found, place=spot.place, furniture=spot.furniture)
    d.thing, d.thing_last = found, True
    return found


def _answers(d: Discourse, surveys: list[Survey], answer: Wanted, kind: str) -> Steps:
    if len(surveys) == 1 and not in_loop(d, surveys[0].call):
        return [Call("say", {"text": Recall(str(surveys[0].call.save_as))})]
    found, new = _kept(d, ("answers",), "answers")
    if new:
        for survey in surveys:
            said = Recall(str(survey.call.save_as))
            line = said if survey.who is None else Sentence((survey.who, Text(": "), said))
            note(d, survey.call, [Collect(found.name, line)], [])
        _before_all(d, found, Items(()))
    return [d.say("answers_were", answers=found)]


def _sum(d: Discourse, surveys: list[Survey], answer: Wanted, kind: str) -> Steps:
    """The sum of answers that are numbers."""
    if not all(option.isdigit() for survey in surveys for option in survey.options):
        raise NotUnderstood(d.language.phrase("count_what"))
    total, new = _kept(d, ("sum",), "total")
    if new:
        for survey in surveys:
            note(d, survey.call, [Increase(total.name, Recall(str(survey.call.save_as)))], [])
        _before_all(d, total, Number(0))
    return [d.say("in_total", number=total)]


def _missing(d: Discourse, surveys: list[Survey], answer: Wanted, kind: str) -> Steps:
    """Who was not found and so could not be asked."""
    found, new = _kept(d, ("missing",), "missing")
    if new:
        calls = {id(survey.call): survey for survey in surveys}
        noted = [_noting_missing(each, calls, found) for each in d.done]
        if noted == d.done:  # whoever was asked was not looked for by name
            raise NotUnderstood(d.language.phrase("no_question"))
        d.done[:] = noted
        _before_all(d, found, Items(()))
    nobody, some = d.say("nobody_missing"), d.say("who_missing", names=found)
    return [If(Compare(Length(found), "==", Number(0)), (nobody,), (some,))]


def _noting_missing(step: Any, calls: dict[int, Survey], found: Recall) -> Any:
    """A step, with a note where somebody was not found."""
    match step:
        case If(Holds(Ask("find", arguments)), then) if any(id(each) in calls for each in then):
            missing = Collect(found.name, arguments["thing"])
            return msgspec.structs.replace(step, otherwise=(missing,))
    inner = {
        name: tuple(_noting_missing(each, calls, found) for each in body)
        for name in BODIES
        if (body := getattr(step, name, ()))
    }
    return msgspec.structs.replace(step, **inner) if inner else step


@meaning("answer_of")
def answer_of(d: Discourse, node: Node) -> Told:
    """ "what Alice said", "whether Bob said yes"."""
    person: Thing | None = d.get(node, "person_ref")
    surveys = asked_before(d)
    if person is not None and person.known and len(surveys) > 1:
        surveys = [each for each in surveys if each.who == person.value] or surveys
    survey = surveys[-1]
    said = said_in(d, node)
    if _of_several(d, node, person):
        return polled(d, "answers" if said is None else "who", said)
    if said is None and (of_whom := said_by(d, node.start, node.end)) is not None:
        return Told(of_whom, [])
    of_one = person is not None and person.known and in_loop(d, survey.call)
    if of_one and person is not None and survey.who is not None:
        name = d.variable("answer_of")
        same = Compare(survey.who, "==", person.value)
        kept = Remember(name, Recall(str(survey.call.save_as)))
        note(d, survey.call, [If(same, (kept,))], [])
        d.done.insert(0, Remember(name, Text("")))
        survey = replace(survey, call=Call("ask", survey.call.arguments, save_as=name))
    elif in_loop(d, survey.call):
        return polled(d, "answers" if said is None else "who", said)
    answer = Recall(str(survey.call.save_as))
    if said is None:
        return Told([Call("say", {"text": answer})], [])
    meant = wanted(d, survey, said)
    told_yes, told_no = d.say("yes_said", answer=answer), d.say("no_said", answer=answer)
    return Told([If(meant.given(survey), (told_yes,), (told_no,))], [])


def said_by(d: Discourse, start: int, end: int) -> Steps | None:
    """What those said whom some words speak of: "her answer", "what he said", "their answers"; None
    if they do not tell one from others."""
    surveys = asked_so_far(d)
    people = {each.who for each in surveys if isinstance(each.who, Text)}
    if len(people) < 2 or any(in_loop(d, each.call) for each in surveys):
        return None
    gender = d.gender(start, end)
    if gender is not None:
        by_them = [each for each in surveys if _may_be(d, each.who, gender) and each.call.save_as]
        return [Call("say", {"text": Recall(str(by_them[-1].call.save_as))})] if by_them else None
    they = d.language.words_called("they")
    return polled(d, "answers", None).words if they & set(d.norms(start, end)) else None


def _may_be(d: Discourse, who: Value | None, gender: str) -> bool:
    return isinstance(who, Text) and d.may_have(Thing(who, known=True, person=True), gender)


@meaning("answer_asked")
def answer_asked(d: Discourse, node: Node) -> Told:
    """ "when she is coming", after she was asked when she is coming."""
    told = told_as_asked(d, node.start, node.end)
    if told is None:
        words = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("not_understood", part=words))
    return told


def told_as_asked(d: Discourse, start: int, end: int) -> Told | None:
    """The answer to a question that some words ask again, or that goes on from the one they ask
    ("whether she is coming, and if so, when"); None if none of those asked is that."""
    norms = d.norms(start, end)
    yes_no = {d.language.phrase("yes"), d.language.phrase("no")}
    surveys = asked_so_far(d)
    if not any(is_about(d, each, norms) for each in surveys):
        return None
    survey = next((each for each in reversed(surveys) if set(each.options) != yes_no), None)
    if survey is None or survey.call.save_as is None:
        return None
    if in_loop(d, survey.call) or several_asked(d):
        return polled(d, "answers", None)
    d.resolved.update(range(start, end))
    return Told([Call("say", {"text": Recall(survey.call.save_as)})], [])


def _of_several(d: Discourse, node: Node, person: Thing | None) -> bool:
    """Whether what several have answered is told: "each of them", "their answers", and "the answer"
    if others than one were asked."""
    if person is not None and (person.group is not None or person.plural):
        return True
    part = node.parts.get("person_ref") or node
    several = set(d.language.speech.get("things_too", ()))
    they = part is not node and bool(several & set(d.norms(part.start, part.end)))
    of_one = d.gender(part.start, part.end) is not None or (person is not None and not they)
    return not of_one and several_asked(d)
