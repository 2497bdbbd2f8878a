"""Where somebody is whom the robot has seen just now is told at once; it looks for all others."""

from __future__ import annotations

import pytest

from nl2robot.run.sightings import GOOD_FOR, Sightings
from tests.nl2robot.test_history import Nurse


class Clock:
    """The time of a ward, which passes when it is told to."""

    def __init__(self) -> None:
        self.now = 1000.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    """To be asked for before the station is."""
    clock = Clock()
    monkeypatch.setattr("nl2robot.run.runner.Sightings", lambda: Sightings(clock))
    return clock


def test_where_she_was_seen_just_now_needs_no_looking(clock, operator) -> None:
    nurse = Nurse(operator)
    first = nurse.says("where is Alice?")
    assert first.program is not None and "find" in first.program
    assert nurse.has_done("go to ward a and ask Alice if she wants tea") == "done"
    answer = nurse.says("where is Alice?")
    assert answer.program is None and answer.status == "ok"
    assert answer.message == "I saw Alice in ward a just now. Ask again, and I will go and look."
    clock.now += 121
    told = nurse.says("do you know where she is?").message
    assert told is not None and told.startswith("I saw Alice in ward a 2 minutes ago.")
    assert nurse.says("where is Henry?").program is not None


def test_who_asks_again_wants_it_looked_for(clock, operator) -> None:
    nurse = Nurse(operator)
    assert nurse.has_done("go to ward a and ask Alice if she wants tea") == "done"
    assert nurse.says("where is Alice?").program is None
    assert nurse.says("where is Alice?").program is not None


@pytest.mark.parametrize(
    "words",
    ["find Alice", "look for Alice and tell me where she is", "go and find out where Alice is"],
)
def test_who_is_sent_to_look_looks(clock, operator, words: str) -> None:
    nurse = Nurse(operator)
    assert nurse.has_done("go to ward a and ask Alice if she wants tea") == "done"
    assert nurse.says(words).program is not None


def test_the_conversation_goes_on_about_her(clock, operator) -> None:
    nurse = Nurse(operator)
    assert nurse.has_done("go to ward a and ask Alice if she wants tea") == "done"
    assert nurse.says("where is Alice?").program is None
    program = nurse.says("bring her the red cup").program
    assert program is not None and '"Alice"' in program


def test_people_go_on(clock, operator) -> None:
    nurse = Nurse(operator)
    assert nurse.has_done("go to ward a and ask Alice if she wants tea") == "done"
    clock.now += GOOD_FOR + 60
    looks = nurse.says("where is Alice?")
    assert looks.program is not None
    assert looks.explanation.startswith("I last saw Alice in ward a 6 minutes ago. I will look")
    clock.now += 4 * 3600
    assert "4 hours ago" in nurse.says("where is Alice?").explanation
    clock.now += 24 * 3600
    assert "last saw" not in nurse.says("where is Alice?").explanation


@pytest.mark.parametrize(
    ("language", "ask", "where", "told"),
    [
        (
            "de",
            "Frag Alice in Station A, ob sie Tee möchte",
            "Wo ist Alice?",
            "Ich habe Alice gerade eben auf Station A gesehen."
            " Fragen Sie noch einmal, dann sehe ich nach.",
        ),
        (
            "fr",
            "Demande à Alice si elle veut du thé",
            "Tu sais où est Alice ?",
            "J'ai vu Alice à l'instant, ici : le service A. Redemandez, et j'irai voir.",
        ),
    ],
)
def test_in_other_languages(clock, operator, language, ask, where, told) -> None:
    nurse = Nurse(operator, language)
    assert nurse.has_done(ask) == "done"
    assert nurse.says(where).message == told


def test_what_is_looked_for_in_vain_or_taken_away_is_forgotten() -> None:
    seen = Sightings(lambda: 0.0)
    seen.note("people", {}, ["Bob", "Tom"], "ward a")
    seen.note("sees", {"thing": "cup"}, True, "kitchen")
    assert seen.of("bob") == seen.of("Tom")
    seen.note("sees", {"thing": "Bob"}, False, "ward b")  # he need not be there
    assert seen.of("Bob") is not None
    seen.note("sees", {"thing": "Bob"}, False, "ward a")
    assert seen.of("Bob") is None
    seen.note("find", {"thing": "Tom", "place": None}, False, "lobby")
    assert seen.of("Tom") is None
    seen.note("grab", {"thing": "cup"}, None, "kitchen")
    assert seen.of("cup") is None
    seen.note("give", {"thing": "cup", "person": "Rosa"}, None, "ward b")
    assert seen.of("cup") is None and seen.of("Rosa") is not None
    seen.note("find", {"thing": "Lina", "place": None}, True, None)  # who knows where
    assert seen.of("Lina") is None
