"""A robot put together from capabilities, and what every such robot does alike.

    parts = [MyCore(book, robot), MyMotion(robot)]
    ComposedDriver(name="Trolley", kind="trolley", parts=parts, hub=hub, book=book, link=link)

It is all that a robot needs around its capabilities: it hands each call to the capability that the
method table names for it, lets one movement happen at a time, holds the robot's limits, ends the
calls in flight when the robot is stopped or lost, tells the truth about a stop, and keeps the log.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Final

from robot_api import limits
from robot_api.capabilities.base import Capability, Hub, Listener
from robot_api.capabilities.camera import Camera
from robot_api.capabilities.core import Core, LogBook
from robot_api.capabilities.tablet import Tablet
from robot_api.driver import Capabilities, StopFlag
from robot_api.errors import (
    InternalError,
    LostConnection,
    NotPossible,
    NotSupported,
    RobotError,
    StopNotConfirmed,
)
from robot_api.interfaces import INTERFACES
from robot_api.methods import METHODS, Method
from robot_api.robots.link import Link
from robot_api.robots.robot_file import RobotFile
from robot_api.schema import find_method, read_arguments

_STOP: Final = "stop"
_JOYSTICK: Final = "drive"
"""The one movement that a newer call of itself takes over from."""
_PATIENCE: Final = 0.02
"""Seconds beyond `Capabilities.stop_within` after which a driver that does not come back from a
stop has not confirmed it."""


@dataclass(frozen=True)
class Call:
    """A call that a driver was asked for, and what came of it."""

    method: str
    arguments: Mapping[str, Any]
    result: Any = None
    error: BaseException | None = None


@dataclass(eq=False)
class _Flight:
    """A call in flight."""

    stop: StopFlag
    method: Method
    lost: bool = False
    """Whether the robot was lost meanwhile, which is then what the call ends with."""


class ComposedDriver:
    """A robot made of capabilities; a `robot_api.driver.Driver`.

    `parts` are its capabilities, `Core` among them. `hub` hands out the events that they publish.
    `publish(kind, data)` takes the driver's own events, if not the hub. `link` is the connection to
    a robot that can be lost, `camera` what it sees with. Any thread may call any of it.
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
        link: Link | None = None,
        camera: Camera | None = None,
    ) -> None:
        self.camera: Final = camera
        self._parts = {part.name: part for part in parts}
        core = self._parts.get(Core.name)
        if not isinstance(core, Core):
            raise TypeError("A driver needs a Core among its parts.")
        self._core = core
        self._hub = hub
        self._book = book
        self._publish = publish or hub.forward
        self._offered = {method: part for part in self._parts.values() for method in part.offers()}
        self._capabilities = Capabilities(
            name=name,
            kind=kind,
            units=units,
            methods=tuple(method for method in METHODS if method in self._offered),
            stand_ins={
                part.name: part.stand_in
                for part in self._parts.values()
                if part.stand_in is not None
            },
            **self._declared(),
        )
        self._lock = threading.Lock()  # for what follows
        self._in_flight: list[_Flight] = []
        self._movements: list[str] = []
        self._calls: deque[Call] = deque(maxlen=10_000)
        self._closed = False
        self._lost_moving = False
        self._link = link
        if link is not None:
            link.on_lost(self._when_lost)
            link.on_found(self._when_found)

    # --- the interface of a driver ---------------------------------------------------------------

    def capabilities(self) -> Capabilities:
        return self._capabilities

    def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
        """Do it; see `Driver.call`. Defaults that are left out are filled in. Raises
        `LostConnection` while the robot is lost, and when it is lost meanwhile."""
        stop.check()
        row = find_method(method)
        part = self._part(row)
        complete = read_arguments(method, (), arguments)
        self._book.write(f"{method}({_spelled(complete)})")
        try:
            with self._flying(stop, row), self._moving(row):
                result = self._do(part, method, self._held(method, complete), stop)
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
        """Wake every call in flight, which then raises `Stopped`, and bring the body to rest.
        Raises `StopNotConfirmed`."""
        self._stop_others(None, because)

    def subscribe(self, listener: Listener) -> Callable[[], None]:
        """As `Driver.subscribe`; who comes while the robot is lost is told so at once."""
        unsubscribe = self._hub.subscribe(listener)
        if self._link is not None and self._link.state == "lost":
            listener("link", self._link.event())
        return unsubscribe

    def attach(self, tablet: Tablet) -> None:
        """Give the robot a real tablet: what it shows is seen there, and who stands there answers
        in place of simulated people."""
        for part in self._parts.values():
            part.tablet = tablet

    def hold(self, file: RobotFile) -> None:
        """From now on the robot has the name and keeps to the limits that its file gives it.
        Raises `NotSupported` if the file names a joint that it lacks."""
        self._capabilities = limits.held(self._capabilities, file)

    def begin(self) -> None:
        """A new program begins: whom another program met by `wait_for`, say, is met anew."""

    def close(self) -> None:
        """Stop, and let go of the robot. Later calls raise `LostConnection`. Whoever has to know
        that it stands calls `stop` before."""
        with self._lock:
            if self._closed:
                return
            self._closed = True
        try:
            self.stop("The robot is being switched off.")
        except StopNotConfirmed:
            return  # the event and the log say it

    # --- looking back ----------------------------------------------------------------------------

    @property
    def calls(self) -> Sequence[Call]:
        """The calls that ended, the last 10,000 of them, in the order in which they ended."""
        with self._lock:
            return tuple(self._calls)

    # --- stopping --------------------------------------------------------------------------------

    def _stop_others(self, mine: StopFlag | None, because: str) -> None:
        with self._lock:
            flags = [flight.stop for flight in self._in_flight if flight.stop is not mine]
        for flag in flags:
            flag.set(because)
        try:
            self._publish("stopping", {"because": because})
        finally:  # whatever becomes of a listener, the robot is stopped
            self._come_to_rest(because)

    def _come_to_rest(self, because: str) -> None:
        try:
            self._rest()
        except StopNotConfirmed as error:
            self._book.write(f"stop not confirmed: {error}", "error")
            self._publish("stop_not_confirmed", {"because": because, "message": str(error)})
            raise
        self._book.write(f"stopped: {because}")
        self._publish("stopped", {"because": because})

    def _rest(self) -> None:
        """Bring the body to rest. However a driver fails at it, that is a stop which is not
        confirmed; so is one that it does not come back from."""
        if self._link is None:  # nothing that could be lost on the way
            self._confirmed_rest()
            return
        failed: list[StopNotConfirmed] = []

        def rest() -> None:
            try:
                self._confirmed_rest()
            except StopNotConfirmed as error:
                failed.append(error)

        resting = threading.Thread(target=rest, name="rest", daemon=True)
        resting.start()
        resting.join(self._capabilities.stop_within + _PATIENCE)
        if resting.is_alive():
            raise StopNotConfirmed()
        if failed:
            raise failed[0]

    def _confirmed_rest(self) -> None:
        try:
            self._core.rest()
        except StopNotConfirmed:
            raise
        except Exception as error:
            self._book.write(f"rest: {type(error).__name__}: {error}", "error")
            raise StopNotConfirmed() from error

    # --- lost and found --------------------------------------------------------------------------

    def _when_lost(self) -> None:
        assert self._link is not None
        error = self._link.error()
        with self._lock:
            flights = [
                flight
                for flight in self._in_flight
                if flight.method.name != _STOP and not flight.stop.is_set()
            ]
            for flight in flights:
                flight.lost = True
            if any(flight.method.moves for flight in flights):
                self._lost_moving = True
        self._book.write(f"lost: {error}", "error")
        for flight in flights:
            flight.stop.set(str(error))

    def _when_found(self) -> None:
        """Nothing is taken up again: what the robot may still be at, it ends."""
        self._book.write("found again")
        with self._lock:
            was_moving, self._lost_moving = self._lost_moving, False
        if was_moving:
            threading.Thread(target=self._stop_found, name="found", daemon=True).start()

    def _stop_found(self) -> None:
        try:
            self.stop("The robot was lost while it moved, and is found again.")
        except StopNotConfirmed:
            return  # the event says it

    # --- inside ----------------------------------------------------------------------------------

    def _declared(self) -> dict[str, Any]:
        declared: dict[str, Any] = {}
        for part in self._parts.values():
            for field, value in part.declares().items():
                both = field == "limits" and field in declared
                declared[field] = limits.narrower(declared[field], value) if both else value
        return declared

    def _held(self, method: str, arguments: dict[str, Any]) -> dict[str, Any]:
        """The arguments as the robot's limits allow them. Raises `InvalidCall`."""
        limits.check(method, arguments, self._capabilities)
        loudest = limits.loudest(method, arguments, self._capabilities)
        if loudest is None:
            return arguments
        self._book.write(
            f"{method}: set to {loudest} percent, the loudest that this robot is allowed", "warning"
        )
        return {**arguments, "percent": loudest}

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
        if method == _STOP:
            # The call that stops the others is not stopped itself: a program may go on after it.
            self._stop_others(stop, "The robot was told to stop.")
            return None
        return getattr(part, method)(stop, **arguments)

    @contextmanager
    def _flying(self, stop: StopFlag, method: Method) -> Iterator[None]:
        """The call is in flight; whoever stops the robot sets its flag, and so does its loss."""
        flight = _Flight(stop, method)
        with self._lock:
            if self._closed:
                raise LostConnection("The robot is switched off. Start it again.")
            self._in_flight.append(flight)
        try:
            if self._link is not None and method.name != _STOP:  # which is always tried
                self._link.check()
            yield
        except BaseException as error:
            # A robot's own software says all sorts of things when the connection is cut.
            if flight.lost and self._link is not None:
                raise self._link.error() from error
            raise
        finally:
            with self._lock:
                self._in_flight.remove(flight)

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
