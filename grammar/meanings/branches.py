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
from grammar.discourse import (
    ANYONE,
    Branched,
    Claim,
    Discourse,
    Meeting,
    NotUnderstood,
    Steps,
    Thing,
)
from grammar.meanings.absences import Addressed, addressed_before
from grammar.meanings.conditions import condition_of, negated, said_so
from grammar.meanings.deliveries import (
    Taken,
    delivered_last,
    first_clause,
    hands_it_over,
    inside,
    lacks,
    still_in_hand,
    taken_back,
)
from grammar.meanings.finding import go, not_found, speak_to
from grammar.meanings.news import BACK, News, go_back
from grammar.meanings.nouns import is_me
from grammar.meanings.polls import polled
from grammar.meanings.registry import meaning
from grammar.meanings.reports import coming_back, known_words, tell_speaker, told_again
from grammar.meanings.searches import (
    Search,
    either_way,
    in_turn,
    same_search,
    search_of,
    searched,
    searches,
    searching_at,
    thing_sought,
)
from grammar.meanings.sights import named_some
from grammar.meanings.speaking import put_for, sentence_form
from grammar.meanings.turns import in_their_turn
from grammar.plan import (
    Ask,
    Call,
    Compare,
    Condition,
    Holds,
    If,
    Items,
    Not,
    Recall,
    Remember,
    Step,
    Text,
    Truth,
)
from grammar.tidy import mentions, nodes
from grammar.wordforms import plural
from grammar.wordorder import direct_clause

ABOUT_ANSWERS: Final = frozenset(
    {
        *("so", "answered", "answer_counts", "answers_many", "answers_same", "unanswered"),
        *("answer_is", "answers_reached"),
        *("code_is", "cannot_check"),
    }
)
LOOKING: Final = frozenset({"look_in", "look_on", "find", "go_find"})
"""Commands that look for something and do nothing else."""
TELL: Final = "tell_condition"
COUNT: Final = "count"
"""The variable that a number is kept in which a condition is about."""


@meaning("if")
def if_(d: Discourse, node: Node) -> Steps:
    node = with_else(node)
    delivery = delivered_last(d)
    before_it, condition = condition_of(d, node)
    condition = in_their_turn(d, node, condition)
    met = d.met
    if node.production.fixed.get("either") and only_told(node.parts["then"]):
        return found_out_either_way(d, node, before_it, condition)
    if node.production.fixed.get("unless"):
        condition, met = negated(condition), turned(met)
    kept = addressed_before(d, met) if delivery is None and not before_it else None
    if kept is not None and met is not None:
        return absent(d, node, kept, met, lambda: d.build(node.parts["then"]))
    if delivery is not None and met is not None and lacks(delivery, met):
        taken = taken_back(d, delivery, met)
        if taken is not None:
            return [*before_it, *failing(d, node, taken, met)]
    if met is None and not before_it:
        as_before(d, condition)
    handed = None
    if delivery is not None and (hands_it_over(node.parts["then"]) or other_hands_it_over(node)):
        handed = still_in_hand(d, delivery)
    start = d.scene()
    known = d.answer
    then = branch(d, node.parts["then"], met, claim_of(d, node, condition, met))
    after = d.scene()
    d.set_scene(start)
    asked = d.answer is not None and d.answer != known
    denied = node.parts.get("otherwise_denied")
    none, found = node.parts.get("otherwise_none"), node.parts.get("otherwise_so")
    part, further = none or found, None
    if part is not None and met is not None and not met.holds:
        # "if it is not in the lab, look in the store; if it is not there either, ...": both are so
        further = searched_on(d, then, part, after, no=part is none)
    if further is not None:
        then, part, after = further, None, d.scene()
    else:
        part = other_branch(d, node, condition) or denied
    if asked and denied is not None:
        # "if Bob is there, ask him whether he has time. If he does not, ...": that is his answer.
        scene = d.scene()
        d.set_scene(after)
        said_no = said_so(d, no=True)
        then = [*then, If(said_no, tuple(branch(d, denied, None, None)))]
        d.set_scene(scene)
    otherwise: Steps = []
    if part is not None and not (asked and part is denied):
        otherwise = branch(d, part, turned(met), found_claim(d, condition, turned(met)))
    else:
        meet_there(d, turned(met))
    leave_off(d, after)
    if handed is not None:
        then = then if hands_it_over(node.parts["then"]) else [handed, *then]
        otherwise = otherwise if hands_it_over(part) else [handed, *otherwise]
        d.holding = None
        # Who is not found is in no state, either.
        looked = searched(d.done[-1]) if d.done and not before_it else None
        if looked is not None and delivery is not None and delivery.person is not None:
            d.done.pop()
            missing = not_found(d, delivery.person)
            return [If(looked, (If(condition, tuple(then), tuple(otherwise)),), (missing,))]
    counted, condition = counted_first(condition, [*then, *otherwise])
    whole = If(condition, tuple(then), tuple(otherwise))
    merged = [whole] if further else either_way(d, whole, looks_on=looks_on(node.parts["then"]))
    if merged != [whole]:
        return [*before_it, *counted, *merged]
    if part is None and denied is None and what_it_means(node.parts["condition"]) in ABOUT_ANSWERS:
        whole, told = told_in_any_case(d, whole)
        if told:
            return [*before_it, *counted, whole, *told]
    d.branched = Branched(whole, start, met, d.answer)
    return [*before_it, *counted, whole]


def if_found_so(d: Discourse, node: Node, search: Search) -> Steps:
    """ "when you find it, bring it, if not, tell me", after looking for it."""
    d.done.pop()
    thing = thing_sought(d, search.found)
    met = Meeting(replace(thing, pronoun=False, place=None), holds=True, sought=True)
    start = d.scene()
    then = branch(d, node.parts["then"], met, found_claim(d, search.found, met))
    after = d.scene()
    d.set_scene(start)
    claim = found_claim(d, search.found, turned(met))
    otherwise = branch(d, node.parts["otherwise"], turned(met), claim)
    leave_off(d, after)
    return [If(search.found, tuple(then), tuple(otherwise))]


def with_else(node: Node) -> Node:
    """A condition whose other branch was read as the last clause of the first: "if you find it,
    bring it, if not, tell me". After a question in between, it would be about the answer."""
    chain: list[Node] = []
    each: Leaf | Node | None = node.parts["then"]
    while isinstance(each, Node) and each.means == "steps":
        chain.append(each)
        each = each.parts.get("rest")
    if len(chain) < 2 or any(name.startswith("otherwise") for name in node.parts):
        return node
    *kept, last = chain
    clause = unwrapped(last.parts["first"])
    condition = unwrapped(clause.parts.get("condition")) if clause is not None else None
    if clause is None or condition is None or clause.production.means not in ("if", TELL):
        return node
    denied = condition.means == "so" and condition.production.fixed.get("no")
    asked = any(part.means.startswith("ask") for one in kept for part in inside(one.parts["first"]))
    if not denied or asked:
        return node
    then: Node | None = None
    for one in reversed(kept):
        parts = {name: part for name, part in one.parts.items() if name != "rest"}
        then = replace(one, parts=parts if then is None else {**parts, "rest": then})
    said = {name: part for name, part in clause.parts.items() if name != "condition"}
    other = replace(clause, parts=said) if clause.production.means == TELL else said.pop("then")
    further = {name: part for name, part in said.items() if name.startswith("otherwise")}
    if then is None or further:
        return node
    return replace(node, parts={**node.parts, "then": then, "otherwise": other})


def unwrapped(part: Leaf | Node | None) -> Node | None:
    """The node that a part stands for; None for a slot."""
    while isinstance(part, Node) and part.production.means is None and len(part.parts) == 1:
        (part,) = part.parts.values()
    return part if isinstance(part, Node) else None


def only_told(part: Leaf | Node | None) -> bool:
    """Whether a branch does nothing but come back and tell: "see if she is there, then tell me"."""
    each = part
    while isinstance(each, Node):
        first = first_clause(each)
        if first.means not in ("come_back", "tell_me_that", "tell_that"):
            return False
        if not all(is_node_of(part, "person_me") for part in first.parts.values()):
            return False
        each = each.parts.get("rest")
    return part is not None


def is_node_of(part: Leaf | Node, means: str) -> bool:
    return isinstance(part, Node) and part.means == means


def found_out_either_way(d: Discourse, node: Node, before_it: Steps, condition: Condition) -> Steps:
    """ "see if there is a mug, then come back and tell me": also if there is none."""
    met, part = d.met, node.parts["condition"]
    clause = d.words(part.start, part.end)
    yes = found_claim(d, condition, met) or d.say("so_it_is", clause=clause)
    no = found_claim(d, condition, turned(met)) or d.say("not_so", clause=clause)
    name = d.variable("seen")
    noted: Steps = [Remember(name, Truth(False)), If(condition, (Remember(name, Truth(True)),))]
    if isinstance(condition, Holds) and isinstance(condition.value, Ask):
        noted = [Remember(name, condition.value)]
    words: Steps = [If(Holds(Recall(name)), (yes,), (no,))]
    d.report, d.checked = None, name
    back = go_back(d, [*before_it, *noted])
    d.news, d.told = News(words, True), words[-1]
    return [*before_it, *noted, *back, *words]


def other_hands_it_over(node: Node) -> bool:
    """Whether the other branch says what becomes of a thing that was brought."""
    names = ("otherwise", "otherwise_not", "otherwise_none", "otherwise_so", "otherwise_denied")
    return any(hands_it_over(node.parts.get(name)) for name in names)


def failing(d: Discourse, node: Node, taken: Taken, met: Meeting) -> Steps:
    """A delivery, and what is done if that is not possible: "if there is no coffee, bring tea"."""
    after = d.scene()
    outer, d.meant_for = d.meant_for, d.meant_for if met.thing.person else taken.delivery
    place = met.thing.place or taken.delivery.thing.place or taken.delivery.before["at"]
    lost = met if met.thing.person else replace(met, thing=replace(met.thing, place=place))
    claim = found_claim(d, taken.condition, lost)
    if "then" in node.parts:
        otherwise = branch(d, node.parts["then"], lost, claim)
    else:
        meet_there(d, lost)
        otherwise = told_so(d, node, claim)
    d.meant_for = outer
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
    at = next((at for at, each in enumerate(then) if each == BACK), 0)
    polls = [Recall(name) for name in d.notes.values()]
    asked = any(isinstance(each, Call) and each.method == "ask" for each in nodes(then[:at]))
    if not asked or not any(mentions(then[at:], each) for each in polls):
        return step, []
    return If(step.condition, tuple(then[:at])), then[at:]


def as_before(d: Discourse, condition: Condition) -> None:
    """Go back to the scene of the condition just before if only one of the two can be: "if she says
    no, tell Bob. If she says yes, ask her ...", for whom nobody has left."""
    from grammar.meanings.alternatives import excludes

    before = d.branched
    last = d.done[-1] if d.done else None
    if before is None or last is not before.step or not isinstance(last, If):
        return
    if excludes(last, If(condition, ())):
        d.set_scene(before.scene)


def absent(
    d: Discourse, node: Node, kept: Addressed, met: Meeting, make: Callable[[], Steps]
) -> Steps:
    """What was done with somebody, if they are there, and what is done if not."""
    after, options, known = d.scene(), d.answer_options, d.answer
    asked = any(isinstance(each, Call) and each.save_as == known for each in kept.steps)
    outer = d.undelivered, d.instead_of
    d.undelivered = None if d.message is None else (d.message, d.known_by_now())
    d.instead_of = known if asked else None
    claim = claim_of(d, node, Holds(Truth(False)), met)
    d.claim, before = None if claim is None else Claim(claim, d.known_by_now()), d.claim
    meet_there(d, met)
    otherwise = d.sequence(lambda: d.done.extend(make()))
    d.claim, (d.undelivered, d.instead_of) = before, outer
    elsewhere = d.scene()
    d.set_scene(after)
    then = list(kept.steps)
    part = other_branch(d, node, Not(kept.condition)) or node.parts.get("otherwise_denied")
    if part is not None:
        answer, d.answer, d.answer_options = d.answer, known, options
        then = d.sequence(lambda: _go_on(d, then, part))
        d.answer = d.answer or answer
        after = d.scene()
    d.set_scene(elsewhere)
    leave_off(d, after)
    return [If(kept.condition, tuple(then), tuple(otherwise))]


def _go_on(d: Discourse, before: Steps, part: Leaf | Node) -> None:
    d.done.extend(before)
    d.done.extend(d.build(part))


def searched_on(
    d: Discourse, steps: Steps, part: Leaf | Node, scene: dict[str, object], *, no: bool
) -> Steps | None:
    """The steps of a branch that ends with a search, and what is done if that finds something, or
    is in vain, too."""
    if not steps or searched(steps[-1]) is None:
        return None
    outer, d.done = d.done, list(steps)
    before = d.scene()
    d.set_scene(scene)
    condition = said_so(d, no=no, there_is_none=no)
    inner = branch(d, part, d.met, None)
    found, d.done = d.done, outer
    d.set_scene(before)
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
    d.place = looked[-1].arguments.get("place", d.place)
    d.at = d.place if len(looked) == 1 else None
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
    outer = d.claim
    d.claim = None if claim is None else Claim(claim, d.known_by_now())
    steps: Steps = d.build(part)
    d.claim = outer
    return steps


def claim_of(d: Discourse, node: Node, condition: Condition, met: Meeting | None) -> Step | None:
    """What a condition says, as a sentence of its own: "if there is a cup, tell me"."""
    part = node.parts["condition"]
    if what_it_means(part) in ("so", "answered"):
        # Of a round it would be told at each place, and never that it is nowhere.
        return found_claim(d, condition, met) if met is not None and not d.in_loop else None
    if what_it_means(part) == "answers_many":  # "if anyone says yes, tell Alice": how many did
        return polled(d, "many", None).words[0]
    if node.production.fixed.get("turned") or node.production.fixed.get("unless"):
        return found_claim(d, condition, met)
    end = part.end
    while d.tokens[end - 1].kind == "mark":
        end -= 1
    clause = as_fact(d, direct_clause(d, part.start, end))
    return Call("say", {"text": Text(sentence_form(clause))})


def as_fact(d: Discourse, clause: str) -> str:
    """What was waited for, in the words for what is so: "soit sorti" -> "est sorti", and of the
    robot as it speaks of itself: "you see a cup" -> "I see a cup"."""
    facts: dict[str, str] = d.language.speech.get("indicative", {})
    clause = " ".join(facts.get(word, word) for word in clause.split(" "))
    return put_for(d, "of_robot", clause)


def found_claim(d: Discourse, condition: Condition, met: Meeting | None) -> Step | None:
    """What has been found, or how many were counted."""
    if met is not None and met.holds:
        return d.say("yes_seen", thing=named_some(d, met.thing))
    if met is not None and met.thing.text == ANYONE:
        return d.say("nobody_seen")
    if met is not None:
        return not_found(d, met.thing)
    if isinstance(condition, Compare) and isinstance(condition.left, Ask):
        thing = condition.left.arguments.get("thing")
        if condition.left.method == "count" and isinstance(thing, Text):
            things = plural(d.called(thing.value), d.language)
            return d.say("counted", things=things, value=Recall(COUNT))
    return None


def counted_first(condition: Condition, branches: Steps) -> tuple[Steps, Condition]:
    """A number that is told in a branch is counted before, for it may be told elsewhere."""
    counts = isinstance(condition, Compare) and isinstance(condition.left, Ask)
    if not counts or not mentions(tuple(branches), Recall(COUNT)):
        return [], condition
    assert isinstance(condition, Compare)
    kept = Compare(Recall(COUNT), condition.operator, condition.right)
    return [Remember(COUNT, condition.left)], kept


def turned(met: Meeting | None) -> Meeting | None:
    """The same if the condition is turned round."""
    return None if met is None else replace(met, holds=not met.holds)


def meet_there(d: Discourse, met: Meeting | None) -> None:
    """The scene where a condition holds that is about somebody or something."""
    if met is None:
        return
    thing = replace(met.thing, here=met.holds, pronoun=False)
    d.missing = None if met.holds else replace(met.thing, place=met.thing.place or d.at)
    d.lacking = None if met.holds or met.sought else d.missing
    if isinstance(thing.place, Items):  # wherever it was found
        d.at = d.with_person = None
        d.away = True
    elif thing.place is not None:  # it was looked for there
        d.went(thing.place)
        d.looked_in = thing.place
    if not met.holds:
        thing = replace(thing, place=None, furniture=None)
    if thing.person:
        d.person, d.thing_last = thing, False
        d.with_person = thing.value if met.holds else None
        if met.holds and not thing.known:
            d.visitor = thing
    else:
        d.thing, d.thing_last = thing, True


def leave_off(d: Discourse, after: dict[str, object]) -> None:
    """The scene behind both branches: where the robot is only if it is there either way, and who
    was spoken of in the first."""
    at, with_person = d.at, d.with_person
    d.set_scene(after)
    if d.at != at:
        d.at = None
    if d.with_person != with_person:
        d.with_person = None
        if d.person is not None and d.person.known:
            d.person = replace(d.person, here=False)


def looks_on(part: Leaf | Node) -> bool:
    """Whether a branch begins with looking somewhere else: "try the lab and bring it here"."""
    first = next((each for each in inside(part) if each.production.rule == "command"), None)
    return first is not None and first.means in LOOKING


@meaning(TELL)
def tell_condition(d: Discourse, node: Node) -> Steps:
    """ "if there are more than three people, tell Alice": that there are more than three people."""
    if "condition" not in node.parts:  # "..., if not, let me know"
        return told_so(d, node, d.claim.saying if d.claim is not None else None)
    before_it, condition = condition_of(d, node)
    met = turned(d.met) if node.production.fixed.get("unless") else d.met
    kept = addressed_before(d, met) if not before_it else None
    if kept is not None and met is not None:
        return absent(
            d,
            node,
            kept,
            met,
            lambda: coming_back(d, node, told_again(d, d.get(node, "person_ref"))),
        )
    person_said = node.parts.get("person_ref")
    asked_whether = person_said and person_said.end <= node.parts["condition"].start
    if asked_whether and is_me(d.get(node, "person_ref")) and is_so(d, node):
        return told_again(d, d.get(node, "person_ref"))
    if asked_whether and what_it_means(node.parts["condition"]) == "answers_same":
        return [*before_it, *told_either_way(d, node, condition)]
    delivery = delivered_last(d)
    if delivery is not None and met is not None and lacks(delivery, met):
        taken = taken_back(d, delivery, met)
        if taken is not None:  # "bring me a coffee; if there is none, let me know"
            return [*before_it, *failing(d, node, taken, met)]
    claim = claim_of(d, node, condition, met)
    if met is None and not before_it:
        as_before(d, condition)
    start = d.scene()
    meet_there(d, met)
    then = told_so(d, node, claim)
    after = d.scene()
    d.set_scene(start)
    part = other_branch(d, node, condition)
    otherwise: Steps = []
    if part is not None:
        otherwise = branch(d, part, turned(met), found_claim(d, condition, turned(met)))
    else:
        meet_there(d, turned(met))
    leave_off(d, after)
    counted, condition = counted_first(condition, [*then, *otherwise])
    whole = If(condition, tuple(then), tuple(otherwise))
    d.branched = Branched(whole, start, met, d.answer)
    return [*before_it, *counted, whole]


def is_so(d: Discourse, node: Node) -> bool:
    """Whether the speaker wants to know what somebody has answered: "let me know if he is", which
    is also told if he is not."""
    so = what_it_means(node.parts["condition"]) == "so"
    return so and d.answer is not None and "otherwise" not in node.parts


def told_so(d: Discourse, node: Node, claim: Step | None) -> Steps:
    """Tell whoever is to be told that something is so."""
    person: Thing | None = d.get(node, "person_ref")
    if "at_place" in node.parts:  # "tell the kitchen": whoever is there
        return [*go(d, d.get(node, "at_place")), *(known_words(d) if claim is None else [claim])]
    if is_me(person):
        outer = d.claim
        d.claim = None if claim is None else Claim(claim, d.known_by_now())
        told = coming_back(d, node, tell_speaker(d))
        d.claim = outer
        return told
    return speak_to(d, person, known_words(d) if claim is None else [claim])


def told_either_way(d: Discourse, node: Node, condition: Condition) -> Steps:
    """ "tell me if it is the same": also if it is not."""
    person: Thing = d.get(node, "person_ref")
    part = node.parts["condition"]
    clause = d.words(part.start, part.end)
    told = If(condition, (d.say("so_it_is", clause=clause),), (d.say("not_so", clause=clause),))
    return [*go_back(d, []), told] if is_me(person) else speak_to(d, person, [told])
