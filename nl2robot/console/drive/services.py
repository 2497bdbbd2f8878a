"""Direct control over the wire: `helm.take` and its like, `helm.drive` for the joystick,
`helm.call` for all else a robot does, and `helm.body` for what this one has.

Clients of the robot's own methods (`robot.*`) need no helm: it is for people at consoles, who would
get into each other's way.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any, Final, TypedDict

import msgspec

from nl2robot.console.drive.helm import HOLDS, Helm, Operator, State
from nl2robot.console.floor.localising import localise
from nl2robot.run.state import Driven
from nl2robot.station.by_hand import BUSY, ByHand
from nl2robot.station.part import Backstage, Part
from nl2robot.wire import an_object, schema_of
from robot_api.driver import Event, StopFlag
from robot_api.errors import InvalidCall, NotPossible, RobotError, Stopped
from robot_api.methods import SPEED, TURN_RATE
from robot_api.server import Context, Service
from robot_api.serving.dispatch import Lane

LINES_KEPT: Final = 1000
"""Of the log, for who opens the page later."""

EVENTS: Mapping[str, str] = {
    "helm": "driver (the name of a connection, or null), who, since (seconds since the epoch),"
    " asking (a list of connection and who)",
}


class HelmTold(TypedDict):
    """Who drives, and which of the connections is the asker's own."""

    driver: str | None
    who: str | None
    since: float | None
    asking: list[Operator]
    me: str


class LogLine(TypedDict):
    """`time` is the local one, as 14:05:00."""

    level: str
    message: str
    time: str


class Controls:
    """The helm of one robot, and what can be done with it."""

    def __init__(self, backstage: Backstage) -> None:
        self._backstage = backstage
        self._driver = backstage.driver
        self._stop = backstage.stop
        self._runner = backstage.runner
        self._simulation = backstage.simulation
        self._has_camera = backstage.camera is not None
        self.helm = Helm(lambda state: backstage.publish("helm", _plain(state)))
        self._telling = threading.Lock()
        self._by_hand = ByHand(backstage.runner.log)
        self._seen: dict[str, Any] = {}
        self._log: deque[Event] = deque(maxlen=LINES_KEPT)
        self.forget = backstage.subscribe(self._on_event)

    # --- who drives

    def state(self, parameters: Mapping[str, Any], context: Context) -> Any:
        return self._told(self.helm.state(), context)

    def take(self, parameters: Mapping[str, Any], context: Context) -> Any:
        return self._told(self.helm.take(context.connection, parameters["who"]), context)

    def give(self, parameters: Mapping[str, Any], context: Context) -> Any:
        return self._told(self.helm.give(context.connection, parameters.get("to")), context)

    def keep(self, parameters: Mapping[str, Any], context: Context) -> Any:
        return self._told(self.helm.keep(context.connection), context)

    def left(self, connection: str) -> None:
        """A connection is gone. To stop a robot may take a moment, for which nobody waits."""

        def let_go() -> None:
            self.helm.left(connection)
            self._note_driver()

        threading.Thread(target=let_go, name="helm left", daemon=True).start()

    # --- what the robot does

    def call(self, parameters: Mapping[str, Any], context: Context) -> Any:
        name, arguments = parameters["name"], dict(parameters.get("arguments", {}))
        if name == "stop":  # any operator's, at any time
            return self._stop(
                f"{context.who} stopped the robot." if context.who else Stopped().because
            )
        if name == "drive":
            raise InvalidCall("Drive with helm.drive, which stops by itself.")
        with self.helm.calling(context.connection, context.stop):
            self._check_no_program()
            self._note(name, arguments, context)
            if name == "localize":  # which others may want to take back
                who = self.helm.state().who or ""
                return localise(self._backstage, arguments, who, context.stop)
            return msgspec.to_builtins(self._driver.call(name, arguments, context.stop))

    def drive(self, parameters: Mapping[str, Any], context: Context) -> None:
        with self.helm.steering(context.connection, context.stop, parameters.get("number")):
            self._check_no_program()
            speeds = {"linear": parameters["linear"], "angular": parameters["angular"]}
            self._note("drive", speeds, context)
            self._driver.call("drive", {**speeds, "seconds": HOLDS}, context.stop)

    def release(self, parameters: Mapping[str, Any], context: Context) -> None:
        self.helm.release(context.connection, parameters.get("number"))

    # --- what is known of it

    def body(self, parameters: Mapping[str, Any], context: Context) -> Any:
        body = msgspec.to_builtins(self._driver.capabilities())
        return {
            **body,
            "places": self._places(),
            "camera": self._has_camera,
            "now": self._now(),
        }

    def log(self, parameters: Mapping[str, Any], context: Context) -> Any:
        return list(self._log)[-parameters.get("lines", 200) :]

    # --- inside

    def _note(self, method: str, arguments: Mapping[str, Any], context: Context) -> None:
        who = context.who or self.helm.state().who
        self._by_hand.note(who, method, arguments)

    def _note_driver(self) -> None:
        """Let the state say who drives: not by the helm itself, which nobody may wait for who is
        telling of a state."""
        with self._telling:  # so that the newest is told last
            self._runner.present.happened(Driven(self.helm.state().who))

    def _told(self, state: State, context: Context) -> dict[str, Any]:
        """The state, and which of the connections is the asker's own."""
        self._note_driver()
        return {**_plain(state), "me": context.connection}

    def _check_no_program(self) -> None:
        if self._runner.present.state.run is not None:
            raise NotPossible(BUSY)

    def _on_event(self, kind: str, data: Event) -> None:
        match kind:
            case "log":
                self._keep(data)
            case "pose" | "battery" | "emotion" | "screen" | "call":
                self._seen[kind] = data
            case "volume":
                self._seen["volume"] = data["percent"]
            case "language":
                self._seen["language"] = data["code"]
            case "joint":
                joints = self._seen.get("joints", {})
                self._seen["joints"] = {**joints, data["name"]: data["degrees"]}
            case "stop":
                self.helm.stopped()
            case "state" if data["run"] is not None:
                self.helm.yield_to_program()

    def _keep(self, line: Event) -> None:
        """Of a drive with the joystick, ten lines a second, only the last one is kept."""
        if self._log and all(_by_stick(each) for each in (self._log[-1], line)):
            self._log.pop()
        self._log.append(line)

    def _places(self) -> list[dict[str, Any]]:
        return [
            {"name": place.name, "kind": place.kind, "aliases": msgspec.to_builtins(place.aliases)}
            for place in self._runner.knowledge.world.places
        ]

    def _now(self) -> dict[str, Any]:
        """How the robot is, as far as it is known."""
        if self._simulation is not None:
            robot = self._simulation.robot
            now = {
                "pose": {
                    "x": robot.x,
                    "y": robot.y,
                    "theta": robot.theta,
                    "place": robot.place,
                    "speed": robot.speed,
                },
                "battery": {"percent": round(robot.battery), "charging": robot.charging},
                "emotion": {"name": robot.emotion},
                "volume": robot.volume,
                "language": robot.language,
                "joints": {
                    name: robot.joints.get(name, 0.0) for name in self._driver.capabilities().joints
                },
            }
            return {**self._seen, **now}
        asked = {} if "pose" in self._seen else {"pose": self._asked("location")}
        if "battery" not in self._seen:
            percent = self._asked("battery")
            asked["battery"] = None if percent is None else {"percent": percent, "charging": None}
        return {**asked, **self._seen}

    def _asked(self, method: str) -> Any:
        """What the robot answers; None if it cannot, or cannot be reached."""
        with suppress(RobotError):
            return msgspec.to_builtins(self._driver.call(method, {}, StopFlag()))
        return None


def part(backstage: Backstage) -> Part:
    controls = Controls(backstage)
    return Part(
        services=_services(controls),
        events=EVENTS,
        left=controls.left,
        close=controls.forget,
    )


def _services(controls: Controls) -> dict[str, Service]:
    number = {"type": "integer", "minimum": 1}
    return {
        "helm.state": _service(
            controls.state, HelmTold, "Tell who drives, and who asks to.", observes=True
        ),
        "helm.take": _service(
            controls.take,
            HelmTold,
            "Drive, if nobody does; else ask whoever does, with the event `helm`.",
            {"who": {"type": "string", "minLength": 1, "maxLength": 100}},
            "who",
        ),
        "helm.give": _service(
            controls.give,
            HelmTold,
            "Hand the helm over to a connection that asks; without one, let it go.",
            {"to": {"type": ["string", "null"], "maxLength": 100}},
        ),
        "helm.keep": _service(
            controls.keep, HelmTold, "Tell those who ask that you go on driving."
        ),
        "helm.call": _service(
            controls.call,
            Any,
            "A robot method, by name, with its arguments, from whoever drives; returns its result."
            " Ends with the connection. `stop` may be called by every operator.",
            {
                "name": {"type": "string", "maxLength": 100},
                "arguments": {"type": "object"},
            },
            "name",
            lane="wait",
        ),
        "helm.drive": _service(
            controls.drive,
            None,
            f"Move the joystick: metres and degrees a second, for {HOLDS:g} s at most; a newer one"
            " takes over. With numbers that count up, a late one does not overtake.",
            {"linear": SPEED.schema, "angular": TURN_RATE.schema, "number": number},
            "linear angular",
            lane="wait",
        ),
        "helm.release": _service(
            controls.release, None, "Let go of the joystick: the robot stands.", {"number": number}
        ),
        "helm.body": _service(
            controls.body,
            dict[str, Any],
            "What this robot can do, where it can go, and how it is just now.",
            observes=True,
        ),
        "helm.log": _service(
            controls.log,
            list[LogLine],
            "The last lines of the log: level, message, time.",
            {"lines": {"type": "integer", "minimum": 1, "maximum": LINES_KEPT}},
            observes=True,
        ),
    }


def _service(
    handler: Callable[[dict[str, Any], Context], Any],
    result: Any,
    doc: str,
    properties: dict[str, Any] | None = None,
    required: str = "",
    observes: bool = False,
    lane: Lane = "control",
) -> Service:
    parameters = an_object(properties or {}, required)
    return Service(handler, parameters, doc, schema_of(result), observes=observes, lane=lane)


def _by_stick(line: Event) -> bool:
    return str(line.get("message", "")).startswith(("drive(", "drive:"))


def _plain(state: State) -> dict[str, Any]:
    plain: dict[str, Any] = msgspec.to_builtins(state)
    return plain
