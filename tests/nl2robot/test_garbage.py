"""No search for garbage holds up a stop of a robot that moves."""

from __future__ import annotations

import gc
import threading
from collections.abc import Iterator

import pytest

from nl2robot.station import garbage
from nl2robot.station.garbage import DUE, OVERDUE, swept

SOON = 20.0


@pytest.fixture
def searches(monkeypatch) -> Iterator[threading.Event]:
    """Set when there was a long one. All that is there already is left out of it."""
    monkeypatch.setattr(garbage, "LOOKS", 0.005)
    searched = threading.Event()

    def note(phase: str, about: dict[str, int]) -> None:
        if phase == "stop" and about["generation"] == 2:
            searched.set()

    gc.callbacks.append(note)
    yield searched
    gc.callbacks.remove(note)


class Wheels:
    def __init__(self) -> None:
        self.move = True
        self.looked = threading.Semaphore(0)

    def __call__(self) -> bool:
        self.looked.release()
        return self.move


def make_due(short_searches: int) -> None:
    for _ in range(short_searches):
        gc.collect(1)


def test_while_the_robot_moves_nobody_searches_and_then_it_is_made_up_for(searches) -> None:
    wheels = Wheels()
    with swept(wheels):
        searches.clear()
        make_due(2 * DUE)
        for _ in range(5):
            assert wheels.looked.acquire(timeout=SOON)
        assert not searches.is_set()
        wheels.move = False
        assert searches.wait(SOON)


def test_one_that_moves_all_day_fills_no_memory(searches) -> None:
    with swept(lambda: True):
        searches.clear()
        make_due(OVERDUE + 1)
        assert searches.wait(SOON)


def test_afterwards_python_searches_as_it_did() -> None:
    before = gc.get_threshold()
    with swept(lambda: False):
        assert gc.get_threshold()[2] > 1_000_000 and gc.get_freeze_count() > 0
    assert gc.get_threshold() == before
