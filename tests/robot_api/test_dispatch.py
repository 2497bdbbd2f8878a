"""Whoever calls much waits for themselves: others, and a stop, are served."""

from __future__ import annotations

import threading
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robot_api.driver import StopFlag
from robot_api.drivers import emulated
from robot_api.serving.dispatch import LANES, Dispatcher, Job, Lane, Workers

SOON = 20.0


@pytest.fixture
def dispatcher() -> Dispatcher:
    return Dispatcher(emulated())


class Call:
    """A call that lasts until it is let go."""

    def __init__(self, dispatcher: Dispatcher, lane: Lane, owner: str) -> None:
        self.begun, self.ended, self.go = (threading.Event() for _ in range(3))
        self.error: Any = None
        dispatcher.start(Job("test", self._run, self._done, owner, lane))

    def _run(self, stop: StopFlag) -> None:
        self.begun.set()
        stop.on_set(self.go.set)
        assert self.go.wait(SOON)

    def _done(self, result: Any, error: Any) -> None:
        self.error = error
        self.ended.set()


@pytest.mark.parametrize("lane", LANES)
def test_one_connection_leaves_room_for_another(dispatcher: Dispatcher, lane: Lane) -> None:
    _, each = LANES[lane]
    greedy = [Call(dispatcher, lane, "greedy") for _ in range(4 * each)]
    other = Call(dispatcher, lane, "other")
    assert other.begun.wait(SOON)
    assert greedy[each - 1].begun.wait(SOON)
    assert not greedy[each].begun.is_set()
    for call in greedy:  # in their turn they are all done
        call.go.set()
    assert all(call.ended.wait(SOON) for call in greedy)
    other.go.set()
    assert other.ended.wait(SOON)


def test_what_tells_of_an_end_is_begun_even_after_the_stop_that_brought_it(
    dispatcher: Dispatcher,
) -> None:
    told: list[tuple[Any, Any]] = []
    ended = [threading.Event() for _ in range(2)]

    def job(number: int, after_stop: bool) -> Job:
        def done(result: Any, error: Any) -> None:
            told.append((result, type(error).__name__))
            ended[number].set()

        return Job("test", StopFlag.is_set, done, "nurse", "wait", after_stop=after_stop)

    for number, after_stop in enumerate((True, False)):
        begun = job(number, after_stop)
        begun.stop.set("It was stopped before a thread had come to it.")
        dispatcher.start(begun)
        assert ended[number].wait(SOON)
    assert told == [(True, "NoneType"), (None, "Stopped")]


def test_who_waits_for_the_end_keeps_nobody_from_ending_it(dispatcher: Dispatcher) -> None:
    most, each = LANES["wait"]
    waiting = [
        Call(dispatcher, "wait", f"client {number // each}") for number in range(most + each)
    ]
    ending = Call(dispatcher, "control", "nurse")
    assert ending.begun.wait(SOON)
    ending.go.set()
    stopped = threading.Event()
    dispatcher.stop("The ward stops it.", lambda result, error: stopped.set())
    assert stopped.wait(SOON)
    assert all(call.ended.wait(SOON) for call in waiting)  # those that had not begun as well
    assert ending.ended.wait(SOON)


@settings(max_examples=30)
@given(st.lists(st.integers(0, 3), max_size=40), st.integers(1, 4), st.integers(1, 3))
def test_everything_is_done_once(owners: list[int], most: int, each: int) -> None:
    workers, done = Workers("test", most, each), []
    left = threading.Semaphore(0)

    def task(number: int) -> None:
        done.append(number)
        left.release()

    for number, owner in enumerate(owners):
        workers.do(lambda number=number: task(number), owner or None)  # type: ignore[misc]
    for _ in owners:
        assert left.acquire(timeout=SOON)
    assert sorted(done) == list(range(len(owners)))
    workers.close()
