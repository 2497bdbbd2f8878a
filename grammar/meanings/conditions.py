"""Conditions: what is seen, heard, answered or scanned, the battery, the time."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Final

from grammar.chart import Leaf, Node
from grammar.discourse import (
    ANYONE,
    START,
    Discourse,
    Meeting,
    NotUnderstood,
    Steps,
    Thing,
    Where,
    as_value,
)
from grammar.meanings.agreement import same_answers
from grammar.meanings.answers import Said, Wanted
from grammar.meanings.answers import wanted as wanted_answer
from grammar.meanings.deliveries import delivered_last, own_place
from grammar.meanings.finding import noun_of, whether_found
from grammar.meanings.news import in_round
from grammar.meanings.places import sought
from grammar.meanings.polls import counted as counted_answers
from grammar.meanings.registry import meaning
from grammar.meanings.searches import just_awaited, just_looked_for, searches
from grammar.meanings.surveys import (
    Survey,
    asked_before,
    asked_so_far,
    in_loop,
    of_one_question,
    replacing,
)
from grammar.plan import (
    Ask,
    Both,
    Call,
    Compare,
    Condition,
    Either,
    ForEach,
    Forever,
    Holds,
    If,
    Items,
    Not,
    Number,
    Recall,
    Remember,
    Share,
    Step,
    Text,
    Truth,
    Try,
    Value,
)
from grammar.tidy import nodes


@meaning("and")
def and_(d: Discourse, node: Node) -> Condition:
    left = d.get(node, "left")
    met, pending = d.met, len(d.pending)
    right = d.get(node, "right")
    if not searches(left) and any(_goes(step) for step in d.pending[pending:]):
        # What is so in one place is noted before the robot goes to look at the other.
        name = d.variable("so")
        noted: Steps = [Remember(name, Truth(False)), If(left, (Remember(name, Truth(True)),))]
        d.pending[pending:pending] = noted
        left = Holds(Recall(name))
    d.met = d.met or met
    return Both((left, right))


def _goes(step: Step) -> bool:
    return isinstance(step, Call) and step.method == "goto"


@meaning("or")
def or_(d: Discourse, node: Node) -> Condition:
    either = Either((d.get(node, "left"), d.get(node, "right")))
    d.met = None
    return either


@meaning("not")
def not_(d: Discourse, node: Node) -> Condition:
    condition = negated(d.get(node, "condition"))
    if d.met is not None:
        d.met = replace(d.met, holds=not d.met.holds)
    return condition


_OPPOSITE: Final = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "==": "!=", "!=": "=="}


def negated(condition: Condition) -> Condition:
    if isinstance(condition, Not):
        return condition.condition
    if isinstance(condition, Compare) and condition.operator in _OPPOSITE:
        return Compare(condition.left, _OPPOSITE[condition.operator], condition.right)
    return Not(condition)


def condition_of(d: Discourse, node: Node, name: str = "condition") -> tuple[Steps, Condition]:
    """The condition of a clause, and the steps that it needs before it can be checked; whom it is
    about is then `d.met`."""
    outer, d.pending, d.met = d.pending, [], None
    condition: Condition = d.get(node, name)
    before, d.pending = d.pending, outer
    return before, condition


# --- what is there


@meaning("is_seen")
def is_seen(d: Discourse, node: Node) -> Condition:
    """ "you see a cup", "Alice is there", "nobody is in the lobby", "a visitor is waving"."""
    return looked_for(d, node, search=False)


@meaning("is_found")
def is_found(d: Discourse, node: Node) -> Condition:
    """ "you find a cup": the robot drives about to look for it, but not on a round."""
    return looked_for(d, node, search=not in_round(d))


def looked_for(d: Discourse, node: Node, search: bool) -> Condition:
    thing = noun_of(d, node)
    if thing.every and not thing.person:  # "if all the beds are taken": one is seen or not
        words = d.words(node.start, node.end)
        gap = (node.start, node.end)
        raise NotUnderstood(d.language.phrase("cannot_check", what=words), gap=gap)
    said_there = d.tokens[node.end - 1].norm in d.language.speech.get("there", ())
    if said_there and thing.place is None and d.at == Recall(START):
        there = d.at_pick_up if d.place == d.at else d.place
        thing = replace(thing, place=there)  # the robot has come back from there meanwhile
    if thing.person and thing.count is not None:  # "five people are there"
        many = _so_many(d, thing, thing.count, ">=")
        return negated(many) if node.production.fixed.get("no") else many
    brought = delivered_last(d)
    if said_there and brought is not None and thing.person and thing.place is None:
        thing = replace(thing, place=own_place(d, thing))
    if isinstance(thing.group, Items):
        result = _each_of_them(d, node, thing.group.items, search)
    else:
        result = _is_doing(d, node, thing) or is_there(d, thing, search)
    if search and d.met is not None:
        d.met = replace(d.met, sought=True)
    if node.production.fixed.get("no"):
        d.met = replace(d.met, holds=False) if d.met is not None else None
        result = Not(result)
        if "state" in node.parts:  # "the cup is not clean": there is one, but none that is so
            plain = {name: part for name, part in node.parts.items() if name != "state"}
            result = Both((is_there(d, noun_of(d, replace(node, parts=plain)), search), result))
    return result


def _is_doing(d: Discourse, node: Node, thing: Thing) -> Condition | None:
    """Whether somebody is seen who does something: "visitor waving"; who goes by a name is looked
    for first."""
    doing = node.parts.get("doing")
    if doing is None:
        return None
    so = Text(f"{thing.text} {d.described_by(doing)}")
    if not thing.known:
        return is_there(d, replace(thing, value=so))
    seen = Holds(Ask("sees", {"thing": so}))
    if thing.here or d.with_person == thing.value:
        return seen
    there = is_there(d, thing, search=True)
    d.met = None
    return Both((there, seen))


def is_there(d: Discourse, thing: Thing, search: bool = False) -> Condition:
    """Whether somebody or something is seen here, or found where it is said to be."""
    if thing.person and thing.text == ANYONE and thing.place is None:
        agreed = just_agreed(d)
        if agreed is not None:
            return agreed
    known = just_looked_for(d, thing) or just_awaited(d, thing) or just_checked(d, thing)
    if known is None:
        if search and thing.place is None and isinstance(d.at, Text):
            thing = replace(thing, place=d.at)  # "go to the kitchen and if you find a cup, ..."
        elsewhere = thing.place is not None and thing.place != d.at
        if search or elsewhere:
            known = whether_found(d, thing)
        else:
            known = Holds(Ask("sees", {"thing": sought(d, thing)}))
    if thing.person:
        d.person, d.thing_last = thing, False
    d.met = Meeting(thing)
    return known


def just_agreed(d: Discourse, no: bool = False) -> Condition | None:
    """Whether the search that the step before is has found somebody who says yes."""
    from grammar.meanings.volunteers import just_found

    known = just_found(d)
    if known is None:
        return None
    condition, person = known
    d.met = Meeting(person, holds=not no)
    return negated(condition) if no else condition


def just_checked(d: Discourse, thing: Thing) -> Condition | None:
    """The check before, if it was for this: "see if there is a cup. If there is a cup, ..."."""
    from grammar.meanings.reports import Report, checked

    report: Report | None = d.report
    about = report.thing if report is not None else None
    if about is None or thing.place not in (None, about.place):
        return None
    nobody = about.person and thing.person and thing.text == ANYONE  # of one who was looked for
    if about.value != thing.value and not nobody:
        return None
    return seen_there(d) or (Holds(known) if (known := checked(d)) is not None else None)


def seen_there(d: Discourse) -> Condition | None:
    """What was checked in a place that was gone to only for that, as a search in that place."""
    from grammar.meanings.reports import Report, checked

    report: Report | None = d.report
    about = report.thing if report is not None else None
    if about is None or about.place is None or checked(d) is None:
        return None
    first = Call("goto", {"place": about.place})
    last = d.done[-1] if d.done else None
    if len(d.done) < 2 or d.done[-2] != first or not isinstance(last, Remember):
        return None
    if last.value != Ask("sees", {"thing": sought(d, about)}):
        return None
    del d.done[-2:]
    d.report = None
    return Holds(Ask("find", {"thing": sought(d, about), "place": about.place}))


def _each_of_them(d: Discourse, node: Node, people: tuple[Value, ...], search: bool) -> Condition:
    """ "Alice and Bob are in their offices", "Alice or Bob is there"."""
    found: list[Condition] = []
    for value in people:
        person = Thing(value, known=True, person=True)
        d.person = person
        spot: Where | None = d.get(node, "from")
        if spot is not None:
            person = replace(person, place=spot.place, furniture=spot.furniture)
        found.append(is_there(d, person, search))
    d.met = None
    part = node.parts.get("person_ref") or node.parts["thing"]
    either = node.production.fixed.get("any") or set(d.language.speech.get("or", ())) & set(
        d.norms(part.start, part.end)
    )
    if either and d.person is not None and d.person.person:  # whoever of them it is
        d.person = Thing(Text(ANYONE), person=True, plural=True, here=True)
    return Either(tuple(found)) if either else Both(tuple(found))


@meaning("place_empty")
def place_empty(d: Discourse, node: Node) -> Condition:
    """ "the lobby is empty": nobody is there."""
    anybody = Thing(Text(ANYONE), d.get(node, "place"), person=True)
    there = is_there(d, anybody)
    d.met = Meeting(anybody, holds=bool(node.production.fixed.get("occupied")))
    return there if node.production.fixed.get("occupied") else Not(there)


@meaning("counted")
def counted(d: Discourse, node: Node) -> Condition:
    """ "there are more than three people"."""
    thing = counted_thing(d, node)
    spot: Where | None = d.get(node, "where")
    if spot is not None:
        thing = replace(thing, place=spot.place, furniture=spot.furniture)
    operator = d.get(node, "operator", "==")
    if operator in ("<", "<=") and not thing.person:  # "..., bring one": for where they are short
        d.lacking = replace(thing, place=thing.place or d.at)
    return _so_many(d, thing, int(d.get(node, "count")), operator)


def _so_many(d: Discourse, thing: Thing, number: int, operator: str) -> Compare:
    """Whether there are so many of somebody or something, where the robot has to go for that."""
    if thing.place is not None and thing.place != d.at:
        d.went(thing.place)
        d.pending.append(Call("goto", {"place": thing.place}))
    if thing.person:
        thing = replace(thing, count=None)
        d.person = replace(thing, plural=True, place=None, here=True)
        d.last_counted = d.person
    return Compare(Ask("count", {"thing": sought(d, thing)}), operator, Number(number))


def counted_thing(d: Discourse, node: Node) -> Thing:
    """What a condition counts: what was counted before, where it does not say."""
    if "thing" in node.parts or "person_ref" in node.parts:
        return noun_of(d, node)
    if d.last_counted is None:
        raise NotUnderstood(d.language.phrase("count_what"))
    return d.last_counted


@meaning("counted_between")
def counted_between(d: Discourse, node: Node) -> Condition:
    """ "there are between three and ten people"."""
    count = Ask("count", {"thing": sought(d, counted_thing(d, node))})
    least, most = (Number(int(d.get(node, each))) for each in ("least", "most"))
    return Both((Compare(count, ">=", least), Compare(count, "<=", most)))


@meaning("cannot_check")
def cannot_check(d: Discourse, node: Node) -> Condition:
    """What was asked before, in its own words: "if he prefers the morning", "if it is not ready".
    Else something that is neither seen nor heard nor known: "the patient feels better"."""
    asked_for = about_answer(d, node)
    if asked_for is not None:
        return asked_for
    start = node.parts["unknown"].start
    end = node.end
    while end < len(d.tokens) and d.tokens[end].kind != "mark":
        end += 1  # "if the door is | open, go in": the clause goes on to its comma
    words = d.words(start, end)
    raise NotUnderstood(d.language.phrase("cannot_check", what=words), gap=(start, end))


def about_answer(d: Discourse, node: Node) -> Condition | None:
    """The condition that some words are on the last answer; None if they say more than what was
    asked, or nothing is known of how it was answered."""
    survey: Survey | None = d.surveys[-1] if d.surveys else None
    if survey is None or not survey.options or d.answer != survey.call.save_as:
        return None
    try:
        meant = wanted_answer(d, survey, Said(node.start, node.end), strict=True)
    except NotUnderstood:
        return None
    if in_loop(d, survey.call) and not d.in_loop:
        return None
    return meant.given(survey)


# --- the battery, the time


@meaning("battery_is")
def battery_is(d: Discourse, node: Node) -> Condition:
    return Compare(Ask("battery"), d.get(node, "operator", "=="), as_value(d.get(node, "percent")))


@meaning("time_is")
def time_is(d: Discourse, node: Node) -> Condition:
    """Times of day compare as "HH:MM" texts do."""
    return Compare(
        Ask("clock", field="time"), d.get(node, "operator", ">="), Text(d.get(node, "clock_time"))
    )


@meaning("weekday_is")
def weekday_is(d: Discourse, node: Node) -> Condition:
    day = Compare(Ask("clock", field="weekday"), "==", Text(d.get(node, "weekday")))
    more: Condition | None = d.get(node, "more")
    if more is None:
        return day
    return Either((day, *(more.conditions if isinstance(more, Either) else (more,))))


FULL_HOUR: Final = Compare(Text(":00"), "in", Ask("clock", field="time"))


@meaning("full_hour")
def full_hour(d: Discourse, node: Node) -> Condition:
    return FULL_HOUR


@meaning("weekend")
def weekend(d: Discourse, node: Node) -> Condition:
    """ "it is the weekend", or no day of the weekend."""
    day = Ask("clock", field="weekday")
    free = Either((Compare(day, "==", Text("Saturday")), Compare(day, "==", Text("Sunday"))))
    return Not(free) if node.production.fixed.get("no") else free


@meaning("robot_is_at")
def robot_is_at(d: Discourse, node: Node) -> Condition:
    return Compare(Ask("location", field="place"), "==", d.get(node, "place"))


@meaning("answered")
def answered(d: Discourse, node: Node) -> Condition:
    """ "if they say yes", "if the answer is radiology"."""
    fixed = node.production.fixed
    if d.answer is None:
        raise NotUnderstood(d.language.phrase("no_question"))
    plain = "answer" in fixed and "text" not in node.parts
    literal = plain and d.language.phrase(str(fixed["answer"])) in d.norms(node.start, node.end)
    pair = paired(d, d.language.phrase(str(fixed["answer"]))) if literal else None
    if pair is not None:
        return pair
    before = yes_no_before(d) if literal else None
    if before is not None:
        return before.said(d.language.phrase(str(fixed["answer"])))
    several = plain and asked_which(d)
    if several:  # "if they agree", on one of several days
        same = same_answers(d, node)
        return Not(same) if fixed["answer"] == "no" else same
    if "answer" in fixed:
        wanted = d.language.phrase(str(fixed["answer"]))
    else:
        place = node.parts.get("place")
        if place is not None:
            value: Value = d.build(place)
            assert isinstance(value, Text)
            wanted = value.value
        else:
            wanted = str(d.get(node, "text"))
    if says_the_same(d, wanted):
        return same_answers(d, node)
    for option in d.answer_options:
        if option.lower() == wanted.lower():
            return Compare(Recall(d.answer), "==", Text(option))
    said = node.parts.get("text")
    yes_no = set(d.answer_options) == {d.language.phrase("yes"), d.language.phrase("no")}
    survey: Survey | None = d.surveys[-1] if d.surveys else None
    if said is not None and survey is not None and d.answer_options:
        if not yes_no and survey.call.save_as == d.answer:
            return wanted_answer(d, survey, Said(said.start, said.end)).given(survey)
        if (asked_for := about_answer(d, node)) is not None:
            return asked_for
    if yes_no:
        ask_openly(d)
    return Compare(Text(wanted), "in", Recall(d.answer))


def ask_openly(d: Discourse) -> None:
    """The last question without its answers yes and no: "ask if they need anything; if they want
    water, ..." waits for more than these."""
    last = next((each for each in reversed(d.surveys) if each.call.save_as == d.answer), None)
    if last is None or not any(each is last.call for each in nodes(tuple(d.done))):
        return
    arguments = {name: each for name, each in last.call.arguments.items() if name != "options"}
    openly = Call(last.call.method, arguments, save_as=last.call.save_as)
    d.done[:] = [
        other
        for each in d.done
        for other in ([openly] if each is last.call else [replacing(each, last.call, [openly])])
    ]
    d.surveys = [
        replace(each, call=openly, options=()) if each is last else each for each in d.surveys
    ]
    d.answer_options = ()


def paired(d: Discourse, wanted: str) -> Condition | None:
    """The other answer to the question that the condition just before was on: "if she says yes, ask
    her whether ... If she says no, ..."."""
    step = d.done[-1] if d.done else None
    if d.branched is None or step is not d.branched.step or not isinstance(step, If):
        return None
    one = step.condition
    if step.otherwise or not isinstance(one, Compare) or one.operator != "==":
        return None
    answers = {d.language.phrase("yes"), d.language.phrase("no")}
    said = one.right.value if isinstance(one.right, Text) else ""
    if {said, wanted} != answers or not isinstance(one.left, Recall):
        return None
    return Compare(one.left, "==", Text(wanted))


def yes_no_before(d: Discourse) -> Survey | None:
    """The last question that was answered with yes or no, if another one was asked since, that is
    not: "if she says yes, ask her when: at 4 or at 5. If she says no, ..."."""
    yes_no = {d.language.phrase("yes"), d.language.phrase("no")}
    surveys = [each for each in asked_so_far(d) if not in_loop(d, each.call)]
    if not surveys or set(surveys[-1].options) == yes_no or surveys[-1].call.save_as != d.answer:
        return None
    if not surveys[-1].options and d.branched is None:
        return None  # "no" may be an answer to an open question, too
    return next((each for each in reversed(surveys) if set(each.options) == yes_no), None)


def asked_which(d: Discourse) -> bool:
    """Whether several people were asked last to choose, but not between yes and no."""
    survey: Survey | None = d.surveys[-1] if d.surveys else None
    yes_no = {d.language.phrase("yes"), d.language.phrase("no")}
    if survey is None or not survey.options or yes_no & set(survey.options):
        return False
    return in_loop(d, survey.call) or len(d.surveys) > 1


def says_the_same(d: Discourse, words: str) -> bool:
    """Whether words mean what somebody else has said: "the same one"."""
    low = words.lower()
    return any(
        re.search(rf"\b{re.escape(each)}\b", low) is not None
        for each in d.language.speech.get("the_same", ())
    )


def said_so(d: Discourse, no: bool, there_is_none: bool = False) -> Condition:
    """ "if so", "if he is not": what was looked for in the step before was found, or the last
    answer was yes."""
    agreed = just_agreed(d, no) or just_branched(d, no)
    if agreed is not None:
        return agreed
    if d.round.stop is not None and in_round(
        d
    ):  # "check every lab for a cup. If there is none, ..."
        if d.round.stop.thing is not None:
            d.met = Meeting(d.round.stop.thing, holds=no == d.round.stop.denied)
        return negated(d.round.stop.condition) if no else d.round.stop.condition
    looked = just_looked_for(d, None)
    if looked is not None:
        person = d.person if not d.thing_last else None
        if person is not None or d.thing is not None:
            found_now = person or d.thing or Thing(Text(ANYONE))
            d.met = Meeting(found_now, holds=not no, sought=True)
        return Not(looked) if no else looked
    delivery = delivered_last(d)
    if delivery is not None and no and (d.answer is None or there_is_none):
        d.met = Meeting(delivery.thing, holds=False, sought=True)
        return Not(Holds(Ask("find", {"thing": delivery.thing.value})))
    if d.answer is None:
        from grammar.meanings.reports import checked

        about = d.report.thing if d.report is not None else None
        looked = seen_there(d)
        known = checked(d) if looked is None else None
        if looked is not None or known is not None:
            if about is not None:
                d.met = Meeting(about, holds=not no)
            result = looked or Holds(known or Truth(True))
            return Not(result) if no else result
        raise NotUnderstood(d.language.phrase("no_question"))
    wanted = d.language.phrase("no" if no else "yes")
    if (pair := paired(d, wanted)) is not None:
        return pair
    if (before := yes_no_before(d)) is not None:
        return before.said(wanted)
    for option in d.answer_options:
        if option.lower() == wanted.lower():
            return Compare(Recall(d.answer), "==", Text(option))
    return Compare(Text(wanted), "in", Recall(d.answer))


def just_branched(d: Discourse, no: bool) -> Condition | None:
    """ "If she isn't there, come back. If she is, ask her ...": the other case of that."""
    before = d.branched
    step = before.step if before is not None else None
    if before is None or before.met is None or not isinstance(step, If) or step.otherwise:
        return None
    if before.answer != d.answer or not d.done or d.done[-1] is not step:
        return None
    if before.met.holds is not no:  # the same case again says something else
        return None
    d.set_scene(before.scene)
    d.met = replace(before.met, holds=not no)
    return negated(step.condition)


@meaning("so")
def so(d: Discourse, node: Node) -> Condition:
    fixed = node.production.fixed
    return said_so(d, no=bool(fixed.get("no")), there_is_none=bool(fixed.get("none")))


@meaning("answer_counts")
def answer_counts(d: Discourse, node: Node) -> Condition:
    """ "if it is more than seven": the answer, a number."""
    number = as_value(d.get(node, "number"))
    found = d.report
    counted = found is not None and found.name == "count" and d.answer is None
    if counted and (isinstance(found.value, Recall) or found.place in (None, d.at)):
        # "count the people, and if it is more than ten, ...": where they were counted
        return Compare(found.value, d.get(node, "operator", "=="), number)
    if d.answer is None:
        raise NotUnderstood(d.language.phrase("no_question"))
    return Compare(Recall(d.answer), d.get(node, "operator", "=="), number)


@meaning("answers_many")
def answers_many(d: Discourse, node: Node) -> Condition:
    """ "if both say yes", "if more than half of them agree", "if nobody wants any"."""
    surveys = of_one_question(asked_before(d))
    answer = d.said = wanted_answer(d, surveys[-1], d.get(node, "said"))
    how = node.production.fixed.get("how")
    not_all = bool(node.production.fixed.get("no"))
    by_one = len(surveys) == 1 or how in ("all", "none", "some")
    if not in_loop(d, surveys[-1].call) and by_one:
        given = of_those_asked(d, surveys, answer, str(how))
        return Not(given) if not_all else given
    said = counted_answers(d, surveys, answer)
    if how == "all":
        return Compare(said, "!=" if not_all else "==", people_asked(d, surveys))
    if how == "most":
        share = Share(said, counted_answers(d, surveys, None))
        return Compare(share, ">", Number(50))
    if how == "none":
        return Compare(said, "==", Number(0))
    least = int(d.get(node, "count", 1))
    return Compare(said, d.get(node, "operator", ">="), Number(least))


def of_those_asked(d: Discourse, surveys: list[Survey], answer: Wanted, how: str) -> Condition:
    """Whether all, some or none of those who were asked one after the other gave an answer."""
    same = surveys[-1].call.arguments["question"]
    alike = [each for each in surveys if each.call.arguments["question"] == same]
    if len(alike) == 1:
        alike = [each for each in surveys if each.options == surveys[-1].options]
    given = tuple(answer.given(each) for each in alike if not in_loop(d, each.call))
    if len(given) < 2:
        return Not(given[-1]) if how == "none" else given[-1]
    if how == "all":
        return Both(given)
    return Not(Either(given)) if how == "none" else Either(given)


@meaning("answer_is")
def answer_is(d: Discourse, node: Node) -> Condition:
    """ "if it's tea", "in case of tea": if that was chosen."""
    asked_for = about_answer(d, node)  # "it is not finished"
    if asked_for is not None:
        return asked_for
    survey: Survey | None = d.surveys[-1] if d.surveys else None
    part = node.parts["text"]
    words = [norm for norm in d.norms(part.start, part.end) if norm not in d.language.closed]
    if words and survey is not None and survey.call.save_as == d.answer:
        for option in survey.options:
            if [each for each in d.language.tokens_of(option) if each in words] == words:
                return survey.said(option)
    said = d.words(node.start, node.end)
    raise NotUnderstood(d.language.phrase("cannot_check", what=said), gap=(node.start, node.end))


def people_asked(d: Discourse, surveys: list[Survey]) -> Value:
    """How many were to be asked: those named, else those who were there."""
    call = surveys[-1].call
    if not any(in_loop(d, each.call) for each in surveys):
        return Number(len(surveys))
    for loop in d.done:
        if not isinstance(loop, ForEach) or not isinstance(loop.items, Items):
            continue
        if any(each is call for each in nodes(loop)):
            return Number(len(loop.items.items))
    return counted_answers(d, surveys, None)


@meaning("unanswered")
def unanswered(d: Discourse, node: Node) -> Condition:
    """ "if he does not answer": the question is then put so that silence is an answer, too."""
    survey: Survey | None = d.surveys[-1] if d.surveys else None
    if survey is None or survey.call.save_as is None:
        raise NotUnderstood(d.language.phrase("no_question"))
    name = survey.call.save_as
    if not any(each is survey.call for each in nodes(tuple(d.done))):
        words = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("not_understood", part=words))
    heard = Try((survey.call,), (Remember(name, Text("")),))
    whole = replacing(Forever(tuple(d.done)), survey.call, [heard])
    d.done[:] = whole.steps
    return Compare(Recall(name), "==", Text(""))


@meaning("is_touched")
def is_touched(d: Discourse, node: Node) -> Condition:
    """ "somebody touches the screen": a button is shown there; nobody need touch it."""
    touched = Recall(d.variable("touched"))
    button = Text(d.language.phrase("button"))
    nobody = Remember(touched.name, Text(""))
    showing = Call("touch", {"options": Items((button,))}, save_as=touched.name)
    d.pending.append(Try((showing,), (nobody,)))
    return Compare(touched, "==", button)


@meaning("code_is")
def code_is(d: Discourse, node: Node) -> Condition:
    if d.code is None:
        raise NotUnderstood(d.language.phrase("no_code"))
    part = node.parts["text"]  # its digits as they were said, should it be a number
    number = isinstance(part, Leaf) and part.slot == "number"
    text = d.words(part.start, part.end) if number else str(d.build(part))
    return Compare(Recall(d.code), "==", Text(text))


@meaning("is_awaited")
def is_awaited(d: Discourse, node: Node) -> Condition:
    """ "nobody comes within five minutes": waited for so long, and no longer."""
    thing = noun_of(d, node)
    if thing.place is not None and thing.place != d.at:
        d.went(thing.place)
        d.pending.append(Call("goto", {"place": thing.place}))
    d.person = replace(thing, here=True)
    seconds = as_value(d.get(node, "seconds"))
    waited = Holds(Ask("wait_for", {"thing": sought(d, thing), "timeout": seconds}))
    no = bool(node.production.fixed.get("no"))
    d.met = Meeting(thing, holds=not no)
    return Not(waited) if no else waited


@meaning("is_heard")
def is_heard(d: Discourse, node: Node) -> Condition:
    """ "you hear help". Where nobody speaks, nothing was heard, and that is no failure."""
    if d.heard is None:
        name = d.variable("heard")
        silence = Remember(name, Text(""))
        d.pending.append(Try((Call("listen", save_as=name),), (silence,)))
        heard: Value = Recall(name)
    else:
        heard = Recall(d.heard)
    part = node.parts.get("text")
    if isinstance(part, Leaf) and part.slot == "text":
        first = d.tokens[part.start].norm
        if first in d.language.speech.get("articles", ()):  # a sound, and nothing that is said
            words = d.words(node.start, node.end)
            raise NotUnderstood(d.language.phrase("cannot_check", what=words))
    if node.production.fixed.get("own_name"):
        if not d.lexicon.robot_name:
            words = d.words(node.start, node.end)
            raise NotUnderstood(d.language.phrase("cannot_check", what=words))
        return Compare(Text(d.lexicon.robot_name), "in", heard)
    return Compare(Text(str(d.get(node, "text"))), "in", heard)
