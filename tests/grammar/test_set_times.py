"""When what is wished for set times is to be done: rounds of a ward, in the words of its people."""

from __future__ import annotations

from dataclasses import replace

import pytest

from grammar.plan import calls
from grammar.requests import When
from grammar.understand import understand
from tests.grammar.hospitals import hospital

WORKDAYS = (0, 1, 2, 3, 4)


def when(sentence: str, language: str) -> When | None:
    request = understand(sentence, hospital(language), language).request
    assert request is not None and request.kind == "schedule", sentence
    assert request.sentence and request.part
    return replace(request.when, bare=()) if request.when is not None else None


def bare(sentence: str, language: str) -> tuple[str, ...]:
    """The times that may be twelve hours off."""
    request = understand(sentence, hospital(language), language).request
    assert request is not None and request.when is not None, sentence
    return request.when.bare


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
        ("every day at half past six", When(("18:30",), repeats=True)),
        ("every day at quarter to one", When(("12:45",), repeats=True)),
        ("every night at two", When(("02:00",), repeats=True)),
        ("every Friday night at one", When(("01:00",), weekdays=(5,), repeats=True)),
        ("every day at eight, twelve and six", When(("08:00", "12:00", "18:00"), repeats=True)),
        ("from Monday to Friday at 8:30", When(("08:30",), weekdays=WORKDAYS, repeats=True)),
        ("twice a day at nine and at three", When(("09:00", "15:00"), repeats=True)),
        ("every morning", When(half="am", repeats=True)),
        # once
        ("tomorrow at ten and at four", When(("10:00", "16:00"), days_ahead=1)),
        ("tomorrow night at one and at two", When(("01:00", "02:00"), days_ahead=2)),
        ("in three days", When(days_ahead=3)),
        ("next Monday", When(weekdays=(0,))),
        ("on the 24th of December at 4 pm", When(("16:00",), date="12-24")),
        (
            "once on Monday, 30 November 2026 at 08:00",
            When(("08:00",), weekdays=(0,), date="2026-11-30"),
        ),
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
        (
            "every hour from 10 pm to six",
            When(minutes=60, repeats=True, since="22:00", until="06:00"),
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
        ("jede Nacht um drei", When(("03:00",), repeats=True)),
        ("montags bis freitags um halb neun", When(("08:30",), weekdays=WORKDAYS, repeats=True)),
        ("am Montagmorgen um neun", When(("09:00",), weekdays=(0,))),
        ("zweimal täglich um neun und um drei", When(("09:00", "15:00"), repeats=True)),
        ("morgen Mittag", When(("12:00",), days_ahead=1)),
        ("am ersten März um halb eins", When(("12:30",), date="03-01")),
        (
            "werktags alle 15 Minuten von 9 bis 17 Uhr",
            When(weekdays=WORKDAYS, minutes=15, repeats=True, since="09:00", until="17:00"),
        ),
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
        ("chaque matin à huit heures,", When(times=("08:00",), repeats=True)),
        ("du lundi au vendredi à 8 h 30", When(("08:30",), weekdays=WORKDAYS, repeats=True)),
        ("deux fois par jour, à neuf heures et à 15 h,", When(("09:00", "15:00"), repeats=True)),
        ("demain à dix heures et à quatre heures", When(("10:00", "16:00"), days_ahead=1)),
        ("le premier mars à midi", When(("12:00",), date="03-01")),
        ("toutes les nuits à deux heures", When(("02:00",), repeats=True)),
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


@pytest.mark.parametrize(
    "sentence, language, part, rest",
    [
        ("fahr jeden Morgen um acht in die Lobby", "de", "jeden Morgen um acht", None),
        ("fahr um zehn und um vier in die Lobby", "de", "um zehn und um vier", None),
        ("fahr montags um zehn in die Lobby", "de", "montags um zehn", None),
        ("go to the lobby tomorrow", "en", "tomorrow", "go to the lobby"),
        ("go every morning at eight to the lobby", "en", "every morning at eight", None),
        ("va chaque matin à huit heures dans le hall", "fr", "chaque matin à huit heures", None),
        ("va dans le hall demain", "fr", "demain", "va dans le hall"),
    ],
)
def test_wherever_it_stands(sentence: str, language: str, part: str, rest: str | None) -> None:
    request = understand(sentence, hospital(language), language).request
    assert request is not None and request.kind == "schedule"
    assert request.part == part
    assert request.sentence == (rest or sentence.replace(f" {part}", ""))


@pytest.mark.parametrize(
    "sentence, language, times",
    [
        ("every day at seven wave", "en", ("07:00",)),
        ("every day at 7:00 wave", "en", ()),
        ("every day at seven pm wave", "en", ()),
        ("every morning at seven wave", "en", ()),
        ("every weekday at eight wave", "en", ()),
        ("every day at ten and at 16:00 wave", "en", ("10:00",)),
        ("jeden Tag um acht wink", "de", ("08:00",)),
        ("jeden Tag um acht Uhr wink", "de", ()),
        ("um zehn Uhr und um vier Uhr wink", "de", ("10:00", "16:00")),  # once
        ("tous les jours à sept heures va dans le hall", "fr", ()),
    ],
)
def test_which_may_be_twelve_hours_off(sentence: str, language: str, times: tuple[str]) -> None:
    assert bare(sentence, language) == times


@pytest.mark.parametrize(
    "sentence, language",
    [
        ("say that the 9 to 5 shift begins", "en"),
        ("greet the visitors for two hours", "en"),
        ("wave three times", "en"),
        ("ask the visitors whether they come back tomorrow", "en"),
        ("say the doctor comes at eight", "en"),
        ("sag, der Arzt kommt um acht", "de"),
        ("frag die Besucher, ob sie morgen wiederkommen", "de"),
        ("dis que le médecin vient à huit heures", "fr"),
    ],
)
def test_not_all_numbers_and_days_are_moments(sentence: str, language: str) -> None:
    plan = understand(sentence, hospital(language), language).plan
    assert plan is not None and not any(call.method == "wait_until" for call in calls(plan))


def test_said_behind_what_is_to_be_done() -> None:
    asked = understand("go to the lobby every morning at eight", hospital("en"), "en").request
    assert asked is not None and asked.when == When(times=("08:00",), repeats=True)


def test_what_goes_on_from_now_is_a_program() -> None:
    """Somebody stands there and waits for it: that is not put into the book of the ward."""
    for sentence in ("every ten minutes go to the lobby", "go to the lobby every hour"):
        assert understand(sentence, hospital("en"), "en").plan is not None


@pytest.mark.parametrize(
    "sentence, language",
    [
        ("go to the lobby the day after tomorrow at noon", "en"),
        ("go to the lobby on Monday night at ten", "en"),
        ("tonight at one go to the lobby", "en"),
        ("fahr in die Lobby morgen Abend um acht", "de"),
        ("fahr morgen früh um neun in die Lobby", "de"),
        ("cette nuit à une heure va dans le hall", "fr"),
        ("va dans le hall lundi à neuf heures", "fr"),
    ],
)
def test_a_single_moment_is_a_program_where_there_is_no_book(sentence: str, language: str) -> None:
    plan = understand(sentence, hospital(language), language).plan
    assert plan is not None
    assert [call.method for call in calls(plan)][-2:] == ["wait_until", "goto"]
