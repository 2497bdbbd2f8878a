"""Robots that are not there, as kinds: `sim` and `emulator`."""

from __future__ import annotations

from robot_api.driver import Driver
from robot_api.drivers import emulated, in_default_world
from robot_api.robots.registry import RobotKind, Setup


def _simulated(setup: Setup) -> Driver:
    return in_default_world(setup.sound)


def _emulated(setup: Setup) -> Driver:
    places = {place.name: place.kind for place in setup.places.named.values()}
    return emulated(places=places or None, sound=setup.sound)


SIM = RobotKind(
    scheme="sim",
    title="A robot in a simulated hospital",
    example="sim",
    connect=_simulated,
    shared=True,
)
EMULATOR = RobotKind(
    scheme="emulator",
    title="A robot that does nothing but log and answer, in no time",
    example="emulator",
    connect=_emulated,
    shared=True,
)
