"""Driving: navigation (`goto`, `location`, `localize`), motion (`move`, `turn`, `drive`) and
`dock`."""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import dataclass

from robot_api.capabilities.base import Capability
from robot_api.capabilities.emulation import Emulation, InEmulation
from robot_api.capabilities.names import one_of, unknown_place
from robot_api.capabilities.simulation import InSimulation, robot_errors
from robot_api.driver import StopFlag
from robot_api.errors import InvalidCall, NotPossible
from robot_api.values import Location

_SPEED = 0.7
"""Metres per second at which the emulator drives."""
_TURN_RATE = 60.0
"""Degrees per second at which it turns."""


@dataclass(frozen=True)
class Goal:
    """Where to drive: metres, degrees."""

    x: float
    y: float
    theta: float | None = None
    """Which way to face at the end; None for any."""
    place: str | None = None
    """The place's name, if it was given by that."""


class Navigation(Capability):
    """A map, and the knowledge of where on it the robot is."""

    name = "navigation"
    lacking = "cannot find its way on a map"

    @abstractmethod
    def locate(self, place: str) -> Goal:
        """Where the place of that name or alias is. Raises `UnknownPlace`."""

    @abstractmethod
    def drive_to(self, stop: StopFlag, goal: Goal) -> None:
        """Drive there; returns on arrival. Raises `Blocked`, `NotPossible`."""

    @abstractmethod
    def location(self, stop: StopFlag) -> Location: ...

    @abstractmethod
    def believe(self, goal: Goal) -> None:
        """Take it for true that the robot is there."""

    def goto(
        self,
        stop: StopFlag,
        place: str | Location | None = None,
        x: float | None = None,
        y: float | None = None,
        theta: float | None = None,
    ) -> None:
        self.drive_to(stop, self.goal(place, x, y, theta))

    def localize(
        self,
        stop: StopFlag,
        place: str | Location | None = None,
        x: float | None = None,
        y: float | None = None,
        theta: float | None = None,
    ) -> None:
        self.believe(self.goal(place, x, y, theta))

    def goal(
        self,
        place: str | Location | None,
        x: float | None = None,
        y: float | None = None,
        theta: float | None = None,
    ) -> Goal:
        """The goal of a call in any of its forms."""
        if isinstance(place, Location):
            return Goal(place.x, place.y, place.theta, place.place)
        if place is not None:
            return self.locate(place)
        if x is None or y is None:
            raise InvalidCall("I do not know where that is. Name a place, or give x and y.")
        return Goal(x, y, theta)


class Motion(Capability):
    """Wheels."""

    name = "motion"
    lacking = "cannot drive"

    @abstractmethod
    def move(self, stop: StopFlag, metres: float) -> None: ...

    @abstractmethod
    def turn(self, stop: StopFlag, degrees: float) -> None: ...

    @abstractmethod
    def drive(self, stop: StopFlag, linear: float, angular: float, seconds: float) -> None: ...


class Dock(Capability):
    """A charging station to drive to."""

    name = "dock"
    lacking = "has no charging station that it could find by itself"

    @abstractmethod
    def dock(self, stop: StopFlag) -> None: ...


# --- emulated ------------------------------------------------------------------------------------


class EmulatedNavigation(InEmulation, Navigation):
    """Arrives wherever it is sent. Unless it was given places, it believes in any."""

    def locate(self, place: str) -> Goal:
        known = one_of(place, self.emulation.places)
        if known is None:
            if not self.emulation.any_place:
                raise unknown_place(place, {name: name for name in self.emulation.places})
            self.emulation.places[place] = place.split()[-1]
            known = place
        # Places stand in a row, so that each is somewhere else.
        return Goal(4.0 * list(self.emulation.places).index(known), 0.0, 0.0, known)

    def drive_to(self, stop: StopFlag, goal: Goal) -> None:
        here = self.emulation.location
        metres = math.hypot(goal.x - here.x, goal.y - here.y)
        self.emulation.pass_time(metres / _SPEED, stop)
        self.believe(goal)

    def believe(self, goal: Goal) -> None:
        theta = self.emulation.location.theta if goal.theta is None else goal.theta
        self.emulation.stand_at(Location(goal.x, goal.y, theta, goal.place))

    def location(self, stop: StopFlag) -> Location:
        return self.emulation.location


class EmulatedMotion(InEmulation, Motion):
    """Adds the distances up and meets no obstacle."""

    def move(self, stop: StopFlag, metres: float) -> None:
        self.emulation.pass_time(abs(metres) / _SPEED, stop)
        self._advance(metres, 0.0)

    def turn(self, stop: StopFlag, degrees: float) -> None:
        self.emulation.pass_time(abs(degrees) / _TURN_RATE, stop)
        self._advance(0.0, degrees)

    def drive(self, stop: StopFlag, linear: float, angular: float, seconds: float) -> None:
        self.emulation.pass_time(seconds, stop)
        self._advance(linear * seconds, angular * seconds)

    def _advance(self, metres: float, degrees: float) -> None:
        here = self.emulation.location
        heading = math.radians(here.theta + degrees / 2)
        self.emulation.stand_at(
            Location(
                here.x + metres * math.cos(heading),
                here.y + metres * math.sin(heading),
                (here.theta + degrees + 180.0) % 360.0 - 180.0,
                here.place if metres == 0 else None,
            )
        )


class EmulatedDock(InEmulation, Dock):
    def __init__(self, emulation: Emulation, navigation: EmulatedNavigation) -> None:
        super().__init__(emulation)
        self._navigation = navigation

    def dock(self, stop: StopFlag) -> None:
        kinds = {kind: name for name, kind in self.emulation.places.items()}
        if "charger" not in kinds:
            raise NotPossible("There is no charging station here. Send me to a place instead.")
        self._navigation.drive_to(stop, self._navigation.locate(kinds["charger"]))
        self.emulation.battery = 100.0
        self.emulation.publish("battery", percent=100, charging=True)


# --- simulated -----------------------------------------------------------------------------------


class SimulatedNavigation(InSimulation, Navigation):
    def locate(self, place: str) -> Goal:
        name = self.place(place)
        with robot_errors():
            x, y, theta = self.simulation.locate(name)
        return Goal(x, y, theta, name)

    def drive_to(self, stop: StopFlag, goal: Goal) -> None:
        self.run(self.simulation.drive_to(goal.x, goal.y, goal.theta), stop)

    def location(self, stop: StopFlag) -> Location:
        robot = self.simulation.robot
        return Location(robot.x, robot.y, robot.theta, robot.place)

    def believe(self, goal: Goal) -> None:
        theta = self.simulation.robot.theta if goal.theta is None else goal.theta
        with robot_errors():
            self.simulation.localize(goal.x, goal.y, theta)


class SimulatedMotion(InSimulation, Motion):
    def move(self, stop: StopFlag, metres: float) -> None:
        self.run(self.simulation.move(metres), stop)

    def turn(self, stop: StopFlag, degrees: float) -> None:
        self.run(self.simulation.turn(degrees), stop)

    def drive(self, stop: StopFlag, linear: float, angular: float, seconds: float) -> None:
        self.run(self.simulation.drive(linear, angular, seconds), stop)


class SimulatedDock(InSimulation, Dock):
    def dock(self, stop: StopFlag) -> None:
        self.run(self.simulation.dock(), stop)
