"""A robot of one's own, put together from capabilities: what the driver does for it."""

from __future__ import annotations

import threading
from datetime import datetime
from typing import Any

import pytest

from robot_api.capabilities.base import Hub
from robot_api.capabilities.core import EmulatedCore, LogBook
from robot_api.capabilities.driving import Motion
from robot_api.capabilities.emulation import Emulation
from robot_api.capabilities.speech import EmulatedSpeech
from robot_api.driver import Event, StopFlag
from robot_api.drivers import INTERFACES, ComposedDriver
from robot_api.errors import InternalError, LostConnection, NotPossible, NotSupported, Stopped
from robot_api.methods import CAPABILITIES, METHODS


class Trolley(Motion):
    """Wheels that turn until they are stopped; they cannot turn on the spot."""

    def __init__(self) -> None:
        self.under_way = threading.Semaphore(0)

    def offers(self) -> tuple[str, ...]:
        return ("move", "drive")

    def move(self, stop: StopFlag, metres: float) -> None:
        if metres > 50:
            raise ZeroDivisionError("a fault in the trolley")
        self._roll(stop)

    def drive(self, stop: StopFlag, linear: float, angular: float, seconds: float) -> None:
        self._roll(stop)

    def turn(self, stop: StopFlag, degrees: float) -> None:
        raise AssertionError("not offered")

    def _roll(self, stop: StopFlag) -> None:
        self.under_way.release()
        assert stop.wait(30)
        stop.check()


class Ride:
    """A call in a thread of its own."""

    def __init__(self, driver: ComposedDriver, method: str, **arguments: Any) -> None:
        self.flag = StopFlag()
        self.error: BaseException | None = None
        self._thread = threading.Thread(target=self._run, args=(driver, method, arguments))
        self._thread.start()

    def _run(self, driver: ComposedDriver, method: str, arguments: dict[str, Any]) -> None:
        try:
            driver.call(method, arguments, self.flag)
        except BaseException as error:  # noqa: BLE001 - the test looks at it
            self.error = error

    def end(self) -> BaseException | None:
        self._thread.join(10)
        assert not self._thread.is_alive()
        return self.error


@pytest.fixture
def wheels() -> Trolley:
    return Trolley()


@pytest.fixture
def trolley(wheels: Trolley) -> ComposedDriver:
    emulation = Emulation(start=datetime(2026, 11, 20, 8, 0))
    book = LogBook(emulation.now, emulation.hub)
    return ComposedDriver(
        name="The trolley",
        kind="trolley",
        parts=[EmulatedCore(emulation, book), EmulatedSpeech(emulation), wheels],
        hub=emulation.hub,
        book=book,
    )


def test_it_declares_what_it_is_made_of(trolley: ComposedDriver) -> None:
    has = trolley.capabilities()
    assert {"say", "move", "drive", "stop", "clock"} <= set(has.methods)
    assert not {"turn", "goto", "grab"} & set(has.methods)
    assert has.methods == tuple(name for name in METHODS if name in has.methods)


def test_it_says_what_it_lacks(trolley: ComposedDriver) -> None:
    with pytest.raises(NotSupported, match="it cannot find its way on a map"):
        trolley.call("goto", {"place": "lab"}, StopFlag())
    with pytest.raises(NotSupported, match="cannot do 'turn'"):
        trolley.call("turn", {"degrees": 90}, StopFlag())


def test_a_second_movement_is_refused_but_speaking_is_not(
    trolley: ComposedDriver, wheels: Trolley
) -> None:
    ride = Ride(trolley, "move", metres=3)
    assert wheels.under_way.acquire(timeout=10)
    for _ in range(2):
        with pytest.raises(NotPossible, match="already moving: it is busy with 'move'"):
            trolley.call("drive", {"linear": 1, "angular": 0, "seconds": 1}, StopFlag())
    trolley.call("say", {"text": "Mind your feet!"}, StopFlag())
    trolley.stop("That is enough.")
    assert isinstance(ride.end(), Stopped)
    again = Ride(trolley, "move", metres=3)
    assert wheels.under_way.acquire(timeout=10)
    again.flag.set()
    assert isinstance(again.end(), Stopped)


def test_a_joystick_may_be_moved_on(trolley: ComposedDriver, wheels: Trolley) -> None:
    pushes = [Ride(trolley, "drive", linear=0.1, angular=0, seconds=1) for _ in range(2)]
    assert wheels.under_way.acquire(timeout=10)
    assert wheels.under_way.acquire(timeout=10)
    trolley.stop("The hand let go.")
    assert [str(push.end()) for push in pushes] == ["The hand let go."] * 2


def test_stop_as_a_method_stops_the_others_and_not_its_own_program(
    trolley: ComposedDriver, wheels: Trolley
) -> None:
    ride = Ride(trolley, "move", metres=3)
    assert wheels.under_way.acquire(timeout=10)
    program = StopFlag()
    trolley.call("stop", {}, program)
    assert isinstance(ride.end(), Stopped)
    trolley.call("say", {"text": "I stand still now."}, program)


def test_a_fault_in_a_capability_is_no_fault_of_the_program(trolley: ComposedDriver) -> None:
    with pytest.raises(InternalError, match="its log has the details"):
        trolley.call("move", {"metres": 99}, StopFlag())
    assert "a fault in the trolley" in trolley.call("log", {"lines": 2}, StopFlag())[0]


def test_a_robot_that_is_switched_off_does_nothing(
    trolley: ComposedDriver, wheels: Trolley
) -> None:
    ride = Ride(trolley, "move", metres=3)
    assert wheels.under_way.acquire(timeout=10)
    trolley.close()
    trolley.close()
    assert isinstance(ride.end(), Stopped)
    with pytest.raises(LostConnection, match="switched off"):
        trolley.call("clock", {}, StopFlag())


def test_a_robot_needs_its_core() -> None:
    hub = Hub()
    with pytest.raises(TypeError, match="Core"):
        ComposedDriver(
            name="Nothing", kind="none", parts=[], hub=hub, book=LogBook(datetime.now, hub)
        )


def test_every_capability_of_the_table_has_an_interface() -> None:
    assert set(INTERFACES) == set(CAPABILITIES)
    for name, interface in INTERFACES.items():
        assert interface.name == name
        for method in METHODS.values():
            if method.capability == name and method.name != "stop":
                assert callable(getattr(interface, method.name, None)), method.name


def test_events_reach_those_who_listen_as_long_as_they_do() -> None:
    hub = Hub()
    heard: list[tuple[str, Event]] = []
    first = hub.subscribe(lambda kind, data: heard.append((f"first {kind}", data)))
    hub.subscribe(lambda kind, data: heard.append((f"second {kind}", data)))
    hub.publish("emotion", name="happy")
    first()
    first()
    hub.publish("gesture", name="wave")
    assert [kind for kind, _ in heard] == ["first emotion", "second emotion", "second gesture"]
    assert heard[0][1] == {"name": "happy"}


def test_a_listener_with_a_fault_takes_the_event_from_nobody(
    trolley: ComposedDriver, wheels: Trolley, caplog: pytest.LogCaptureFixture
) -> None:
    def fail(kind: str, data: Event) -> None:
        raise ValueError("a listener with a fault")

    heard: list[str] = []
    trolley.subscribe(fail)
    trolley.subscribe(lambda kind, data: heard.append(kind))
    ride = Ride(trolley, "move", metres=3)
    assert wheels.under_way.acquire(timeout=10)
    trolley.stop("The ward stops it.")
    assert isinstance(ride.end(), Stopped)
    assert [kind for kind in heard if kind != "log"] == ["stopping", "stopped"]
    assert "a listener failed at the event 'stopping'" in caplog.text
