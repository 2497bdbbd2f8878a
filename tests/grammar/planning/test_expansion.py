"""What goes without saying in the dialect is said in the plan."""

from __future__ import annotations

import pytest

from grammar.language import load_language
from grammar.planning.model.expansion import expanded, program_of
from grammar.program import write_program
from grammar.program_parser import NotAPlan
from tests.grammar.ward import WARD, program

EN, DE = load_language("en"), load_language("de")


def told(text: str, people: tuple[str, ...] = ("Bob", "Alice", "visitor", "person")) -> str:
    return program(expanded(text, people, WARD, EN))


def test_the_robot_stands_before_its_methods_and_nothing_else() -> None:
    assert program_of('names = people()\nsay(f"{len(names)}")', EN) == (
        "names = robot.people()\nrobot.say(f'{len(names)}')\n"
    )
    assert program_of("x = random_choice(people())", EN) == "x = random.choice(robot.people())\n"


@pytest.mark.parametrize(
    "text",
    [
        "say(",
        'say("a\x00b")',
        "(" * 300 + ")" * 300,
        "-" * 5000 + "1",
        "dock() dock()",
        "fly()",
    ],
)
def test_what_is_no_plan_is_told_to_be_none(text: str) -> None:
    with pytest.raises(NotAPlan):
        expanded(text, ["Bob"], WARD, EN)


def test_what_follows_a_search_for_somebody_is_done_if_they_are_found() -> None:
    assert told('find("Bob")\nsay("Lunch is ready.")') == (
        'start = location(); if find("Bob") { say("Lunch is ready.") }'
        ' else { goto(start); say("I could not find Bob.") }'
    )


def test_nothing_after_it_has_to_be_done() -> None:
    assert told('find("Bob")') == (
        'start = location(); if not find("Bob") { goto(start); say("I could not find Bob.") }'
    )


def test_two_searches_stand_in_each_other() -> None:
    found = told('find("Bob")\nfind("Alice")\nsay("Hi.")')
    assert found.startswith('start = location(); if find("Bob") { if find("Alice") { say("Hi.") }')
    assert found.count("start = location()") == 1


def test_whoever_is_missing_keeps_nothing_from_the_next() -> None:
    assert told('find("Bob")\nsay("Come.")\nfind("Alice")\nsay("Go.")') == (
        'start = location(); if find("Bob") { say("Come.") }'
        ' else { goto(start); say("I could not find Bob.") };'
        ' if find("Alice") { say("Go.") } else { goto(start); say("I could not find Alice.") }'
    )


@pytest.mark.parametrize(
    "first",
    [
        'answer = ask("When?", person="Bob")\nfind("Alice")\nsay(f"Bob says {answer}.")',
        'grab("cup")\nfind("Alice")\ngive("cup", "Alice")',
        'say("Come along.")\nfind("Alice")\nguide("Bob", "kitchen")',
    ],
)
def test_what_the_first_was_found_for_is_not_done_without_them(first: str) -> None:
    found = told(f'find("Bob")\n{first}')
    assert "if find" in found.partition("else")[0].partition("if find")[2]


def test_where_the_plan_keeps_the_start_itself_it_is_kept_once() -> None:
    found = told('start = location()\nfind("Bob")\ngoto(start)')
    assert found.count("location()") == 1
    late = told('find("Bob")\nstart = location()\ngoto(start)')
    assert late.startswith("start = location(); if find")


def test_a_start_that_is_no_place_is_left_alone() -> None:
    found = told('start = clock().time\nfind("Bob")\nsay(f"{start}")')
    assert "start_2 = location()" in found and "goto(start_2)" in found
    looped = told('for start in ["a", "b"]:\n    say(f"{start}")\nfind("Bob")\nsay("Hi.")')
    assert "goto(start_2)" in looped


def test_in_a_loop_who_is_missing_is_passed_over() -> None:
    assert told('for person in ["Alice", "Bob"]:\n    find(person)\n    say("Hi.")') == (
        'for person in ["Alice", "Bob"] { if find(person) { say("Hi.") } }'
    )


@pytest.mark.parametrize(
    "text",
    [
        'find("cup")\ngrab("cup")',
        'find("person")\nsay("Hi.")',
        'found = find("Bob")\nif found:\n    say("Hi.")',
        'if find("Bob"):\n    say("Hi.")',
    ],
)
def test_other_searches_are_as_they_were_written(text: str) -> None:
    assert "could not find" not in told(text)


def test_whoever_is_no_name_is_called_as_people_do() -> None:
    assert "I could not find the visitor." in told('find("visitor")\nsay("Hi.")')
    german = write_program(expanded('find("Bob")\nsay("Hallo.")', ["Bob"], WARD, DE))
    assert "Bob" in german.split("else:")[1] and "could" not in german


def test_days_are_compared_as_the_clock_calls_them_and_said_as_people_do() -> None:
    german = write_program(expanded('if weekday() == "Friday":\n    dock()', [], WARD, DE))
    assert "robot.clock().weekday" in german and "friday" in german.lower()
    other_way = write_program(expanded('if "Friday" == weekday():\n    dock()', [], WARD, DE))
    assert "Freitag" not in other_way
    text = 'day = weekday()\nsay(f"{day}")\nif day in ["Saturday", "Sunday"]:\n    dock()'
    named = write_program(expanded(text, [], WARD, DE))
    assert "samstag" in named.lower() and "saturday" not in named.split("if day")[1].lower()
