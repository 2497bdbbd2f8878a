"""Pepper is lost, and found again."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

import pytest

from robot_api.errors import LostConnection
from robot_api.robots.pepper.session import BEAT, SILENT_AFTER
from tests.robots.pepper.conftest import Call, call, until


class Links:
    """What is told of the link."""

    def __init__(self, driver: Any) -> None:
        self.told: list[tuple[str, str]] = []
        driver.subscribe(self._hear)

    def _hear(self, kind: str, data: Any) -> None:
        if kind == "link":
            self.told.append((data["state"], data["because"]))

    @property
    def states(self) -> list[str]:
        return [state for state, _ in self.told]


def test_a_pepper_that_is_switched_off_is_lost_at_once(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in()
    driver = drive(pepper)
    links = Links(driver)
    driving = Call(driver, "say", text="blah " * 300)
    assert until(lambda: pepper.texts)
    pepper.kill()
    assert driving.over(2.0)
    assert isinstance(driving.error, LostConnection)
    assert until(lambda: links.told, 2.0)
    assert links.told == [("lost", "The connection to Pepper was cut.")]
    with pytest.raises(LostConnection, match="switched on and in the network"):
        call(driver, "battery")


def test_switched_on_again_it_is_found_and_nothing_is_resumed(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in()
    driver = drive(pepper)
    links = Links(driver)
    pepper.kill()
    assert until(lambda: links.states == ["lost"])
    pepper.again()
    assert until(lambda: links.states == ["lost", "connected"])
    assert pepper.texts == []
    assert sorted(pepper.done) == ["killAll", "load map", "stopAll", "stopMove"]
    assert call(driver, "battery") == 87
    assert call(driver, "location").place == "lobby"  # it has its map again
    call(driver, "say", text="Here I am again.")
    assert pepper.texts == ["Here I am again."]
    asking = Call(driver, "touch", options=["yes", "no"])
    assert until(lambda: pepper.touch("no"))  # the tablet is listened to again as well
    assert asking.over()
    assert asking.result == "no"


def test_a_frozen_pepper_is_lost_and_found_when_it_thaws(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in(hurry=1.0)
    driver = drive(pepper)
    links = Links(driver)
    driving = Call(driver, "move", metres=3)
    assert until(lambda: pepper.speed > 0.1)
    pepper.freeze()
    began = time.monotonic()
    assert driving.over(BEAT + SILENT_AFTER + 2)
    assert time.monotonic() - began > SILENT_AFTER / 2
    assert isinstance(driving.error, LostConnection)
    assert links.told == [("lost", "Pepper has not answered for 1.5 seconds.")]
    pepper.thaw()
    assert until(lambda: links.states == ["lost", "connected"])
    assert pepper.speed < 0.001  # it was told to stand before anything else
    assert pepper.pose[0] < 2.9


def test_it_is_not_found_before_it_stands(
    standing_in: Callable[..., Any], drive: Callable[..., Any], network: Callable[..., Any]
) -> None:
    pepper = standing_in(hurry=0.3, braking=0.001)
    way = network(pepper)
    driver = drive(way)
    links = Links(driver)
    driving = Call(driver, "move", metres=5)
    assert until(lambda: pepper.speed > 0.05)
    way.cut()
    assert driving.over()
    way.mend()
    assert until(lambda: "stopMove" in pepper.done)
    assert links.states == ["lost"]
    pepper.set(braking=10)
    assert until(lambda: links.states == ["lost", "connected"])


def test_a_robot_that_knows_where_it_is_is_not_made_to_look_again(
    standing_in: Callable[..., Any], drive: Callable[..., Any], network: Callable[..., Any]
) -> None:
    """Loading the map anew would lose the place that it has found on it."""
    pepper = standing_in()
    way = network(pepper)
    driver = drive(way)
    links = Links(driver)
    way.cut()
    assert until(lambda: links.states == ["lost"])
    way.mend()
    assert until(lambda: links.states == ["lost", "connected"])
    assert pepper.done.count("load map") == 1


def test_two_servers_do_not_drive_one_pepper(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    from robot_api.errors import AccessDenied

    pepper = standing_in()
    first = drive(pepper)
    with pytest.raises(AccessDenied, match="already drives this Pepper"):
        drive(pepper)
    call(first, "say", text="I am still here.")
    first.close()
    assert call(drive(pepper), "battery") == 87


def test_closed_it_says_so(standing_in: Callable[..., Any], drive: Callable[..., Any]) -> None:
    driver = drive(standing_in())
    driver.close()
    with pytest.raises(LostConnection):
        call(driver, "battery")


LEAVES = """
import sys, threading
from robot_api.driver import StopFlag
from robot_api.robots.address import parse
from robot_api.robots.pepper import PEPPER
from robot_api.robots.registry import Setup

driver = PEPPER.connect(Setup(address=parse(sys.argv[1])))
begun = threading.Event()
driver.subscribe(lambda kind, data: begun.set() if kind == "speech" else None)
said = ("say", {"text": "blah " * 300}, StopFlag())
threading.Thread(target=driver.call, args=said, daemon=True).start()
assert begun.wait(10)
"""


def test_who_ends_without_letting_go_of_it_ends_well(standing_in: Callable[..., Any]) -> None:
    """A session of `qi` that outlives Python takes it down with a segmentation fault."""
    pepper = standing_in()
    address = f"pepper://127.0.0.1:{pepper.port}"
    ended = subprocess.run([sys.executable, "-c", LEAVES, address], timeout=60, check=False)
    assert ended.returncode == 0
