"""A robot behind a server of ours, through `ws://`, passes like any other."""

from __future__ import annotations

from robot_api.checker import check_robot
from robot_api.driver import Driver
from robot_api.robots.address import Address
from robot_api.robots.registry import Setup
from robot_api.robots.wire import SERVER
from tests.robot_api.conformance.distant import ward


def connect(address: Address) -> Driver:
    return SERVER.connect(Setup(address=address))


def test_a_robot_behind_a_server_of_ours_conforms() -> None:
    with ward(speed=50) as address:
        report = check_robot(connect, address)
    assert report == []
    states = {row.part: row.state for row in report.rows}
    assert set(states.values()) == {"works"}
    assert {"link", "two clients", "limits"} <= set(states)
