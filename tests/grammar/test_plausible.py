"""A plan that makes no sense as a whole is not run, however well each word was read."""

from __future__ import annotations

import pytest

from grammar.plan import Ask, Call, ForEach, Holds, If, Items, Plan, Recall, Step, Text
from grammar.plausible import Doubt, implausible
from grammar.understand import understand
from tests.grammar.ward import WARD

CUP = {"thing": Text("cup")}
OFFICES = Ask("places", {"kind": Text("office")})


def plan(*steps: Step) -> Plan:
    return Plan(steps)


def test_what_may_be_in_the_hand_already_may_be_put_down_once() -> None:
    assert implausible(plan(Call("put", CUP))) is None
    assert implausible(plan(Call("put", CUP), Call("put", CUP))) is Doubt.EMPTY_HANDED


def test_what_was_taken_may_be_let_go() -> None:
    assert implausible(plan(*2 * (Call("grab", CUP), Call("give", CUP)))) is None


def test_nobody_holds_an_answer() -> None:
    asked = Call("ask", {"question": Text("Where to?")}, save_as="answer")
    assert implausible(plan(asked, Call("put", {"thing": Recall("answer")}))) is Doubt.EMPTY_HANDED


def test_in_a_round_each_thing_must_be_taken_anew() -> None:
    things = Items((Text("small box"), Text("big box")))
    put = Call("put", {"thing": Recall("thing")})
    grab = Call("grab", {"thing": Recall("thing")})
    assert implausible(plan(ForEach("thing", things, (put,)))) is Doubt.EMPTY_HANDED
    assert implausible(plan(ForEach("thing", things, (grab, put)))) is None


def test_what_only_one_branch_took_is_perhaps_there() -> None:
    branch = If(Holds(Ask("find", CUP)), (Call("grab", CUP),))
    assert implausible(plan(branch, Call("give", CUP))) is None


def look(place: str) -> tuple[Step, ...]:
    return Call("goto", {"place": Recall(place)}), Call("sees", CUP, save_as="seen")


def test_nobody_goes_round_twice_to_find_out_the_same() -> None:
    first = ForEach("place", OFFICES, look("place"))
    assert implausible(plan(first, ForEach("room", OFFICES, look("room")))) is Doubt.TWICE


def test_after_a_while_the_same_may_be_found_out_again() -> None:
    one = ForEach("place", OFFICES, look("place"))
    assert implausible(plan(one, Call("wait", {}), one)) is None


@pytest.mark.parametrize("name", ["room 3", "office number 4", "lab 2"])
def test_a_room_with_a_number_is_that_room_or_none(name: str) -> None:
    understood = understand(f"bring the cup to the patient in {name}", WARD)
    assert understood.plan is None
    assert understood.message is not None
    assert name in understood.message
