"""Waiting for a time, or for something to happen, and what is done then."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from math import ceil
from typing import Final

import msgspec

from grammar.chart import Leaf, Node, what_it_means
from grammar.discourse import ANYONE, Discourse, Steps, Thing
from grammar.meanings.arrivals import may_be_another, names_somebody
from grammar.meanings.asking_until import as_soon_as_answered, stops_asking
from grammar.meanings.branches import if_
from grammar.meanings.carrying import take_back_delivery
from grammar.meanings.claims import claim_of, meet_there
from grammar.meanings.conditions import ABOUT_ANSWERS, condition_of, negated
from grammar.meanings.deliveries import hands_it_over, inside
from grammar.meanings.finding import speak_to
from grammar.meanings.news import BACK, Told, go_back, in_round
from grammar.meanings.other_answers import other_answer
from grammar.meanings.persons import is_me, kind_in_plural
from grammar.meanings.polls import told_as_asked
from grammar.meanings.registry import meaning
from grammar.meanings.reports import known_words
from grammar.meanings.round_ends import STOP, ended_there
from grammar.meanings.strangers import as_announced
from grammar.meanings.surveys import asked_without_end, moved
from grammar.pauses import takes_time
from grammar.plan import (
    Ask,
    Call,
    Compare,
    Condition,
    Elapsed,
    End,
    Forever,
    Holds,
    If,
    Number,
    Recall,
    Remember,
    Repeat,
    RepeatUntil,
    Step,
    Text,
    Value,
    While,
)
from grammar.texts.judging import MESSAGES
from grammar.texts.words import words_for
from grammar.tidy import LOOPS, gives, in_each_round, nodes

WITH_ONE: Final = frozenset({"say", "ask", "guide", "gesture"})
"""What is done with one person after the other."""
A_MINUTE: Final = 60
LOOK_EVERY: Final = 10
"""Seconds between two looks at a condition that is waited for."""


@meaning("on_sight")
def on_sight(d: Discourse, node: Node) -> Steps:
    """ "as soon as you see Bob, ...": on a round of places, at the one where he is."""
    if d.round.stop is not None:
        there: Steps = d.build(node.parts["then"])
        return there
    if not in_round(d):
        return when(d, node)
    *before, seen = if_(d, node)
    if isinstance(seen, If) and d.branch.met is not None and d.branch.met.thing.known:
        seen = msgspec.structs.replace(seen, then=(*seen.then, End()))
    return [*before, seen]


@meaning("when")
def when(d: Discourse, node: Node) -> Steps:
    """ "when somebody comes, ...": wait for it, then do it; "whenever": again and again, but once
    at each place of a round: "go round the labs, and whenever you find a cup, ...". "Go tell
    Clara when he wants to leave", after he was asked that, tells her what he said."""
    parted = other_answer(node)
    if parted is not None:
        own, others = parted
        d.done += when(d, own)
        other: Steps = d.build(others)
        return other
    if node.production.fixed.get("always") and in_round(d):
        return if_(d, node)
    if waited_in_time(d) and not node.production.fixed.get("always"):
        whether: Steps = if_(d, node)
        return whether
    whole = told_with(node.parts["then"], node.parts["condition"])
    always = bool(node.production.fixed.get("always"))
    if whole is not None and not always and of_others(d, whole, node.parts["condition"]):
        once: Steps = d.build(whole)
        return once
    if asked_when(d, node) is not None and tells_only(node.parts["then"]):
        told: Steps = d.build(node.parts["then"])
        return told
    if stops_asking(d, node) and not node.production.fixed.get("always"):
        return as_soon_as_answered(d, node)
    about_answer = what_it_means(node.parts["condition"]) in ABOUT_ANSWERS
    in_turn = bool(d.answers.surveys) and asked_without_end(d, d.answers.surveys[-1])
    if about_answer and d.answers.last is not None and (in_turn or not always):
        return if_(d, node)  # "when he says yes", of somebody who was asked: he has answered
    if not_there(d, node) and not node.production.fixed.get("always"):
        return if_(d, node)
    person = d.scene.person
    if d.people.came is not None and not always and not names_somebody(node.parts["condition"]):
        d.scene = replace(d.scene, person=d.people.came)
        after: Steps = d.build(node.parts["then"])
        return after
    if not always and may_be_another(d, node.parts["condition"]):
        return if_(d, node)
    before, condition = condition_of(d, node)
    meet_there(d, d.branch.met)
    waited = Call("wait_for", {"thing": person.value}) if person is not None else None
    if d.done[-1:] == [waited] and wait_until(condition) == [waited]:
        d.done.pop()  # "wait for the doctor, and when she comes, ..."
    last = d.done[-1] if d.done else None
    if not before and person is not None and just_came(last) and wait_until(condition) == [ANY]:
        d.scene = replace(d.scene, person=person)  # "wait for a visitor. When somebody comes, ..."
        met: Steps = d.build(node.parts["then"])
        return met
    *going, waiting = wait_until(condition)
    if d.people.announced is not None and not always and waiting == ANY:
        coming = as_announced(d, [*before, *going])  # "Mr Keller is coming. When he arrives, ..."
        return [*coming, *d.build(node.parts["then"])]
    if not before and waited_for_them(d, node, condition):
        done: Steps = d.build(node.parts["then"])
        return done
    if hands_it_over(node.parts["then"]) and d.scene.thing is not None:
        take_back_delivery(d, d.scene.thing)  # "get the cup and hand it to Bob when he comes"
    body: Steps = d.build(node.parts["then"])
    if body == [STOP] and not always:
        there = ended_there(d, before, condition)
        if there is not None:
            return there
    each = always or _is_duty(d, node, condition) or is_habit(d, node)
    if each or is_greeter(d, node, condition, body):
        return each_time(before, condition, body)
    return [*awaited(before, condition), *body]


def told_with(part: Leaf | Node, behind: Leaf | Node) -> Node | None:
    """What is told to somebody with what stands behind it, which is a part of it then: "tell Bob to
    take two pills every four hours", "tell Bob that we close when Victor comes". None if nothing is
    told there."""
    if isinstance(part, Leaf):
        return None
    told = part.parts.get("text")
    if part.means in MESSAGES and isinstance(told, Leaf) and told.slot == "text":
        if told.end > behind.start:
            return None
        return _longer(part, {"text": replace(told, end=behind.end)})
    name = max(part.parts, key=lambda each: part.parts[each].end, default=None)
    last = None if name is None else told_with(part.parts[name], behind)
    return None if name is None or last is None else _longer(part, {name: last})


def of_others(d: Discourse, told: Node, condition: Leaf | Node) -> bool:
    """Whether a condition behind a message speaks neither of what the robot sees nor of whoever is
    told: "tell Bob that lunch is ready when you see him", "... when he comes"."""
    if words_for(d.language).addressing.intersection(d.norms(condition.start, condition.end)):
        return False
    while told.means not in MESSAGES:
        told = max((each for each in told.parts.values() if isinstance(each, Node)), key=_end)
    listener, who = told.parts.get("person_ref"), condition
    while isinstance(who, Node) and who.means != "person_pronoun" and who.parts:
        who = min(who.parts.values(), key=lambda each: each.start)
    if not isinstance(who, Node):
        return names_somebody(condition)
    gender = d.gender(who.start, who.end)
    if listener is None or gender is None:
        return False
    return d.gender_of(d.tokens[listener.end - 1].norm, gender) != gender


def _end(node: Node) -> int:
    return node.end


def _longer(node: Node, parts: dict[str, Leaf | Node]) -> Node:
    """A node that ends with some other parts."""
    return replace(node, end=max(each.end for each in parts.values()), parts=node.parts | parts)


ANY: Final = Call("wait_for", {"thing": Text(ANYONE)})


GREETING: Final = frozenset({"say", "ask", "gesture", "emotion"})
"""What is done with whoever comes, one after the other."""


def just_came(step: Step | None) -> bool:
    """Whether a step ends when somebody has come."""
    return isinstance(step, Call) and step.method == "wait_for" and "timeout" not in step.arguments


def _is_duty(d: Discourse, node: Node, condition: Condition) -> bool:
    """Whether it is to be done for whoever comes, for the robot stands guard or stays somewhere:
    "guard the store. If anybody comes, tell them ..."."""
    wait = wait_until(condition)
    if not d.people.on_duty or not (isinstance(wait[-1], Call) and _waits(wait[-1])):
        return False
    part = node.parts["condition"]
    anybody = d.language.words_called("any_words") & set(d.norms(part.start, part.end))
    return d.people.on_duty == "guard" or bool(anybody)


def is_greeter(d: Discourse, node: Node, condition: Condition, body: Steps) -> bool:
    """Whether the robot stays somewhere for nothing but to speak to whoever comes: "stand at the
    reception. When somebody arrives, ask them to sign in"."""
    last = all(token.kind == "mark" for token in d.tokens[node.end :])
    spoken = all(isinstance(step, Call) and step.method in GREETING for step in body)
    return d.people.on_duty == "stay" and last and spoken and wait_until(condition) == [ANY]


def is_habit(d: Discourse, node: Node) -> bool:
    """Whether it is to be done for all who come, of whom nobody says how many: "when visitors
    come, ask their name"."""
    part = node.parts["condition"]
    if d.tokens[part.start - 1].norm not in d.language.words_called("habitual"):
        return False
    people = (each for each in inside(part) if each.means == "person_kind")
    return any(each.start == part.start and kind_in_plural(d, each) for each in people)


def waited_for_them(d: Discourse, node: Node, condition: Condition) -> bool:
    """Whether the step before has waited for this already: "wait until there are five people. When
    they are there, ..."."""
    match d.done[-1] if d.done else None:
        case While(Compare(Ask("count") as count, _, number) as short, steps) if _only_waits(steps):
            if short == negated(at_least(condition)):
                return True
        case Repeat(number, (Call("wait_for", arguments),)):
            count = Ask("count", arguments)
        case _:
            return False
    if condition == Compare(count, "==", number):
        return True
    part = node.parts["condition"]
    words = set(d.norms(part.start, part.end))
    them = d.language.words_called("all_of_them")
    seen = condition.value if isinstance(condition, Holds) else None
    return isinstance(seen, Ask) and seen.method == "sees" and bool(words & them)


def waited_in_time(d: Discourse) -> bool:
    """Whether the step before waits only for some time: "wait five minutes for Bob. If he comes,
    ..." asks then whether he did."""
    last = d.done[-1] if d.done else None
    return isinstance(last, Call) and _waits(last) and "timeout" in last.arguments


def not_there(d: Discourse, node: Node) -> bool:
    """Whether somebody who was to be told or asked something is said not to be there: "when he
    isn't there, tell David" waits for nobody to leave."""
    condition = node.parts["condition"]
    absent = any(
        each.production.means == "is_seen" and each.production.fixed.get("no")
        for each in inside(condition)
    )
    return absent and d.answers.message is not None and condition.start < node.parts["then"].start


def asked_when(d: Discourse, node: Node) -> Told | None:
    """What was answered to the question when something is, if that is what is told of here."""
    condition = node.parts["condition"]
    told = node.parts.get("person_ref") or node.parts["then"]
    if condition.start < told.end:
        return None
    return told_as_asked(d, condition.start, condition.end)


def tells_only(part: Leaf | Node) -> bool:
    """Whether some steps are nothing but telling somebody."""
    meant = {each.production.means for each in inside(part)} - {None}
    return meant <= {"steps", "tell_that", "news", "person_name", "person_pronoun"}


def each_time(before: Steps, condition: Condition, body: Steps) -> Steps:
    """Steps each time that something happens; what lasts happens once, until it is over."""
    first, looks = parted(before, condition)
    if looks:
        return [*first, Forever((*looks, If(condition, tuple(body))))]
    wait = wait_until(condition)
    if isinstance(wait[-1], Call):  # for somebody who was not met before
        return [*first, *there_first([Forever((*wait, *body))])]
    over = wait_until(negated(condition))
    return [*first, Forever((*wait, *body, *over))]


def there_first(steps: Steps) -> Steps:
    """Going where somebody is waited for, before the loop in which that is done: "whenever somebody
    enters the lobby"."""
    loop = steps[-1]
    if not isinstance(loop, Forever | RepeatUntil | While | Repeat) or len(loop.steps) < 2:
        return steps
    going = loop.steps[0]
    goes = isinstance(going, Call) and going.method == "goto"
    if not goes or _waited_for(loop.steps[1]) is None:
        return steps
    rest = loop.steps[1:]
    return [*steps[:-1], going, msgspec.structs.replace(loop, steps=rest)]


def _waits(step: Step | Value | None) -> bool:
    return isinstance(step, Call | Ask) and step.method == "wait_for"


@meaning("moment")
def moment(d: Discourse, node: Node) -> Steps:
    """ "wait", "stay here": for how long is not said, so that it is until what is waited for next
    (`until_then`)."""
    waiting = d.call_of(node, "wait")
    d.command = replace(d.command, moments=(*d.command.moments, waiting))
    return [waiting]


def until_then(d: Discourse, done: Steps, later: Steps) -> Steps:
    """The steps of a sequence in which what would go on without end is done until what was waited
    for before: "stay in the lobby until noon and greet everybody who comes", or as long as was
    waited before, if it is not of those that were said to come `later`; and in which somebody who
    is led away in each round is waited for in each: "wait for visitors and take them to radiology
    until five"."""
    result: Steps = []
    for step in _with_each_one(done, later):
        last = result[-1] if result else None
        if any(last is each for each in d.command.moments) and _awaits(step):
            result.pop()
            last = result[-1] if result else None
        if isinstance(step, Forever) and isinstance(last, While) and _only_waits(last.steps):
            step = RepeatUntil(negated(last.condition), tuple(looking_up(list(step.steps))))
            result.pop()
        elif isinstance(step, Forever) and _goes_on_meanwhile(step, last, later):
            result.pop()
            *before, step = for_so_long(d, _lasting(last), list(step.steps))
            result += before
        elif isinstance(step, LOOPS) and isinstance(last, Call) and _waits(last):
            if _waited_for(step.steps[0]) == last.arguments["thing"]:
                result.pop()
            elif _leads_away(step.steps, last.arguments["thing"]):
                steps: Steps = [last, *step.steps]
                if isinstance(step, RepeatUntil | While):
                    steps = looking_up(steps)
                step = msgspec.structs.replace(step, steps=tuple(steps))
                result.pop()
        result.append(step)
    return result


def _with_each_one(done: Steps, later: Steps) -> Steps:
    """The steps, where what is done with whoever is waited for again and again is one round: "wave
    at everybody who comes in, and say hello"."""
    result: Steps = []
    for step in done:
        last = result[-1] if result else None
        with_one = isinstance(step, Call) and step.method in WITH_ONE
        if (
            with_one
            and isinstance(last, Forever)
            and _awaits(last)
            and not any(each is step or each is last for each in later)
        ):
            result[-1] = in_each_round(last, step)
        else:
            result.append(step)
    return result


def _goes_on_meanwhile(endless: Forever, last: Step | None, later: Steps) -> bool:
    """Whether somebody is waited for again and again while some time is waited anyway."""
    afterwards = any(endless is each for each in later)
    return _awaits(endless) and _lasting(last) >= A_MINUTE and not afterwards


def _lasting(step: Step | None) -> float:
    """How many seconds are waited; 0 if nothing is, or nobody can tell."""
    if not isinstance(step, Call) or step.method != "wait":
        return 0
    seconds = step.arguments.get("seconds")
    return seconds.value if isinstance(seconds, Number) else 0


def for_so_long(d: Discourse, seconds: float, body: Steps) -> Steps:
    """As many rounds as there is time for, which a program can tell to the minute."""
    begin = d.variable("begin")
    time_left = Compare(Elapsed(Recall(begin)), "<", Number(ceil(seconds / A_MINUTE)))
    *before, loop = there_first([While(time_left, tuple(looking_up(body)))])
    return [*before, Remember(begin, Ask("clock", field="time")), loop]


def _waited_for(step: Step) -> Value | None:
    """Who is waited for, if a round begins with that."""
    first: Step | Value = step
    if isinstance(step, If) and isinstance(step.condition, Holds):
        first = step.condition.value
    return first.arguments["thing"] if isinstance(first, Call | Ask) and _waits(first) else None


def _awaits(step: Step) -> bool:
    """Whether something is waited for first."""
    if isinstance(step, LOOPS) and step.steps:
        return _only_waits(step.steps) or _awaits(step.steps[0])
    return _waits(step) or _waited_for(step) is not None


def _only_waits(steps: Iterable[Step]) -> bool:
    return all(isinstance(step, Call) and step.method == "wait" for step in steps)


def _leads_away(steps: Iterable[Step], person: Value) -> bool:
    return any(
        isinstance(step, Call) and step.method == "guide" and step.arguments["person"] == person
        for step in steps
    )


def looking_up(body: Steps) -> Steps:
    """A round that begins with waiting for somebody, so that it ends in time where nobody comes:
    "greet visitors until five"."""
    for at, step in enumerate(body):
        if not isinstance(step, Call) or step.method not in ("goto", "wait_for"):
            break
        if step.method == "wait_for" and step.save_as is None and len(body) > at + 1:
            timeout = step.arguments.get("timeout", Number(LOOK_EVERY))
            waited = Holds(Ask("wait_for", {**step.arguments, "timeout": timeout}))
            return [*body[:at], If(waited, tuple(body[at + 1 :]))]
    return body


def waiting(d: Discourse, node: Node) -> Steps:
    """Wait until the condition of a clause holds; whoever is waited for is then here."""
    before, condition = condition_of(d, node)
    meet_there(d, d.branch.met)
    return awaited(before, condition)


@meaning("tell_when")
def tell_when(d: Discourse, node: Node) -> Steps:
    """ "as soon as Bob is here, tell me": wait for it, then say that it is so; "tell Bob when she
    is coming", after she was asked that: what she said."""
    asked = asked_when(d, node)
    if asked is not None:
        asker: Thing = d.get(node, "person_ref")
        back = go_back(d, []) if is_me(asker) else []
        return [*back, *asked.words] if is_me(asker) else speak_to(d, asker, asked.words)
    wait_before_going_back(d, node)
    part = node.parts.get("person_ref")
    if part is None or part.start < node.parts["condition"].start:
        d.get(node, "person_ref")  # who is named first is spoken of as "she" then
    before_it, condition = condition_of(d, node)
    claim = claim_of(d, node, condition, d.branch.met)
    meet_there(d, d.branch.met)
    waiting = _at_the_pace_before(d, [*before_it], condition) or awaited(before_it, condition)
    if waiting and d.done[-1:] == waiting[-1:]:
        waiting = waiting[:-1]  # "wait for her, and when she comes, tell Bob"
    away = d.scene.at is not None or moved(waiting)
    person: Thing = d.get(node, "person_ref")
    d.scene = replace(
        d.scene, looked_in=d.scene.at
    )  # whoever is to be told is not there, or would know
    told = speak_to(d, person, known_words(d) if claim is None else [claim])
    if is_me(person) and away:
        told = [Call("goto", {"place": d.start()}), *told]
    if node.production.fixed.get("always"):
        return each_time(before_it, condition, told)
    return [*waiting, *told]


def _at_the_pace_before(d: Discourse, looking: Steps, condition: Condition) -> Steps | None:
    """ "check the kitchen every ten minutes and tell me when it is empty": looked for at that pace,
    and no more once it is so."""
    rounds = d.done[-1] if d.done else None
    if not isinstance(rounds, Forever):
        return None
    *body, pause = rounds.steps
    if not body or not isinstance(pause, Call) or pause.method != "wait":
        return None
    d.done.pop()
    return looked_for_at_pace([*body, *looking], condition, pause)


def looked_for_at_pace(looking: Steps, condition: Condition, pause: Call) -> Steps:
    """Look whether something is so, and wait before the next look, until it is."""
    return [*looking, While(negated(at_least(condition)), (pause, *looking))]


def wait_before_going_back(d: Discourse, node: Node) -> None:
    """ "watch the mail room and come back and let me know when somebody comes": it is there that
    they are waited for, and then gone back."""
    if not d.done or d.done[-1] != BACK or node.parts["condition"].start < node.start + 2:
        return
    d.done.pop()
    if d.scene.place is None or d.scene.place == BACK.arguments["place"]:
        d.scene = replace(d.scene, at=None)  # the robot has not left yet
    else:
        d.went(d.scene.place)


def at_least(condition: Condition) -> Condition:
    """ "until there are three people": more are enough, too."""
    if (
        isinstance(condition, Compare)
        and condition.operator == "=="
        and isinstance(condition.left, Ask)
        and condition.left.method == "count"
    ):
        return Compare(condition.left, ">=", condition.right)
    return condition


def awaited(before: Steps, condition: Condition) -> Steps:
    """Wait until a condition holds that needs some steps before it can be checked: what is found
    out by them is found out anew each time."""
    first, looks = parted(before, condition)
    if not looks:
        return [*first, *wait_until(condition)]
    return [*first, RepeatUntil(at_least(condition), tuple(looks))]


def parted(before: Steps, condition: Condition) -> tuple[Steps, Steps]:
    """The steps before a condition: those that are done once, and those that find out what it is
    about."""
    names = {each.name for each in nodes(condition) if isinstance(each, Recall)}
    looks = [step for step in before if names & gives(step)]
    return [step for step in before if step not in looks], looks


def wait_until(condition: Condition) -> Steps:
    """Wait until a condition holds."""
    condition = at_least(condition)
    if isinstance(condition, Holds) and isinstance(condition.value, Ask):
        asked = condition.value
        if asked.method in ("sees", "wait_for"):
            return [Call("wait_for", asked.arguments)]
        if asked.method == "find" and "place" in asked.arguments:
            there = Call("goto", {"place": asked.arguments["place"]})
            return [there, Call("wait_for", {"thing": asked.arguments["thing"]})]
    pause = 1 if takes_time(condition) else LOOK_EVERY
    return [While(negated(condition), (Call("wait", {"seconds": Number(pause)}),))]


@meaning("wait_until")
def wait_until_(d: Discourse, node: Node) -> Steps:
    return waiting(d, node)


@meaning("delayed")
def delayed(d: Discourse, node: Node) -> Steps:
    """ "in five minutes, ...", "at three o'clock, ..."."""
    waiting: Steps = d.build(node.parts["delay"])
    return [*waiting, *d.build(node.parts["then"])]


@meaning("at_time")
def at_time(d: Discourse, node: Node) -> Steps:
    """Wait until it is that late."""
    time = Compare(Ask("clock", field="time"), ">=", Text(d.get(node, "clock_time")))
    return wait_until(time)


@meaning("no_later")
def no_later(d: Discourse, node: Node) -> Steps:
    """ "by noon": what is done at once is done by then."""
    d.background += (d.words(node.start, node.end),)
    return []
