"""A server that is killed, or frozen, leaves a robot standing: its guardian sees to that."""

from __future__ import annotations

import dataclasses
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

import msgspec
import pytest

from robot_api.conformance.killing import COMMAND, PART, check_killed
from robot_api.conformance.subject import Findings
from robot_api.errors import LostConnection
from robot_api.robots.address import parse
from robot_api.robots.guardian import Guardian, Order
from robot_api.robots.places import Places
from robot_api.robots.registry import Setup, kind_of
from robot_api.robots.robot_file import RobotFile
from robot_api.robots.ros.settings import RosSettings, Topics
from tests.robots.ros.stand_in import StandIn
from tests.robots.ros.ward import WARD

both = pytest.mark.parametrize("version", [1, 2])
SOON = 30.0


def order_for(robot: StandIn) -> Order:
    address = parse(f"ros{robot.version}://127.0.0.1:{robot.port}")
    return Order.of(Setup(address=address, places=Places(WARD)))


@contextmanager
def driven(robot: StandIn) -> Iterator[subprocess.Popen[bytes]]:
    """Another process sends the robot to the far end, with a guardian beside it."""
    server = subprocess.Popen(COMMAND, stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0)
    assert server.stdin is not None and server.stdout is not None
    try:
        server.stdin.write(msgspec.json.encode(order_for(robot)) + b"\n")
        assert server.stdout.readline() == b"moving goto\n"
        robot.until(lambda: robot.body.speed > 0.3)
        yield server
    finally:
        server.kill()
        server.wait()
        server.stdin.close()
        server.stdout.close()


@both
def test_of_a_server_that_is_killed_the_robot_stands(version) -> None:
    """Nav2 and move_base alone would drive on to the goal."""
    with StandIn(version, speed=0.5) as robot, driven(robot) as server:
        server.kill()
        robot.until(lambda: robot.stands and robot.goal is None, within=5)
        assert robot.body.x < 10


def test_of_a_server_that_is_frozen_too_and_it_may_go_on_when_it_wakes_up() -> None:
    with StandIn(speed=0.5) as robot, driven(robot) as server:
        server.send_signal(signal.SIGSTOP)
        try:
            robot.until(lambda: robot.stands and robot.goal is None, within=8)
        finally:
            server.send_signal(signal.SIGCONT)
        robot.at_the_robot(lambda: robot.pursue(robot.body.x + 30, 0))
        robot.until(lambda: robot.body.speed > 0.3)
        server.kill()  # and it is watched over as before
        robot.until(lambda: robot.stands and robot.goal is None, within=5)


@contextmanager
def guarded(order: Order) -> Iterator[Guardian]:
    guardian = Guardian(order)
    try:
        assert guardian.watches(SOON)
        yield guardian
    finally:
        guardian.close()


def test_who_says_goodbye_left_it_standing() -> None:
    """What moves the robot then is somebody else."""
    with StandIn(speed=0.5) as robot:
        with guarded(order_for(robot)):
            robot.at_the_robot(lambda: robot.pursue(30, 0))
            robot.until(lambda: robot.body.speed > 0.3)
        robot.until(lambda: robot.connections == 0)
        assert robot.goal is not None


def test_a_guardian_that_dies_is_followed_by_another(monkeypatch) -> None:
    monkeypatch.setattr("robot_api.robots.guardian._ANEW", 0.0)
    with StandIn() as robot, guarded(order_for(robot)) as guardian:
        first = guardian._process
        os.kill(first.pid, signal.SIGKILL)
        while guardian._process is first or not guardian.watches(SOON):
            time.sleep(0.01)
        assert guardian._process.poll() is None


def test_whom_it_does_not_reach_is_told_of(monkeypatch, caplog) -> None:
    monkeypatch.setattr("robot_api.robots.guardian.REACHES_WITHIN", 0.0)
    with StandIn() as robot:
        order = order_for(robot)
    guardian = Guardian(order)  # of a robot that was switched off
    try:
        while "does not reach the robot" not in caplog.text:
            time.sleep(0.01)
    finally:
        guardian.close()
    assert caplog.text.count("does not reach the robot") == 1


def test_neither_ctrl_c_nor_a_terminate_takes_it_away_from_the_robot() -> None:
    with StandIn() as robot, guarded(order_for(robot)) as guardian:
        for number in (signal.SIGINT, signal.SIGTERM):
            guardian._process.send_signal(number)
        with pytest.raises(subprocess.TimeoutExpired):
            guardian._process.wait(0.5)


def test_an_order_says_all_that_the_robot_file_said() -> None:
    setup = Setup(
        address=parse("ros2://porter@robot.ward:9091"),
        file=RobotFile(name="Otto", gestures={"wave": "wave_hand"}),
        settings=RosSettings(topics=Topics(velocity="/base/cmd_vel")),
        places=Places(WARD),
        password="a secret",
    )
    order = msgspec.json.decode(msgspec.json.encode(Order.of(setup)), type=Order)
    kind, again = order.setup()
    assert kind.scheme == "ros2"
    assert dataclasses.replace(again, places=setup.places) == setup
    assert again.places.named == setup.places.named


# --- the conformance suite ------------------------------------------------------------------------

UNGUARDED = """
import dataclasses
from robot_api.conformance import killing
from robot_api.robots import ros
ros.ROS2 = dataclasses.replace(ros.ROS2, brake=None)
killing.main()
"""


def findings_of(robot: StandIn, *command: str) -> Findings:
    findings, order = Findings(), order_for(robot)
    address = parse(order.address)

    def connect(address):
        return kind_of(address).connect(Setup(address=address, places=Places(WARD)))

    check_killed(connect, address, order, findings, command or COMMAND)
    return findings


def test_the_suite_kills_a_server_and_sees_the_robot_stand() -> None:
    with StandIn(speed=0.5) as robot:
        findings = findings_of(robot)
        assert PART in findings.tried and not findings.problems


def test_the_suite_sees_a_robot_that_drives_on() -> None:
    with StandIn(speed=0.5) as robot:
        [problem] = findings_of(robot, sys.executable, "-c", UNGUARDED).problems
        assert "s after its server was killed in the middle of goto" in problem.message
        robot.at_the_robot(lambda: setattr(robot, "goal", None))


def test_a_robot_that_is_not_there_is_no_fault_of_its_own() -> None:
    with StandIn() as robot:
        order = order_for(robot)
    findings = Findings()

    def connect(address):
        raise LostConnection("There is nobody.")

    check_killed(connect, parse(order.address), order, findings)
    assert not findings.problems and PART not in findings.tried
    assert findings.notes[PART]
