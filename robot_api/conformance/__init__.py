"""The conformance suite: does anybody's driver do what the method table and the docs promise?

    for problem in check_driver(my_driver):
        print(problem)

    print(check_robot(connect, parse("ros2://192.168.1.20:9090")).table())

It calls everything that the driver declares, so give the robot room, or leave the movements out
with `move=False`. Nothing is left moving afterwards. docs/conformance.md says all that is checked.
"""

from __future__ import annotations

import contextlib

from robot_api.conformance.behaviour import (
    check_at_once,
    check_declared,
    check_events,
    check_methods,
    check_names,
    check_places,
)
from robot_api.conformance.killing import check_killed
from robot_api.conformance.limits import check_limits
from robot_api.conformance.link import Proxy
from robot_api.conformance.losing import Connect, check_link
from robot_api.conformance.report import Problem, Report, Row, State
from robot_api.conformance.stopping import check_stopping
from robot_api.conformance.subject import Findings, Subject, report
from robot_api.driver import Driver
from robot_api.errors import RobotError
from robot_api.robots.address import Address
from robot_api.robots.guardian import Order

__all__ = ["Connect", "Problem", "Proxy", "Report", "Row", "State", "check_driver", "check_robot"]


def check_driver(driver: Driver, *, move: bool = True) -> Report:
    """Everything that is wrong with the driver, and what was found of each capability.

    `move`: whether to call methods that move the body. The driver stays the caller's.
    """
    subject = Subject(driver, move, Findings())
    _look_at(subject)
    return report(subject)


def check_robot(
    connect: Connect, address: Address, *, move: bool = True, order: Order | None = None
) -> Report:
    """The same for the robot at an address, and what happens when it cannot be reached.

    `connect` makes a driver for an address; it is called several times, mostly with that of a
    `Proxy` that stands for the robot, so the address needs a port. One without a host, such as
    `sim`, has no link to be cut. `order` is how another process reaches the robot: that is killed
    while it drives. Raises what `connect` raises if the robot is not there at all.
    """
    driver = connect(address)
    subject = Subject(driver, move, Findings())
    try:
        _look_at(subject)
    finally:
        with contextlib.suppress(RobotError):
            driver.close()
    if address.host:
        check_link(connect, address, move, subject.findings)
        if order is not None and move:
            check_killed(connect, address, order, subject.findings)
    return report(subject)


def _look_at(subject: Subject) -> None:
    try:
        check_declared(subject)
        if subject.findings.problems:  # what is declared decides how the methods are called
            return
        check_methods(subject)
        check_names(subject)
        check_places(subject)
        check_limits(subject)
        check_stopping(subject)
        check_at_once(subject)
        check_events(subject)
    finally:
        subject.let_go()
