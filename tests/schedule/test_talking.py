"""Appointments in conversation: made, asked about, called off for a day, and taken out."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from nl2robot.knowledge import Knowledge
from nl2robot.review.review import digest, review
from nl2robot.schedule.schedule import Schedule
from nl2robot.translate.outcome import Translation
from nl2robot.translate.talk import Talk
from nl2robot.translate.translation import translate
from sim.world.loading import load_world
from tests.schedule.conftest import ROUND, Clock, rhythm

Says = Callable[..., Translation]
SENTENCE = "go to ward a and say good morning"


@pytest.fixture
def schedule(tmp_path: Path, clock: Clock, monkeypatch: pytest.MonkeyPatch) -> Iterator[Schedule]:
    """With a round each morning at eight, by the clocks of Zurich."""
    for module in ("schedule", "talking"):
        monkeypatch.setattr(f"nl2robot.schedule.{module}.local_zone", lambda: "Europe/Zurich")
    knowledge = Knowledge(load_world("ward"))
    book = tmp_path / "schedule.sqlite"
    schedule = Schedule(
        book, lambda: "robot", lambda program, *_, **__: review(program, knowledge), clock
    )
    schedule.add(
        program=ROUND, sha256=digest(ROUND), by="Nurse Kim", sentence=SENTENCE, rhythm=rhythm()
    )
    yield schedule
    schedule.close()


@pytest.fixture
def says(schedule: Schedule) -> Says:
    """Each says it in a conversation of their own, until it is `talk`."""
    knowledge, talk = Knowledge(load_world("ward")), Talk()

    def says(words: str, language: str = "en") -> Translation:
        return translate(words, knowledge, language, "grammar", talk, schedule=schedule)

    return says


@pytest.mark.parametrize(
    ("language", "words", "told"),
    [
        ("en", "what is planned?", "every day at 08:00"),
        ("de", "was ist geplant?", "das nächste Mal am Montag, 30. November 2026, um 08:00"),
        ("fr", "qu'est-ce qui est prévu ?", "la prochaine fois le lundi 30 novembre 2026"),
    ],
)
def test_what_is_planned(says: Says, language: str, words: str, told: str) -> None:
    answer = says(words, language)
    assert answer.status == "ok" and told in (answer.message or "")
    assert SENTENCE in (answer.message or "")


@pytest.mark.parametrize(
    ("language", "words", "yes"),
    [
        ("en", "not tomorrow", "yes"),
        ("de", "morgen nicht", "ja"),
        ("fr", "pas demain", "oui"),
        ("en", "not on Tuesday", "yes"),
    ],
)
def test_not_tomorrow(says: Says, schedule: Schedule, language: str, words: str, yes: str) -> None:
    asked = says(words, language)
    assert asked.status == "clarify" and SENTENCE in (asked.message or "")
    [before] = schedule.listed()
    assert before.off == (), "nothing is called off before somebody says yes"
    assert says(yes, language).status == "ok"
    [after] = schedule.listed()
    assert after.off == before.next[1:2]
    assert says(words, language).status == "ok", "nothing is left to call off then"


@pytest.mark.parametrize(
    ("language", "words", "yes"),
    [
        ("en", "cancel the round at eight", "yes"),
        ("de", "sag die Runde um acht ab", "ja"),
        ("fr", "annule la ronde de huit heures", "oui"),
    ],
)
def test_the_round_at_eight_is_cancelled(
    says: Says, schedule: Schedule, language: str, words: str, yes: str
) -> None:
    assert says(words, language).status == "clarify"
    assert len(schedule.listed()) == 1
    says(yes, language)
    assert schedule.listed() == []
    assert says("what is planned?").message is not None


def test_who_says_no_keeps_it(says: Says, schedule: Schedule) -> None:
    says("cancel the round at eight")
    assert says("no").message == "All right, it stays as it is."
    assert len(schedule.listed()) == 1
    assert says("cancel the round at nine").status == "rejected"


@pytest.mark.parametrize(
    ("language", "words", "answer", "when"),
    [
        ("en", "every morning at eight go to ward a", None, "every day at 08:00"),
        ("en", "every day go to ward a", "at nine in the evening", "every day at 21:00"),
        ("en", "every day at 8 go to ward a", "20:00", "every day at 20:00"),
        ("de", "jeden Tag geh zur Station A", "um acht Uhr abends", "jeden Tag um 20:00"),
    ],
)
def test_what_is_to_be_done_at_set_times_is_never_a_program_for_now(
    says: Says, language: str, words: str, answer: str | None, when: str
) -> None:
    made = says(words, language)
    if answer is not None:
        assert (made.status, made.schedule) == ("clarify", None)
        made = says(answer, language)
    assert made.schedule is not None and made.program is None
    assert made.schedule.when == when
    assert made.schedule.program == 'robot.goto("ward a")\n'


def test_another_order_is_no_answer_to_when(says: Says) -> None:
    says("every day go to ward a")
    assert says("say hello").program == 'robot.say("Hello!")\n'


def test_what_is_not_understood_has_no_times_either(says: Says) -> None:
    refused = says("every day at eight go to the moon")
    assert refused.status == "rejected" and "moon" in (refused.message or "")
