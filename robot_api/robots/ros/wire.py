"""One connection to a rosbridge.

It lives once: when it ends, it is over, and a new one is another object. So nothing that was meant
for the old one is sent later, when the robot is found again; roslibpy by itself would keep it.
"""

from __future__ import annotations

import http.client
import logging
import socket
import ssl
import threading
import time
from base64 import b64encode
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from robot_api.capabilities.base import POLL
from robot_api.driver import StopFlag
from robot_api.errors import AccessDenied, LostConnection, NotSupported

OPEN_WITHIN = 3.0
"""Seconds that a rosbridge has to take a connection."""
ANSWER_WITHIN = 3.0
"""Seconds that a service has to answer, unless a call says more."""

SETTLES = 0.5
"""Seconds after which the robot's programs have noticed that a topic is advertised."""


class Answer:
    """What a service says, now or later."""

    def __init__(self) -> None:
        self.done = threading.Event()
        self.ok = False
        """Whether it did what was asked; if not, `said` tells why."""
        self.values: Mapping[str, Any] = {}
        self.said = ""

    def good(self, values: Any) -> None:
        self.ok, self.values = True, dict(values)
        self.done.set()

    def bad(self, said: Any) -> None:
        self.said = str(said)
        self.done.set()


@dataclass(frozen=True)
class Where:
    """A rosbridge."""

    host: str
    port: int
    tls: bool = False
    user: str | None = None
    password: str | None = None

    def headers(self) -> dict[str, str]:
        if self.password is None:
            return {}
        login = b64encode(f"{self.user or ''}:{self.password}".encode()).decode()
        return {"Authorization": f"Basic {login}"}

    def __str__(self) -> str:
        return f"{self.host}:{self.port}"


class Wire:
    """Any thread may call any of it. Raises `LostConnection` once it has ended.

    What comes in is handled in the one thread that all connections have in common: handlers must
    not wait.
    """

    def __init__(self, ros: Any) -> None:
        self._ros = ros
        self._over = threading.Event()
        self._lock = threading.Lock()
        self._waiting: set[Answer] = set()
        self._topics: dict[str, Any] = {}
        self._settled: dict[str, float] = {}
        self._actions: dict[str, Any] = {}
        self._on_end: list[Callable[[], None]] = []
        ros.on("close", self._end)

    @classmethod
    def open(cls, where: Where, within: float = OPEN_WITHIN) -> Wire:
        """Raises `LostConnection` if nobody answers there, `AccessDenied` if it wants a login,
        `NotSupported` if it is no rosbridge."""
        _knock(where, within)
        import roslibpy

        ros = roslibpy.Ros(
            where.host, where.port, where.tls, where.headers(), transport=_transport()
        )
        ros.factory.maxRetries = 0
        wire = cls(ros)
        try:
            ros.run(within)
        except roslibpy.RosTimeoutError:
            ros.on_ready(ros.close, run_in_thread=False)  # should it come about after all
            raise LostConnection(_silent(where, within)) from None
        return wire

    @property
    def over(self) -> bool:
        return self._over.is_set()

    def on_end(self, listener: Callable[[], None]) -> None:
        """Call it once when the connection ends; must not wait."""
        with self._lock:
            if not self._over.is_set():
                self._on_end.append(listener)
                return
        listener()

    def close(self) -> None:
        """End it; what waits for an answer is told at once."""
        if not self._over.is_set():
            import roslibpy

            try:
                self._ros.close(timeout=1)
            except roslibpy.RosTimeoutError:
                logging.getLogger(__name__).debug("it would not close")
        self._end()

    # --- topics ----------------------------------------------------------------------------------

    def advertise(self, topic: str, kind: str, latch: bool = False) -> None:
        self._check()
        import roslibpy

        self._topics[topic] = roslibpy.Topic(
            self._ros, topic, kind, latch=latch, queue_size=1, reconnect_on_close=False
        )
        self._topics[topic].advertise()
        self._settled[topic] = time.monotonic() + SETTLES

    def publish(self, topic: str, message: Mapping[str, Any], repeated: bool = False) -> None:
        """On a topic that was advertised. What is not `repeated` waits, if need be, until the
        robot's programs have noticed that it is advertised: before, it would be lost."""
        self._check()
        if not repeated:
            time.sleep(max(0.0, self._settled[topic] - time.monotonic()))
        self._topics[topic].publish(message)

    def subscribe(
        self, topic: str, kind: str, handler: Callable[[Mapping[str, Any]], None], every: float
    ) -> None:
        """`every`: seconds between two messages at least, of those between the last counts."""
        self._check()
        import roslibpy

        listening = roslibpy.Topic(
            self._ros,
            topic,
            kind,
            throttle_rate=round(every * 1000),
            queue_length=1,
            reconnect_on_close=False,
        )
        self._topics[f"from {topic}"] = listening
        listening.subscribe(handler)

    def unsubscribe(self, topic: str) -> None:
        listening = self._topics.pop(f"from {topic}", None)
        if listening is not None and not self._over.is_set():
            listening.unsubscribe()

    # --- services --------------------------------------------------------------------------------

    def ask(self, service: str, arguments: Mapping[str, Any] | None = None) -> Answer:
        """Call it and go on."""
        import roslibpy

        answer = Answer()
        with self._lock:
            self._check()
            self._waiting = {known for known in self._waiting if not known.done.is_set()}
            self._waiting.add(answer)
            # Inside, because roslibpy counts its calls without a lock.
            request = roslibpy.ServiceRequest(dict(arguments or {}))
            roslibpy.Service(self._ros, service, "").call(request, answer.good, answer.bad)
        return answer

    def call(
        self,
        service: str,
        arguments: Mapping[str, Any] | None = None,
        *,
        within: float = ANSWER_WITHIN,
        stop: StopFlag | None = None,
    ) -> Answer:
        """Call it and wait for the answer. Raises `LostConnection` if none comes in time."""
        answer = self.ask(service, arguments)
        end = time.monotonic() + within
        while not answer.done.wait(POLL if stop is not None else within):
            if stop is not None:
                stop.check()
            if time.monotonic() >= end:
                raise LostConnection(
                    f"The robot has not answered for {within:g} seconds ({service})."
                    " See that its programs run."
                )
        self._check()
        return answer

    # --- actions of ROS 2 ------------------------------------------------------------------------

    def send_goal(
        self,
        action: str,
        kind: str,
        goal: Mapping[str, Any],
        on_result: Callable[[int, Any], None],
        on_feedback: Callable[[Any], None],
    ) -> str:
        """Its id. `on_result` gets the status, a number of action_msgs/GoalStatus, and the values
        or, as a text, why there are none."""
        self._check()
        import roslibpy

        client = self._actions.get(action)
        if client is None:
            client = self._actions[action] = roslibpy.ActionClient(
                self._ros, action, kind, reconnect_on_close=False
            )

        def ended(result: Mapping[str, Any]) -> None:
            on_result(result["status"].value, result["values"])

        with self._lock:
            return str(client.send_goal(roslibpy.Goal(goal), ended, on_feedback, ended))

    def cancel_goal(self, action: str, goal: str) -> None:
        """By rosbridge's own means, which by default comes too late (see `actions`)."""
        if not self._over.is_set() and action in self._actions:
            self._actions[action].cancel_goal(goal)

    # --- inside ----------------------------------------------------------------------------------

    def _check(self) -> None:
        if self._over.is_set():
            raise LostConnection(
                "The connection to the robot has ended. Wait until it is found again."
            )

    def _end(self, *_: Any) -> None:
        with self._lock:
            if self._over.is_set():
                return
            self._over.set()
            listeners, self._on_end = self._on_end, []
            waiting, self._waiting = self._waiting, set()
        for answer in waiting:
            answer.done.set()
        for listener in listeners:
            listener()


def _knock(where: Where, within: float) -> None:
    """Find out at once, and in words, whether a WebSocket can be opened there."""
    make = (
        partial(http.client.HTTPSConnection, context=ssl.create_default_context())
        if where.tls
        else http.client.HTTPConnection
    )
    door = make(where.host, where.port, timeout=within)
    try:
        door.request(
            "GET",
            "/",
            headers={
                "Upgrade": "websocket",
                "Connection": "Upgrade",
                "Sec-WebSocket-Version": "13",
                "Sec-WebSocket-Key": b64encode(b"is anybody there").decode(),
                **where.headers(),
            },
        )
        status = door.getresponse().status
    except ssl.SSLError as error:
        raise LostConnection(
            f"The robot at {where} cannot be reached safely ({error.reason})."
            " Check its certificate, or whether it has one."
        ) from None
    except TimeoutError:
        raise LostConnection(_silent(where, within)) from None
    except socket.gaierror:
        raise LostConnection(
            f"There is no machine called {where.host} in this network. Check the address."
        ) from None
    except http.client.HTTPException:
        raise NotSupported(f"What answers at {where} is no rosbridge. Check the port.") from None
    except OSError as error:
        raise LostConnection(
            f"The robot at {where} cannot be reached ({error.strerror or error})."
            " See that it is switched on and that rosbridge runs on it."
        ) from None
    finally:
        door.close()
    if status in (401, 403):
        raise AccessDenied(
            f"The robot at {where} wants a login. Write USER@ before the host, and put the"
            " password into NL2ROBOT_ROBOT_PASSWORD."
        )
    if status != 101:
        raise NotSupported(f"What answers at {where} is no rosbridge. Check the port.")


def _silent(where: Where, within: float) -> str:
    return (
        f"The robot at {where} has not answered for {within:g} seconds."
        " See that it is switched on and that rosbridge runs on it."
    )


def _transport() -> str:
    """roslibpy's way without Twisted, whose reactor cannot be started again and which prints.
    What it and asyncio have to say is for whoever listens to the log, not for the terminal."""
    for name in ("roslibpy", "autobahn", "txaio"):
        log = logging.getLogger(name)
        if not any(isinstance(handler, logging.NullHandler) for handler in log.handlers):
            log.addHandler(logging.NullHandler())
    return "asyncio"
