"""The small functions at the top of programs do what they are for, in the sandbox."""

from __future__ import annotations

import pytest

from grammar import plan as p
from grammar.language import languages, load_language
from grammar.program import write_program
from robot_api.stub import stub
from sandbox.check import check
from tests.sandbox.ward import Ward

STUB = stub()


def worked_out(value: p.Value, language: str = "en") -> str:
    """What a robot says of a value."""
    said = p.Call("say", {"text": p.Sentence((p.Text("= "), value))})
    program = write_program(p.Plan((said,), language))
    assert check(program, STUB) == []
    ward = Ward()
    assert ward.run(program).status == "done", program
    return ward.said[0].removeprefix("= ")


def numbers_in(answers: list[str], language: str) -> list[float]:
    """The numbers that a program finds in these answers."""
    found = p.Items(tuple(p.NumberIn(p.Text(answer)) for answer in answers))
    return [float(each) for each in worked_out(found, language).split(", ")]


@pytest.mark.parametrize("language", languages())
def test_every_number_up_to_99_that_the_language_knows_is_found(language: str) -> None:
    numbers = load_language(language).numbers
    known = {**numbers["words"], **numbers.get("compounds", {})}
    # YAML takes "null" for nothing at all.
    names = {name or "null": value for name, value in known.items() if value in range(100)}
    assert len(names) >= 28
    assert numbers_in(list(names), language) == list(names.values())


@pytest.mark.parametrize(
    ("language", "answers"),
    [
        (
            "en",
            {
                "five": 5,
                "I would say seven": 7,
                "Twenty-five, please.": 25,
                "5 or 6": 5,
                "about 2.5 metres": 2.5,
                "the 3rd": 3,
                "4%": 4,
                "one or two": 1,
                "nineteen ninety": 19,
                "zero": 0,
                "no idea": 0,
                "": 0,
            },
        ),
        (
            "de",
            {
                "fünf": 5,
                "ich nehme eine": 1,
                "siebenundzwanzig": 27,
                "einunddreißig Jahre": 31,
                "zwei oder drei": 2,
                "2,5 Meter": 2.5,
                "keine Ahnung": 0,
            },
        ),
        (
            "fr",
            {
                "cinq": 5,
                "une seule": 1,
                "vingt et un": 21,
                "soixante-dix-sept ans": 77,
                "quatre-vingts": 80,
                "quatre-vingt-dix-neuf": 99,
                "deux ou trois": 2,
                "2,5 mètres": 2.5,
                "je ne sais pas": 0,
            },
        ),
    ],
)
def test_the_first_number_of_an_answer_is_found(language: str, answers: dict[str, float]) -> None:
    assert numbers_in(list(answers), language) == list(answers.values())


def test_figures_are_made_of_numbers_in_words_and_digits() -> None:
    answers = p.Items(tuple(map(p.Text, ("five", "I do not know", "8", "twenty one", "zero"))))
    figures = {how: worked_out(p.Figure(how, answers)) for how in ("sum", "highest", "lowest")}
    assert figures == {"sum": "34", "highest": "21", "lowest": "0"}
    assert worked_out(p.Figure("average", answers)) == "8.5"
    assert worked_out(p.Figure("average", p.Items((p.Text("?"),)))) == "0"


def test_the_key_with_the_highest_value_is_the_first_of_several() -> None:
    votes = p.Record(
        (
            (p.Text("tea"), p.Number(2)),
            (p.Text("milk"), p.Number(1)),
            (p.Text("coffee"), p.Number(2)),
        )
    )
    assert worked_out(p.KeyOf("max", votes)) == "tea"
    assert worked_out(p.KeyOf("min", votes)) == "milk"
    assert worked_out(p.KeyOf("max", p.Record())) == ""


@pytest.mark.parametrize(
    ("value", "result"),
    [
        (p.Arithmetic(p.Number(7), "//", p.Number(2)), "3"),
        (p.Arithmetic(p.Number(7), "%", p.Number(2)), "1"),
        (
            p.Arithmetic(p.Arithmetic(p.Number(1), "+", p.Number(2)), "*", p.Number(3)),
            "9",
        ),
        (p.Arithmetic(p.Number(9), "-", p.Arithmetic(p.Number(3), "-", p.Number(1))), "7"),
        (p.Round(p.Number(2.54), p.Number(1)), "2.5"),
        (p.Absolute(p.Number(-3)), "3"),
        (p.Aggregate("max", p.Items((p.Number(1), p.Text("12")))), "12"),
        (p.Aggregate("sum", p.Items(())), "0"),
        (p.Sorted(p.Items((p.Text("b"), p.Text("a"))), descending=True), "b, a"),
        (p.Distinct(p.Items((p.Text("b"), p.Text("a"), p.Text("b")))), "b, a"),
        (p.Occurrences(p.Items((p.Text("yes"), p.Text("no"))), p.Text("yes")), "1"),
        (p.Item(p.Items((p.Text("b"), p.Text("a"))), p.Number(-1)), "a"),
        (p.Join(p.ListOf(p.Range(p.Number(4), p.Number(1))), p.Text(" and ")), "1 and 2 and 3"),
        (p.Item(p.Record(((p.Text("a"), p.Number(1)),)), p.Text("b"), p.Number(0)), "0"),
    ],
)
def test_what_is_worked_out(value: p.Value, result: str) -> None:
    assert worked_out(value) == result
