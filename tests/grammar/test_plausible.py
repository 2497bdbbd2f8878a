"""A plan that makes no sense as a whole is not run, however well each word was read."""

from __future__ import annotations

import pytest

from grammar.lexicon import Lexicon, Name
from grammar.plan import Ask, Call, ForEach, Holds, If, Items, Plan, Recall, Step, Text
from grammar.plausible import Doubt, implausible
from grammar.understand import understand
from tests.grammar.ward import WARD, program

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


def test_the_same_thing_is_not_taken_twice_in_a_row() -> None:
    assert implausible(plan(*2 * (Call("grab", CUP),))) is Doubt.FULL_HANDED
    branch = If(Holds(Ask("find", CUP)), (Call("grab", CUP),))
    assert implausible(plan(branch, Call("grab", CUP))) is None


def test_what_only_one_branch_took_is_perhaps_there() -> None:
    branch = If(Holds(Ask("find", CUP)), (Call("grab", CUP),))
    assert implausible(plan(branch, Call("give", CUP))) is None


def look(place: str) -> tuple[Step, ...]:
    return Call("goto", {"place": Recall(place)}), Call("sees", CUP, save_as="seen")


def test_nobody_goes_round_twice_to_find_out_the_same() -> None:
    first = ForEach("place", OFFICES, look("place"))
    assert implausible(plan(first, ForEach("room", OFFICES, look("room")))) is Doubt.TWICE


def test_looking_for_it_everywhere_finds_out_the_same_once_more() -> None:
    first = ForEach("place", OFFICES, look("place"))
    search = Ask("find", CUP | {"place": Recall("room")})
    again = ForEach("room", Ask("places"), (If(Holds(search), (Call("grab", CUP),)),))
    assert implausible(plan(first, again)) is Doubt.TWICE


def test_after_a_while_the_same_may_be_found_out_again() -> None:
    one = ForEach("place", OFFICES, look("place"))
    assert implausible(plan(one, Call("wait", {}), one)) is None


@pytest.mark.parametrize("say", ["visit each conference room", "go to all conference rooms"])
def test_rooms_that_only_a_number_tells_apart_are_a_kind(say: str) -> None:
    rooms = tuple(Name(f"Conference room {number}") for number in (1, 2))
    understood = understand(say, Lexicon(places=(*rooms, Name("lobby"))))
    assert understood.plan is not None, understood.message
    assert program(understood.plan).startswith(
        'for place in ["Conference room 1", "Conference room 2"] { goto(place)'
    )


def test_no_words_begin_in_the_middle_of_a_name() -> None:
    house = Lexicon(places=(Name("lobby"),), people=(Name("Professor Lee"),))
    understood = understand("tell Professor Lee which was more popular", house)
    assert understood.plan is None


@pytest.mark.parametrize("name", ["room 3", "office number 4", "lab 2"])
def test_a_room_with_a_number_is_that_room_or_none(name: str) -> None:
    understood = understand(f"bring the cup to the patient in {name}", WARD)
    assert understood.plan is None
    assert understood.message is not None
    assert name in understood.message
