"""A Furhat that is connected: what is asked of it, what it is doing, and how it is stopped.

Two connections go to the robot, one for what is asked of it and one that is used for stopping
alone, so that no stop waits behind anything else. When either ends, the robot is lost: whoever
waits for it is told, and it is looked for until it is found again.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from queue import Empty, SimpleQueue
from typing import Any, Final

from robot_api.driver import StopFlag
from robot_api.errors import AccessDenied, LostConnection, StopNotConfirmed
from robot_api.robots.furhat.connection import GONE, Connection, Message, new_id
from robot_api.robots.link import Link

ANSWERS_WITHIN: Final = 5.0
"""Seconds in which the robot answers what it can answer at once."""
STOP_WITHIN: Final = 2.0
"""Seconds in which it confirms that it is at rest. Speech ends at once, but nothing ends a gesture:
most last about a second."""
FIRST_PAUSE: Final = 0.25
"""Seconds before a lost robot is looked for; each pause is twice the one before."""
LONGEST_PAUSE: Final = 4.0

_SIGN: Final = "response.face.status"
_DOES_NOTHING = (
    "The Furhat is there but does not do what it is asked. Wait a little, or switch it off and on."
)


@dataclass
class _Motion:
    """Something that the robot was told to do and has not ended."""

    speech: bool
    """Whether it can be ended; a gesture cannot."""
    over: float
    """When it has ended whatever the robot says."""
    started: bool
    unwanted: bool = False
    """Whether it was stopped: should it begin in spite of that, it is stopped again."""


class Exchange:
    """What the robot says to one request: the messages that carry its number, in their order."""

    def __init__(self, stop: StopFlag, link: Link) -> None:
        self.number = new_id()
        self._stop = stop
        self._link = link
        self._queue: SimpleQueue[Message | None] = SimpleQueue()

    def put(self, message: Message | None) -> None:
        """Hand it to whoever waits; with None they look whether they may go on waiting."""
        self._queue.put(message)

    def next(self, within: float, *kinds: str) -> Message | None:
        """The next message of such a kind, or None after so many seconds. Raises `Stopped`,
        `LostConnection`."""
        end = time.monotonic() + within
        while True:
            self._stop.check()
            self._link.check()
            left = end - time.monotonic()
            if left <= 0:
                return None
            with suppress(Empty):
                message = self._queue.get(timeout=left)
                if message is not None and message["type"] in kinds:
                    return message

    def expect(self, within: float, *kinds: str) -> Message:
        """As `next`; that none comes is a robot that is there in name only: `LostConnection`."""
        message = self.next(within, *kinds)
        if message is None:
            raise LostConnection(_DOES_NOTHING)
        return message


class Furhat:
    """The robot at `where` ("host:port"), entered with `key` if it wants one. Any thread may call
    any of it. Raises `LostConnection`, `AccessDenied`."""

    def __init__(self, where: str, key: str | None, link: Link) -> None:
        self._where = where
        self._key = key
        self._link = link
        self._closing = threading.Event()
        self._exchanges: dict[str, Exchange] = {}
        self._changed = threading.Condition()  # for what follows
        self._motions: dict[str, _Motion] = {}
        self._attempt = 0
        """How often it was tried to connect: each pair of connections has the number of its own."""
        self._connected: int | None = None
        """The attempt that the connections are of."""
        self._ended = 0
        """The last attempt of which a connection has ended."""
        self._connect()

    @property
    def session(self) -> int | None:
        """Another number after the robot was lost and found: what it was told before, it may have
        forgotten."""
        return self._connected

    # --- asking ----------------------------------------------------------------------------------

    def send(self, kind: str, **fields: Any) -> None:
        """Send it and await nothing."""
        self._link.check()
        self._asking.send(kind, **fields)

    @contextmanager
    def exchange(self, stop: StopFlag) -> Iterator[Exchange]:
        """Hear, in the `with` block, what the robot says to requests with the exchange's number."""
        exchange = Exchange(stop, self._link)
        self._exchanges[exchange.number] = exchange
        stop.on_set(lambda: exchange.put(None))
        try:
            yield exchange
        finally:
            del self._exchanges[exchange.number]

    def ask(self, stop: StopFlag, kind: str, answer: str, **fields: Any) -> Message:
        """Send a request and await its answer. Raises `Stopped` and `LostConnection`."""
        with self.exchange(stop) as exchange:
            return self.request(exchange, kind, answer, **fields)

    def request(self, exchange: Exchange, kind: str, answer: str, **fields: Any) -> Message:
        """As `ask`, in an exchange that is there: who asks again and again needs no new one."""
        self.send(kind, request_id=exchange.number, **fields)
        return exchange.expect(ANSWERS_WITHIN, answer)

    def tell(self, stop: StopFlag, kind: str, **fields: Any) -> None:
        """Send what the robot gives no answer to, and await that it has read it. Raises `Stopped`
        and `LostConnection`."""
        with self.exchange(stop) as exchange:
            self.send(kind, **fields)
            self._ask_for_a_sign(self._asking, exchange)
            exchange.expect(ANSWERS_WITHIN, _SIGN)

    @contextmanager
    def motion(self, stop: StopFlag, *, speech: bool, lasts: float) -> Iterator[Exchange]:
        """As `exchange`, for a request that sets the robot in motion for `lasts` seconds at most.
        It is in motion until it says otherwise, also when nobody waits for that any longer; speech
        that is left before its end is ended."""
        with self.exchange(stop) as exchange:
            number = exchange.number
            with self._changed:
                self._motions[number] = _Motion(speech, time.monotonic() + lasts, not speech)
            try:
                yield exchange
            finally:
                with self._changed:
                    motion = self._motions.get(number)
                    if motion is not None:
                        motion.unwanted = True
                if motion is not None and speech:
                    with suppress(LostConnection):
                        self.send("request.speak.stop")

    def never_began(self, exchange: Exchange) -> None:
        """The robot did not react to that request for a motion."""
        with self._changed:
            self._motions.pop(exchange.number, None)

    # --- stopping --------------------------------------------------------------------------------

    def halt(self) -> None:
        """Silence it, on a connection of its own, and wait until it says that it is at rest.
        Raises `StopNotConfirmed`."""
        end = time.monotonic() + STOP_WITHIN
        with self._changed:
            for motion in self._motions.values():
                motion.unwanted = True
        try:
            self._hush(self._stopping)
            for connection in self._to_confirm():
                with self.exchange(StopFlag()) as exchange:
                    self._ask_for_a_sign(connection, exchange)
                    exchange.expect(end - time.monotonic(), _SIGN)
            with self._changed:
                at_rest = self._changed.wait_for(self._at_rest, max(0.0, end - time.monotonic()))
            self._link.check()
        except LostConnection as error:
            raise StopNotConfirmed() from error
        if not at_rest:
            raise StopNotConfirmed()

    def close(self) -> None:
        self._closing.set()
        for connection in (self._asking, self._stopping):
            connection.close()

    def _to_confirm(self) -> list[Connection]:
        """Where it has to give a sign: it has read the stop then; and where it was asked to speak,
        it has told whether it began before."""
        with self._changed:
            may_begin = any(not motion.started for motion in self._motions.values())
        return [self._stopping, self._asking] if may_begin else [self._stopping]

    def _ask_for_a_sign(self, connection: Connection, exchange: Exchange) -> None:
        """It takes one message after the other: who answers this has read what went before."""
        connection.send(
            "request.face.status", face_id=True, face_list=False, request_id=exchange.number
        )

    def _hush(self, connection: Connection) -> None:
        connection.send("request.speak.stop")
        connection.send("request.listen.stop")

    def _at_rest(self) -> bool:
        now = time.monotonic()
        self._motions = {n: motion for n, motion in self._motions.items() if motion.over > now}
        return not any(motion.started for motion in self._motions.values())

    # --- hearing from it -------------------------------------------------------------------------

    def _heard(self, message: Message) -> None:
        number = message.get("request_id")
        if not isinstance(number, str):
            return
        kind = message["type"]
        if kind == "response.speak.start":
            self._starts(number)
        elif kind in ("response.speak.end", "response.gesture.end"):
            with self._changed:
                self._motions.pop(number, None)
                self._changed.notify_all()
        exchange = self._exchanges.get(number)
        if exchange is not None:
            exchange.put(message)

    def _starts(self, number: str) -> None:
        with self._changed:
            motion = self._motions.get(number)
            if motion is not None:
                motion.started = True
        if motion is not None and motion.unwanted:
            with suppress(LostConnection):
                self._stopping.send("request.speak.stop")

    # --- losing and finding it -------------------------------------------------------------------

    def _connect(self) -> None:
        """Raises `LostConnection`, `AccessDenied`."""
        self._attempt += 1
        attempt = self._attempt

        def ended() -> None:
            self._lose(attempt)

        opened: list[Connection] = []
        try:
            for _ in range(2):
                opened.append(Connection(self._where, self._key, self._heard, ended))
            with self._changed:
                if self._ended == attempt:
                    raise LostConnection(GONE)
                self._asking, self._stopping = opened
                self._connected = attempt
                self._motions.clear()
        except BaseException:
            for connection in opened:
                connection.close()
            raise

    def _lose(self, attempt: int) -> None:
        with self._changed:
            if self._closing.is_set() or attempt <= self._ended:
                return
            self._ended = attempt
            if attempt != self._connected:
                return  # it was never found, and is being looked for
        self._link.lost(GONE)
        for exchange in list(self._exchanges.values()):
            exchange.put(None)
        with self._changed:
            self._changed.notify_all()
        threading.Thread(target=self._find_again, name="furhat: find", daemon=True).start()

    def _find_again(self) -> None:
        for connection in (self._asking, self._stopping):
            connection.close()
        pause = FIRST_PAUSE
        while not self._closing.wait(pause):
            pause = min(2 * pause, LONGEST_PAUSE)
            try:
                self._connect()
            except (LostConnection, AccessDenied):
                continue
            # Whoever asked for what it may still be saying was told that it is lost.
            with suppress(LostConnection):
                self._hush(self._stopping)
            break
        if self._closing.is_set():
            self.close()
            return
        self._link.found()
        if self._ended == self._connected:
            self._link.lost(GONE)
