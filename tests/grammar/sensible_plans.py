"""Random plans that make sense: whatever they speak of is there and of the right kind, so that they
pass the check and run to their end on a robot that does nothing."""

from __future__ import annotations

import functools

from hypothesis import strategies as st

from grammar import plan as p

ANSWER, COUNT, AVERAGE = p.Recall("answer"), p.Recall("count"), p.Recall("average")
NAMES, COUNTS, VOTES, BEGIN = map(p.Recall, ("names", "counts", "votes", "begin"))
HERE, FOUND = p.Recall("here"), p.Recall("found")

KNOWN: tuple[p.Step, ...] = (
    p.Call("ask", {"question": p.Text("How many?")}, "answer"),
    p.Remember("count", p.Number(3)),
    p.Remember("average", p.Number(2.5)),
    p.Remember("names", p.Items((p.Text("Alice"), p.Text("Bob"), p.Text("Alice")))),
    p.Remember("counts", p.Items((p.Number(4), p.Number(7)))),
    p.Remember("votes", p.Record(((p.Text("Alice"), p.Number(1)), (p.Text("Bob"), p.Number(0))))),
    p.Remember("begin", p.Ask("clock", field="time")),
    p.Call("location", {}, "here"),
    p.Call("sees", {"thing": p.Text("cup")}, "found"),
)
"""What is known before anything else is done."""

WORDS = ("yes", "Alice", "the pharmacy", "five or six", 'the "blue" room', "Größe", "14:05")
words = st.sampled_from(WORDS).map(p.Text)
some = st.integers(0, 40).map(p.Number)


@functools.cache
def texts(depth: int) -> st.SearchStrategy[p.Value]:
    simple = st.one_of(words, st.just(ANSWER), st.just(p.PLACE), st.just(BEGIN))
    if depth <= 0:
        return simple
    inner = values(depth - 1)
    return st.one_of(
        simple,
        st.lists(inner, min_size=1, max_size=3).map(lambda parts: p.Sentence(tuple(parts))),
        st.builds(p.Item, st.just(NAMES), st.sampled_from([0, -1, 1]).map(p.Number)),
        st.builds(p.Join, lists(depth - 1), words),
        st.just(p.Choice(NAMES)),
        st.builds(p.KeyOf, st.sampled_from(["min", "max"]), st.just(VOTES)),
        st.just(p.Weekday(("Mo", "Di", "Mi", "Do", "Fr", "Sa", "So"))),
        st.builds(p.Field, st.just(HERE), st.just("place")),
    )


@functools.cache
def numbers(depth: int) -> st.SearchStrategy[p.Value]:
    simple = st.one_of(some, st.just(COUNT), st.just(AVERAGE), st.just(p.Ask("battery")))
    if depth <= 0:
        return simple
    inner, of_numbers = numbers(depth - 1), number_lists(depth - 1)
    divided = st.builds(
        p.Arithmetic, inner, st.sampled_from(["/", "//", "%"]), st.integers(1, 9).map(p.Number)
    )
    return st.one_of(
        simple,
        st.builds(p.Arithmetic, inner, st.sampled_from(["+", "-", "*"]), inner),
        divided,
        texts(depth - 1).map(p.NumberIn),
        st.builds(p.Round, inner, st.integers(0, 2).map(p.Number)),
        inner.map(p.Absolute),
        st.builds(p.Aggregate, st.sampled_from(["min", "max", "sum"]), of_numbers),
        st.builds(
            p.Figure, st.sampled_from(["sum", "average", "highest", "lowest"]), st.just(NAMES)
        ),
        lists(depth - 1).map(p.Length),
        st.just(p.Length(VOTES)),
        st.builds(p.Occurrences, st.just(NAMES), words),
        st.builds(p.Item, st.just(VOTES), words, some),
        st.builds(p.Share, inner, inner),
        st.just(p.Elapsed(BEGIN)),
        st.just(p.Field(HERE, "x")),
    )


@functools.cache
def number_lists(depth: int) -> st.SearchStrategy[p.Value]:
    simple = st.one_of(st.just(COUNTS), st.just(p.Values(VOTES)))
    if depth <= 0:
        return simple
    inner = number_lists(depth - 1)
    return st.one_of(
        simple,
        st.lists(numbers(depth - 1), min_size=1, max_size=3).map(lambda some: p.Items(tuple(some))),
        st.builds(p.Range, some, st.sampled_from([0, 2]).map(p.Number)).map(p.ListOf),
        st.builds(p.Sorted, inner, st.booleans()),
        inner.map(p.Distinct),
        st.builds(p.Arithmetic, st.just(COUNTS), st.just("+"), st.just(p.Values(VOTES))),
    )


@functools.cache
def lists(depth: int) -> st.SearchStrategy[p.Value]:
    simple = st.one_of(st.just(NAMES), st.just(p.ListOf(VOTES)), st.just(p.Ask("people")))
    if depth <= 0:
        return simple
    inner = lists(depth - 1)
    return st.one_of(
        simple,
        st.builds(p.Sorted, inner, st.booleans()),
        inner.map(p.Distinct),
        number_lists(depth - 1),
    )


@functools.cache
def values(depth: int) -> st.SearchStrategy[p.Value]:
    return st.one_of(texts(depth), numbers(depth), lists(depth), conditions(depth), st.just(HERE))


@functools.cache
def conditions(depth: int) -> st.SearchStrategy[p.Condition]:
    equal, ordered = st.sampled_from(["==", "!="]), st.sampled_from(["<", "<=", ">", ">="])
    simple = st.one_of(
        st.just(p.Holds(FOUND)),
        st.just(p.Holds(p.Ask("sees", {"thing": p.Text("person")}))),
        st.sampled_from([NAMES, VOTES, ANSWER, COUNT]).map(p.Holds),
    )
    if depth <= 0:
        return simple
    inner, several = conditions(depth - 1), st.lists(conditions(depth - 1), min_size=1, max_size=3)
    return st.one_of(
        simple,
        st.builds(p.Compare, texts(depth - 1), st.one_of(equal, ordered), texts(depth - 1)),
        st.builds(p.Compare, numbers(depth - 1), st.one_of(equal, ordered), numbers(depth - 1)),
        st.builds(p.Compare, st.just(ANSWER), st.one_of(equal, ordered), numbers(depth - 1)),
        st.builds(p.Compare, st.just(HERE), equal, words),
        st.builds(p.Compare, texts(depth - 1), st.just("in"), texts(depth - 1)),
        st.builds(p.Compare, texts(depth - 1), st.just("in"), st.sampled_from([NAMES, VOTES])),
        st.builds(p.Compare, numbers(depth - 1), st.just("in"), number_lists(0)),
        inner.map(p.Not),
        several.map(lambda some: p.Both(tuple(some))),
        several.map(lambda some: p.Either(tuple(some))),
    )


def said(value: p.Value) -> p.Call:
    return p.Call("say", {"text": p.Sentence((p.Text("This: "), value))})


@functools.cache
def steps(depth: int, in_loop: bool) -> st.SearchStrategy[p.Step]:
    leaving = [st.sampled_from([p.End(), p.Continue()])] if in_loop else []
    simple = st.one_of(
        values(2).map(said),
        st.builds(p.Remember, st.just("count"), numbers(1).map(p.Round)),
        st.builds(p.Remember, st.just("found"), conditions(1)),
        st.builds(p.Collect, st.just("names"), texts(1)),
        st.builds(p.Increase, st.just("count"), st.one_of(st.none(), some, st.just(ANSWER))),
        st.builds(p.Increase, st.just("counts"), number_lists(0)),
        st.builds(p.Increase, st.just("votes"), st.one_of(st.none(), some), texts(1)),
        st.builds(p.SetItem, st.just("votes"), words, some),
        st.builds(p.SetItem, st.just("counts"), st.just(p.Number(-1)), some),
        *leaving,
    )
    if depth <= 0:
        return simple
    same, inside = blocks(depth - 1, in_loop), blocks(depth - 1, True)
    left = inside.map(lambda some: (*some, p.End()))
    few = st.integers(0, 2).map(p.Number)
    return st.one_of(
        simple,
        st.builds(p.If, conditions(2), same, same),
        st.builds(p.Repeat, few, inside),
        # A list of its own, which the loop may add to without going on for ever.
        st.builds(p.ForEach, st.just("each"), lists(1).map(p.ListOf), inside),
        st.builds(p.ForEach, st.just("number"), st.builds(p.Range, few), inside.map(_counting)),
        st.builds(p.ForEach, st.just("name"), st.just(p.Sorted(VOTES)), inside),
        st.builds(
            p.ForEach,
            st.just("name"),
            st.just(VOTES),
            st.just((said(p.Recall("name")), said(p.Recall("value")))),
            st.just("value"),
        ),
        st.builds(p.While, conditions(1), left),
        left.map(p.Forever),
        st.builds(p.RepeatUntil, conditions(1), st.just((p.End(),))),
        st.builds(
            p.Try,
            same,
            same.map(lambda some: (said(p.Recall("problem")), *some)),
            st.just("problem"),
        ),
    )


def _counting(steps: tuple[p.Step, ...]) -> tuple[p.Step, ...]:
    return (said(p.Recall("number")), *steps)


@functools.cache
def blocks(depth: int, in_loop: bool) -> st.SearchStrategy[tuple[p.Step, ...]]:
    return st.lists(steps(depth, in_loop), max_size=3).map(tuple)


plans = st.builds(
    p.Plan,
    blocks(2, False).map(lambda steps: (*KNOWN, *steps)),
    st.sampled_from(["en", "de", "fr"]),
    st.lists(st.sampled_from(["I do not hear well", "It is # 1!"]), max_size=1).map(tuple),
)
