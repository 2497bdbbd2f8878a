"""What a sentence speaks of: times and how often, as people say them in three languages."""

from __future__ import annotations

import pytest

from grammar.language import load_language
from grammar.planning.turn import Turn
from tests.grammar.ward import WARD
from tests.grammar.ward_de import STATION
from tests.grammar.ward_fr import HOPITAL

WARDS = {"en": WARD, "de": STATION, "fr": HOPITAL}

TIMES = {
    "en": "half two = 14:30 | half past nine = 09:30 | twenty to four = 15:40 | noon = 12:00"
    " | a quarter to three = 14:45",
    "de": "halb zwei = 13:30 | fünf vor halb zehn = 09:25 | fünf nach halb zehn = 09:35"
    " | viertel vier = 15:15 | dreiviertel vier = 15:45 | zehn vor acht = 07:50",
    "fr": "quatre heures moins vingt = 15:40 | midi et quart = 12:15 | midi moins le quart = 11:45"
    " | deux heures et dix = 14:10 | midi vingt = 12:20",
}
SPANS = {
    "en": "every quarter of an hour = 900 | every couple of minutes = 120 | half an hour = 1800",
    "de": "stündlich = 3600 | alle Viertelstunde = 900 | anderthalb Stunden = 5400",
    "fr": "tous les quarts d'heure = 900 | une heure et demie = 5400 | trois quarts d'heure = 2700",
}


def cases(told: dict[str, str]) -> list[tuple[str, str, str]]:
    return [
        (language, *(part.strip() for part in each.split("=")))  # type: ignore[misc]
        for language, all_of_them in told.items()
        for each in all_of_them.split("|")
    ]


def heard(language: str, words: str, sort: str) -> str:
    """The value of what has the most words."""
    turn = Turn(f"{words}.", WARDS[language], load_language(language))
    found = [each for each in turn.mentions if each.sort == sort]
    return max(found, key=lambda each: (each.end - each.start, -each.cost)).value


@pytest.mark.parametrize(("language", "words", "time"), cases(TIMES))
def test_times_of_day(language: str, words: str, time: str) -> None:
    assert heard(language, words, "time") == time


@pytest.mark.parametrize(("language", "words", "seconds"), cases(SPANS))
def test_how_long_and_how_often(language: str, words: str, seconds: str) -> None:
    assert heard(language, words, "seconds") == seconds
