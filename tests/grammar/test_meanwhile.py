"""What is done while the robot stays somewhere for some time, and what only afterwards; what is
done somewhere that is only on the way."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator

import pytest

from tests.grammar.test_kinds import program

STAYING = {
    "en": ("wait in the lobby for ten minutes", "stay ten minutes in the lobby"),
    "de": ("warte zehn Minuten in der Eingangshalle", "bleib zehn Minuten in der Eingangshalle"),
    "fr": ("attends dix minutes dans le hall", "reste dix minutes dans le hall"),
}
EACH = {
    "en": ("greet everybody who comes in", "wave at everyone who comes"),
    "de": ("begrüsse jeden, der hereinkommt", "winke jedem zu, der kommt"),
    "fr": ("salue tous ceux qui entrent", "dis bonjour à chaque personne qui arrive"),
}
MEANWHILE = {"en": (" and ", ". ", ", and "), "de": (" und ", ". "), "fr": (" et ", ". ")}
AFTERWARDS = {
    "en": (", then ", " and afterwards ", ". Then "),
    "de": (", danach ", " und danach ", ". Dann "),
    "fr": (", puis ", " et ensuite ", ". Ensuite "),
}


def orders(joints: dict[str, tuple[str, ...]]) -> Iterator[tuple[str, str]]:
    for language, stays in STAYING.items():
        for parts in itertools.product(stays, joints[language], EACH[language]):
            yield language, "".join(parts)


@pytest.mark.parametrize(("language", "words"), list(orders(MEANWHILE)))
def test_whoever_comes_while_it_stays_is_met_until_the_time_is_over(
    language: str, words: str
) -> None:
    text = program(language, words)
    assert "while minutes_since(begin) < 10:" in text, text
    assert "robot.wait(" not in text and "while True" not in text, text


@pytest.mark.parametrize(("language", "words"), list(orders(AFTERWARDS)))
def test_what_is_said_to_come_afterwards_does(language: str, words: str) -> None:
    text = program(language, words)
    assert text.index("robot.wait(600)") < text.index("while True:"), text


@pytest.mark.parametrize(
    ("language", "words"),
    [
        ("en", "stay in the lobby {}, wave at everybody who comes in, and say hello"),
        ("de", "bleib {} in der Eingangshalle, winke jedem zu, der hereinkommt, und sag hallo"),
        ("fr", "reste dans le hall {}, fais signe à tous ceux qui entrent et dis bonjour"),
    ],
)
@pytest.mark.parametrize("end", ["minutes", "noon"])
def test_all_that_is_done_with_each_is_done_in_each_round(
    language: str, words: str, end: str
) -> None:
    ends = {
        "minutes": {"en": "for ten minutes", "de": "zehn Minuten", "fr": "dix minutes"},
        "noon": {"en": "until noon", "de": "bis Mittag", "fr": "jusqu'à midi"},
    }
    text = program(language, words.format(ends[end][language]))
    waved, spoken = (re.search(rf"^( *)robot\.{it}\(", text, re.M) for it in ("gesture", "say"))
    assert waved and spoken and waved[1] == spoken[1] != "", text


@pytest.mark.parametrize(
    ("language", "words"),
    [
        ("en", "go to ward b via the lobby and wave"),
        ("en", "go via the lobby to ward b and wave"),
        ("de", "fahr über die Eingangshalle zur Station B und wink"),
        ("de", "fahr zur Station B über die Eingangshalle und wink"),
        ("fr", "va à l'unité B en passant par le hall et fais signe"),
    ],
)
def test_nothing_is_done_at_a_place_on_the_way(language: str, words: str) -> None:
    assert program(language, words) == (
        'robot.goto("lobby")\nrobot.goto("ward b")\nrobot.gesture("wave")\n'
    )
