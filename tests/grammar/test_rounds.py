"""Where a round of places ends: what is done elsewhere afterwards is done once."""

from __future__ import annotations

import itertools

import pytest

from tests.grammar.test_kinds import program

EVERY_WARD = {
    "en": ("go to every ward", "visit every ward", "go to all wards"),
    "de": ("fahr zu jeder Station", "besuch jede Station", "fahr in alle Stationen"),
    "fr": ("va dans chaque service", "passe dans tous les services"),
}
DONE_THERE = {
    "en": ("", " and say good night", " and wave", " and wait a minute"),
    "de": ("", " und sag gute Nacht", " und wink", " und warte eine Minute"),
    "fr": ("", " et dis bonne nuit", " et fais signe de la main", " et attends une minute"),
}
ELSEWHERE = {
    "en": (", then go to the {}", " and then drive to the {}"),
    "de": (", dann fahr zu {}", " und fahr danach zu {}"),
    "fr": (", puis va à {}", " et ensuite va à {}"),
}
PLACES = {
    "en": {"pharmacy": "pharmacy", "lobby": "lobby", "kitchen": "kitchen"},
    "de": {"der Apotheke": "pharmacy", "der Küche": "kitchen"},
    "fr": {"la pharmacie": "pharmacy", "la cuisine": "kitchen"},
}


@pytest.mark.parametrize("language", EVERY_WARD)
def test_where_one_goes_after_a_round_one_goes_once(language: str) -> None:
    for there, done, then in itertools.product(
        EVERY_WARD[language], DONE_THERE[language], ELSEWHERE[language]
    ):
        for place, name in PLACES[language].items():
            words = there + done + then.format(place)
            made = program(language, words)
            assert made.endswith(f'\nrobot.goto("{name}")\n'), f"{words}\n{made}"
            assert "    robot.goto(place)\n" in made, f"{words}\n{made}"


@pytest.mark.parametrize(
    ("language", "words"),
    [
        ("en", "go to every ward, get a blanket and bring it to the kitchen"),
        ("en", "for every ward, go to the pharmacy and wave"),
        ("de", "fahr zu jeder Station, nimm eine Decke und bring sie in die Küche"),
        ("fr", "va dans chaque service, prends une couverture et apporte-la à la cuisine"),
    ],
)
def test_what_is_brought_elsewhere_from_each_place_belongs_to_the_round(
    language: str, words: str
) -> None:
    assert "\n    robot.goto(" in program(language, words)
    assert "\nrobot.goto(" not in program(language, words)


def lettered(language: str, words: str) -> bool:
    return 'for place in ["ward a", "ward b", "ward c"]:' in program(language, words)


@pytest.mark.parametrize(
    ("language", "row"),
    [
        ("en", "wards {}, {} and {}"),
        ("de", "den Stationen {}, {} und {}"),
        ("fr", "les services {}, {} et {}"),
    ],
)
@pytest.mark.parametrize("letters", ["abc", "ABC"])
def test_rooms_of_a_kind_are_named_by_their_letters(language: str, row: str, letters: str) -> None:
    verb = {
        "en": "go to {} and say hello",
        "de": "fahr zu {} und sag hallo",
        "fr": "va dans {} et dis bonjour",
    }
    assert lettered(language, verb[language].format(row.format(*letters)))
