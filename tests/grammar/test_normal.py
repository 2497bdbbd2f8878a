"""All plans that say the same have one normal form, and it is written as they are."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from grammar import plan as p
from grammar.normal import normal
from grammar.program import write_program
from tests.grammar import random_plans, sensible_plans

MODEST = settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))

X, ANSWER = p.Recall("x"), p.Recall("answer")
SEEN = p.Holds(p.Ask("sees", {"thing": p.Text("cup")}))
ASKED = p.Call("ask", {"question": p.Text("Coffee?")}, "answer")
DOCK = p.Call("dock")
HELLO = p.Call("say", {"text": p.Text("Hello")})


def simple(*steps: p.Step) -> tuple[p.Step, ...]:
    return normal(p.Plan(steps)).steps


@MODEST
@given(st.one_of(random_plans.plans, sensible_plans.plans))
def test_a_normal_form_is_its_own_and_is_written_as_the_plan_is(plan: p.Plan) -> None:
    form = normal(plan)
    assert normal(form) == form
    assert write_program(form) == write_program(plan)


@pytest.mark.parametrize(
    ("value", "simpler"),
    [
        (p.Number(5.0), p.Number(5)),
        (
            p.Sentence((p.Text("a"), p.Sentence((p.Text("b"), X)), p.Text(""))),
            p.Sentence((p.Text("ab"), X)),
        ),
        (p.Sentence((p.Text("Room "), p.Number(12.0))), p.Text("Room 12")),
        (p.Sentence(()), p.Text("")),
        (
            p.Length(p.Ask("count", {"thing": p.Text("cup")})),
            p.Ask("count", {"thing": p.Text("cup")}),
        ),
        (p.Length(p.ListOf(X)), p.Length(X)),
        (p.ListOf(p.Sorted(X)), p.Sorted(X)),
        (p.Arithmetic(p.Number(0), "-", p.Number(2)), p.Number(-2)),
        (p.Arithmetic(p.Text("a"), "+", X), p.Sentence((p.Text("a"), X))),
        (p.NumberIn(p.Number(3)), p.Number(3)),
        (p.Join(p.Items((p.Text("a"),)), p.Text(", ")), p.Sentence((p.Items((p.Text("a"),)),))),
        (p.Both((SEEN,)), SEEN.value),
        (p.Not(p.Not(SEEN)), SEEN.value),
        (p.Both((SEEN, p.Both((SEEN, SEEN)))), p.Both((SEEN, SEEN, SEEN))),
        (p.Either(()), p.Truth(False)),
        (p.Not(p.Compare(X, "<", p.Number(3))), p.Compare(X, ">=", p.Number(3))),
        (p.Compare(p.Number(3), "<", X), p.Compare(X, ">", p.Number(3))),
        (p.Compare(X, "==", p.Text("YES")), p.Compare(p.Sentence((X,)), "==", p.Text("yes"))),
        (p.Compare(p.Length(X), "!=", p.Number(0)), p.Compare(p.Length(X), ">", p.Number(0))),
    ],
)
def test_values(value: p.Value, simpler: p.Value) -> None:
    assert simple(p.Collect("y", value)) == (p.Collect("y", simpler),)


@pytest.mark.parametrize(
    ("step", "simpler"),
    [
        (p.Remember("x", p.Ask("battery")), p.Call("battery", {}, "x")),
        (p.Remember("x", p.Arithmetic(X, "+", p.Number(1))), p.Increase("x")),
        (p.Increase("x", p.Number(1)), p.Increase("x")),
        (p.If(SEEN, (), (DOCK,)), p.If(p.Not(SEEN), (DOCK,))),
        (p.ForEach("i", p.Range(p.Number(3)), (DOCK,)), p.Repeat(p.Number(3), (DOCK,))),
        (p.While(p.Holds(p.Truth(True)), (HELLO,)), p.Forever((HELLO,))),
        (p.Forever((p.If(SEEN, (p.End(),)), HELLO)), p.While(p.Not(SEEN), (HELLO,))),
        (p.Forever((HELLO, p.If(SEEN, (p.End(),)))), p.RepeatUntil(SEEN, (HELLO,))),
        (p.While(SEEN, (p.Call("wait", {"seconds": p.Number(1)}),)), p.While(SEEN, ())),
        (p.Try((DOCK,), (HELLO,), "why"), p.Try((DOCK,), (HELLO,))),
        (
            p.Call("goto", {"theta": p.Number(90), "y": p.Number(2), "x": p.Number(1)}),
            p.Call("goto", {"x": p.Number(1), "y": p.Number(2), "theta": p.Number(90)}),
        ),
        (
            p.Call("do", {"skill": p.Text("sit"), "How long": p.Number(3)}),
            p.Call("do", {"skill": p.Text("sit"), "how_long": p.Number(3)}),
        ),
    ],
)
def test_steps(step: p.Step, simpler: p.Step) -> None:
    assert simple(step) == (simpler,)


def test_what_is_heard_is_made_a_number_and_a_number_a_text() -> None:
    _, wait, say = simple(
        ASKED,
        p.Call("wait", {"seconds": ANSWER}),
        p.Call("say", {"text": p.Ask("battery")}),
    )
    assert wait == p.Call("wait", {"seconds": p.NumberIn(ANSWER)})
    assert say == p.Call("say", {"text": p.Sentence((p.Ask("battery"),))})


def test_names_become_identifiers_each_its_own() -> None:
    first, second = simple(p.Remember("Größe!", p.Number(1)), p.Remember("grosse", p.Number(2)))
    assert (first, second) == (
        p.Remember("grosse", p.Number(1)),
        p.Remember("grosse_2", p.Number(2)),
    )


def test_a_counter_that_is_used_keeps_its_name() -> None:
    counted = p.ForEach("i", p.Range(p.Number(3)), (p.Call("turn", {"degrees": p.Recall("i")}),))
    assert simple(counted) == (counted,)
    after = (p.ForEach("i", p.Range(p.Number(3)), (DOCK,)), p.Remember("x", p.Recall("i")))
    assert simple(*after) == after


def test_what_was_said_besides_stands_on_one_line() -> None:
    plan = p.Plan((DOCK,), background=("I do not\nhear  well\u202e", " "))
    assert normal(plan).background == ("I do not hear well",)
    assert write_program(plan) == "# I do not hear well\nrobot.dock()\n"
