"""Random plans for property tests: any steps, any texts, valid by the method table."""

from __future__ import annotations

import functools
from typing import Any

from hypothesis import reject
from hypothesis import strategies as st

from grammar import plan as p
from grammar.program import write_program
from grammar.writing import PlanError
from robot_api.methods import METHODS

WORDS = ("person", "red cup", "Alice's office", 'the "blue" room', "Größe", "pharmacy", "yes")
NAMES = ("answer", "place", "class", "robot", "len", "Größe", "2 cups", "x")

short_texts = st.one_of(st.sampled_from(WORDS), st.text(min_size=1, max_size=20)).map(p.Text)
speeches = st.lists(st.sampled_from(WORDS), min_size=8, max_size=60).map(" ".join).map(p.Text)
texts = st.one_of(short_texts, speeches)
numbers = st.one_of(
    st.integers(0, 100), st.floats(0, 100, allow_nan=False).map(lambda x: round(x, 2))
).map(p.Number)
names = st.sampled_from(NAMES)


@functools.cache
def of_kind(
    annotation: str, depth: int, text: st.SearchStrategy[p.Text]
) -> st.SearchStrategy[p.Value]:
    if annotation in ("int", "float"):
        return numbers
    if annotation == "list[str]":
        return st.lists(text, min_size=1, max_size=4).map(lambda items: p.Items(tuple(items)))
    return st.one_of(text, values(depth - 1)) if depth > 0 else text


@functools.cache
@st.composite
def arguments(
    draw: st.DrawFn, method: str, depth: int, text: st.SearchStrategy[p.Text] = short_texts
) -> dict[str, p.Value]:
    form = draw(st.sampled_from(METHODS[method].forms))
    chosen: dict[str, Any] = {}
    for parameter in form:
        if parameter.required or draw(st.booleans()):
            annotation = parameter.kind.annotation.removesuffix(" | None")
            chosen[parameter.name] = draw(of_kind(annotation, depth, text))
    return chosen


@functools.cache
@st.composite
def asks(draw: st.DrawFn, depth: int) -> p.Ask:
    giving = [name for name, method in METHODS.items() if method.returns.annotation != "None"]
    method = draw(st.sampled_from(giving))
    field = None
    if method == "clock":
        field = draw(st.sampled_from([None, "time", "weekday"]))
    if method == "location":
        field = draw(st.sampled_from([None, "place", "x"]))
    return p.Ask(method, draw(arguments(method, depth - 1)), field)


@functools.cache
def values(depth: int = 2) -> st.SearchStrategy[p.Value]:
    simple = st.one_of(short_texts, numbers, names.map(p.Recall), st.booleans().map(p.Truth))
    if depth <= 0:
        return simple
    inner = values(depth - 1)
    lists = st.lists(inner, max_size=4).map(lambda items: p.Items(tuple(items)))
    entries = st.lists(st.tuples(simple, inner), max_size=3).map(lambda some: p.Record(tuple(some)))
    several = st.one_of(names.map(p.Recall), lists, entries)
    return st.one_of(
        simple,
        asks(depth),
        lists,
        entries,
        st.lists(inner, min_size=1, max_size=4).map(lambda parts: p.Sentence(tuple(parts))),
        st.builds(p.Share, inner, inner),
        inner.map(p.Elapsed),
        st.builds(p.HasCome, inner, inner),
        st.lists(st.text(min_size=1), min_size=7, max_size=7).map(
            lambda names: p.Weekday(tuple(names))
        ),
        st.one_of(lists, ranges(inner)).map(p.Choice),
        of_several(several, inner),
        of_numbers(inner, st.one_of(lists, ranges(inner))),
        st.builds(p.Field, names.map(p.Recall), st.sampled_from(["x", "place", "time"])),
        conditions(depth - 1),
    )


def ranges(of: st.SearchStrategy[p.Value]) -> st.SearchStrategy[p.Range]:
    return st.builds(p.Range, of, st.one_of(st.just(p.Number(0)), of))


def of_several(
    several: st.SearchStrategy[p.Value], inner: st.SearchStrategy[p.Value]
) -> st.SearchStrategy[p.Value]:
    """Values made of lists and records."""
    return st.one_of(
        several.map(p.Length),
        st.builds(p.Item, several, inner, st.one_of(st.none(), inner)),
        st.one_of(several, ranges(inner)).map(p.ListOf),
        several.map(p.Values),
        st.builds(p.KeyOf, st.sampled_from(["min", "max"]), several),
        st.builds(p.Occurrences, several, inner),
        st.builds(p.Sorted, several, st.booleans()),
        several.map(p.Distinct),
        st.builds(p.Join, several, st.one_of(short_texts, st.just(p.Text(", ")))),
        st.builds(p.Figure, st.sampled_from(["sum", "average", "highest", "lowest"]), several),
    )


def of_numbers(
    inner: st.SearchStrategy[p.Value], lists: st.SearchStrategy[p.Value]
) -> st.SearchStrategy[p.Value]:
    """Values that are calculated."""
    return st.one_of(
        st.builds(p.Aggregate, st.sampled_from(["min", "max", "sum"]), lists),
        st.builds(p.Arithmetic, inner, st.sampled_from(["+", "-", "*", "/", "//", "%"]), inner),
        st.builds(p.Round, inner, st.integers(0, 2).map(p.Number)),
        inner.map(p.Absolute),
        inner.map(p.NumberIn),
    )


@functools.cache
def conditions(depth: int = 2) -> st.SearchStrategy[p.Condition]:
    operators = st.sampled_from(["==", "!=", "<", "<=", ">", ">=", "in"])
    inside = values(1) if depth > 0 else values(0)
    simple = st.one_of(
        st.builds(p.Holds, st.one_of(asks(1), inside)),
        st.builds(p.Compare, inside, operators, inside),
    )
    if depth <= 0:
        return simple
    inner = conditions(depth - 1)
    several = st.lists(inner, min_size=1, max_size=3).map(tuple)
    return st.one_of(simple, inner.map(p.Not), several.map(p.Both), several.map(p.Either))


@functools.cache
@st.composite
def calls(draw: st.DrawFn) -> p.Call:
    method = draw(st.sampled_from(sorted(METHODS)))
    returns = METHODS[method].returns.annotation != "None"
    save_as = draw(st.one_of(st.none(), names)) if returns else None
    return p.Call(method, draw(arguments(method, 2, texts)), save_as)


@functools.cache
def steps(depth: int = 2, in_loop: bool = False) -> st.SearchStrategy[p.Step]:
    simple: list[st.SearchStrategy[p.Step]] = [
        calls(),
        st.builds(p.Remember, names, values()),
        st.builds(p.Collect, names, values(1)),
        st.builds(
            p.Increase, names, st.one_of(st.none(), values(1)), st.one_of(st.none(), values(1))
        ),
        st.builds(p.SetItem, names, values(1), values(1)),
    ]
    if in_loop:
        simple += [st.just(p.End()), st.just(p.Continue())]
    if depth <= 0:
        return st.one_of(*simple)
    same = blocks(depth - 1, in_loop)
    inside = blocks(depth - 1, True)
    return st.one_of(
        *simple,
        st.builds(p.If, conditions(1), same, same),
        st.builds(p.Repeat, st.one_of(numbers, names.map(p.Recall)), inside),
        st.builds(p.ForEach, names, values(1), inside, st.one_of(st.none(), names)),
        st.builds(p.While, conditions(1), inside),
        st.builds(p.RepeatUntil, conditions(1), inside),
        st.builds(p.Forever, inside),
        st.builds(p.Try, same, same, st.one_of(st.none(), names)),
    )


@functools.cache
def blocks(depth: int, in_loop: bool) -> st.SearchStrategy[tuple[p.Step, ...]]:
    return st.lists(steps(depth, in_loop), max_size=3).map(tuple)


@st.composite
def plans_that_can_be_written(draw: st.DrawFn) -> p.Plan:
    """No plan that asks a time of day for its x, which no program does."""
    plan = p.Plan(tuple(draw(st.lists(steps(), max_size=6))))
    try:
        write_program(plan)
    except PlanError:
        reject()
    return plan


plans = plans_that_can_be_written()
