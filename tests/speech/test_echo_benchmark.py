"""A robot in a simulated room, by its ears: alone, and when somebody speaks over it."""

from __future__ import annotations

import numpy as np
import pytest

from nl2robot.bench.echo import LEVEL, Session, share
from nl2robot.bench.trials import Speaker
from nl2robot.speech.scenes import Signal, level
from nl2robot.speech.speak.voices import espeak


@pytest.fixture
def session() -> Session:
    return Session(np.random.default_rng(1), delay=0.06, louder=0.0)


@pytest.fixture(scope="module")
def robot() -> Signal:
    return Speaker(espeak("en", "")).say("The pharmacy is closed today. Please ring twice, Alice.")


def test_the_robot_alone_does_not_interrupt_itself(session: Session, robot: Signal) -> None:
    scene = session.hear(robot, robot[:0], at=0.0)
    assert scene.silent == np.inf
    assert level(scene.raw.astype(np.float32) / 32768) == pytest.approx(LEVEL, rel=0.1)
    assert scene.nobody.mean() > 0.5


def test_who_speaks_over_it_silences_it(session: Session, robot: Signal) -> None:
    session.hear(robot, robot[:0], at=0.0)
    person = Speaker(espeak("en-us", "f4"), pitch=1.1).say("No, please take me to radiology.")
    scene = session.hear(robot, person, at=1.0)
    assert 1.25 < scene.silent < 2.25


def test_the_share_of_words_that_were_heard() -> None:
    assert share("go to the lobby, please", "go the lobby") == pytest.approx(3 / 5)
    assert share("stop", "") == 0
