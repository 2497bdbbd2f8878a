"""Drivers: robots put together from capabilities.

    driver = simulated(Simulation(load_world("city-hospital")))
    driver = emulated(answers=["the pharmacy, please"], log=print)
    driver.call("goto", {"place": "pharmacy"}, StopFlag())

`ComposedDriver` is all that a robot needs around its capabilities: it hands each call to the
capability that the method table names for it, lets one movement happen at a time, wakes the calls
in flight on a stop, and keeps the log. docs/drivers.md shows how to write a driver for a robot.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime
from typing import TYPE_CHECKING, Any

from robot_api.capabilities.arms import (
    EmulatedGesture,
    EmulatedJoints,
    Gesture,
    Joints,
    SimulatedGesture,
    SimulatedJoints,
)
from robot_api.capabilities.base import Capability, Hub, Listener
from robot_api.capabilities.company import (
    EmulatedFollowing,
    EmulatedGuiding,
    Following,
    Guiding,
    SimulatedFollowing,
    SimulatedGuiding,
)
from robot_api.capabilities.core import Core, EmulatedCore, LogBook, SimulatedCore
from robot_api.capabilities.driving import (
    Dock,
    EmulatedDock,
    EmulatedMotion,
    EmulatedNavigation,
    Motion,
    Navigation,
    SimulatedDock,
    SimulatedMotion,
    SimulatedNavigation,
)
from robot_api.capabilities.emulation import Emulation
from robot_api.capabilities.face import EmulatedFace, Face, ScreenFace, SimulatedFace
from robot_api.capabilities.hearing import EmulatedHearing, Hearing, SimulatedHearing
from robot_api.capabilities.manipulation import (
    EmulatedManipulation,
    Manipulation,
    SimulatedManipulation,
)
from robot_api.capabilities.scanner import EmulatedScanner, Scanner, SimulatedScanner
from robot_api.capabilities.screen import EmulatedScreen, Screen, SimulatedScreen
from robot_api.capabilities.skills import EmulatedSkills, SimulatedSkills, Skills
from robot_api.capabilities.sound import SILENT, Sound
from robot_api.capabilities.speech import EmulatedSpeech, SimulatedSpeech, Speech
from robot_api.capabilities.tablet import Tablet
from robot_api.capabilities.telepresence import (
    EmulatedTelepresence,
    SimulatedTelepresence,
    Telepresence,
)
from robot_api.capabilities.vision import EmulatedVision, SimulatedVision, Vision
from robot_api.driver import Capabilities, StopFlag
from robot_api.errors import InternalError, LostConnection, NotPossible, NotSupported, RobotError
from robot_api.methods import METHODS, Method
from robot_api.schema import find_method, read_arguments

if TYPE_CHECKING:
    from sim.simulation import Simulation

INTERFACES: Mapping[str, type[Capability]] = {
    interface.name: interface
    for interface in (
        Core,
        Speech,
        Hearing,
        Navigation,
        Motion,
        Dock,
        Face,
        Gesture,
        Joints,
        Telepresence,
        Scanner,
        Screen,
        Vision,
        Manipulation,
        Following,
        Guiding,
        Skills,
    )
}
"""The interface of each capability in the method table."""

_JOYSTICK = "drive"
"""The one movement that a newer call of itself takes over from."""


@dataclass(frozen=True)
class Call:
    """A call that a driver was asked for, and what came of it."""

    method: str
    arguments: Mapping[str, Any]
    result: Any = None
    error: BaseException | None = None


class ComposedDriver:
    """A robot made of capabilities; a `robot_api.driver.Driver`.

    `parts` are its capabilities, `Core` among them. `hub` hands out the events that they publish.
    `publish(kind, data)` takes the driver's own events, if not the hub. Any thread may call any of
    it.
    """

    def __init__(
        self,
        *,
        name: str,
        kind: str,
        parts: Iterable[Capability],
        hub: Hub,
        book: LogBook,
        units: str = "m",
        publish: Callable[[str, dict[str, Any]], None] | None = None,
        link: Any = None,
    ) -> None:
        self._parts = {part.name: part for part in parts}
        core = self._parts.get(Core.name)
        if not isinstance(core, Core):
            raise TypeError("A driver needs a Core among its parts.")
        self._core = core
        self._hub = hub
        self._book = book
        self._publish = publish or hub.forward
        self._offered = {method: part for part in self._parts.values() for method in part.offers()}
        declared = {
            field: value
            for part in self._parts.values()
            for field, value in part.declares().items()
        }
        self._capabilities = Capabilities(
            name=name,
            kind=kind,
            units=units,
            methods=tuple(method for method in METHODS if method in self._offered),
            **declared,
        )
        self._lock = threading.Lock()  # for what follows
        self._in_flight: list[StopFlag] = []
        self._movements: list[str] = []
        self._calls: deque[Call] = deque(maxlen=10_000)
        self._closed = False

    # --- the interface of a driver ---------------------------------------------------------------

    def capabilities(self) -> Capabilities:
        return self._capabilities

    def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
        """Do it; see `Driver.call`. Defaults that are left out are filled in."""
        stop.check()
        row = find_method(method)
        part = self._part(row)
        complete = read_arguments(method, (), arguments)
        self._book.write(f"{method}({_spelled(complete)})")
        try:
            with self._flying(stop), self._moving(row):
                result = self._do(part, method, complete, stop)
        except RobotError as error:
            self._book.write(f"{method}: {type(error).__name__}: {error}", "warning")
            self._remember(Call(method, complete, error=error))
            raise
        except Exception as error:  # a fault in a capability must not take the server down
            self._book.write(f"{method}: {type(error).__name__}: {error}", "error")
            self._remember(Call(method, complete, error=error))
            raise InternalError(
                f"The robot's own software failed at '{method}'. "
                "Tell whoever looks after the robot; its log has the details."
            ) from error
        except BaseException as error:
            self._book.write(f"{method}: stopped")
            self._remember(Call(method, complete, error=error))
            raise
        if result is not None:
            self._book.write(f"{method}: {_short(result)}")
        self._remember(Call(method, complete, result))
        return result

    def stop(self, because: str) -> None:
        """Wake every call in flight, which then raises `Stopped`, and bring the body to rest."""
        self._stop_others(None, because)

    def subscribe(self, listener: Listener) -> Callable[[], None]:
        return self._hub.subscribe(listener)

    def attach(self, tablet: Tablet) -> None:
        """Give the robot a real tablet: what it shows is seen there, and who stands there answers
        in place of simulated people."""
        for part in self._parts.values():
            part.tablet = tablet

    def close(self) -> None:
        """Stop, and let go of the robot. Later calls raise `LostConnection`."""
        with self._lock:
            if self._closed:
                return
            self._closed = True
        self.stop("The robot is being switched off.")

    # --- looking back ----------------------------------------------------------------------------

    @property
    def calls(self) -> Sequence[Call]:
        """The calls that ended, the last 10,000 of them, in the order in which they ended."""
        with self._lock:
            return tuple(self._calls)

    # --- inside ----------------------------------------------------------------------------------

    def _stop_others(self, mine: StopFlag | None, because: str) -> None:
        with self._lock:
            flags = [flag for flag in self._in_flight if flag is not mine]
        for flag in flags:
            flag.set(because)
        self._core.rest()
        self._book.write(f"stopped: {because}")
        self._publish("stopped", {"because": because})

    def _part(self, method: Method) -> Capability:
        part = self._offered.get(method.name)
        if part is None:
            lacking = INTERFACES[method.capability].lacking
            if method.capability in self._parts:
                lacking = "was built without it"
            raise NotSupported(
                f"{self._capabilities.name} cannot do '{method.name}': it {lacking}. "
                "Leave that step out, or use a robot that can."
            )
        return part

    def _do(self, part: Capability, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
        if method == "stop":
            # The call that stops the others is not stopped itself: a program may go on after it.
            self._stop_others(stop, "The robot was told to stop.")
            return None
        return getattr(part, method)(stop, **arguments)

    @contextmanager
    def _flying(self, stop: StopFlag) -> Iterator[None]:
        """The call is in flight; whoever stops the robot sets its flag."""
        with self._lock:
            if self._closed:
                raise LostConnection("The robot is switched off. Start it again.")
            self._in_flight.append(stop)
        try:
            yield
        finally:
            with self._lock:
                self._in_flight.remove(stop)

    @contextmanager
    def _moving(self, method: Method) -> Iterator[None]:
        """If the method moves the body: it has the body to itself."""
        if not method.moves:
            yield
            return
        with self._lock:
            if any({other, method.name} != {_JOYSTICK} for other in self._movements):
                raise NotPossible(
                    f"The robot is already moving: it is busy with '{self._movements[0]}'. "
                    "Wait until it is done, or stop it first."
                )
            self._movements.append(method.name)
        try:
            yield
        finally:
            with self._lock:
                self._movements.remove(method.name)

    def _remember(self, call: Call) -> None:
        with self._lock:
            self._calls.append(call)


def _spelled(arguments: Mapping[str, Any]) -> str:
    """Arguments as a program would write them, without those that were left out."""
    given = {name: value for name, value in arguments.items() if value is not None}
    return ", ".join(f"{name}={_short(value)}" for name, value in given.items())


def _short(value: Any) -> str:
    """A value for a line of the log, where pages of HTML and other lines would be too long."""
    text = repr(value)
    return text if len(text) <= 200 else f"{text[:197]}..."


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
        EmulatedMotion(emulation),
        EmulatedDock(emulation, navigation),
        EmulatedFace(emulation),
        EmulatedGesture(emulation),
        EmulatedJoints(emulation),
        EmulatedTelepresence(emulation),
        EmulatedScanner(emulation, speech),
        screen,
        EmulatedVision(emulation, navigation),
        EmulatedManipulation(emulation),
        EmulatedFollowing(emulation, navigation),
        EmulatedGuiding(navigation),
        EmulatedSkills(emulation, skills),
    ]
    return [part for part in parts if part is not None]


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


def _simulated_parts(simulation: Simulation, book: LogBook, sound: Sound) -> list[Capability]:
    speech = SimulatedSpeech(simulation, sound)
    screen = SimulatedScreen(simulation, speech)
    navigation = SimulatedNavigation(simulation)
    return [
        SimulatedCore(simulation, book),
        speech,
        SimulatedHearing(simulation, speech, screen, sound),
        navigation,
        SimulatedMotion(simulation),
        SimulatedDock(simulation),
        SimulatedFace(simulation),
        SimulatedGesture(simulation),
        SimulatedJoints(simulation),
        SimulatedTelepresence(simulation),
        SimulatedScanner(simulation, speech),
        screen,
        SimulatedVision(simulation),
        SimulatedManipulation(simulation),
        SimulatedFollowing(simulation),
        SimulatedGuiding(simulation, navigation),
        SimulatedSkills(simulation),
    ]
