"""Standing orders in conversation: they become appointments, are asked back, or stay errands."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from nl2robot.knowledge import Knowledge
from nl2robot.review.review import review
from nl2robot.schedule.schedule import Schedule
from nl2robot.schedule.triggers import Trigger
from nl2robot.translate.outcome import Translation
from nl2robot.translate.talk import Talk
from nl2robot.translate.translation import translate
from robot_api.drivers import simulated
from sim.simulation import Simulation
from sim.world.loading import load_world
from tests.schedule.conftest import Clock

Says = Callable[..., Translation]
GREET = "somebody comes into the lobby, greet them"


@pytest.fixture
def schedule(tmp_path: Path, clock: Clock) -> Iterator[Schedule]:
    knowledge = Knowledge(load_world("city-hospital"))
    book = tmp_path / "schedule.sqlite"
    schedule = Schedule(
        book, lambda: "robot", lambda program, *_, **__: review(program, knowledge), clock
    )
    yield schedule
    schedule.close()


@pytest.fixture
def says(schedule: Schedule) -> Says:
    """In a conversation at a station."""
    knowledge, talk = Knowledge(load_world("city-hospital")), Talk()

    def says(words: str, language: str = "en") -> Translation:
        return translate(words, knowledge, language, "grammar", talk, schedule=schedule)

    return says


def plainly(words: str, language: str = "en") -> Translation:
    """Where nobody keeps appointments."""
    return translate(words, Knowledge(load_world("city-hospital")), language, "grammar")


def test_whenever_makes_an_appointment(says: Says) -> None:
    made = says(f"whenever {GREET}")
    assert made.program is None and made.status == "ok"
    assert made.schedule is not None
    assert made.schedule.trigger == Trigger(what="seen", thing="person", place="lobby")
    assert made.schedule.program == 'robot.say("Hello!")\n'
    assert made.schedule.sentence == "greet them"
    assert made.message is not None
    assert made.message.startswith(
        "When the robot sees somebody come while it is at lobby: I will say “Hello!”"
    )


def test_how_often_at_most_is_kept(says: Says) -> None:
    made = says(f"whenever {GREET}, at most once an hour")
    assert made.schedule is not None and made.schedule.trigger is not None
    assert made.schedule.trigger.every == 3600
    assert made.schedule.when.endswith(", at most every hour")


@pytest.mark.parametrize(
    ("words", "language", "when"),
    [
        ("immer wenn der Akku unter 15 % fällt, geh laden", "de", "unter 15 % fällt"),
        ("chaque fois que la batterie est sous 15 %, va te recharger", "fr", "sous 15 %"),
    ],
)
def test_in_other_languages(says: Says, words: str, language: str, when: str) -> None:
    made = says(words, language)
    assert made.schedule is not None and when in made.schedule.when
    assert made.schedule.program == "robot.dock()\n"


def test_when_may_be_once_or_each_time_and_is_asked(says: Says) -> None:
    asked = says(f"when {GREET}")
    assert asked.status == "clarify" and asked.suggestions == ["each time", "only once"]
    each = says("each time")
    assert each.schedule is not None and each.schedule.trigger is not None
    assert says(f"when {GREET}").status == "clarify"
    once = says("only once")
    assert once.program == plainly(f"when {GREET}").program
    assert says(f"when {GREET}").status == "clarify"
    assert says("go to the lobby").program == 'robot.goto("lobby")\n'  # another order
    assert says("each time").schedule is None


@pytest.mark.parametrize(
    "errand",
    [
        "when you get to the lobby, say hello",
        "go to the lobby and when somebody comes, greet them",
        "when Alice comes into the lobby, say hello to her",
        "stay in the lobby. whenever somebody comes, greet them",
        "whenever somebody comes into the lobby, greet them until noon",
        "when somebody comes, tell me",
        "whenever the battery is low, tell Alice",
    ],
)
def test_an_errand_stays_one(says: Says, errand: str) -> None:
    made = says(errand)
    assert made.schedule is None and made.program is not None
    assert made.program == plainly(errand).program


def test_where_no_appointments_are_kept_somebody_is_waited_for(says: Says) -> None:
    made = plainly(f"whenever {GREET}")
    assert made.schedule is None and made.program is not None and "while True" in made.program
    # What no program could wait for as well is no program here either.
    made = plainly("whenever the battery is below 20 %, go and charge")
    assert made.program is None and made.schedule is not None


def test_what_is_to_be_done_has_to_be_understood(says: Says) -> None:
    made = says("whenever a badge is scanned, frobnicate")
    assert (made.status, made.program, made.schedule) == ("rejected", None, None)


def test_a_robot_that_cannot_scan_is_told_of(schedule: Schedule) -> None:
    driver = simulated(Simulation(load_world("city-hospital")))
    capabilities = driver.capabilities()
    blind = type(capabilities)(
        **{
            **{name: getattr(capabilities, name) for name in capabilities.__struct_fields__},
            "methods": tuple(each for each in capabilities.methods if each != "scan"),
        }
    )
    knowledge = Knowledge(load_world("city-hospital"), capabilities=blind)
    made = translate(
        "if ever a badge is scanned, say thank you", knowledge, planner="grammar", schedule=schedule
    )
    assert made.status == "rejected"
    assert made.message == "This robot would never notice that. Choose another event."
    driver.close()
