"""Going with people: `follow` (following), `guide` (guiding)."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING

from robot_api.capabilities.base import Capability
from robot_api.capabilities.emulation import Emulation, InEmulation
from robot_api.capabilities.languages import language_data
from robot_api.capabilities.simulation import InSimulation
from robot_api.driver import StopFlag
from robot_api.values import Location

if TYPE_CHECKING:
    from robot_api.capabilities.driving import Navigation
    from robot_api.capabilities.speech import Speech
    from sim.simulation import Simulation


class Following(Capability):
    """Going after a person."""

    name = "following"
    lacking = "cannot follow people"

    @abstractmethod
    def follow(self, stop: StopFlag, person: str, to: str | None) -> None: ...


class Guiding(Capability):
    """Leading a person."""

    name = "guiding"
    lacking = "cannot tell whether somebody comes along"

    @abstractmethod
    def guide(self, stop: StopFlag, person: str, place: str | Location) -> None: ...


class EmulatedFollowing(InEmulation, Following):
    """The person goes straight to where they are followed to, or is soon there."""

    def __init__(self, emulation: Emulation, navigation: Navigation) -> None:
        super().__init__(emulation)
        self._navigation = navigation

    def follow(self, stop: StopFlag, person: str, to: str | None) -> None:
        if to is not None:
            self._navigation.goto(stop, to)
        else:
            self.emulation.pass_time(10.0, stop)


class EmulatedGuiding(Guiding):
    """The person comes along."""

    def __init__(self, navigation: Navigation) -> None:
        self._navigation = navigation

    def guide(self, stop: StopFlag, person: str, place: str | Location) -> None:
        self._navigation.goto(stop, place)


class LeadingGuiding(Guiding):
    """Asks to be followed and goes ahead, for robots that cannot see who comes along."""

    stand_in = "going ahead, without looking whether somebody comes along"

    def __init__(self, navigation: Navigation, speech: Speech) -> None:
        self._navigation = navigation
        self._speech = speech

    def guide(self, stop: StopFlag, person: str, place: str | Location) -> None:
        goal = self._navigation.goal(place)  # or nobody is asked to come along
        self._speech.say(stop, language_data(self._speech.language).follow_me)
        self._navigation.drive_to(stop, goal)


class SimulatedFollowing(InSimulation, Following):
    def follow(self, stop: StopFlag, person: str, to: str | None) -> None:
        where = None if to is None else self.place(to)
        self.run(self.simulation.follow(person, where), stop)


class SimulatedGuiding(InSimulation, Guiding):
    def __init__(self, simulation: Simulation, navigation: Navigation) -> None:
        super().__init__(simulation)
        self._navigation = navigation

    def guide(self, stop: StopFlag, person: str, place: str | Location) -> None:
        goal = self._navigation.goal(place)
        self.run(self.simulation.guide(person, goal.x, goal.y, goal.theta), stop)
