"""What is told of a poll: who said yes and what share that is, what each of them said, the sum of
the numbers they named, what most want.

It goes back into the steps made for the asking: a note behind each question, and before everything
the empty list or the zero that it is noted in.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import Any, Final

import msgspec

from grammar.chart import Leaf, Node
from grammar.discourse import Discourse, Steps, Thing, Where
from grammar.errors import NotUnderstood
from grammar.meanings.answers import Said, Wanted, is_about, wanted, yes
from grammar.meanings.follow_ups import said_in_all, said_one_by_one
from grammar.meanings.news import Told
from grammar.meanings.registry import meaning
from grammar.meanings.surveys import (
    Survey,
    asked_before,
    asked_so_far,
    asked_yet,
    before_all,
    in_loop,
    note,
    of_one_question,
    several_asked,
)
from grammar.plan import (
    Ask,
    Both,
    Call,
    Collect,
    Compare,
    Condition,
    Figure,
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
from grammar.tidy import BODIES

FIGURES: Final = {
    "sum": "in_total",
    "average": "on_average",
    "highest": "highest_was",
    "lowest": "lowest_was",
}
"""What one number is made of many, and the phrases that tell it."""
ASKED_WHERE: Final = {"which": "where", "many": "many"}
"""What is told of the places of a round, as what is told of those who were asked there."""


def said_in(d: Discourse, node: Node) -> Said | None:
    """The words for an answer, if there are any."""
    said: Said | None = d.get(node, "said")
    return said


def polled(d: Discourse, kind: str, said: Said | None) -> Told:
    surveys = asked_before(d)
    if kind not in ("answers", "missing"):
        surveys = of_one_question(surveys)
    if said is not None:
        meant = _meant(d, surveys, said)
        d.answers = replace(d.answers, said=meant)
    answer: Wanted = d.answers.said or yes(d)
    if kind == "many":
        d.answers = replace(d.answers, said=answer)
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
        **dict.fromkeys(FIGURES, _figure),
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
    if key in d.answers.notes:
        return Recall(d.answers.notes[key]), False
    d.keep_note(key, d.variable(name))
    return Recall(d.answers.notes[key]), True


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
    return Both((condition, Not(other)))


def how_many(d: Discourse, surveys: list[Survey], answer: Wanted) -> Value:
    """How many gave an answer: those whose names are kept, or a number of its own."""
    key = ("who", answer, *(survey.who for survey in surveys))
    ids = tuple(id(survey.call) for survey in surveys)
    named = d.answers.notes.get((*key, *ids))
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
    return [Call("say", {"text": how_many_words(d, surveys, answer)})]


def how_many_words(d: Discourse, surveys: list[Survey], answer: Wanted) -> Value:
    said, asked = how_many(d, surveys, answer), counted(d, surveys, None)
    return d.sentence("how_many_said", number=said, asked=asked, answer=answer.label(d))


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
    d.scene = d.scene.speaking_of(found)
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


def _figure(d: Discourse, surveys: list[Survey], answer: Wanted, kind: str) -> Steps:
    """The sum, the average, the highest or the lowest of answers that are numbers."""
    agree = {d.language.phrase("yes"), d.language.phrase("no")}
    if any(agree & set(survey.options) for survey in surveys):
        raise NotUnderstood(d.language.phrase("count_what"))
    numbers, new = _kept(d, ("numbers",), "numbers")
    if new:
        for survey in surveys:
            said = Recall(str(survey.call.save_as))
            note(d, survey.call, [Collect(numbers.name, said)], [])
        _before_all(d, numbers, Items(()))
    return [d.say(FIGURES[kind], number=Figure(kind, numbers))]


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
    part = node.parts.get("person_ref")
    whatever = said is None and part is not None and part.start > node.start  # "what they said"
    if whatever and (each_said := said_one_by_one(d)):
        return Told(each_said, [])
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
        last = survey.call.save_as == d.answers.last
        return Told([Call("say", {"text": said_in_all(d) if last else answer})], [])
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
    d.resolve(range(start, end))
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
    return not of_one and (several_asked(d) or (they and _in_turn(d)))


def _in_turn(d: Discourse) -> bool:
    """Whether what is said is for each of several who were asked, in turn: "ask them whether they
    have a car; if so ask how big it is, and tell me what they said"."""
    survey: Survey | None = d.answers.surveys[-1] if d.answers.surveys else None
    return (
        survey is not None and isinstance(survey.who, Recall) and d.scene.with_person == survey.who
    )


def asked_there(d: Discourse, trait: Leaf | Node) -> bool:
    """Whether people were asked in a round what is told of the places: "ask in each office if they
    need toner and tell me which office needs some"."""
    survey: Survey | None = d.answers.surveys[-1] if d.answers.surveys else None
    asked = isinstance(trait, Node) and trait.means == "trait_asked" and asked_yet(d)
    if survey is None or survey.where is None or not asked:
        return False
    return is_about(d, survey, d.norms(trait.start, trait.end))
