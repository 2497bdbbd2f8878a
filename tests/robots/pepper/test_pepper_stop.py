"""A stop of Pepper tells the truth."""

from __future__ import annotations

import subprocess
import time
from collections.abc import Callable
from typing import Any

import msgspec
import pytest

from robot_api.conformance.killing import COMMAND
from robot_api.driver import StopFlag
from robot_api.errors import StopNotConfirmed, Stopped
from robot_api.robots.address import parse
from robot_api.robots.guardian import Order
from robot_api.robots.pepper import PepperSettings
from robot_api.robots.registry import Setup
from tests.robots.pepper.conftest import MAP, PLACES, Call, call, until


@pytest.mark.parametrize(
    ("method", "arguments"),
    [
        ("goto", {"place": "pharmacy"}),
        ("move", {"metres": 3}),
        ("turn", {"degrees": 3600}),
        ("drive", {"linear": 0.2, "angular": 20, "seconds": 60}),
    ],
)
def test_whatever_it_drives_it_stands_when_the_stop_returns(
    standing_in: Callable[..., Any], drive: Callable[..., Any], method: str, arguments: Any
) -> None:
    pepper = standing_in(hurry=1.0)
    driver = drive(pepper)
    driving = Call(driver, method, **arguments)
    assert until(lambda: pepper.speed > 0.1)
    driving.stop.set()
    driver.stop("The nurse pressed stop.")
    assert pepper.speed < 0.001
    assert driving.over()
    assert isinstance(driving.error, Stopped)


@pytest.mark.parametrize(
    ("method", "arguments", "begun"),
    [
        ("say", {"text": "blah " * 300}, "blah"),
        ("gesture", {"name": "wave"}, "Hey_1"),
        ("joint", {"name": "HeadYaw", "degrees": 119}, "HeadYaw"),
    ],
)
def test_arms_and_voice_end_with_a_stop(
    standing_in: Callable[..., Any],
    drive: Callable[..., Any],
    method: str,
    arguments: Any,
    begun: str,
) -> None:
    pepper = standing_in(hurry=0.3)
    driver = drive(pepper)
    told: list[Any] = []
    driver.subscribe(lambda kind, data: told.append(data) if kind == "joint" else None)
    doing = Call(driver, method, **arguments)
    assert until(lambda: begun in f"{pepper.done} {pepper.texts}" or method == "joint")
    assert not doing.over(0.2)
    doing.stop.set()
    driver.stop("The nurse pressed stop.")
    assert doing.over()
    assert isinstance(doing.error, Stopped)
    assert {"stopMove", "killAll", "stopAll"} <= set(pepper.done)
    assert pepper.angles["HeadYaw"] == 0
    where_it_stands = [{"name": "HeadYaw", "degrees": 0.0}] if method == "joint" else []
    assert told == where_it_stands, "not where it should have gone"


def test_a_call_that_alone_is_called_off_stops_what_it_began(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    """Not the whole robot is stopped: a client has cancelled its own call. `qi` cannot take a plain
    call back, so Pepper has to be told."""
    pepper = standing_in(hurry=1.0)
    driver = drive(pepper)
    driving = Call(driver, "move", metres=3)
    assert until(lambda: pepper.speed > 0.1)
    driving.stop.set("Called off.")
    assert driving.over(1.0)
    assert isinstance(driving.error, Stopped)
    assert until(lambda: pepper.speed == 0)
    assert pepper.pose[0] < 1.5


def test_a_stop_never_waits_behind_what_is_under_way(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    """Speech, arms and wheels at once; what stops them goes out at once nevertheless."""
    pepper = standing_in(hurry=0.5, braking=1000)
    driver = drive(pepper)
    calls = [Call(driver, "say", text="blah " * 300), Call(driver, "move", metres=3)]
    assert until(lambda: pepper.speed > 0.1)
    began = time.monotonic()
    driver.stop("The nurse pressed stop.")
    assert time.monotonic() - began < 1.0
    for each in calls:
        each.stop.set()
        assert each.over()


def test_a_frozen_pepper_has_not_confirmed_that_it_stands(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in(hurry=1.0)
    driver = drive(pepper)
    driving = Call(driver, "move", metres=3)
    assert until(lambda: pepper.speed > 0.1)
    pepper.freeze()
    began = time.monotonic()
    with pytest.raises(StopNotConfirmed, match=r"Use the robot's own button\."):
        driver.stop("The nurse pressed stop.")
    within = driver.capabilities().stop_within
    assert time.monotonic() - began < within + 1.0
    driving.stop.set()
    assert driving.over(1.0)
    pepper.thaw()  # and hears it then
    assert until(lambda: pepper.speed == 0)
    assert pepper.pose[0] < 2.9


def test_a_pepper_that_says_it_goes_on_has_not_confirmed_it(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    """It answers, but its brakes hardly hold."""
    pepper = standing_in(hurry=1.0, braking=0.02)
    driver = drive(pepper)
    driving = Call(driver, "move", metres=5)
    assert until(lambda: pepper.speed > 0.2)
    driving.stop.set()
    with pytest.raises(StopNotConfirmed):
        driver.stop("The nurse pressed stop.")
    assert pepper.speed > 0
    pepper.set(braking=10)


def test_a_dead_pepper_has_not_confirmed_it_either(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in()
    driver = drive(pepper)
    pepper.kill()
    with pytest.raises(StopNotConfirmed):
        driver.stop("The nurse pressed stop.")


def test_a_program_goes_on_after_a_stop_of_its_own(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in()
    driver = drive(pepper)
    call(driver, "stop")
    call(driver, "say", text="I stand.")
    assert pepper.texts == ["I stand."]


def test_what_is_stopped_before_it_begins_does_not_begin(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in()
    driver = drive(pepper)
    flag = StopFlag()
    flag.set()
    with pytest.raises(Stopped):
        driver.call("move", {"metres": 1}, flag)
    assert pepper.pose == [0, 0, 0]


def test_of_a_server_that_is_killed_pepper_stands(standing_in: Callable[..., Any]) -> None:
    """Pepper alone would go on to where it was sent."""
    pepper = standing_in(hurry=1.0)
    setup = Setup(
        address=parse(f"pepper://127.0.0.1:{pepper.port}"),
        places=PLACES,
        settings=PepperSettings(map=MAP),
    )
    server = subprocess.Popen(COMMAND, stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0)
    assert server.stdin is not None and server.stdout is not None
    with server.stdin, server.stdout:
        server.stdin.write(msgspec.json.encode(Order.of(setup)) + b"\n")
        assert server.stdout.readline().startswith(b"moving ")
        server.kill()
        server.wait()
        assert until(lambda: pepper.speed < 0.001)
        assert not until(lambda: pepper.speed > 0.01, 0.5)
