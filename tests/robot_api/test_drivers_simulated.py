"""The simulated robot on a small ward: every method does what it says there."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from typing import Any

import pytest

from robot_api.checker import check_driver
from robot_api.driver import Event, StopFlag
from robot_api.drivers import SimulatedDriver, simulated
from robot_api.errors import (
    InvalidCall,
    NotFound,
    NotPossible,
    Stopped,
    TimedOut,
    UnknownPerson,
    UnknownPlace,
)
from robot_api.methods import METHODS
from sim.simulation import Simulation
from sim.world.loading import load_world


def do(driver: SimulatedDriver, method: str, **arguments: Any) -> Any:
    return driver.call(method, arguments, StopFlag())


class Diary:
    """The events, but for the many poses and log lines."""

    def __init__(self, driver: SimulatedDriver) -> None:
        self.events: list[tuple[str, Event]] = []
        driver.subscribe(self.note)

    def note(self, kind: str, data: Event) -> None:
        if kind not in ("pose", "log"):
            self.events.append((kind, dict(data)))

    def of(self, kind: str) -> list[Event]:
        return [data for what, data in self.events if what == kind]


class Errand:
    """A call in a thread of its own."""

    def __init__(self, driver: SimulatedDriver, method: str, **arguments: Any) -> None:
        self._error: BaseException | None = None
        self._thread = threading.Thread(target=self._run, args=(driver, method, arguments))
        self._thread.start()

    def _run(self, driver: SimulatedDriver, method: str, arguments: dict[str, Any]) -> None:
        try:
            driver.call(method, arguments, StopFlag())
        except BaseException as error:  # noqa: BLE001 - the test looks at it
            self._error = error

    def end(self) -> BaseException | None:
        self._thread.join(10)
        assert not self._thread.is_alive()
        return self._error


@pytest.fixture
def robot() -> Iterator[SimulatedDriver]:
    driver = simulated(Simulation(load_world("ward"), seed=1))
    yield driver
    driver.close()


@pytest.fixture
def live_robot() -> Iterator[SimulatedDriver]:
    """One whose clock runs, at the speed of real time."""
    driver = simulated(Simulation(load_world("ward"), seed=1, speed=1))
    yield driver
    driver.close()


def test_it_has_every_method_and_knows_its_world(robot: SimulatedDriver) -> None:
    has = robot.capabilities()
    assert has.methods == tuple(METHODS)
    assert has.contacts == ("Alice",)
    assert has.units == "m"
    assert do(robot, "places") == ["corridor", "charger", "ward a", "ward b"]
    assert do(robot, "places", kind="wards") == ["ward a", "ward b"]
    assert do(robot, "clock").weekday == "Monday"


def test_it_drives_to_places_by_name_alias_and_memory(robot: SimulatedDriver) -> None:
    start = do(robot, "location")
    assert start.place == "charger"
    do(robot, "goto", place="Ward A")
    assert do(robot, "location").place == "ward a"
    do(robot, "goto", place="second ward")
    assert do(robot, "location").place == "ward b"
    do(robot, "goto", place=start)
    back = do(robot, "location")
    assert (back.x, back.y) == pytest.approx((start.x, start.y), abs=0.1)
    do(robot, "goto", x=6, y=1.5, theta=180)
    assert abs(do(robot, "location").theta) == pytest.approx(180, abs=3)


@pytest.mark.parametrize(
    ("method", "arguments"),
    [
        ("goto", {"place": "ward bee"}),
        ("localize", {"place": "ward bee"}),
        ("guide", {"person": "Alice", "place": "ward bee"}),
        ("follow", {"person": "Alice", "to": "ward bee"}),
        ("find", {"thing": "cup", "place": "ward bee"}),
    ],
)
def test_a_misheard_place_gets_a_suggestion(
    robot: SimulatedDriver, method: str, arguments: dict[str, Any]
) -> None:
    with pytest.raises(UnknownPlace) as unknown:
        do(robot, method, **arguments)
    assert str(unknown.value) == "I know no place called 'ward bee'. Did you mean the ward b?"
    assert do(robot, "location").place == "charger"


def test_it_talks_with_alice(robot: SimulatedDriver) -> None:
    diary = Diary(robot)
    do(robot, "goto", place="ward a")
    assert do(robot, "people") == ["Alice"]
    assert (
        do(robot, "ask", question="Are you busy?", options=["yes", "no"], person="Alice") == "yes"
    )
    options = ["ward a", "ward b"]
    assert do(robot, "ask", question="Where to?", options=options) == "ward b"
    assert diary.of("heard")[1] == {"text": "ward b", "person": "Alice"}
    assert diary.of("speech")[0] == {"text": "Are you busy?", "language": "en"}
    with pytest.raises(NotFound, match="do not see Henry"):
        do(robot, "ask", question="Henry?", person="Henry")


def test_it_answers_in_the_language_that_is_set(robot: SimulatedDriver) -> None:
    do(robot, "set_language", code="de")
    reply = do(robot, "answer", question="Wann gibt es denn Mittagessen?")
    assert reply == "Mittagessen gibt es um halb zwölf."
    do(robot, "say", text="Bonjour", language="fr")
    assert robot.simulation.record.happenings[-1].data == {"text": "Bonjour", "language": "fr"}


def test_nobody_in_the_corridor_answers(robot: SimulatedDriver) -> None:
    do(robot, "goto", place="corridor")
    with pytest.raises(TimedOut):
        do(robot, "listen", timeout=2)
    with pytest.raises(TimedOut):
        do(robot, "scan", timeout=2)


def test_it_looks_for_the_book_and_brings_it_to_alice(robot: SimulatedDriver) -> None:
    assert do(robot, "sees", thing="book") is False
    with pytest.raises(NotFound):
        do(robot, "grab", thing="book")
    assert do(robot, "find", thing="green book") is True
    assert do(robot, "location").place == "ward b"
    assert "book" in do(robot, "objects")
    assert do(robot, "count", thing="cup") == 1
    assert "green" in do(robot, "describe", thing="book")
    do(robot, "grab", thing="book")
    assert do(robot, "scan", prompt="What have I got?") == "2000000000428"
    with pytest.raises(NotPossible):
        do(robot, "grab", thing="cup")
    do(robot, "goto", place="ward a")
    do(robot, "give", thing="book", person="Alice")
    do(robot, "grab", thing="cup")
    do(robot, "put", thing="cup", where="table")
    assert robot.simulation.robot.holding == []


def test_it_guides_alice_and_follows_her(robot: SimulatedDriver) -> None:
    do(robot, "goto", place="ward a")
    assert do(robot, "wait_for", thing="nurse", timeout=5) is True
    do(robot, "guide", person="Alice", place="ward b")
    assert do(robot, "location").place == "ward b"
    assert "Alice" in do(robot, "people")
    do(robot, "follow", person="Alice")
    with pytest.raises(NotFound):
        do(robot, "follow", person="Santa Claus")


def test_a_new_program_meets_people_anew(robot: SimulatedDriver) -> None:
    do(robot, "goto", place="ward a")
    assert do(robot, "wait_for", thing="nurse", timeout=1) is True
    assert do(robot, "wait_for", thing="nurse", timeout=1) is False
    robot.begin()
    assert do(robot, "wait_for", thing="nurse", timeout=1) is True


def test_wheels_dock_and_battery(robot: SimulatedDriver) -> None:
    do(robot, "move", metres=2)
    do(robot, "turn", degrees=90)
    here = do(robot, "location")
    assert (here.x, here.y, here.theta) == pytest.approx((3, 1.5, 90), abs=0.1)
    do(robot, "drive", linear=-0.2, angular=0, seconds=1)
    assert do(robot, "location").y < 1.5
    do(robot, "dock")
    do(robot, "wait", seconds=60)
    assert robot.simulation.robot.charging
    assert do(robot, "battery") in (99, 100)
    do(robot, "localize", place="ward b")
    assert do(robot, "location").place == "ward b"


def test_body_language(robot: SimulatedDriver) -> None:
    diary = Diary(robot)
    do(robot, "emotion", name="surprised")
    do(robot, "gesture", name="Wave")
    do(robot, "joint", name="head_yaw", degrees=-45)
    do(robot, "set_volume", percent=20)
    do(robot, "do", skill="look around")
    before = robot.simulation.time
    do(robot, "do", skill="spin", times=2)
    assert robot.simulation.time - before > 5
    assert diary.of("emotion") == [{"name": "surprised"}]
    assert diary.of("gesture") == [{"name": "wave"}]
    state = robot.simulation.robot
    assert (state.emotion, state.joints, state.volume) == ("surprised", {"head_yaw": -45}, 20)
    with pytest.raises(InvalidCall, match="1 to 10 times"):
        do(robot, "do", skill="spin", times=0)
    with pytest.raises(InvalidCall, match="takes nothing besides"):
        do(robot, "do", skill="look around", quickly=True)


def test_a_video_call_with_alice(robot: SimulatedDriver) -> None:
    diary = Diary(robot)
    do(robot, "call", contact="alice")
    do(robot, "hang_up")
    assert [data["state"] for data in diary.of("call")] == ["calling", "connected", "ended"]
    with pytest.raises(UnknownPerson, match="I can call Alice"):
        do(robot, "call", contact="the king")


def test_the_tablet(robot: SimulatedDriver) -> None:
    do(robot, "goto", place="ward a")
    do(robot, "show", html="<input id=name>")
    do(robot, "type_text", selector="#name", text="Ann")
    assert do(robot, "touch", options=["tea", "coffee"]) in ("tea", "coffee")
    assert robot.simulation.robot.screen == {"html": '<input id="name" value="Ann"/>'}


def test_a_dry_run_changes_nothing(robot: SimulatedDriver) -> None:
    do(robot, "show", html="<p>Hello</p>")
    diary = Diary(robot)
    rehearsal = robot.copy()
    do(rehearsal, "goto", place="ward b")
    do(rehearsal, "say", text="This is only a rehearsal.")
    assert do(rehearsal, "read_text", selector="p") == "Hello"
    assert do(rehearsal, "location").place == "ward b"
    rehearsal.close()
    assert do(robot, "location").place == "charger"
    assert robot.simulation.time == 0
    assert diary.events == []


def test_dry_runs_while_the_robot_drives(live_robot: SimulatedDriver) -> None:
    drive = Errand(live_robot, "goto", place="ward b")
    for place in ("ward a", "ward b") * 3:
        rehearsal = live_robot.copy()
        do(rehearsal, "goto", place=place)
        assert do(rehearsal, "location").place == place
        rehearsal.close()
    live_robot.stop("It is only an exercise.")
    assert isinstance(drive.end(), Stopped)


def test_an_emergency_stop_on_the_way(live_robot: SimulatedDriver) -> None:
    diary = Diary(live_robot)
    driving = threading.Event()
    live_robot.subscribe(
        lambda kind, data: driving.set() if kind == "pose" and data["speed"] > 0.2 else None
    )
    drive = Errand(live_robot, "goto", place="ward b")
    assert driving.wait(10)
    with pytest.raises(NotPossible, match="busy with 'goto'"):
        do(live_robot, "move", metres=1)
    do(live_robot, "emotion", name="happy")
    live_robot.stop("Somebody pressed the red button.")
    assert live_robot.simulation.robot.speed == 0
    end = drive.end()
    assert isinstance(end, Stopped) and not isinstance(end, Exception)
    assert str(end) == "Somebody pressed the red button."
    assert diary.of("stopped") == [{"because": "Somebody pressed the red button."}]
    assert do(live_robot, "location").place == "corridor" or do(live_robot, "location").x < 6


def test_the_simulated_robot_conforms(robot: SimulatedDriver) -> None:
    assert check_driver(robot) == []


def test_the_simulated_robot_conforms_while_its_clock_runs() -> None:
    driver = simulated(Simulation(load_world("ward"), seed=2, speed=10))
    assert check_driver(driver) == []
    driver.close()
