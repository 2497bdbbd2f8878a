"""Things are taken, carried, put down and handed over; one hand, and no magic."""

from __future__ import annotations

import math

import pytest

from sim.errors import NotFound, NotPossible


@pytest.fixture
def ward_b(small_ward, living):
    ward = living(small_ward)
    ward.goes_to("ward b")
    return ward


def test_the_book_is_carried_from_ward_b_to_the_table_of_ward_a(ward_b) -> None:
    simulation = ward_b.simulation
    assert ward_b.does(simulation.grab("book")) == "book"
    assert simulation.robot.holding == ["book"]
    assert simulation.visible("book") == []
    ward_b.goes_to("ward a")
    ward_b.does(simulation.put("book", "table"))
    assert simulation.robot.holding == []
    (book,) = simulation.visible("book")
    assert simulation.world.place_at(book.x, book.y).name == "ward a"
    assert simulation.describe("book").endswith("on the table.")
    told = [(h.kind, h.data) for h in simulation.record.happenings]
    assert ("grab", {"thing": "book"}) in told
    assert ("put", {"thing": "book", "where": "table"}) in told


def test_put_without_where_puts_it_down_before_the_robot(ward_b) -> None:
    ward_b.does(ward_b.simulation.grab("book"))
    ward_b.goes_to("corridor")
    ward_b.does(ward_b.simulation.put("book"))
    robot = ward_b.simulation.robot
    (book,) = ward_b.simulation.visible("book")
    assert math.dist((robot.x, robot.y), (book.x, book.y)) < 0.6
    assert ward_b.does(ward_b.simulation.grab("book")) == "book"


def test_it_has_one_hand(ward_b) -> None:
    ward_b.does(ward_b.simulation.grab("book"))
    with pytest.raises(NotPossible, match="already holds the book"):
        ward_b.does(ward_b.simulation.grab("cup"))
    assert ward_b.simulation.robot.holding == ["book"]


def test_only_what_is_here_is_taken(ward_b) -> None:
    with pytest.raises(NotFound, match="red cup"):
        ward_b.does(ward_b.simulation.grab("red cup"))
    assert ward_b.does(ward_b.simulation.grab("cup")) == "cup"
    ward_b.does(ward_b.simulation.put("blue cup", "table"))


def test_what_it_does_not_hold_it_cannot_put_or_give(ward_b) -> None:
    with pytest.raises(NotPossible, match="hand is empty"):
        ward_b.does(ward_b.simulation.put("cup"))
    ward_b.does(ward_b.simulation.grab("book"))
    with pytest.raises(NotPossible, match="It holds the book"):
        ward_b.does(ward_b.simulation.give("cup"))


def test_there_must_be_such_furniture_here(ward_b) -> None:
    ward_b.does(ward_b.simulation.grab("book"))
    with pytest.raises(NotFound, match="sideboard"):
        ward_b.does(ward_b.simulation.put("book", "sideboard"))
    assert ward_b.simulation.robot.holding == ["book"]


def test_a_thing_is_handed_to_henry_in_his_bed(ward_b) -> None:
    ward_b.does(ward_b.simulation.grab("cup"))
    assert ward_b.does(ward_b.simulation.give("cup", "Henry")) == "Henry"
    assert ward_b.simulation.robot.holding == []
    assert "holding a cup" in ward_b.simulation.describe("Henry")
    # What somebody holds is theirs.
    with pytest.raises(NotFound):
        ward_b.does(ward_b.simulation.grab("cup"))


def test_nobody_here_nobody_to_give_it_to(ward_b) -> None:
    ward_b.does(ward_b.simulation.grab("book"))
    ward_b.goes_to("corridor")
    with pytest.raises(NotFound):
        ward_b.does(ward_b.simulation.give("book"))
    assert ward_b.simulation.robot.holding == ["book"]


def test_a_wheelchair_is_too_heavy(hospital, living) -> None:
    ward = living(hospital)
    ward.goes_to("supply room")
    with pytest.raises(NotPossible, match="wheelchair is too heavy"):
        ward.does(ward.simulation.grab("wheelchair"))
    assert ward.does(ward.simulation.grab("red stapler")) == "stapler"
