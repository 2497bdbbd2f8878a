"""The client: a robot somewhere else, as an object whose methods return when the action is done.

    from robot_api import Robot

    with Robot("127.0.0.1:9090") as robot:
        robot.say("Hello")
        robot.goto("pharmacy")

A failure raises one of `robot_api.errors`. All methods may be called from several threads; calls
from different threads run side by side, and `stop()` overtakes them all.
"""

from __future__ import annotations

import contextlib
import itertools
import logging
import math
import queue
import socket
import ssl
import threading
import time
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, Final

import msgspec
import websocket

from robot_api import protocol
from robot_api.calls import Calls
from robot_api.driver import Capabilities, StopFlag
from robot_api.errors import (
    AccessDenied,
    InternalError,
    InvalidCall,
    LostConnection,
    NotTrusted,
    RobotError,
)
from robot_api.methods import METHODS
from robot_api.schema import bind, read_result

DEFAULT_PORT: Final = 9090
FIRST_PAUSE: Final = 0.05
"""Seconds between the first two attempts to connect again; each pause is twice the one before."""
LONGEST_PAUSE: Final = 1.0
NOTICE_SIGNALS: Final = 0.1
"""Seconds after which a waiting main thread looks up: a Ctrl-C does not always wake it, for the
system may hand the signal to another thread."""

_log = logging.getLogger("robot_api.client")

_DEFAULTS: Final = {
    method.name: {
        parameter.name: parameter.default
        for form in method.forms
        for parameter in form
        if not parameter.required
    }
    for method in METHODS.values()
}

Listener = Callable[[str, dict[str, Any]], None]
"""Called with the kind of an event and its data."""


class Robot(Calls):
    """A connection to a robot's server.

    `address` is "host:port", "host" or a "ws://" or "wss://" address; `token` what a server that
    asks for one was started with; `ca` a file with the certificate of the authority that a "wss://"
    server's own is from, if this machine does not trust it anyway. `timeout` is how many seconds a
    connection may take to be made, and how long the server may be silent (while a call is in flight
    too) before it counts as lost.
    Raises LostConnection if there is no robot at the address, AccessDenied for a wrong token or a
    certificate that is not to be trusted.

    A connection that is lost between calls is made again by the next call. A call that is in flight
    when it is lost raises LostConnection and is never repeated: the robot may have done it.
    `on_lost` is told, in a thread of its own, when a connection has ended.
    """

    def __init__(
        self,
        address: str = f"127.0.0.1:{DEFAULT_PORT}",
        *,
        token: str | None = None,
        ca: str | Path | None = None,
        timeout: float = 10.0,
        on_lost: Callable[[], None] | None = None,
    ) -> None:
        self.address = address
        self._on_lost = on_lost
        self._url = websocket_url(address)
        self._token = token
        self._trust = _trust(ca) if self._url.startswith("wss://") else None
        self._timeout = timeout
        self._ids = itertools.count(1)
        # Guards the listeners; `_connecting` is held while a lost connection is made again, which
        # may take long.
        self._lock = threading.Lock()
        self._connecting = threading.Lock()
        self._closed = threading.Event()
        # Who wants to hear of which kinds of events.
        self._listeners: list[tuple[frozenset[str], Listener]] = []
        self._events: queue.SimpleQueue[protocol.Event | None] = queue.SimpleQueue()
        self._link = self._connect()

    # --- calls

    def request(
        self, method: str, params: protocol.Params = None, stop: StopFlag | None = None
    ) -> Any:
        """Call any method of the server, such as `program.run`, and return its result as JSON
        data. `stop` breaks off this call alone, which then raises `Stopped`."""
        return self._connected().call(next(self._ids), method, params, stop)

    def perform(
        self, method: str, arguments: Mapping[str, Any], stop: StopFlag | None = None
    ) -> Any:
        """Do a method of the table by its name; as `request`, with a result of the method's kind:
        plain data, a `Location` or a `Clock`."""
        defaults = _DEFAULTS[method]
        # What is left out stays left out: an older server may not know it.
        params = {
            name: value
            for name, value in arguments.items()
            if name not in defaults or value != defaults[name]
        }
        for name, value in params.items():
            # JSON has no word for these, and would say nothing instead.
            if isinstance(value, float) and not math.isfinite(value):
                raise InvalidCall(f"{name} of {method} must be a number; got {value}.")
        result = self.request(f"robot.{method}", params, stop)
        try:
            return read_result(METHODS[method], result)
        except msgspec.ValidationError:
            raise InternalError(f"The robot's answer to {method} makes no sense.") from None

    def capabilities(self) -> Capabilities:
        """What this robot can do."""
        return msgspec.convert(self.request("robot.capabilities"), Capabilities)

    def cancel(self) -> None:
        """Stop the calls that this client has in flight: each raises `Stopped` where it was made.
        From any thread; returns at once."""
        self._link.cancel_all()

    def _call(self, method: str, /, *arguments: Any, **named: Any) -> Any:
        return self.perform(method, bind(method, arguments, named) if arguments else named)

    # --- events

    def subscribe(self, kinds: str | Iterable[str], listener: Listener) -> Callable[[], None]:
        """Call `listener(kind, data)` for each event of these kinds, "*" for all; returns what ends
        it. Listeners are called one after the other in a thread of their own, and may call the
        robot. They are subscribed again when a lost connection has been made again."""
        wanted = frozenset([kinds] if isinstance(kinds, str) else kinds)
        entry = (wanted, listener)
        with self._lock:
            if not self._listeners:
                self._start_thread("robot events", self._hand_out_events)
            self._listeners.append(entry)  # what comes right behind the answer is for them, too
        try:
            self.request(protocol.SUBSCRIBE, {"events": sorted(wanted)})
        except BaseException:
            self._forget(entry)
            raise

        def unsubscribe() -> None:
            unwanted = self._forget(entry)
            if unwanted and not self._link.lost.is_set():
                with contextlib.suppress(LostConnection):  # nothing comes from there any more
                    self.request(protocol.UNSUBSCRIBE, {"events": sorted(unwanted)})

        return unsubscribe

    def _forget(self, entry: tuple[frozenset[str], Listener]) -> frozenset[str]:
        """Let a listener go; returns the kinds of events that nobody listens to any more."""
        with self._lock:
            if entry not in self._listeners:
                return frozenset()
            self._listeners.remove(entry)
            if not self._listeners:
                self._events.put(None)
            return entry[0].difference(*(kinds for kinds, _ in self._listeners))

    def _hand_out_events(self) -> None:
        while (event := self._events.get()) is not None:
            with self._lock:
                listeners = list(self._listeners)
            for kinds, listener in listeners:
                if event.kind in kinds or protocol.EVERY_EVENT in kinds:
                    try:
                        listener(event.kind, event.data)
                    except Exception:  # noqa: BLE001 - one listener must not silence the others
                        _log.exception("a listener to %s failed", event.kind)

    # --- the connection

    @property
    def connected(self) -> bool:
        """Whether the connection stands, as far as is known. The next call makes a lost one
        again."""
        return not self._link.lost.is_set()

    def close(self) -> None:
        """Let go of the robot; calls in flight raise LostConnection, and their motion is stopped
        by the server."""
        self._closed.set()
        self._events.put(None)
        self._link.close()

    def __enter__(self) -> Robot:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _connected(self) -> _Link:
        """The connection, made again if it was lost."""
        link = self._link
        if not link.lost.is_set():
            return link
        with self._connecting:
            if self._link.lost.is_set():
                self._link = self._connect_again()
            return self._link

    def _connect_again(self) -> _Link:
        until = time.monotonic() + self._timeout
        pause = FIRST_PAUSE
        while True:
            if self._closed.is_set():
                raise LostConnection("This connection to the robot was closed.")
            try:
                return self._connect()
            except LostConnection:
                if time.monotonic() + pause > until:
                    raise
            self._closed.wait(pause)
            pause = min(2 * pause, LONGEST_PAUSE)

    def _connect(self) -> _Link:
        opened = _open(self._url, self._token, self._timeout, self.address, self._trust)
        link = _Link(opened, self._link_said)
        with self._lock:
            kinds: set[str] = set().union(*(kinds for kinds, _ in self._listeners))
        threading.Thread(
            target=link.receive, args=(self._link_lost,), name="robot replies", daemon=True
        ).start()
        if kinds:
            link.call(next(self._ids), protocol.SUBSCRIBE, {"events": sorted(kinds)})
        return link

    def _link_said(self, event: protocol.Event) -> None:
        self._events.put(event)

    def _link_lost(self) -> None:
        """Those who listen make no calls that would connect again."""
        if self._on_lost is not None:
            self._on_lost()  # who then sees to it
        elif self._listeners and not self._closed.is_set():
            self._start_thread("robot reconnect", self._connect_for_listeners)

    def _connect_for_listeners(self) -> None:
        try:
            self._connected()
        except RobotError as error:
            _log.warning("events have ended: %s", error)

    def _start_thread(self, name: str, run: Callable[[], None]) -> None:
        threading.Thread(target=run, name=name, daemon=True).start()


class _Pending:
    """A call in flight: who made it waits here."""

    def __init__(self) -> None:
        self._ended = threading.Lock()
        self._ended.acquire()
        self.reply = protocol.Reply(None)

    def end(self, reply: protocol.Reply) -> None:
        self.reply = reply
        self._ended.release()

    def wait(self) -> Any:
        main = threading.current_thread() is threading.main_thread()
        while not self._ended.acquire(timeout=NOTICE_SIGNALS if main else -1):
            pass
        if self.reply.error is not None:
            raise self.reply.error
        return self.reply.result


class _Link:
    """One WebSocket connection, from the moment it is open until it is lost."""

    def __init__(
        self, opened: websocket.WebSocket, on_event: Callable[[protocol.Event], None]
    ) -> None:
        self.lost = threading.Event()
        self._socket = opened
        self._raw = opened.sock
        self._on_event = on_event
        # Held while a request is noted and sent, so that a cancel never overtakes what it cancels.
        self._sending = threading.Lock()
        # Guards the calls in flight, under their ids.
        self._lock = threading.Lock()
        self._pending: dict[protocol.Id, _Pending] = {}

    def call(
        self, id: int, method: str, params: protocol.Params, stop: StopFlag | None = None
    ) -> Any:
        """Send the request and wait for its reply."""
        frame = protocol.request(id, method, params)
        pending = _Pending()
        with self._sending:
            with self._lock:
                if self.lost.is_set():
                    raise _connection_was_lost()
                self._pending[id] = pending
            self._send(frame)
        if stop is not None:
            stop.on_set(lambda: self._send(_cancel(id)))
        try:
            return pending.wait()
        except KeyboardInterrupt:
            # Whoever presses Ctrl-C while the robot drives wants it to stand.
            self._send(_cancel(id))
            raise

    def cancel_all(self) -> None:
        with self._sending:
            with self._lock:
                pending = list(self._pending)
            for id in pending:
                self._send(_cancel(id))

    def close(self) -> None:
        with contextlib.suppress(websocket.WebSocketException, OSError):
            self._socket.send_close()
        self._lose()

    def receive(self, on_lost: Callable[[], None]) -> None:
        """Hand out what comes in until the connection is lost."""
        try:
            self._receive()
        except (websocket.WebSocketException, OSError, ValueError):
            pass  # however it ends, it has ended
        finally:
            self._lose()
            if self._raw is not None:
                self._raw.close()
            on_lost()

    def _receive(self) -> None:
        asked_for_sign_of_life = False
        while True:
            try:
                opcode, content = self._socket.recv_data(control_frame=True)
            except websocket.WebSocketTimeoutException:
                if asked_for_sign_of_life:
                    return
                self._socket.ping()
                asked_for_sign_of_life = True
                continue
            asked_for_sign_of_life = False
            if opcode == websocket.ABNF.OPCODE_TEXT:
                self._take(protocol.read_message(content.decode()))
            elif opcode == websocket.ABNF.OPCODE_CLOSE:
                return

    def _take(self, message: protocol.Reply | protocol.Event | None) -> None:
        match message:
            case protocol.Event():
                self._on_event(message)
            case protocol.Reply():
                with self._lock:
                    pending = self._pending.pop(message.id, None)
                if pending is not None:
                    pending.end(message)
                elif message.error is not None:
                    _log.warning("the robot's server says: %s", message.error)

    def _send(self, frame: str) -> None:
        try:
            self._socket.send(frame)
        except (websocket.WebSocketException, OSError):
            # The calls in flight learn of it as of every loss.
            self._lose()

    def _lose(self) -> None:
        with self._lock:
            self.lost.set()
            pending, self._pending = self._pending, {}
        with contextlib.suppress(OSError):
            if self._raw is not None:
                self._raw.shutdown(socket.SHUT_RDWR)  # wakes the thread that receives
        for call in pending.values():
            call.end(protocol.Reply(None, error=_connection_was_lost()))


def _connection_was_lost() -> LostConnection:
    return LostConnection("The connection to the robot was lost.")


def _cancel(id: int | protocol.Id) -> str:
    return protocol.notification(protocol.CANCEL, {"id": id})


_trusted: list[Path] = []


def trust_also(authority: str | Path) -> None:
    """Trust this authority as well, in all connections that this process makes from now on. Raises
    `InvalidCall` if the file has no certificate (PEM)."""
    _trust(authority)
    _trusted.append(Path(authority))


def _trust(ca: str | Path | None) -> ssl.SSLContext:
    """Whom a client trusts: the authorities of this system, and those in these files."""
    trust = ssl.create_default_context()
    for file in (*_trusted, *([ca] if ca is not None else [])):
        try:
            trust.load_verify_locations(file)
        except (OSError, ValueError):  # an SSLError is an OSError
            raise InvalidCall(
                f"{file} is no file with an authority's certificate (PEM). The server's page /trust"
                " has it."
            ) from None
    return trust


def _open(
    url: str, token: str | None, timeout: float, address: str, trust: ssl.SSLContext | None
) -> websocket.WebSocket:
    try:
        opened = websocket.create_connection(
            url,
            timeout=timeout,
            sslopt={"context": trust} if trust else None,
            header={"Authorization": f"Bearer {token}"} if token else None,
            suppress_origin=True,
            enable_multithread=True,
            skip_utf8_validation=True,  # slow, and decoding does the same
        )
    except websocket.WebSocketBadStatusException as refused:
        sentence = (refused.resp_body or b"").decode(errors="replace").strip()
        if refused.status_code in (401, 403):
            raise AccessDenied(sentence or "The robot refuses the connection.") from None
        if refused.status_code == 503 and sentence:
            raise LostConnection(sentence) from None
        raise LostConnection(f"What answers at {address} is no robot.") from None
    except websocket.WebSocketTimeoutException:
        raise LostConnection(f"The robot at {address} does not answer.") from None
    except ssl.SSLCertVerificationError as error:
        why = error.verify_message.rstrip(".")
        raise NotTrusted(
            f"The certificate of {address} is not to be trusted ({why})."
            " Give the certificate of its authority, which the server's page /trust has, with --ca"
            " (in Python: ca=...)."
        ) from None
    except (websocket.WebSocketException, OSError, ValueError):
        raise LostConnection(
            f"There is no robot at {address}. Is its server running, and the address right?"
        ) from None
    # Half of it in silence, then a question for a sign of life, then the other half.
    opened.settimeout(timeout / 2)
    return opened


def websocket_url(address: str) -> str:
    """The WebSocket address that "host:port", "host" or an address with its scheme stands for."""
    if address.startswith(("ws://", "wss://")):
        return address
    host, _, port = address.rpartition(":")
    if not host or not port.isdigit():
        return f"ws://{address}:{DEFAULT_PORT}/"
    return f"ws://{address}/"
