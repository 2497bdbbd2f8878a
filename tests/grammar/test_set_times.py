"""When what is wished for set times is to be done: rounds of a ward, in the words of its people."""

from __future__ import annotations

import pytest

from grammar.requests import When
from grammar.understand import understand
from tests.grammar.hospitals import hospital

WORKDAYS = (0, 1, 2, 3, 4)


def when(sentence: str, language: str) -> When | None:
    request = understand(sentence, hospital(language), language).request
    assert request is not None and request.kind == "schedule", sentence
    assert request.sentence and request.part
    return request.when


@pytest.mark.parametrize(
    "wish, means",
    [
        ("every morning at eight", When(times=("08:00",), repeats=True)),
        ("every evening at eight", When(times=("20:00",), repeats=True)),
        ("every night at ten", When(times=("22:00",), repeats=True)),
        ("every day at noon", When(times=("12:00",), repeats=True)),
        ("every weekday at eight", When(times=("08:00",), weekdays=WORKDAYS, repeats=True)),
        ("every day at ten and at four", When(times=("10:00", "16:00"), repeats=True)),
        ("at ten and at four", When(times=("10:00", "16:00"))),  # today, without a rhythm
        ("on mondays and thursdays at 9:30", When(times=("09:30",), weekdays=(0, 3), repeats=True)),
        ("every Friday at half past two", When(times=("14:30",), weekdays=(4,), repeats=True)),
        # which eight it is, nobody can know; what is said as clocks show it is clear
        ("every day at seven", When(("07:00",), repeats=True, unclear=("07:00", "19:00"))),
        ("every day at half past six", When(("18:30",), repeats=True, unclear=("06:30", "18:30"))),
        ("every day at 7:00", When(times=("07:00",), repeats=True)),
        ("every day at seven pm", When(times=("19:00",), repeats=True)),
        (
            "every hour from nine to five",
            When(minutes=60, repeats=True, since="09:00", until="17:00"),
        ),
        (
            "every ten minutes between 14:00 and 16:00 on weekdays",
            When(weekdays=WORKDAYS, minutes=10, repeats=True, since="14:00", until="16:00"),
        ),
        ("every week at eight", None),  # on which day was not said
    ],
)
def test_in_english(wish: str, means: When | None) -> None:
    assert when(f"{wish} go to the lobby and say good morning", "en") == means


@pytest.mark.parametrize(
    "wish, means",
    [
        ("jeden Werktag um acht", When(times=("08:00",), weekdays=WORKDAYS, repeats=True)),
        ("um zehn und um vier", When(times=("10:00", "16:00"))),
        ("jeden Tag um Mitternacht", When(times=("00:00",), repeats=True)),
        ("jeden Morgen um viertel vor acht", When(times=("07:45",), repeats=True)),
        ("jeden Abend um acht", When(times=("20:00",), repeats=True)),
        ("täglich um 8 Uhr", When(times=("08:00",), repeats=True)),
        ("jeden Tag um acht", When(("08:00",), repeats=True, unclear=("08:00", "20:00"))),
        ("montags und freitags um halb zwei", When(("13:30",), weekdays=(0, 4), repeats=True)),
        (
            "jede Stunde von neun bis fünf",
            When(minutes=60, repeats=True, since="09:00", until="17:00"),
        ),
    ],
)
def test_in_german(wish: str, means: When) -> None:
    assert when(f"{wish} fahr in die Lobby", "de") == means


@pytest.mark.parametrize(
    "wish, means",
    [
        ("tous les jours à 8 h", When(times=("08:00",), repeats=True)),
        ("à dix heures et à seize heures", When(times=("10:00", "16:00"))),
        ("chaque matin à huit heures", When(times=("08:00",), repeats=True)),
        ("tous les soirs à huit heures", When(times=("20:00",), repeats=True)),
        ("le lundi et le jeudi à midi et demi", When(("12:30",), weekdays=(0, 3), repeats=True)),
        (
            "toutes les heures de neuf heures à dix-sept heures",
            When(minutes=60, repeats=True, since="09:00", until="17:00"),
        ),
    ],
)
def test_in_french(wish: str, means: When) -> None:
    assert when(f"{wish} va dans le hall", "fr") == means


def test_said_behind_what_is_to_be_done() -> None:
    asked = understand("go to the lobby every morning at eight", hospital("en"), "en").request
    assert asked is not None and asked.when == When(times=("08:00",), repeats=True)


def test_what_goes_on_from_now_is_a_program() -> None:
    """Somebody stands there and waits for it: that is not put into the book of the ward."""
    for sentence in ("every ten minutes go to the lobby", "go to the lobby every hour"):
        assert understand(sentence, hospital("en"), "en").plan is not None
