"""A robot that is lost, slow or out of its mind: a driver that tells the truth passes, each lie and
each silence is found."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from typing import Any

import pytest

from robot_api.checker import Report, check_robot
from robot_api.conformance import Proxy, losing
from robot_api.conformance.losing import Connect, Losing
from robot_api.conformance.subject import Findings
from robot_api.driver import StopFlag
from robot_api.drivers import emulated
from robot_api.errors import AccessDenied, LostConnection, RobotError
from robot_api.methods import METHODS
from robot_api.robots.address import Address
from tests.robot_api.conformance.distant import DistantDriver, ward


@pytest.fixture
def robot() -> Iterator[Address]:
    with ward() as address:
        yield address


@pytest.fixture
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    """The suite waits a little less for what does not come."""
    monkeypatch.setattr(losing, "LOST_WITHIN", 2.0)
    monkeypatch.setattr(losing, "FOUND_WITHIN", 2.0)


def looking_at(connect: Connect, address: Address, move: bool = True) -> Losing:
    return Losing(connect, address, move, Findings())


def found(look: Losing) -> list[str]:
    return [str(problem) for problem in look.findings.problems]


# --- a good driver


def test_a_robot_at_an_address_is_looked_at_whole() -> None:
    with ward(speed=50) as address:
        report = check_robot(DistantDriver, address)
    assert report == []
    states = {row.part: row.state for row in report.rows}
    assert states["navigation"] == states["link"] == states["two clients"] == "works"


def test_a_robot_that_must_not_move_is_looked_at_without() -> None:
    called = set()

    class Watched(DistantDriver):
        def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
            called.add(method)
            return super().call(method, arguments, stop)

    with ward(speed=50) as robot:
        report = check_robot(Watched, robot, move=False)
    assert report == []
    assert "say" in called
    assert not any(METHODS[method].moves for method in called)
    states = {row.part: row.state for row in report.rows}
    assert states["link"] == "works"
    assert states["manipulation"] == "not tried"


def test_a_robot_without_a_host_has_no_link_to_be_cut() -> None:
    report = check_robot(lambda address: emulated(), Address("emulator"))
    assert report == []
    assert "link" not in {row.part for row in report.rows}


def test_a_robot_that_is_not_there_is_no_robot_to_be_looked_at() -> None:
    with pytest.raises(LostConnection, match="no robot at"):
        check_robot(DistantDriver, Address("ws", "127.0.0.1", 1))


def link_of(report: Report) -> tuple[str, str]:
    row = next(row for row in report.rows if row.part == "link")
    return row.state, row.note


def test_an_address_without_a_port_has_no_link_to_be_cut() -> None:
    report = check_robot(lambda address: emulated(), Address("far", "porter"), move=False)
    assert report == []
    assert link_of(report) == ("not tried", "its address names no port, so it was never cut")


def test_a_robot_that_speaks_to_nobody_in_between() -> None:
    with ward(speed=50) as robot:

        def connect(address: Address) -> DistantDriver:
            if address != robot:
                raise AccessDenied("Its certificate is for another machine. Ask who made it.")
            return DistantDriver(address)

        report = check_robot(connect, robot, move=False)
    assert report == []
    state, note = link_of(report)
    assert state == "not tried"
    assert note.startswith("it cannot be reached through a proxy: Its certificate")


def test_a_robot_may_have_one_client_only_if_it_says_so(robot: Address) -> None:
    taken = threading.Lock()

    class Jealous(DistantDriver):
        def __init__(self, address: Address) -> None:
            if not taken.acquire(blocking=False):
                raise AccessDenied("Another server drives this robot. End that one first.")
            super().__init__(address)

        def close(self) -> None:
            super().close()
            taken.release()

    look = looking_at(Jealous, robot)
    look.two_clients()
    assert found(look) == []
    assert look.findings.notes["two clients"].startswith("the second is refused: Another server")


# --- connecting


def test_errors_of_a_library_while_connecting(robot: Address) -> None:
    def connect(address: Address) -> DistantDriver:
        try:
            return DistantDriver(address)
        except LostConnection:
            raise ConnectionError("[Errno 111]") from None

    look = looking_at(connect, robot)
    look.nobody_there()
    look.answers_nonsense()
    assert found(look) == [
        "connecting where nobody is raised ConnectionError, and raised no LostConnection",
        "connecting to what answers nonsense raised ConnectionError, and raised no LostConnection",
    ]


def test_a_driver_that_is_there_though_the_robot_is_not(robot: Address) -> None:
    look = looking_at(lambda address: emulated(), robot)
    look.nobody_there()
    assert len(found(look)) == 1
    assert found(look)[0].startswith("connecting where nobody is returned")


def test_a_driver_that_waits_for_ever_for_an_answer(robot: Address, impatient: None) -> None:
    over = threading.Event()

    def connect(address: Address) -> DistantDriver:
        over.wait(60)
        raise LostConnection("That took long.")

    look = looking_at(connect, robot)
    look.answers_nothing()
    over.set()
    assert found(look) == ["connecting to what never answers takes more than 2 s"]


def test_a_driver_that_goes_past_the_link_cannot_be_judged() -> None:
    with ward(speed=50) as robot:
        report = check_robot(lambda address: DistantDriver(robot), robot, move=False)
    assert report == []
    past = "the driver goes past the address, so it was never cut"
    assert link_of(report) == ("not tried", past)


# --- lost


def lost(driver: type[DistantDriver], robot: Address, move: bool = True) -> list[str]:
    look = looking_at(driver, robot, move)
    look.lost("was cut", Proxy.cut)
    return found(look)


def test_a_silent_loss(robot: Address, impatient: None) -> None:
    class Silent(DistantDriver):
        def lost(self) -> None:
            """Nobody is told."""

    problems = lost(Silent, robot)
    assert "sent no event 'link' with the state 'lost' when the link was cut" in problems


def test_a_robot_that_is_found_and_nobody_is_told(robot: Address, impatient: None) -> None:
    class Silent(DistantDriver):
        def found(self) -> None:
            """Nobody is told."""

    problems = lost(Silent, robot)
    told = "sent no event 'link' with the state 'connected' after the link was cut"
    assert told in problems
    assert any(line.startswith("battery does not work again after the link") for line in problems)


def test_a_call_that_waits_for_a_robot_that_is_gone(robot: Address, impatient: None) -> None:
    over = threading.Event()

    class Patient(DistantDriver):
        def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
            try:
                return super().call(method, arguments, stop)
            except LostConnection:
                if method == "wait":
                    over.wait(60)
                raise

    problems = lost(Patient, robot)
    over.set()
    assert problems == ["wait: did not come back within 2 s when the link was cut"]


def test_a_call_that_ends_well_though_the_robot_is_gone(robot: Address) -> None:
    class Cheerful(DistantDriver):
        def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
            try:
                return super().call(method, arguments, stop)
            except LostConnection:
                if method in ("wait", "battery"):
                    raise ConnectionResetError("[Errno 104]") from None
                return None

    assert lost(Cheerful, robot) == [
        "wait: raised ConnectionResetError when the link was cut, and raised no LostConnection",
        "goto: returned None when the link was cut, and raised no LostConnection",
        "battery: raised ConnectionResetError when the link was cut, and raised no LostConnection",
    ]


def test_a_stop_that_is_believed_though_the_robot_never_heard_of_it(robot: Address) -> None:
    class Liar(DistantDriver):
        def stands(self) -> bool:
            super().stands()
            return True

    assert lost(Liar, robot) == [
        "a stop returned None when the link was cut, and raised no StopNotConfirmed",
        "a stop sent no event 'stop_not_confirmed' when the link was cut",
        "a stop sent the event 'stopped' when the link was cut",
    ]


def test_a_stop_that_waits_for_the_robot(robot: Address) -> None:
    class Patient(DistantDriver):
        def stands(self) -> bool:
            until_lost = StopFlag()
            return super().stands() or until_lost.wait(1)

    problems = lost(Patient, robot)
    assert len(problems) == 1
    assert problems[0].startswith("a stop took 1")


def test_a_movement_that_is_resumed_unasked(robot: Address) -> None:
    class Eager(DistantDriver):
        def __init__(self, address: Address) -> None:
            super().__init__(address)
            self.was_at: dict[str, Any] = {}

        def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
            if method == "goto":
                self.was_at = arguments
            return super().call(method, arguments, stop)

        def found(self) -> None:
            if self.link.state == "lost" and self.was_at:
                threading.Thread(target=self._resume, daemon=True).start()
            super().found()

        def _resume(self) -> None:
            try:
                self.robot.goto(**self.was_at)
            except BaseException:  # noqa: BLE001 - it is stopped at the end
                return

    problems = lost(Eager, robot)
    assert len(problems) == 1
    assert problems[0].startswith("the robot moved on by")
    assert problems[0].endswith("after the link was cut was mended, without being asked")


def test_a_robot_that_drives_on_though_nobody_can_reach_it() -> None:
    with ward(speed=1, ping_seconds=60) as robot:  # its server does not miss us
        look = looking_at(DistantDriver, robot)
        look.lost("froze", Proxy.freeze)
    assert len(found(look)) == 1
    assert found(look)[0].startswith("the robot moved on by")
    assert found(look)[0].endswith("3 s after the link froze")


def test_a_robot_with_one_client_hides_whether_it_stands(robot: Address) -> None:
    class Jealous(DistantDriver):
        def __init__(self, address: Address) -> None:
            if address == robot:
                raise AccessDenied("Another server drives this robot. End that one first.")
            super().__init__(address)

    look = looking_at(Jealous, robot)
    look.lost("was cut", Proxy.cut)
    assert found(look) == []
    assert look.findings.notes["link"].startswith("whether it stands alone was not seen: Another")


# --- slow, and out of its mind


def test_a_stop_that_is_confirmed_before_it_arrives(robot: Address) -> None:
    class Hasty(DistantDriver):
        def stands(self) -> bool:
            return True  # the order to stop is under way

    look = looking_at(Hasty, robot)
    look.slow()
    assert found(look) == [
        "a stop was confirmed before it can have reached the robot over a slow link"
    ]


def test_a_slow_link_that_is_taken_for_a_lost_one(robot: Address) -> None:
    class Nervous(DistantDriver):
        silence = 0.2  # an answer takes twice that

    look = looking_at(Nervous, robot)
    look.slow()
    assert found(look) == [
        "battery: raised LostConnection, which is none of its errors",
        "a slow link counts as a lost one",
    ]


def test_nonsense_that_is_handed_on(robot: Address) -> None:
    class Gullible(DistantDriver):
        def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
            try:
                return super().call(method, arguments, stop)
            except RobotError:
                raise UnicodeDecodeError("utf-8", b"\xff", 0, 1, "invalid start byte") from None

    look = looking_at(Gullible, robot)
    look.garbled()
    assert "battery: raised UnicodeDecodeError when the robot answers nonsense" in found(look)


# --- two clients


def test_a_stop_that_stops_only_ones_own_calls(robot: Address) -> None:
    class Selfish(DistantDriver):
        def stands(self) -> bool:
            return True

    look = looking_at(Selfish, robot)
    look.two_clients()
    assert any(line.startswith("the robot moved on by") for line in found(look))


def test_another_client_without_a_voice(robot: Address) -> None:
    drivers: list[DistantDriver] = []

    class Second(DistantDriver):
        def __init__(self, address: Address) -> None:
            super().__init__(address)
            drivers.append(self)

        def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
            if method == "battery" and self is drivers[1]:
                raise RobotError("There is somebody already.")
            return super().call(method, arguments, stop)

    look = looking_at(Second, robot)
    look.two_clients()
    assert found(look) == ["battery: raised RobotError, which is none of its errors"]
