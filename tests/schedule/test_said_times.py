"""What people on wards, at receptions and in laboratories say of times, with a book of appointments
at hand: what becomes an appointment, what a program, and what is asked back."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from datetime import datetime
from zoneinfo import ZoneInfo

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grammar.requests import When
from grammar.understand import understand
from nl2robot.knowledge import Knowledge
from nl2robot.review.review import Review
from nl2robot.schedule import wishes
from nl2robot.schedule.rhythm import Rhythm, local, times
from nl2robot.schedule.schedule import Schedule
from nl2robot.schedule.wishes import rhythm_of
from nl2robot.schedule.words import in_words
from nl2robot.translate import translation
from nl2robot.translate.outcome import Translation
from nl2robot.translate.talk import Talk
from nl2robot.translate.translation import translate
from sim.world.loading import load_world
from tests.grammar.hospitals import hospital
from tests.schedule.conftest import ZURICH, at

MONDAY = "2026-11-30 10:00"
GOES = {"en": "go to the lobby", "de": "fahr in die Lobby", "fr": "va dans le hall"}
KNOWLEDGE = Knowledge(load_world("city-hospital"))


@pytest.fixture(autouse=True)
def in_zurich(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(translation, "local_zone", lambda: ZURICH)


def nobody_reviews(program: str, language: str = "en", *, at: datetime | None = None) -> Review:
    raise AssertionError(f"a sentence alone has {program!r} reviewed")


def said(words: str, language: str, now: str = MONDAY, talk: Talk | None = None) -> Translation:
    schedule = Schedule(None, lambda: "robot", nobody_reviews, lambda: at(now))
    return translate(words, KNOWLEDGE, language, "grammar", talk, schedule=schedule)


def moments(made: Translation, now: str = MONDAY) -> list[str]:
    """The first three times of an appointment."""
    assert made.schedule is not None, made.message or made.program
    found = itertools.islice(times(made.schedule.rhythm, at(now)), 3)
    return [f"{local(each, ZURICH):%a %d %b %H:%M}" for each in found]


@pytest.mark.parametrize(
    "words, language, first",
    [
        ("tonight at nine go round all the wards and say good night", "en", "Mon 30 Nov 21:00"),
        ("tomorrow at ten go to the lobby and come back", "en", "Tue 01 Dec 10:00"),
        ("go to the lobby tomorrow night at one", "en", "Wed 02 Dec 01:00"),
        ("tonight at twelve go to the lobby", "en", "Tue 01 Dec 00:00"),
        ("in three days at ten go to the lobby", "en", "Thu 03 Dec 10:00"),
        ("on Monday at nine go to ward a and say hello", "en", "Mon 07 Dec 09:00"),
        ("in half an hour go to the pharmacy", "en", "Mon 30 Nov 10:30"),
        ("at 3:30 go to the reception", "en", "Mon 30 Nov 15:30"),
        ("at three go to the lobby", "en", "Mon 30 Nov 15:00"),
        ("today at eight go to the lobby", "en", "Mon 30 Nov 20:00"),
        ("fahr heute Abend um neun in alle Stationen und sag gute Nacht", "de", "Mon 30 Nov 21:00"),
        ("kannst du bitte um fünf in die Lobby fahren", "de", "Mon 30 Nov 17:00"),
        ("am Freitag um zwei fahr zum Empfang", "de", "Fri 04 Dec 14:00"),
        ("fahr in einer Dreiviertelstunde in die Lobby", "de", "Mon 30 Nov 10:45"),
        ("heute Nacht um eins fahr in die Lobby", "de", "Tue 01 Dec 01:00"),
        ("ce soir à neuf heures fais le tour des services", "fr", "Mon 30 Nov 21:00"),
        ("vendredi à deux heures, va à la réception", "fr", "Fri 04 Dec 14:00"),
        ("dans deux heures et demie va dans le hall", "fr", "Mon 30 Nov 12:30"),
    ],
)
def test_what_is_to_be_done_later_once_is_an_appointment(
    words: str, language: str, first: str
) -> None:
    """It holds no robot until then, and outlives a restart."""
    made = said(words, language)
    assert moments(made) == [first]
    assert made.schedule is not None and "wait_until" not in made.schedule.program
    assert "robot.wait(" not in made.schedule.program


@pytest.mark.parametrize("words", ["in ten minutes go to the lobby", "at 10:10 go to the lobby"])
def test_what_is_to_be_done_soon_is_waited_for(words: str) -> None:
    assert (said(words, "en").program or "").startswith("robot.wait")


def test_without_a_book_it_is_a_program_that_waits() -> None:
    program = translate("tomorrow at ten go to the lobby", KNOWLEDGE, "en", "grammar").program
    assert program is not None and 'robot.wait_until("10:00")' in program


def test_a_plan_that_would_wait_for_the_wrong_half_of_the_day_is_not_run() -> None:
    made = said("today at nine go to the lobby", "en", "2026-11-30 20:50")
    assert moments(made, "2026-11-30 20:50") == ["Mon 30 Nov 21:00"]


@pytest.mark.parametrize(
    "words, language, question, answers",
    [
        (
            "at eight go to the lobby",
            "en",
            "today at 20:00 or tomorrow at 08:00",
            {
                "eight in the evening": "Mon 30 Nov 20:00",
                "20:00": "Mon 30 Nov 20:00",
                "the second one": "Tue 01 Dec 08:00",
                "8 am": "Tue 01 Dec 08:00",
            },
        ),
        (
            "um acht Uhr fahr in die Lobby",
            "de",
            "heute um 20:00 oder morgen um 08:00",
            {"acht Uhr abends": "Mon 30 Nov 20:00", "um 8 Uhr morgens": "Tue 01 Dec 08:00"},
        ),
        (
            "va dans le hall demain à huit heures",
            "fr",
            "08:00 ou 20:00",
            {"huit heures du soir": "Tue 01 Dec 20:00", "à 8 heures du matin": "Tue 01 Dec 08:00"},
        ),
        ("tomorrow go to the lobby", "en", "what time", {"at ten": "Tue 01 Dec 10:00"}),
        ("this evening go to the lobby", "en", "what time", {"nine": "Mon 30 Nov 21:00"}),
        ("heute Abend fahr in die Lobby", "de", "Uhrzeit", {"um neun": "Mon 30 Nov 21:00"}),
        ("demain va dans le hall", "fr", "quelle heure", {"à midi": "Tue 01 Dec 12:00"}),
    ],
)
def test_what_is_open_is_asked(
    words: str, language: str, question: str, answers: dict[str, str]
) -> None:
    for answer, first in answers.items():
        talk = Talk()
        asked = said(words, language, talk=talk)
        assert asked.status == "clarify" and question in (asked.message or ""), asked
        for suggestion in asked.suggestions:
            assert said(suggestion, language).schedule is not None, suggestion
        assert moments(said(answer, language, talk=talk)) == [first], answer


def test_it_says_that_it_will_be_tomorrow() -> None:
    late = "2026-11-30 21:30"
    made = said("at eight go to the lobby", "en", late)
    assert made.schedule is not None
    assert made.schedule.when == "once tomorrow, Tuesday, 1 December 2026, at 08:00"
    assert "tomorrow" in (made.message or "")


def test_what_is_past_today_is_told() -> None:
    made = said("today at three go to the lobby", "en", "2026-11-30 18:00")
    assert (made.status, made.message) == (
        "rejected",
        "That time is past. Say one that is still to come.",
    )


# --- told and understood again

CLOCKS = st.integers(0, 24 * 12 - 1).map(lambda each: f"{each // 12:02}:{each % 12 * 5:02}")
DAYS = st.lists(st.integers(0, 6), unique=True).map(lambda days: tuple(sorted(days)))
NOWS = st.integers(int(at("2026-01-01 00:00")), int(at("2027-12-31 23:59")))
SAID = st.lists(CLOCKS, min_size=1, max_size=5, unique=True).map(lambda each: tuple(sorted(each)))
WISHES = st.one_of(
    st.builds(When, times=SAID, weekdays=DAYS, repeats=st.just(True)),
    st.builds(When, times=SAID, days_ahead=st.integers(1, 40)),
    st.builds(
        When,
        weekdays=DAYS,
        minutes=st.sampled_from([15, 20, 30, 60, 120]),
        repeats=st.just(True),
        since=st.sampled_from(["06:00", "08:30", "09:00", "22:00"]),
        until=st.sampled_from(["17:00", "20:30", "05:00"]),
    ),
)


def following(rhythm: Rhythm, now: float) -> Iterator[float]:
    return itertools.islice(times(rhythm, now), 40)


@pytest.mark.parametrize("language", list(GOES))
@settings(deadline=None, max_examples=25)
@given(wish=WISHES, now=NOWS)
def test_what_is_told_is_understood_so(language: str, wish: When, now: int) -> None:
    """Over midnight, the ends of months and years, and both times that clocks are set."""
    meant = rhythm_of(wish, now, ZURICH)
    assert isinstance(meant, Rhythm)
    words = f"{in_words(meant, language)} {GOES[language]}"
    asked = understand(words, hospital(language), language).request
    assert asked is not None and asked.when is not None, words
    again = rhythm_of(asked.when, now, ZURICH)
    assert isinstance(again, Rhythm), words
    assert list(following(again, now)) == list(following(meant, now)), words


@settings(deadline=None)
@given(
    now=NOWS,
    hour=st.integers(0, 23),
    minute=st.sampled_from([0, 15, 30]),
    ahead=st.integers(0, 40),
)
def test_a_day_and_a_time_are_that_by_the_clock_on_the_wall(
    now: int, hour: int, minute: int, ahead: int
) -> None:
    when = When(times=(f"{hour:02}:{minute:02}",), days_ahead=ahead)
    here = datetime.fromtimestamp(now, ZoneInfo(ZURICH))
    try:
        found = rhythm_of(when, now, ZURICH)
    except wishes.BadRhythm:
        assert ahead == 0 and (hour, minute) <= (here.hour, here.minute)
        return
    assert isinstance(found, Rhythm)
    [moment] = times(found)
    there = datetime.fromtimestamp(moment, ZoneInfo(ZURICH))
    assert (there.date() - here.date()).days == ahead
    leapt = there.utcoffset() != datetime.fromtimestamp(moment - 7200, there.tzinfo).utcoffset()
    assert (there.hour, there.minute) == (hour, minute) or (leapt and hour == 2)
