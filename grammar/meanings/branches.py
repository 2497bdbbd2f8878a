"""What is done if something is so, and what otherwise; the two may be sentences of their own.

Both branches begin with the same scene, but for what the condition says: where somebody has been
found they are here, and where they have not they still have to be looked for.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Final

from msgspec.structs import replace as structs_replace

from grammar.chart import Leaf, Node, what_it_means
from grammar.discourse import ANYONE, START, Branched, Claim, Discourse, Meeting, Steps, Thing
from grammar.errors import NotUnderstood
from grammar.meanings.absences import Addressed, addressed_before
from grammar.meanings.alternatives import excludes
from grammar.meanings.answered import said_so
from grammar.meanings.claims import (
    claim_of,
    counted_first,
    found_claim,
    leave_off,
    meet_there,
    told_so,
    turned,
)
from grammar.meanings.conditions import ABOUT_ANSWERS, condition_of, negated
from grammar.meanings.deliveries import (
    Taken,
    delivered_last,
    first_clause,
    gives_it,
    hands_it_over,
    inside,
    kept_in_hand,
    lacks,
    missed_at_home,
    still_in_hand,
    taken_back,
)
from grammar.meanings.finding import not_found
from grammar.meanings.holders import the_one_who_says_so
from grammar.meanings.in_time import too_late
from grammar.meanings.news import BACK, News
from grammar.meanings.registry import meaning
from grammar.meanings.searches import (
    Search,
    either_way,
    in_turn,
    only_told_missing,
    same_search,
    search_of,
    searched,
    searches,
    searching_at,
    thing_sought,
)
from grammar.meanings.speaking import clause_of
from grammar.meanings.turns import in_their_turn, of_whoever_says_so
from grammar.memory import Scene
from grammar.plan import (
    Ask,
    Call,
    Compare,
    Condition,
    Holds,
    If,
    Not,
    Recall,
    Remember,
    Step,
    Text,
    Truth,
)
from grammar.tidy import mentions, nodes

LOOKING: Final = frozenset({"look_in", "look_on", "find", "go_find"})
"""Commands that look for something and do nothing else."""


@meaning("if")
def if_(d: Discourse, node: Node) -> Steps:
    handed_back = the_one_who_says_so(d, node)
    if handed_back is not None:
        return handed_back
    delivery = delivered_last(d)
    of_one = of_whoever_says_so(d, node)
    before_it, condition = condition_of(d, node) if of_one is None else ([], of_one)
    condition = in_their_turn(d, node, condition)
    met = d.branch.met
    if node.production.fixed.get("either") and only_told(node.parts["then"]):
        return found_out_either_way(d, node, before_it, condition)
    if node.production.fixed.get("unless"):
        condition, met = negated(condition), turned(met)
    met = missed_at_home(d, delivery, met)
    if not before_it and is_other_case(d, condition, met):
        return [as_said_now(d, node, condition, met)]
    late = before_it or too_late(d, condition, met, lambda: d.build(node.parts["then"]))
    if isinstance(late, If):
        return [late]
    kept = addressed_before(d, met) if delivery is None and not before_it else None
    if kept is not None and met is not None:
        return absent(d, node, kept, met, lambda: d.build(node.parts["then"]))
    if delivery is not None and met is not None and lacks(delivery, met):
        taken = taken_back(d, delivery, met)
        if taken is not None:
            return [*before_it, *failing(d, node, taken, met)]
    if met is None and not before_it:
        as_before(d, condition)
    handed: Steps = []
    if hands_it_over(node.parts["then"]) or other_hands_it_over(node):
        last = None if delivery is None else still_in_hand(d, delivery)
        handed = [] if last is None else [last]
        if delivery is None:
            kept_back = kept_in_hand(d) or []
            handed = [] if gives_it(node.parts["then"]) else kept_back
    start = d.scene
    known = d.answers.last
    then = branch(d, node.parts["then"], met, claim_of(d, node, condition, met))
    after = d.scene
    d.scene = start
    asked = d.answers.last is not None and d.answers.last != known
    denied = node.parts.get("otherwise_denied")
    openly = bool(d.answers.surveys) and not d.answers.surveys[-1].options
    if asked and denied is not None and openly and isinstance(condition, Compare):
        asked = False
        d.answers = replace(d.answers, last=known)  # "ask her where; if she has not, ..."
    none, found = node.parts.get("otherwise_none"), node.parts.get("otherwise_so")
    if asked and denied is None and denies(d, condition):
        # "if not, ask Bob, and if he doesn't have one either, ask Clara": it is Bob who denies it
        denied = none or node.parts.get("otherwise_not")
    part, further = none or found, None
    if part is not None and met is not None and not met.holds:
        # "if it is not in the lab, look in the store; if it is not there either, ...": both are so
        further = searched_on(d, then, part, after, no=part is none)
    if further is not None:
        then, part, after = further, None, d.scene
    else:
        part = other_branch(d, node, condition) or denied
    if asked and denied is not None:
        # "if Bob is there, ask him whether he has time. If he does not, ...": that is his answer.
        scene = d.scene
        d.scene = after
        said_no = said_so(d, no=True)
        then = [*then, If(said_no, tuple(branch(d, denied, None, None)))]
        d.scene = scene
    otherwise: Steps = []
    if part is not None and not (asked and part is denied):
        led_from_here(d, then, after)
        otherwise = branch(d, part, turned(met), found_claim(d, condition, turned(met)))
    else:
        meet_there(d, turned(met))
    leave_off(d, after)
    assumed = bool(handed) and not otherwise
    if handed:
        then = then if hands_it_over(node.parts["then"]) else [*handed, *then]
        otherwise = otherwise if hands_it_over(part) else [*handed, *otherwise]
        d.scene = replace(d.scene, holding=None)
        # Who is not found is in no state, either.
        looked = searched(d.done[-1]) if d.done and not before_it else None
        if looked is not None and delivery is not None and delivery.person is not None:
            d.done.pop()
            missing = not_found(d, delivery.person)
            inner = If(condition, tuple(then), tuple(otherwise))
            same = seen_as_found(looked, inner) if met is not None else None
            return [same or If(looked, (inner,), (missing,))]
    counted, condition = counted_first(condition, [*then, *otherwise])
    whole = If(condition, tuple(then), tuple(otherwise))
    merged = [whole] if further else either_way(d, whole, looks_on=looks_on(node.parts["then"]))
    if merged != [whole]:
        return [*before_it, *counted, *merged]
    if part is None and denied is None and what_it_means(node.parts["condition"]) in ABOUT_ANSWERS:
        whole, told = told_in_any_case(d, whole)
        if told:
            return [*before_it, *counted, whole, *told]
    d.branch = replace(d.branch, before=Branched(whole, start, met, d.answers.last, assumed))
    return [*before_it, *counted, whole]


def led_from_here(d: Discourse, then: Steps, after: Scene) -> None:
    """ "if a room is free, take the visitors there. Otherwise tell them to wait": they are where
    the robot would have come back for them."""
    led = after.led
    back = [at for at, each in enumerate(then) if each == BACK]
    after_it = then[back[-1] :] if back else []
    guided = any(isinstance(each, Call) and each.method == "guide" for each in after_it)
    if guided and isinstance(led, Thing) and d.scene.person != led:
        d.scene = d.scene.speaking_of_person(replace(led, here=False, place=Recall(START)))


def is_other_case(d: Discourse, condition: Condition, met: Meeting | None) -> bool:
    """Whether a condition is the case of the one before of which nothing was said yet: "if she is
    in, give it to her. If nobody is in, ..."."""
    before = d.branch.before
    last = d.done[-1] if d.done else None
    if before is None or last is not before.step or not isinstance(last, If):
        return False
    if before.assumed and condition == negated(last.condition):
        return True
    nobody = met is not None and not met.holds and met.thing.text == ANYONE
    hers = before.met is not None and before.met.holds and before.met.thing.known
    return nobody and hers and not last.otherwise


def as_said_now(d: Discourse, node: Node, condition: Condition, met: Meeting | None) -> If:
    """ "if she is in, give it to her. If she is out, leave it on the desk": instead of what was
    assumed to be done then."""
    before = d.branch.before
    assert before is not None
    d.scene = before.scene
    otherwise = branch(d, node.parts["then"], met, claim_of(d, node, condition, met))
    first = d.done.pop()
    assert isinstance(first, If)
    return If(first.condition, first.then, tuple(otherwise))


def seen_as_found(looked: Condition, step: If) -> If | None:
    """A condition that only asks once more whether somebody is there who was just looked for: "take
    it to Alice. If she is in, give it to her, otherwise ..."."""
    condition, turned_round = step.condition, False
    if isinstance(condition, Not):
        condition, turned_round = condition.condition, True
    match condition:
        case Holds(value=Ask(method="sees", arguments={"thing": who})):
            if all(each.arguments["thing"] == who for each in searches(looked)):
                then, otherwise = step.then, step.otherwise
                return If(looked, *((otherwise, then) if turned_round else (then, otherwise)))
    return None


def denies(d: Discourse, condition: Condition) -> bool:
    """Whether a condition is that somebody answered with no."""
    refuse = Text(d.language.phrase("no"))
    return (
        isinstance(condition, Compare) and condition.operator == "==" and condition.right == refuse
    )


def if_found_so(d: Discourse, node: Node, search: Search) -> Steps:
    """ "when you find it, bring it, if not, tell me", after looking for it."""
    d.done.pop()
    thing = thing_sought(d, search.found)
    met = Meeting(replace(thing, pronoun=False, place=None), holds=True, sought=True)
    start = d.scene
    then = branch(d, node.parts["then"], met, found_claim(d, search.found, met))
    after = d.scene
    d.scene = start
    claim = found_claim(d, search.found, turned(met))
    otherwise = branch(d, node.parts["otherwise"], turned(met), claim)
    leave_off(d, after)
    return [If(search.found, tuple(then), tuple(otherwise))]


def only_told(part: Leaf | Node | None) -> bool:
    """Whether a branch does nothing but come back and tell: "see if she is there, then tell me"."""
    each = part
    while isinstance(each, Node):
        if first_clause(each).means not in ("come_back", "tell_me_that", "tell_that"):
            return False
        each = each.parts.get("rest")
    return part is not None


def found_out_either_way(d: Discourse, node: Node, before_it: Steps, condition: Condition) -> Steps:
    """ "see if there is a mug, then come back and tell me": also if there is none."""
    met, part = d.branch.met, node.parts["condition"]
    clause = clause_of(d, part)
    yes = found_claim(d, condition, met) or d.say("so_it_is", clause=clause)
    no = found_claim(d, condition, turned(met)) or d.say("not_so", clause=clause)
    name = d.variable("seen")
    noted: Steps = [Remember(name, Truth(False)), If(condition, (Remember(name, Truth(True)),))]
    if isinstance(condition, Holds) and isinstance(condition.value, Ask):
        noted = [Remember(name, condition.value)]
    words: Steps = [If(Holds(Recall(name)), (yes,), (no,))]
    d.reports = replace(d.reports, last=None, checked=name)
    d.done += [*before_it, *noted]
    d.reports = replace(d.reports, news=News(words, True, waiting=True))
    told: Steps = d.build(node.parts["then"])
    if d.reports.news.waiting:  # "..., then come back": to say it
        d.reports = replace(d.reports, news=News(words, True), told=words[-1])
        return [*told, *words]
    return told


def other_hands_it_over(node: Node) -> bool:
    """Whether the other branch says what becomes of a thing that was brought."""
    names = ("otherwise", "otherwise_not", "otherwise_none", "otherwise_so", "otherwise_denied")
    return any(hands_it_over(node.parts.get(name)) for name in names)


def failing(d: Discourse, node: Node, taken: Taken, met: Meeting) -> Steps:
    """A delivery, and what is done if that is not possible: "if there is no coffee, bring tea"."""
    after = d.scene
    outer = d.deliveries.meant_for
    d.deliveries = replace(
        d.deliveries, meant_for=d.deliveries.meant_for if met.thing.person else taken.delivery
    )
    place = met.thing.place or taken.delivery.thing.place or taken.delivery.before.at
    lost = met if met.thing.person else replace(met, thing=replace(met.thing, place=place))
    claim = found_claim(d, taken.condition, lost)
    if "then" in node.parts:
        otherwise = branch(d, node.parts["then"], lost, claim)
    else:
        meet_there(d, lost)
        otherwise = told_so(d, node, claim)
    d.deliveries = replace(d.deliveries, meant_for=outer)
    leave_off(d, after)
    names = ("otherwise", "otherwise_not", "otherwise_none")
    part = next((node.parts[name] for name in names if name in node.parts), None)
    further = search_of(otherwise[0]) if len(otherwise) == 1 else None
    first = searching_at(taken.condition, place)
    if further is not None and same_search(first, further.found) and part is None:
        # "if there is none, try the lab": brought from wherever it is found
        return [in_turn(first, further), *taken.steps]
    done = [*taken.steps, *(d.build(part) if part is not None else [])]
    return [If(taken.condition, tuple(done), tuple(otherwise))]


def told_in_any_case(d: Discourse, step: If) -> tuple[If, Steps]:
    """What is told of all who were asked, whether or not one more of them was: "if she says no, ask
    Bob and then come back and tell me what they said"."""
    then = list(step.then)
    asking = [at for at, each in enumerate(then) if _asks(each)]
    polls = [Recall(name) for name in d.answers.notes.values()]
    at = next(
        (at for at in range(asking[-1] + 1, len(then)) if _leads_to_telling(then[at], polls))
        if asking
        else iter(()),
        0,
    )
    if not at or not any(mentions(then[at:], each) for each in polls):
        return step, []
    return If(step.condition, tuple(then[:at])), then[at:]


def _asks(step: Step) -> bool:
    return any(isinstance(each, Call) and each.method == "ask" for each in nodes(step))


def _leads_to_telling(step: Step, polls: list[Recall]) -> bool:
    """Whether a step goes to somebody, or tells of a poll."""
    going = isinstance(step, Call) and step.method in ("goto", "find")
    return going or any(mentions((step,), each) for each in polls)


def as_before(d: Discourse, condition: Condition) -> None:
    """Go back to the scene of the condition just before if only one of the two can be: "if she says
    no, tell Bob. If she says yes, ask her ...", for whom nobody has left."""
    before = d.branch.before
    last = d.done[-1] if d.done else None
    if before is None or last is not before.step or not isinstance(last, If):
        return
    if excludes(last, If(condition, ())):
        d.scene = before.scene


def absent(
    d: Discourse, node: Node, kept: Addressed, met: Meeting, make: Callable[[], Steps]
) -> Steps:
    """What was done with somebody, if they are there, and what is done if not."""
    after, options, known = d.scene, d.answers.options, d.answers.last
    asked = any(isinstance(each, Call) and each.save_as == known for each in kept.steps)
    outer = d.answers
    d.answers = replace(
        d.answers,
        undelivered=None if d.answers.message is None else (d.answers.message, d.known_by_now()),
        instead_of=known if asked else None,
    )
    claim = claim_of(d, node, Holds(Truth(False)), met)
    before = d.branch.claim
    d.branch = replace(d.branch, claim=None if claim is None else Claim(claim, d.known_by_now()))
    meet_there(d, met)
    otherwise = tried_there(d, d.sequence(lambda: d.done.extend(make())), met.thing, kept)
    part = other_branch(d, node, Not(kept.condition)) or node.parts.get("otherwise_denied")
    last = otherwise[-1] if otherwise else None
    neither = node.parts.get("otherwise_none")  # "if she is not there either, ..."
    if neither is not None and part is neither and isinstance(last, If) and only_told_missing(last):
        in_vain = d.sequence(lambda: d.done.extend(d.build(neither)))
        otherwise[-1], part = structs_replace(last, otherwise=tuple(in_vain)), None
    d.answers = replace(d.answers, undelivered=outer.undelivered, instead_of=outer.instead_of)
    d.branch = replace(d.branch, claim=before)
    elsewhere = d.scene
    d.scene = after
    then = list(kept.steps)
    if part is not None:
        answer = d.answers.last
        d.answers = replace(d.answers, last=known, options=options)
        then = d.sequence(lambda: _go_on(d, then, part))
        d.answers = replace(d.answers, last=d.answers.last or answer)
        after = d.scene
    d.scene = elsewhere
    leave_off(d, after)
    otherwise, told = told_by_either(otherwise, Recall(known) if asked and known else None)
    return [kept.or_else(then, otherwise), *told]


def tried_there(d: Discourse, steps: Steps, who: Thing, kept: Addressed) -> Steps:
    """ "tell Alice ...; if she is not in her office, try the library": if she is there, she is told
    there."""
    match steps:
        case [*before, If(Not(Holds(Ask("find", where)) as found), missing, ())] if (
            where["thing"] == who.value
        ):
            return [*before, If(found, tuple(kept.steps), missing)]
        case _:
            return steps


def told_by_either(steps: Steps, answer: Recall | None) -> tuple[Steps, Steps]:
    """Steps with somebody who is asked instead of another, and what is told of the answer, which is
    told of either: "if he is not there, ask Alice and tell me the answer"."""
    if answer is None:
        return steps, []
    telling = (at for at, each in enumerate(steps) if each == BACK or mentions((each,), answer))
    at = next(telling, len(steps))
    told = steps[at:]
    checked = any(isinstance(each, If) and mentions(each.condition, answer) for each in told)
    return (steps[:at], told) if mentions(told, answer) and not checked else (steps, [])


def _go_on(d: Discourse, before: Steps, part: Leaf | Node) -> None:
    d.done.extend(before)
    d.done.extend(d.build(part))


def searched_on(
    d: Discourse, steps: Steps, part: Leaf | Node, scene: Scene, *, no: bool
) -> Steps | None:
    """The steps of a branch that ends with a search, and what is done if that finds something, or
    is in vain, too."""
    if not steps or searched(steps[-1]) is None:
        return None
    outer, d.done = d.done, list(steps)
    before = d.scene
    d.scene = scene
    condition = said_so(d, no=no, there_is_none=no)
    inner = branch(d, part, d.branch.met, None)
    found, d.done = d.done, outer
    d.scene = before
    return [*found, If(condition, tuple(inner))]


def in_branch(d: Discourse, clause: Node) -> Steps | None:
    """The steps of a clause that goes on a search in the other branch of the condition before it:
    "If it is not in the lab, look in the store. If it is not there either, tell Bob."."""
    last = d.done[-1] if d.done else None
    if not isinstance(last, If) or not asks_again(clause):
        return None
    inner = _with_more(d, last, clause)
    if inner is None:
        return None
    d.done.pop()
    return [inner]


def asks_again(clause: Node) -> bool:
    """Whether a condition is about what was looked for before."""
    while clause.production.means in (None, "steps") and len(clause.parts) == 1:
        (only,) = clause.parts.values()
        if not isinstance(only, Node):
            return False
        clause = only
    condition = clause.parts.get("condition")
    if clause.production.means != "if" or condition is None:
        return False
    about = what_it_means(condition)
    if about == "so":
        return True
    return about in ("is_seen", "is_found") and any(
        each.production.means == "thing_it" for each in inside(condition)
    )


def _with_more(d: Discourse, step: If, clause: Node) -> If | None:
    """A condition with a clause put at the end of the branch that ends with a search."""
    name = "otherwise" if step.otherwise else "then"
    body: Steps = list(getattr(step, name))
    search = searched(body[-1] if body else None)
    if search is None:
        deeper = body[-1] if body else None
        inner = _with_more(d, deeper, clause) if isinstance(deeper, If) else None
        return None if inner is None else structs_replace(step, **{name: (*body[:-1], inner)})
    outer, d.done = d.done, body
    looked = searches(search)
    d.scene = replace(d.scene, place=looked[-1].arguments.get("place", d.scene.place))
    d.scene = replace(d.scene, at=d.scene.place if len(looked) == 1 else None)
    more = d.build(clause)
    done, d.done = [*d.done, *more], outer
    return structs_replace(step, **{name: tuple(done)})


def other_branch(d: Discourse, node: Node, condition: Condition) -> Leaf | Node | None:
    """What is said to be done otherwise; "but if there are some, ..." is that only where there are
    none at first."""
    part = node.parts.get("otherwise_so")
    if part is None:
        names = ("otherwise", "otherwise_not", "otherwise_none")
        return next((node.parts[name] for name in names if name in node.parts), None)
    if not isinstance(condition, Not) and not node.production.fixed.get("unless"):
        words = d.words(part.start, part.end)
        raise NotUnderstood(d.language.phrase("not_understood", part=words))
    return part


def branch(d: Discourse, part: Leaf | Node, met: Meeting | None, claim: Step | None) -> Steps:
    """The steps of one branch; `claim` says what is so in it."""
    meet_there(d, met)
    outer = d.branch.claim
    d.branch = replace(d.branch, claim=None if claim is None else Claim(claim, d.known_by_now()))
    steps: Steps = d.build(part)
    d.branch = replace(d.branch, claim=outer)
    return steps


def looks_on(part: Leaf | Node) -> bool:
    """Whether a branch begins with looking somewhere else: "try the lab and bring it here"."""
    first = next((each for each in inside(part) if each.production.rule == "command"), None)
    return first is not None and first.means in LOOKING
