"""The simulated hospital, as a robot's driver sees it.

    simulation = Simulation(load_world("city-hospital"), seed=1)
    simulation.run(simulation.drive_to(12.0, 3.5), stop)

Without a `speed` no time passes except inside `run`, and there it passes as fast as the machine
can; the same seed and the same calls give exactly the same run. With a speed a clock thread lets
time pass at that multiple of real time. Methods that take time return a behaviour for `run`; all
others return at once. Metres, seconds, degrees (left is +) everywhere.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Sequence
from datetime import UTC, datetime, timedelta
from types import TracebackType
from typing import Any, TypeVar

import msgspec

from sim.behaviours import company, driving, handling, searching, talking
from sim.behaviours.talking import Reply
from sim.hospital import Hospital, Listener, chart_of
from sim.people import likely, perception
from sim.people.perception import Seen
from sim.physics.bodies import STEP
from sim.physics.navigation import Chart
from sim.physics.robot import RobotState
from sim.record import Record
from sim.runner import Behaviour, Runner, Stop
from sim.snapshot import Snapshot, snapshot
from sim.view import View, view
from sim.world.model import Place, World, Zone
from sim.world.starts import beginning

__all__ = ["Behaviour", "Reply", "RobotState", "Seen", "Simulation", "Stop", "View"]

T = TypeVar("T")

LEAPS_AFTER = 60.0
"""Of a time in which the robot only waits, a copy leaps over what is beyond so many seconds."""
_PATIENCE_WITH_LISTENERS = 0.02
"""Seconds for which who has something to tell waits for another who tells: no stop hangs on it."""


class Simulation:
    """A hospital floor with a robot in it.

    Raises `sim.errors.NotPossible` if the world has no geometry."""

    def __init__(
        self,
        world: World,
        seed: int = 0,
        speed: float | None = None,
        start: datetime | None = None,
    ) -> None:
        self._open(Hospital(world, seed, start), speed)

    def _open(self, hospital: Hospital, speed: float | None) -> None:
        self._hospital = hospital
        self._leaps = False
        self._waiting: Behaviour[None] | None = None
        """The latest wait of a simulation that leaps."""
        self._waited = 0.0
        """How long its robot has done nothing but wait."""
        self._listeners: dict[int, Listener] = {}
        self._delivering = threading.Lock()
        self._deliverer: int | None = None
        """The thread that hands out events now."""
        self._runner = Runner(hospital.step, hospital.rest, self._deliver, STEP, speed)

    # --- running ---------------------------------------------------------------------------------

    def run(self, behaviour: Behaviour[T], stop: Stop) -> T:
        """Run a behaviour to its end and return its result. Raises the kinds of
        `sim.errors.SimError`, or `Interrupted` once `stop` is set or somebody halts."""
        if behaviour is not self._waiting:
            self._waited = 0.0
        return self._runner.run(behaviour, stop)

    def halt(self) -> None:
        """Bring the robot to rest this instant and interrupt every running behaviour; from any
        thread."""
        self._runner.halt()

    def copy(self) -> Simulation:
        """The present state as a simulation of its own, without a clock, for trying things out:
        in it long waits are leapt over."""
        with self._runner.turn:
            now, chart = snapshot(self._hospital), self._hospital.chart
        return self._of(now, chart)

    @classmethod
    def _of(cls, now: Snapshot, chart: Chart | None = None) -> Simulation:
        twin = cls.__new__(cls)
        twin._open(Hospital.of(now, chart), None)
        twin._leaps = True
        return twin

    def __reduce__(self) -> tuple[Callable[[Snapshot], Simulation], tuple[Snapshot]]:
        """What is pickled is a copy."""
        with self._runner.turn:
            return Simulation._of, (snapshot(self._hospital),)

    def close(self) -> None:
        """End the clock thread, if there is one, and whatever runs."""
        self._runner.close()

    def __enter__(self) -> Simulation:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    # --- looking in from outside -----------------------------------------------------------------

    @property
    def world(self) -> World:
        return self._hospital.world

    @property
    def time(self) -> float:
        """Simulated seconds since the start."""
        return self._hospital.time

    @property
    def stepped(self) -> float:
        """As `time`, without what was leapt over."""
        return (self._hospital.steps - self._hospital.leapt) * STEP

    def clock(self) -> datetime:
        """The simulated date and time, in the zone that it started in."""
        start, passed = self._hospital.start, timedelta(seconds=self._hospital.time)
        return (start.astimezone(UTC) + passed).astimezone(start.tzinfo)

    def set_clock(self, moment: datetime) -> None:
        """It is that date and time now; what has no zone is by the clocks of the world."""
        with self._runner.turn:
            passed = timedelta(seconds=self._hospital.time)
            now = beginning(self.world, moment)
            self._hospital.start = (now.astimezone(UTC) - passed).astimezone(now.tzinfo)

    @property
    def robot(self) -> RobotState:
        """The robot at this moment."""
        with self._runner.turn:
            return self._hospital.robot_state()

    def view(self) -> View:
        """The whole floor at this moment."""
        with self._runner.turn:
            return view(self._hospital)

    @property
    def record(self) -> Record:
        """What has happened so far."""
        return self._hospital.record

    def new_record(self) -> Record:
        """End the record and begin another; returns the one that ended."""
        with self._runner.turn:
            return self._hospital.new_record()

    def subscribe(self, listener: Listener) -> Callable[[], None]:
        """Call `listener(kind, data)` for every event (see `robot_api.driver.EVENTS`), from
        whichever thread lets time pass; returns what ends it."""
        number = max(self._listeners, default=0) + 1
        self._listeners = {**self._listeners, number: listener}

        def unsubscribe() -> None:
            self._listeners = {k: v for k, v in self._listeners.items() if k != number}

        return unsubscribe

    def emit(self, kind: str, data: dict[str, Any]) -> None:
        """Put an event into the record and tell it to those who subscribed."""
        with self._runner.turn:
            self._hospital.emit(kind, data)
        self._deliver()

    def _deliver(self) -> None:
        """Hand out the events, one thread at a time: everybody hears of them in the order in which
        they happened, of the end of a stop never before its beginning."""
        me, events = threading.get_ident(), self._hospital.events
        if self._deliverer == me:  # a listener has made an event: it comes after the one at hand
            return
        # Who comes second waits until its own are told, but not for a listener that hangs: then
        # the first hands them out as well, since it looks once more after it has let go.
        while events and self._delivering.acquire(timeout=_PATIENCE_WITH_LISTENERS):
            self._deliverer = me
            try:
                while events:
                    kind, data = events.popleft()
                    for listener in self._listeners.values():
                        listener(kind, data)
            finally:
                self._deliverer = None
                self._delivering.release()

    # --- things that take no time ----------------------------------------------------------------

    def locate(self, name: str) -> tuple[float, float, float]:
        """Where the robot stands when it is at the place of that name or alias: x, y, theta.
        Raises `UnknownPlace`."""
        return self._hospital.locate(name)

    def visible(self, thing: str) -> list[Seen]:
        """What the robot sees of such things or people where it is, the nearest first: "stapler",
        "red cup", "person waving", "people", "objects", "leftmost bottle"."""
        with self._runner.turn:
            likely.remember(self._hospital, thing, perception.in_view(self._hospital, thing))
            return perception.visible(self._hospital, thing)

    def describe(self, thing: str) -> str:
        """The first of them in a sentence. Raises `NotFound`."""
        with self._runner.turn:
            return perception.describe(self._hospital, thing)

    def lidar(self) -> list[float]:
        """The latest scan: 36 distances of at most 8 m, the first straight ahead, then leftwards.
        Ten scans a second."""
        with self._runner.turn:
            return list(self._hospital.lidar)

    def localize(self, x: float, y: float, theta: float) -> None:
        """Tell the robot where it is. It never gets lost here, so this sets it down there.
        Raises `NotPossible` where there is no room for it."""
        with self._runner.turn:
            self._hospital.localize(x, y, theta)
        self._deliver()

    def forget_met(self) -> None:
        """A new program begins: `wait_for` has met nobody yet."""
        with self._runner.turn:
            self._hospital.met.clear()
            self._hospital.partner = None

    def set_emotion(self, name: str) -> None:
        with self._runner.turn:
            self._hospital.robot.emotion = name
        self.emit("emotion", {"name": name})

    def set_joint(self, name: str, degrees: float) -> None:
        with self._runner.turn:
            self._hospital.robot.joints[name] = degrees
        self.emit("joint", {"name": name, "degrees": degrees})

    def set_volume(self, percent: int) -> None:
        with self._runner.turn:
            self._hospital.robot.volume = percent
        self.emit("volume", {"percent": percent})

    def set_language(self, code: str) -> None:
        with self._runner.turn:
            self._hospital.robot.language = code

    def show(self, content: dict[str, Any]) -> None:
        """Put it on the screen: {"text"}, {"html"}, {"url"} or {"options"} with what to show."""
        with self._runner.turn:
            self._hospital.robot.screen = content
        self.emit("screen", content)

    def set_door(self, number: int, open_: bool) -> None:
        """Open or close the world's door of that number. The robot finds out when it gets there."""
        with self._runner.turn:
            self._hospital.set_door(number, open_)

    def limit_pace(
        self,
        speed: float | None = None,
        turn_rate: float | None = None,
        acceleration: float | None = None,
    ) -> None:
        """Drive no faster from now on: m/s, degrees a second, m/s²."""
        with self._runner.turn:
            robot = self._hospital.robot
            robot.pace = robot.pace.within(speed, turn_rate, acceleration)

    def set_zones(self, zones: Iterable[Zone]) -> None:
        """Keep the robot out of these zones and no others; `world.zones` is these from now on.
        Their outlines must be sound (`sim.world.zones.trouble_with`). A robot that is in one may
        leave it; one on its way somewhere looks for another way."""
        drawn = tuple(zones)
        # Time passes while the floor is charted.
        chart = chart_of(msgspec.structs.replace(self.world, zones=drawn))
        with self._runner.turn:
            self._hospital.set_zones(drawn, chart)

    def set_places(self, places: Iterable[Place]) -> None:
        """These are the places from now on. Whoever walks between places must keep theirs."""
        with self._runner.turn:
            self._hospital.world = msgspec.structs.replace(self.world, places=tuple(places))

    # --- behaviours: driving ---------------------------------------------------------------------

    def wait(self, seconds: float) -> Behaviour[None]:
        if not self._leaps:
            return self._hospital.wait(seconds)
        self._waiting = self._wait_or_leap(seconds)
        return self._waiting

    def _wait_or_leap(self, seconds: float) -> Behaviour[None]:
        stepped = min(seconds, max(0.0, LEAPS_AFTER - self._waited))
        self._waited += seconds
        yield from self._hospital.wait(stepped)
        self._hospital.leap(seconds - stepped)

    def drive_to(self, x: float, y: float, theta: float | None = None) -> Behaviour[None]:
        """Raises `Blocked`; `NotPossible` if nobody could stand there, or the battery is empty."""
        return driving.drive_to(self._hospital, x, y, theta)

    def move(self, metres: float) -> Behaviour[None]:
        """Straight ahead or back. Raises `Blocked`, `NotPossible`."""
        return driving.move(self._hospital, metres)

    def turn(self, degrees: float) -> Behaviour[None]:
        return driving.turn(self._hospital, degrees)

    def drive(self, linear: float, angular: float, seconds: float) -> Behaviour[None]:
        """As with a joystick: m/s and degrees/s; a newer one takes over. Raises `Blocked`."""
        return driving.drive(self._hospital, linear, angular, seconds)

    def dock(self) -> Behaviour[None]:
        """Drive to the charger. Raises `Blocked`, `NotPossible`."""
        return driving.dock(self._hospital)

    def gesture(self, name: str) -> Behaviour[None]:
        """Two seconds of it."""
        return talking.gesture(self._hospital, name)

    # --- behaviours: people ----------------------------------------------------------------------

    def follow(self, person: str, to: str | None = None) -> Behaviour[None]:
        """Raises `NotFound`, `UnknownPlace`, `Blocked`."""
        return company.follow(self._hospital, person, to)

    def guide(self, person: str, x: float, y: float, theta: float | None = None) -> Behaviour[None]:
        """Raises `NotFound`, `Blocked`, `NotPossible`."""
        return company.guide(self._hospital, person, x, y, theta)

    def find(self, thing: str, place: str | None = None) -> Behaviour[bool]:
        """True and standing by it, or False. Raises `UnknownPlace`, `Blocked`."""
        return searching.find(self._hospital, thing, place)

    def wait_for(self, thing: str, timeout: float | None = None) -> Behaviour[bool]:
        """Whether one came that `wait_for` had not met here before."""
        return searching.wait_for(self._hospital, thing, timeout)

    # --- behaviours: handling --------------------------------------------------------------------

    def grab(self, thing: str) -> Behaviour[str]:
        """Returns the name of what it took. Raises `NotFound`, `NotPossible`."""
        return handling.grab(self._hospital, thing)

    def put(self, thing: str, where: str | None = None) -> Behaviour[None]:
        """Raises `NotFound`, `NotPossible`."""
        return handling.put(self._hospital, thing, where)

    def give(self, thing: str, person: str | None = None) -> Behaviour[str]:
        """Returns the name of who has it now. Raises `NotFound`, `NotPossible`."""
        return handling.give(self._hospital, thing, person)

    # --- behaviours: talking ---------------------------------------------------------------------

    def speak(self, text: str, language: str | None = None) -> Behaviour[None]:
        return talking.speak(self._hospital, text, language)

    def hear(
        self,
        timeout: float = 10.0,
        question: str | None = None,
        options: Sequence[str] | None = None,
        person: str | None = None,
    ) -> Behaviour[str | None]:
        """What somebody says, or None if nobody does. Raises `NotFound` if `person` is not here."""
        return talking.hear(self._hospital, timeout, question, options, person)

    def reply(
        self,
        timeout: float = 10.0,
        question: str | None = None,
        options: Sequence[str] | None = None,
        person: str | None = None,
    ) -> Behaviour[Reply | None]:
        """Who says what, as `hear`; for a robot that has to hear it first: no event is told."""
        return talking.reply(self._hospital, timeout, question, options, person)

    def scan(self, timeout: float = 30.0) -> Behaviour[str | None]:
        """The code of the thing held, or of one that is held up or lies before the robot."""
        return talking.scan(self._hospital, timeout)

    def touch(self, options: Sequence[str], timeout: float = 30.0) -> Behaviour[str | None]:
        """Which of the options somebody presses, or None if nobody does."""
        return talking.touch(self._hospital, options, timeout)
