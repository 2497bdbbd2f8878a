"""Who drives, and the dead man's switch: as stories, at random, and over the wire."""

import itertools
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from nl2robot.console.drive.helm import HOLDS, IDLE, Helm, Operator, State
from nl2robot.console.drive.services import part
from nl2robot.run.present import Present
from nl2robot.run.runlog import RunLog
from nl2robot.run.state import Began, Halted, PauseAsked, on_wire
from nl2robot.station.part import Backstage
from robot_api import Robot, Server
from robot_api.driver import StopFlag
from robot_api.drivers import simulated
from robot_api.errors import AccessDenied, InvalidCall, NotPossible, RobotError, Stopped
from sim.simulation import Simulation
from sim.world.loading import load_world

SOON = 20  # seconds; what is waited for comes within milliseconds


class Clock:
    time = 1000.0

    def __call__(self) -> float:
        return self.time


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def told() -> list[State]:
    return []


@pytest.fixture
def helm(clock: Clock, told: list[State]) -> Helm:
    return Helm(told.append, clock, clock)


# --- who drives


def test_who_comes_first_drives_and_the_next_one_asks(helm: Helm, told: list[State]) -> None:
    assert helm.take("1", "Ruth").driver == "1"
    assert helm.take("2", "Karim").driver == "1"
    assert told[-1].who == "Ruth" and told[-1].asking == (Operator("2", "Karim"),)
    given = helm.give("1", "2")
    assert (given.driver, given.who, given.asking) == ("2", "Karim", ())
    assert told[-1] == given


def test_let_go_of_the_helm_goes_to_whoever_asked_first(helm: Helm) -> None:
    helm.take("1", "Ruth")
    assert helm.give("1").driver is None
    helm.take("1", "Ruth")
    helm.take("2", "Karim")
    helm.take("3", "Lea")
    assert helm.give("1").who == "Karim"
    assert helm.state().asking == (Operator("3", "Lea"),)


def test_who_leaves_lets_go_and_who_left_gets_nothing(helm: Helm, told: list[State]) -> None:
    helm.take("1", "Ruth")
    helm.take("2", "Karim")
    helm.left("1")
    assert told[-1].who == "Karim"
    before = len(told)
    helm.left("8")
    assert len(told) == before, "a stranger's leaving is no news"
    with pytest.raises(NotPossible):
        helm.take("1", "Ruth")  # sent before, handled after
    helm.left("2")
    assert helm.state() == State(driver=None, who=None, since=None, asking=())


def test_who_keeps_the_helm_answers_all_who_ask(helm: Helm) -> None:
    helm.take("1", "Ruth")
    helm.take("2", "Karim")
    assert helm.keep("1").asking == ()
    with pytest.raises(NotPossible):
        helm.give("1", "2")
    with pytest.raises(AccessDenied, match="Ruth drives"):
        helm.keep("2")


def test_a_forgotten_helm_can_be_taken(helm: Helm, clock: Clock) -> None:
    helm.take("1", "Ruth")
    clock.time += IDLE - 1
    with helm.calling("1", StopFlag()):
        clock.time += IDLE
        assert helm.take("2", "Karim").driver == "1", "what was asked of the robot still goes on"
    assert helm.take("2", "Karim").driver == "1"
    clock.time += IDLE
    assert helm.take("2", "Karim").driver == "2"


def test_only_who_drives_may_do_something(helm: Helm) -> None:
    with pytest.raises(AccessDenied, match="Take the helm"), helm.calling("1", StopFlag()):
        pass
    helm.take("1", "Ruth")
    for way in (helm.calling, helm.steering):
        with pytest.raises(AccessDenied, match="Ruth drives"), way("2", StopFlag()):
            pass


# --- what must end


def test_the_connections_end_ends_what_it_asked_for(helm: Helm) -> None:
    helm.take("1", "Ruth")
    goto, stick = StopFlag(), StopFlag()
    with helm.calling("1", goto), helm.steering("1", stick):
        helm.left("1")
        assert goto.is_set() and stick.is_set()


def test_a_hand_over_ends_the_joystick_and_no_errand(helm: Helm) -> None:
    helm.take("1", "Ruth")
    helm.take("2", "Karim")
    goto, stick = StopFlag(), StopFlag()
    with helm.calling("1", goto), helm.steering("1", stick):
        helm.give("1", "2")
        assert stick.is_set() and not goto.is_set()


def test_a_late_movement_does_not_follow_the_release(helm: Helm) -> None:
    helm.take("1", "Ruth")
    first = StopFlag()
    with helm.steering("1", first, number=1):
        helm.release("1", number=3)
        assert first.is_set()
    with pytest.raises(Stopped), helm.steering("1", StopFlag(), number=2):
        pass
    with helm.steering("1", StopFlag(), number=4):
        pass


def test_after_a_stop_the_stick_must_be_let_go_first(helm: Helm) -> None:
    helm.take("1", "Ruth")
    flag = StopFlag()
    with helm.steering("1", flag):
        flag.set("The robot was stopped.")
    with pytest.raises(NotPossible, match="Let go"), helm.steering("1", StopFlag()):
        pass
    helm.release("2")  # who does not drive lets go of nothing
    with pytest.raises(NotPossible, match="Let go"), helm.steering("1", StopFlag()):
        pass
    helm.release("1")
    with helm.steering("1", StopFlag()):
        pass
    helm.release("1")
    helm.stopped()  # nobody holds the stick: nothing to let go of
    with helm.steering("1", StopFlag()):
        pass


def test_a_program_that_begins_ends_the_joystick(helm: Helm) -> None:
    helm.take("1", "Ruth")
    flag = StopFlag()
    with helm.steering("1", flag):
        helm.yield_to_program()
        assert flag.is_set()


class Operators(RuleBasedStateMachine):
    """Operators who do anything at all, and a robot that drives as it is told for `HOLDS`."""

    connections = st.sampled_from("1234")

    def __init__(self) -> None:
        super().__init__()
        self.clock = Clock()
        self.told: list[State] = []
        self.helm = Helm(self.told.append, self.clock, self.clock)
        self.flights: list[tuple[StopFlag, str, float, ExitStack]] = []
        self.gone: set[str] = set()
        self.refused_until_release = False

    @rule(who=connections)
    def take(self, who: str) -> None:
        try:
            self.helm.take(who, f"operator {who}")
        except NotPossible:
            assert who in self.gone

    @rule(who=connections, to=st.none() | connections)
    def give(self, who: str, to: str | None) -> None:
        before = self.helm.state()
        try:
            self.helm.give(who, to)
        except (AccessDenied, NotPossible):
            assert self.helm.state() == before

    @rule(who=connections)
    def leave(self, who: str) -> None:
        self.gone.add(who)
        self.helm.left(who)

    @rule(who=connections)
    def steer(self, who: str) -> None:
        flag, landing = StopFlag(), ExitStack()
        before = self.helm.state()
        try:
            landing.enter_context(self.helm.steering(who, flag))
        except AccessDenied:
            assert before.driver != who
        except NotPossible:
            assert self.refused_until_release
        else:
            assert before.driver == who
            self.flights.append((flag, who, self.clock.time + HOLDS, landing))

    @rule(who=connections)
    def release(self, who: str) -> None:
        self.helm.release(who)
        if who == self.helm.state().driver:
            assert not self.moving(), "who lets go stands"

    @rule()
    def stop(self) -> None:
        for flag, *_ in self.flights:
            flag.set()
        self.helm.stopped()
        self.refused_until_release = True

    @rule(seconds=st.sampled_from([0.05, 0.1, 0.3, 70.0]))
    def wait(self, seconds: float) -> None:
        self.clock.time += seconds
        for flight in list(self.flights):
            if self.clock.time >= flight[2] or flight[0].is_set():
                flight[3].close()
                self.flights.remove(flight)

    def moving(self) -> list[str]:
        """Whose movements the robot still makes."""
        return [who for flag, who, until, _ in self.flights if not flag.is_set()]

    @invariant()
    def at_most_one_drives_and_who_is_told(self) -> None:
        state = self.helm.state()
        assert state.driver not in self.gone
        assert state.driver not in [asking.connection for asking in state.asking]
        assert not self.told or self.told[-1] == state

    @invariant()
    def the_dead_man_stops(self) -> None:
        assert set(self.moving()) <= {self.helm.state().driver}, "no movement but the driver's"


Operators.TestCase.settings = settings(max_examples=60, stateful_step_count=40)
test_at_random = Operators.TestCase


# --- over the wire, with a robot in the simulated hospital


class Ward(SimpleNamespace):
    server: Server
    simulation: Simulation
    present: Present
    log: RunLog
    news: threading.Event

    def operator(self, who: str) -> Robot:
        robot = Robot(self.server.address)
        robot.request("helm.take", {"who": who})
        return robot

    def speed(self) -> float:
        return self.simulation.robot.speed

    def until(self, holds: Callable[[], bool]) -> None:
        """Wait until it holds; looked at whenever something happens."""
        while not holds():
            assert self.news.wait(SOON)
            self.news.clear()

    def tell(self, *happened: Any) -> None:
        self.news.set()


@pytest.fixture
def ward(tmp_path: Path) -> Iterator[Ward]:
    world = load_world("city-hospital")
    simulation = Simulation(world, speed=1.0)
    driver = simulated(simulation)
    present = Present(lambda state: backstage.tell("state", on_wire(state)))
    ward = Ward(simulation=simulation, present=present, news=threading.Event())

    def publish(kind: str, data: Any, to: str | None = None) -> None:
        server.publish(kind, data, to)
        ward.tell()

    log = RunLog(tmp_path / "runs.sqlite")
    runner = SimpleNamespace(present=present, knowledge=SimpleNamespace(world=world), log=log)
    ward.log = log
    backstage = Backstage(
        driver=driver,
        runner=runner,
        talks=None,
        proposals=None,
        simulation=simulation,
        publish=publish,
        wanted=lambda kind: server.wanted(kind),
        stop=driver.stop,
    )
    made = part(backstage)
    driver.subscribe(backstage.tell)
    driver.subscribe(ward.tell)
    ward.server = server = Server(
        driver, port=0, services=made.services, events=made.events, on_left=made.left
    )
    with server:
        yield ward
    made.close()
    driver.close()
    log.close()


_numbers = itertools.count(1)


@contextmanager
def held(robot: Robot, linear: float) -> Iterator[None]:
    """The joystick is held, as a page does: a movement every 100 ms."""
    over = threading.Event()

    def renew() -> None:
        while not over.is_set():
            params = {"linear": linear, "angular": 0, "number": next(_numbers)}
            threading.Thread(target=_quietly, args=(robot, "helm.drive", params)).start()
            over.wait(0.1)

    thread = threading.Thread(target=renew)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()


def _quietly(robot: Robot, method: str, params: dict[str, Any]) -> None:
    with suppress(Stopped, RobotError):
        robot.request(method, params)


def test_the_robot_drives_while_the_stick_is_held_and_stands_when_it_is_not(ward: Ward) -> None:
    with ward.operator("Ruth") as ruth:
        with held(ruth, 0.4):
            ward.until(lambda: ward.speed() > 0.3)
        ward.until(lambda: ward.speed() == 0)  # nobody said so: the dead man's switch
        with held(ruth, 0.4):
            ward.until(lambda: ward.speed() > 0.1)
        ruth.request("helm.release", {"number": next(_numbers)})
        ward.until(lambda: ward.speed() == 0)
        lines = [line["message"] for line in ruth.request("helm.log", {})]
        assert len([line for line in lines if line.startswith("drive")]) == 1, "not ten a second"
        assert [(each.who, each.method) for each in ward.log.done_by_hand()] == [("Ruth", "drive")]


def test_a_lost_connection_stops_the_joystick_and_the_errand(ward: Ward) -> None:
    ruth = ward.operator("Ruth")
    with Robot(ward.server.address) as karim:
        karim.request("helm.take", {"who": "Karim"})
        errand = {"name": "goto", "arguments": {"place": "pharmacy"}}
        threading.Thread(target=_quietly, args=(ruth, "helm.call", errand)).start()
        ward.until(lambda: ward.speed() > 0.2)
        ruth.close()
        ward.until(lambda: ward.speed() == 0)
        ward.until(lambda: karim.request("helm.state", {})["who"] == "Karim")
        karim.request("helm.call", {"name": "emotion", "arguments": {"name": "happy"}})
    assert ward.simulation.robot.emotion == "happy"


def test_after_stop_a_stick_that_is_still_held_moves_nothing(ward: Ward) -> None:
    with ward.operator("Ruth") as ruth, Robot(ward.server.address) as anybody, held(ruth, 0.4):
        ward.until(lambda: ward.speed() > 0.1)
        anybody.stop()
        assert ward.speed() == 0
        anybody.wait(3 * HOLDS)
        assert ward.speed() == 0


def test_the_state_says_who_drives(ward: Ward) -> None:
    def driven_by() -> str | None:
        return ward.present.state.driven_by

    with ward.operator("Ruth") as ruth:
        assert driven_by() == "Ruth"
        with Robot(ward.server.address) as karim:
            karim.request("helm.take", {"who": "Karim"})
            assert driven_by() == "Ruth"  # he only asks
            ruth.request("helm.give", {})
            assert driven_by() == "Karim"
        ward.until(lambda: driven_by() is None)


def test_calls_are_the_drivers_and_no_programs(ward: Ward) -> None:
    with ward.operator("Ruth") as ruth, ward.operator("Karim") as karim:
        with pytest.raises(AccessDenied, match="Ruth drives"):
            karim.request("helm.call", {"name": "emotion", "arguments": {"name": "sad"}})
        with pytest.raises(AccessDenied, match="Ruth drives"):
            karim.request("helm.drive", {"linear": 0.1, "angular": 0})
        with pytest.raises(InvalidCall, match=r"helm\.drive"):
            ruth.request("helm.call", {"name": "drive", "arguments": {}})
        for happening in (Began(1), PauseAsked(), Halted()):
            ward.present.happened(happening)
        with pytest.raises(NotPossible, match="program is running"):
            ruth.request("helm.call", {"name": "dock"})
        with pytest.raises(NotPossible, match="program is running"):
            ruth.request("helm.drive", {"linear": 0.1, "angular": 0})
        karim.request("helm.call", {"name": "stop"})


def test_what_a_robot_has_is_told_with_how_it_is(ward: Ward) -> None:
    with ward.operator("Ruth") as ruth:
        ruth.request(
            "helm.call", {"name": "joint", "arguments": {"name": "head_yaw", "degrees": 5}}
        )
        ruth.request("helm.call", {"name": "set_volume", "arguments": {"percent": 35}})
        body = ruth.request("helm.body", {})
        assert "happy" in body["emotions"] and body["joints"]["head_yaw"] == [-90, 90]
        assert {"pharmacy"} <= {place["name"] for place in body["places"]}
        assert body["now"]["volume"] == 35 and body["now"]["joints"]["head_yaw"] == 5
        lines = ruth.request("helm.log", {"lines": 5})
        assert any("head_yaw" in line["message"] for line in lines)
