"""One errand, on the simulator and on a Pepper: the same program, and the same comes of it."""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from nl2robot.speech.speak.aloud import ears_at
from robot_api.capabilities.sound import Sound
from sandbox.execution import Outcome
from tests.fetched import fetched
from tests.robots.errand import Visitor, execution_on, in_the_simulator, outcome_on, ward_in
from tests.robots.pepper.conftest import until

RECORDINGS = Path(__file__).parents[2] / "speech" / "recordings"


def test_a_visitor_is_shown_the_way_by_pepper_as_in_the_simulator(
    tmp_path: Path, standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    """Pepper hears the visitor by its own microphone and our recogniser."""
    fetched("en")
    voices = ("to-the-pharmacy-please.wav", "yes-please.wav")
    pepper = standing_in(voices=[str(RECORDINGS / voice) for voice in voices])
    on_pepper = drive(pepper, sound=Sound(ears_at=ears_at(ward_in(tmp_path))))
    with_pepper = outcome_on(on_pepper)
    assert with_pepper == in_the_simulator(tmp_path)
    assert with_pepper[0].status == "done"
    assert pepper.texts[-1] == with_pepper[2]
    assert "Please follow me." in pepper.texts
    assert [deed for deed in pepper.done if deed.startswith("navigate")] == [
        "navigate 3.00 2.00",
        "navigate 0.00 0.00",
    ]
    assert pepper.pose == pytest.approx([0, 0, 0], abs=0.05)


def test_stopped_in_the_middle_it_stands_and_the_program_is_over(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in(hurry=2.0)
    driver = drive(pepper, sound=Sound(ears_at=lambda _: Visitor("pharmacy")))
    execution = execution_on(driver)
    outcomes: list[Outcome] = []
    running = threading.Thread(target=lambda: outcomes.append(execution.run()))
    running.start()
    assert until(lambda: pepper.speed > 0.2)
    execution.stop("Nurse Kim pressed stop.")
    driver.stop("Nurse Kim pressed stop.")
    assert pepper.speed < 0.001
    running.join(5)
    assert [outcome.status for outcome in outcomes] == ["stopped"]
    assert "navigate 0.00 0.00" not in pepper.done


def test_cut_in_the_middle_the_program_ends_and_is_not_taken_up_again(
    standing_in: Callable[..., Any], drive: Callable[..., Any], network: Callable[..., Any]
) -> None:
    """Pepper drives on while nobody reaches it; found again, the first thing that it hears is to
    stop."""
    pepper = standing_in(hurry=0.5)
    way = network(pepper)
    driver = drive(way, sound=Sound(ears_at=lambda _: Visitor("pharmacy")))
    links: list[str] = []
    driver.subscribe(lambda kind, data: links.append(data["state"]) if kind == "link" else None)
    outcomes: list[Outcome] = []
    running = threading.Thread(target=lambda: outcomes.append(execution_on(driver).run()))
    running.start()
    assert until(lambda: pepper.speed > 0.1)
    way.cut()
    running.join(5)
    [outcome] = outcomes
    assert (outcome.status, outcome.error) == ("failed", "LostConnection")
    assert "in the network" in outcome.message
    assert pepper.speed > 0
    way.mend()
    assert until(lambda: "connected" in links)
    assert links == ["lost", "connected"]
    assert pepper.speed < 0.001
    assert pepper.pose[0] < 2.9
    assert "navigate 0.00 0.00" not in pepper.done
