"""Drivers: robots put together from capabilities.

    driver = simulated(Simulation(load_world("city-hospital")))
    driver = emulated(answers=["the pharmacy, please"], log=print)
    driver.call("goto", {"place": "pharmacy"}, StopFlag())

Both are a `ComposedDriver` (`robot_api.composed`). docs/drivers.md shows how to write a driver for
a robot.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from datetime import datetime
from typing import TYPE_CHECKING, Any, TypeVar

from robot_api import limits
from robot_api.capabilities.base import Capability, Hub
from robot_api.capabilities.company import EmulatedFollowing, EmulatedGuiding, SimulatedGuiding
from robot_api.capabilities.core import EmulatedCore, LogBook, SimulatedCore
from robot_api.capabilities.driving import EmulatedDock, EmulatedNavigation, SimulatedNavigation
from robot_api.capabilities.emulation import Emulation, InEmulation
from robot_api.capabilities.face import Face, ScreenFace
from robot_api.capabilities.hearing import EmulatedHearing, SimulatedHearing
from robot_api.capabilities.scanner import EmulatedScanner, SimulatedScanner
from robot_api.capabilities.screen import EmulatedScreen, Screen, SimulatedScreen
from robot_api.capabilities.simulation import InSimulation
from robot_api.capabilities.skills import EmulatedSkills
from robot_api.capabilities.sound import SILENT, Sound
from robot_api.capabilities.speech import EmulatedSpeech, SimulatedSpeech, Speech
from robot_api.capabilities.vision import EmulatedVision
from robot_api.composed import Call, ComposedDriver
from robot_api.driver import StopFlag
from robot_api.interfaces import INTERFACES, implementations
from robot_api.methods import CAPABILITIES
from robot_api.robots.robot_file import RobotFile
from robot_api.schema import find_method
from sim.world.loading import load_world

if TYPE_CHECKING:
    from sim.simulation import Simulation

__all__ = [
    "INTERFACES",
    "Call",
    "ComposedDriver",
    "EmulatedDriver",
    "SimulatedDriver",
    "emulated",
    "in_default_world",
    "simulated",
]

_World = TypeVar("_World")


# --- the emulator --------------------------------------------------------------------------------


class EmulatedDriver(ComposedDriver):
    """The robot that is not there; see `emulated`."""

    def __init__(
        self,
        emulation: Emulation,
        results: Mapping[str, Any],
        skills: Mapping[str, str],
        without: Collection[str],
        units: str,
        log: Callable[[str], None] | None,
        sound: Sound = SILENT,
    ) -> None:
        self.emulation = emulation
        self._results = {
            method: deque(result) if isinstance(result, list) else result
            for method, result in results.items()
        }
        for method in results:
            find_method(method)
        book = LogBook(emulation.now, emulation.hub, log)
        sound.publish_to(emulation.hub.forward)
        parts = [
            part
            for part in _emulated_parts(emulation, book, skills, without, sound)
            if part.name not in without
        ]
        screen = next((part for part in parts if isinstance(part, Screen)), None)
        if Face.name in without and screen is not None:
            parts.append(ScreenFace(screen, emulation.hub))
        super().__init__(
            name="The emulated robot",
            kind="emulator",
            parts=parts,
            hub=emulation.hub,
            book=book,
            units=units,
        )

    def _do(self, part: Capability, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
        canned = self._results.get(method)
        if isinstance(canned, deque):
            canned = canned.popleft() if canned else None
        if canned is None:
            return super()._do(part, method, arguments, stop)
        if isinstance(canned, BaseException):
            raise canned
        return canned


def emulated(
    answers: Iterable[str | None] = (),
    *,
    results: Mapping[str, Any] | None = None,
    places: Mapping[str, str] | None = None,
    questions: Mapping[str, str] | None = None,
    contacts: Sequence[str] | None = None,
    skills: Mapping[str, str] | None = None,
    without: Collection[str] = (),
    units: str = "m",
    speed: float | None = None,
    start: datetime | None = None,
    log: Callable[[str], None] | None = None,
    sound: Sound = SILENT,
) -> EmulatedDriver:
    """A robot that does nothing but log and answer, for testing programs without one.

    It succeeds at everything, remembers where it was sent, what it holds and what its screen shows,
    and takes no real time, unless told otherwise:

    - `answers`: what people say, touch and hold to the scanner, in order; None is silence. After
      the last, they take the first option, or say "yes".
    - `results`: what methods return, for example {"battery": 9, "sees": [False, True], "goto":
      Blocked("...")}; of a list one after the other, then as usual; errors are raised.
    - `places`: names with their kinds; without it, any place exists. `questions`: predefined
      questions with their answers. `contacts`, `skills` (with a line about each).
    - `without`: capabilities that it lacks, such as "manipulation".
    - `units`: "m" or "cm", what the paper's message style counts in (`robot_api.messages`).
    - `speed`: emulated seconds pass at this multiple of real time.
    - `start`: its date and time at the start. `log`: gets each line of the log.
    - `sound`: a loudspeaker to be heard on, ears that hear real people instead of `answers`.
    """
    emulation = Emulation(answers, places, questions, contacts, speed, start)
    known = skills if skills is not None else {"sit": "sit down", "dance": "dance a little"}
    return EmulatedDriver(emulation, results or {}, known, without, units, log, sound)


def _emulated_parts(
    emulation: Emulation,
    book: LogBook,
    skills: Mapping[str, str],
    without: Collection[str],
    sound: Sound,
) -> list[Capability]:
    speech = EmulatedSpeech(emulation, sound) if Speech.name not in without else None
    screen = EmulatedScreen(emulation, speech) if Screen.name not in without else None
    navigation = EmulatedNavigation(emulation)
    parts: list[Capability | None] = [
        EmulatedCore(emulation, book),
        speech,
        EmulatedHearing(emulation, speech, screen, sound),
        navigation,
        EmulatedDock(emulation, navigation),
        EmulatedScanner(emulation, speech),
        screen,
        EmulatedVision(emulation, navigation),
        EmulatedFollowing(emulation, navigation),
        EmulatedGuiding(navigation),
        EmulatedSkills(emulation, skills),
    ]
    return _with_others(parts, implementations(InEmulation), emulation, without)


def _with_others(
    parts: Iterable[Capability | None],
    known: Mapping[str, Callable[[_World], Capability]],
    world: _World,
    without: Collection[str] = (),
) -> list[Capability]:
    """These capabilities and all others that are known, which need nothing but the world that they
    are in; in the order of the table."""
    made = {part.name: part for part in parts if part is not None}
    others = {
        name: kind(world)
        for name, kind in known.items()
        if name not in made and name not in without
    }
    return [each for name in CAPABILITIES if (each := (made | others).get(name)) is not None]


# --- the simulator -------------------------------------------------------------------------------


class SimulatedDriver(ComposedDriver):
    """A robot in a `sim.simulation.Simulation`; see `simulated`."""

    def __init__(self, simulation: Simulation, sound: Sound = SILENT) -> None:
        self.simulation = simulation
        hub = Hub()
        book = LogBook(simulation.clock, hub)
        self._unsubscribe = simulation.subscribe(hub.forward)
        sound.publish_to(hub.forward)
        super().__init__(
            name="The simulated robot",
            kind="simulator",
            parts=_simulated_parts(simulation, book, sound),
            hub=hub,
            book=book,
            units=simulation.world.units,
            publish=simulation.emit,
        )

    def copy(self) -> SimulatedDriver:
        """A driver of a copy of the simulation as it is now, to try a program out on, silently."""
        return SimulatedDriver(self.simulation.copy())

    def hold(self, file: RobotFile) -> None:
        super().hold(file)
        self.simulation.limit_pace(**limits.pace(self.capabilities()))

    def begin(self) -> None:
        """A new program begins: whom another program met by `wait_for` is met anew."""
        self.simulation.forget_met()

    def close(self) -> None:
        super().close()
        self._unsubscribe()
        self.simulation.close()


def simulated(simulation: Simulation, sound: Sound = SILENT) -> SimulatedDriver:
    """A robot in that simulation, with all methods of the table; with `sound` it is heard, and
    hears real or simulated people. Closing it closes the simulation."""
    return SimulatedDriver(simulation, sound)


def in_default_world(sound: Sound = SILENT) -> SimulatedDriver:
    """A simulated robot for who wants no world of their own."""
    from sim.simulation import Simulation

    return simulated(Simulation(load_world("city-hospital")), sound)


def _simulated_parts(simulation: Simulation, book: LogBook, sound: Sound) -> list[Capability]:
    speech = SimulatedSpeech(simulation, sound)
    screen = SimulatedScreen(simulation, speech)
    navigation = SimulatedNavigation(simulation)
    parts = (
        SimulatedCore(simulation, book),
        speech,
        SimulatedHearing(simulation, speech, screen, sound),
        navigation,
        SimulatedScanner(simulation, speech),
        screen,
        SimulatedGuiding(simulation, navigation),
    )
    return _with_others(parts, implementations(InSimulation), simulation)
