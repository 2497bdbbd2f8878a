"""Programs go on as programs do, or as the sentence went on."""

from __future__ import annotations

from nl2robot.language_model.habits import HABITS, MOST, NONE, guessed


def test_a_habit_is_guessed_as_far_as_it_goes() -> None:
    habits = {"1 2": 3, "2 3": 4, "4": NONE}
    assert guessed(habits, [9, 1, 2]) == [3, 4]


def test_the_longest_known_ending_decides() -> None:
    habits = {"2": 3, "1 2": NONE, "8 2": 5, "5": NONE}
    assert guessed(habits, [1, 2]) == []
    assert guessed(habits, [8, 2]) == [5]


def test_what_was_read_twice_goes_on_as_the_first_time() -> None:
    assert guessed({}, [1, 2, 3, 4, 5, 7, 1, 2])[:3] == [3, 4, 5]
    assert len(guessed({}, [1, 2, 3, 4, 5, 6, 7, 1, 2])) == MOST
    assert guessed({}, [1, 2, 3, 4]) == []
    assert guessed({}, []) == []


def test_those_of_the_corpus_are_there() -> None:
    assert len(HABITS) > 1000
    assert all(follows == NONE or follows >= 0 for follows in HABITS.values())
