"""A few of the million inputs of `make soak`: all are read, or refused in sentences."""

from __future__ import annotations

import random
import subprocess
import sys
from pathlib import Path

import pytest

from tests.attacks.fuzz import Found, case_of, fuzzed, targets
from tests.attacks.inputs import Case, Target
from tests.attacks.mutations import bytes_like, data_like, text_like
from tests.attacks.outcome import what_is_no_sentence
from tests.attacks.served import Served
from tests.attacks.smaller import smaller
from tests.attacks.wire import fuzzed as fuzzed_on_the_wire

SEED = 7
INPUTS = 100


@pytest.mark.parametrize("name", list(targets()))
def test_whatever_is_handed_in_is_read_or_refused_in_sentences(name: str) -> None:
    found = fuzzed(targets()[name], SEED, range(INPUTS), seconds=20, shrinking=1)
    assert not found.failures
    assert found.tried == found.survived == INPUTS


def test_whatever_comes_over_the_wire_is_answered_and_stops_are_heard() -> None:
    for row in fuzzed_on_the_wire(SEED, 2000):
        assert not row.failures
        assert row.tried == row.survived > 0


def test_the_same_seed_gives_the_same_inputs() -> None:
    for name, target in targets().items():
        assert case_of(target, 1, 5) == case_of(target, 1, 5), name
        assert len({str(case_of(target, 1, number)) for number in range(9)}) > 5, name


def refuses(case: Case) -> None:
    if b"!" in case.data:  # type: ignore[operator]
        raise KeyError("!")


def test_what_does_harm_is_told_with_the_smallest_input_of_its_kind() -> None:
    wish = Target("wishes", lambda chance: Case(bytes(chance.choices(b"abc!", k=40))), refuses, 1)
    found: Found = fuzzed(wish, SEED, range(20))
    assert found.survived < found.tried == 20
    [failure] = found.failures.values()
    assert failure.case == "b'!'" and failure.times == 20 - found.survived
    assert "KeyError" in failure.why


def waits(case: Case) -> None:
    while len(case.data) > 3:
        pass


def test_what_takes_too_long_is_harm() -> None:
    slow = Target("slow", lambda chance: Case("a" * 6), waits, 1)
    found = fuzzed(slow, SEED, range(1), seconds=0.05)
    assert [each.case for each in found.failures.values()] == ["'aaaa'"]


def test_mutations_differ_from_what_they_are_made_of_and_not_from_themselves() -> None:
    tree = {"name": "ward", "places": [{"name": "a"}, {"name": "b"}]}
    for make in (
        lambda chance: bytes_like(chance, [b"name: ward"]),
        lambda chance: text_like(chance, ["name: ward"]),
        lambda chance: data_like(chance, tree),
    ):
        made = [make(random.Random(seed)) for seed in range(40)]
        assert repr(made) == repr([make(random.Random(seed)) for seed in range(40)])
        assert len(set(map(repr, made))) > 20
    assert tree == {"name": "ward", "places": [{"name": "a"}, {"name": "b"}]}


def test_what_is_cut_out_does_harm_without() -> None:
    least = smaller(Case("x" * 50 + "b" + "y" * 50), lambda case: "b" in str(case.data), 5)
    assert least.data == "b"


@pytest.mark.parametrize(
    ("said", "fits"),
    [
        ("There is no such place. Did you mean “ward a”?", True),
        ("Où faut-il aller ?", True),
        ('"lobby" is here twice. Keep one of them.', True),
        ("Merci.", True),
        ("", False),
        ("KeyError.", False),
        ("KeyError", False),
        ("no end to this", False),
        ("Failed with <object at 0x7f00aa11bb22>.", False),
        ('Traceback (most recent call last):\n  File "a.py", line 3.', False),
    ],
)
def test_a_sentence_is_told_from_what_is_none(said: str, fits: bool) -> None:
    assert (what_is_no_sentence(said) is None) == fits


def test_a_server_that_complains_is_found_out(tmp_path: Path) -> None:
    with subprocess.Popen([sys.executable, "-c", ""], text=True) as process:
        server = Served("", process, tmp_path, tmp_path / "errors")
        assert server.faults() is None
        (tmp_path / "faults.log").write_text("Traceback (most recent call last):\n", "utf-8")
        assert server.faults()
        server.forget_faults()
        assert server.faults() is None
