"""Conditions side by side: "if they say tea, ...; if they say coffee, ..., otherwise ..."."""

from __future__ import annotations

import operator
from dataclasses import replace
from typing import Final

from grammar.chart import Leaf, Node, what_it_means
from grammar.discourse import Discourse, Steps
from grammar.meanings.arrivals import may_be_another
from grammar.meanings.conditions import ABOUT_ANSWERS, negated
from grammar.meanings.deliveries import inside
from grammar.meanings.searches import only_told_missing
from grammar.plan import Ask, Both, Call, Compare, Condition, Holds, If, Not, Number, Recall, Text
from grammar.tidy import nodes

_HOLDS: Final = {
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
}
BRANCHES: Final = ("otherwise", "otherwise_not", "otherwise_denied", "then")
"""The parts of a condition that are steps, the last one first."""
CONDITIONAL: Final = frozenset({"if", "tell_condition"})
FETCHING: Final = frozenset({"fetch_person", "find", "grab", "fetch_from"})
"""Clauses that only get somebody or something."""
FOUND: Final = frozenset({"when_found"})
"""Clauses that are conditions on a search before."""


def side_by_side(d: Discourse, clause: Node) -> tuple[Node, Node | None]:
    """A condition without those that stand beside it, and these: "if it is empty, come back, if
    there are many, call Bob". One that is about an answer which the first asks for stands in it,
    and so does what is joined by "and": "if Bob is there and if he ..."."""
    clause = itself(clause)
    last = next((name for name in BRANCHES if name in clause.parts), "")
    body = clause.parts.get(last)
    conditional = is_conditional(d, clause) or clause.production.means in FOUND
    if not conditional or not isinstance(body, Node):
        return clause, None
    about = _about(clause)
    chain = [body]
    while isinstance(rest := chain[-1].parts.get("rest"), Node):
        before, first = chain[-1].parts["first"], rest.parts["first"]
        if isinstance(first, Node) and _stands_beside(d, before, first, about):
            return _cut(clause, last, chain, rest)
        chain.append(rest)
    return clause, None


def for_all(d: Discourse, chain: Node) -> Node:
    """A condition on an answer that stands last is one on all that the sentence says: "fetch it and
    bring it to him if he says yes"."""
    if d.answers.last is None:
        return chain
    before: list[Node] = []
    each = chain
    while isinstance(rest := each.parts.get("rest"), Node):
        first = each.parts["first"]
        if each.production.fixed.get("joint", "and") == "stop" or _asks(first):
            return chain
        before.append(each)
        each = rest
        last = itself(_node(each.parts["first"]))
        then = last.parts.get("then")
        if last.production.means != "if" or not isinstance(then, Node):
            continue
        if then.start > last.parts["condition"].start or not _about(last):
            return chain
        for step in reversed(before):
            then = replace(step, parts={**step.parts, "rest": then}, end=then.end)
        whole = replace(last, parts={**last.parts, "then": then}, start=then.start)
        return replace(each, parts={**each.parts, "first": whole}, start=then.start)
    return chain


def done_first(chain: Node) -> Node:
    """What is to be done before the last of several clauses is done before all of them: "go to the
    lobby and wait there once you have greeted Bob"."""
    before: list[Node] = []
    each: Leaf | Node | None = chain
    while isinstance(each, Node):
        last = itself(_node(each.parts["first"]))
        if fetched_late(before, last):
            rest = replace(each, parts={**each.parts, "first": _node(last.parts["then"])})
            for step in reversed(before):
                rest = replace(step, parts={**step.parts, "rest": rest})
            late = replace(last, parts={**last.parts, "then": rest}, start=chain.start)
            return replace(chain, parts={"first": late}, end=late.end)
        if last.production.means == "once_done" and "later" in last.parts and before:
            prior = {name: part for name, part in last.parts.items() if name != "later"}
            rest = replace(each, parts={**each.parts, "first": last.parts["later"]})
            for step in reversed(before):
                rest = replace(step, parts={**step.parts, "rest": rest})
            return replace(chain, parts={"first": replace(last, parts=prior), "rest": rest})
        before.append(each)
        each = each.parts.get("rest") if each.production.fixed.get("joint") == "and" else None
    return chain


def fetched_late(before: list[Node], last: Node) -> bool:
    """Whether a time is said of somebody or something that is fetched first: "get Clara and take
    her to the hall at two" has nobody fetched now who then waits until two."""
    if last.production.means != "delayed" or not before or "rest" in last.parts:
        return False
    if last.parts["delay"].start < last.parts["then"].start:
        return False
    fetching = (itself(_node(step.parts["first"])).production.means for step in before)
    return all(means in FETCHING for means in fetching)


def _asks(part: Leaf | Node) -> bool:
    """Whether a clause asks something, or is a condition itself."""
    means = {each.production.means for each in inside(part)}
    return bool(means & {*CONDITIONAL, "ask", "ask_again", "ask_topic", "ask_more", "ask_in"})


def _node(part: Leaf | Node) -> Node:
    assert isinstance(part, Node)
    return part


def itself(clause: Node) -> Node:
    """What a clause stands for, if it is nothing but another one."""
    while clause.production.means is None and len(clause.parts) == 1:
        (inner,) = clause.parts.values()
        if not isinstance(inner, Node):
            break
        clause = inner
    return clause


def _about(clause: Node) -> bool:
    """Whether a condition is about an answer."""
    condition = clause.parts.get("condition")
    return condition is not None and what_it_means(condition) in ABOUT_ANSWERS


def is_conditional(d: Discourse, clause: Node) -> bool:
    """Whether a clause does something only if something is so: "if Bob comes", too, once somebody
    has come."""
    condition = clause.parts.get("condition")
    if condition is None:
        return False
    means = clause.production.means
    return means in CONDITIONAL or (means == "when" and may_be_another(d, condition))


def _stands_beside(d: Discourse, before: Leaf | Node, clause: Node, about: bool) -> bool:
    clause = itself(clause)
    if not is_conditional(d, clause):
        return False
    if not about and what_it_means(clause.parts["condition"]) == "so":
        return not _asks(before)  # "if she is not there, come back, if she is, ask her ..."
    if about or _about(clause):
        return about and _about(clause)
    joins = d.language.speech.get("clause", {}).get("and", ("and",))
    return not set(joins) & set(d.norms(before.end, clause.start))


def _cut(clause: Node, branch: str, chain: list[Node], tail: Node) -> tuple[Node, Node]:
    kept: Node | None = None
    for each in reversed(chain):
        parts = {name: part for name, part in each.parts.items() if name != "rest"}
        kept = replace(each, parts=parts if kept is None else {**parts, "rest": kept})
    assert kept is not None
    return replace(clause, parts={**clause.parts, branch: kept}), tail


def exclusive(done: Steps) -> Steps:
    """ "if they say tea, ...; if they say coffee, ..., otherwise ...": only one of them can be."""
    result: Steps = []
    for each in done:
        step = _other_case_beside(each) if isinstance(each, If) else each
        last = result[-1] if result else None
        if isinstance(last, If) and isinstance(step, If) and _told_otherwise(last, step):
            result[-1] = If(last.condition, last.then, step.then)
        elif isinstance(last, If) and isinstance(step, If) and excludes(last, step):
            result[-1] = _or_else(last, step)
        elif isinstance(last, If) and isinstance(step, If) and _is_silence(last, step):
            result[-1] = If(step.condition, step.then, (last,))
        elif isinstance(last, If) and isinstance(step, If) and _takes_up(last, step):
            inner = last.then[-1]
            assert isinstance(inner, If)
            taken = If(inner.condition, step.then, inner.otherwise)
            result[-1] = If(last.condition, (*last.then[:-1], taken), last.otherwise)
        else:
            result.append(step)
    return result


def _other_case_beside(step: If) -> If:
    """A condition whose last step is for the other case, as its other branch: "if yes, tell Alice,
    if he has not finished, come back"."""
    inner = step.then[-1] if len(step.then) > 1 else None
    first = If(step.condition, step.then[:-1], step.otherwise)
    if step.otherwise or not isinstance(inner, If) or not excludes(first, inner):
        return step
    return _or_else(first, inner)


def _takes_up(first: If, second: If) -> bool:
    """ "If she is not in her office, try the lobby. If she is not there either, come back": that is
    done instead of saying that she was not found."""
    inner = first.then[-1] if first.then else None
    return (
        isinstance(inner, If)
        and isinstance(inner.condition, Not)
        and inner.condition == second.condition
        and all(isinstance(each, Call) and each.method == "say" for each in inner.then)
        and not second.otherwise
    )


def _is_silence(first: If, second: If) -> bool:
    """Whether nothing was said at all, which is neither the answer asked for first nor another."""
    one, silent = first.condition, second.condition
    return (
        isinstance(one, Compare)
        and isinstance(silent, Compare)
        and one.left == silent.left
        and silent.right == Text("")
        and not second.otherwise
    )


def _or_else(first: If, second: If) -> If:
    if first.otherwise:
        inner = first.otherwise[0]
        assert isinstance(inner, If)
        return If(first.condition, first.then, (_or_else(inner, second),))
    if second.condition == negated(first.condition) and not second.otherwise:
        return If(first.condition, first.then, second.then)
    return If(first.condition, first.then, (second,))


def _told_otherwise(first: If, second: If) -> bool:
    """ "when you find it, bring it. If not, ...": that is done instead of saying that it was not
    found."""
    opposite = second.condition == negated(first.condition) and not second.otherwise
    return opposite and only_told_missing(first)


def excludes(first: If, second: If) -> bool:
    """Whether an answer that one asks for cannot be the one that the other asks for, and the first
    leaves room for the second."""
    one, other = first.condition, second.condition
    if not _cannot_be_both(one, other):
        return False
    names = {each.name for each in nodes(one) if isinstance(each, Recall)}
    if any(_gives_anew(each, name) for name in names for each in nodes(first.then)):
        return False
    if not first.otherwise:
        return True
    inner = first.otherwise[0]
    return len(first.otherwise) == 1 and isinstance(inner, If) and excludes(inner, second)


def _gives_anew(step: object, name: str) -> bool:
    return isinstance(step, Call) and step.save_as == name


def _cannot_be_both(one: Condition, other: Condition) -> bool:
    if isinstance(one, Both):
        return any(_cannot_be_both(each, other) for each in one.conditions)
    if isinstance(other, Both):
        return any(_cannot_be_both(one, each) for each in other.conditions)
    if one == negated(other) or other == negated(one):
        return True
    if isinstance(one, Compare) and isinstance(other, Compare):
        return one.left == other.left and _apart(one, other)
    if isinstance(one, Not) and isinstance(one.condition, Holds) and isinstance(other, Compare):
        return _are_some(one.condition, other)
    if isinstance(one, Compare) and isinstance(other, Not) and isinstance(other.condition, Holds):
        return _are_some(other.condition, one)
    return False


def _are_some(seen: Holds, counted: Compare) -> bool:
    """Whether there are some of what is seen: "nobody is there", "there are more than three"."""
    looked, counting = seen.value, counted.left
    if not (isinstance(looked, Ask) and isinstance(counting, Ask) and counting.method == "count"):
        return False
    same = looked.arguments.get("thing") == counting.arguments.get("thing")
    some = isinstance(counted.right, Number) and counted.right.value >= 1
    return same and some and counted.operator in (">", ">=", "==")


def _apart(one: Compare, other: Compare) -> bool:
    """Whether no value is both: below 20 and above 80, before noon and after six."""
    values = (one.right, other.right)
    texts = all(isinstance(each, Text) for each in values)
    numbers = all(isinstance(each, Number) for each in values)
    if not (texts or numbers) or not {one.operator, other.operator} <= _HOLDS.keys():
        return False
    left, right = (each.value for each in values)  # type: ignore[union-attr]
    ranks = (0, 0) if left == right else (0, 2) if left < right else (2, 0)  # type: ignore[operator]
    return not any(
        _HOLDS[one.operator](value, ranks[0]) and _HOLDS[other.operator](value, ranks[1])
        for value in (-1, 0, 1, 2, 3)
    )
