"""A robot's server: the wire and the web pages on one port.

The path of a call: a frame comes in (`Client.serve`), the protocol reads it (`protocol`), a worker
thread does it (`dispatch`), and the reply goes out through the client's own queue. The loop thread
never waits for a robot, so that a stop is heard at once, whatever else goes on.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import queue
import ssl
import threading
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Final, Protocol

import jsonschema
import msgspec
import uvicorn
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import (
    HTMLResponse,
    JSONResponse,
    PlainTextResponse,
)
from starlette.routing import BaseRoute, Mount, Route, WebSocketRoute
from starlette.types import ASGIApp
from starlette.websockets import WebSocket

from robot_api import protocol
from robot_api.driver import EVENTS, Driver, Event, StopFlag
from robot_api.errors import (
    InternalError,
    InvalidCall,
    RobotError,
    StopNotConfirmed,
    Stopped,
)
from robot_api.methods import METHODS
from robot_api.openrpc import openrpc
from robot_api.schema import is_oversize, read_arguments, with_whole_numbers
from robot_api.serving import access, roles
from robot_api.serving.beside import Beside
from robot_api.serving.connections import REMEMBERED, UNCONFIRMED, Client
from robot_api.serving.dispatch import Dispatcher, Job, Lane
from robot_api.serving.guard import OPEN_TO_ALL, Doors, Guard
from robot_api.serving.port import CannotListen as CannotListen
from robot_api.serving.port import listen, on_signals
from robot_api.serving.status import HEADERS, Status, status_page
from robot_api.serving.two_way_port import TwoWayServer
from robot_api.serving.watchdog import Watchdog

CALLER: Final = ("who", "by", "changed_by")
"""Parameters of services in which callers say who they are. Who has signed in need not be believed:
the name of their account stands there."""
LONGEST_NAME: Final = 60
"""Characters of the name of whoever stops the robot."""
DEFAULT_PORT: Final = 9090
PING_SECONDS: Final = 1.25
"""How often a client is asked for a sign of life, and how long it has to answer."""

MAX_CLIENTS: Final = 256
"""Connections at a time: each takes a descriptor, of which the robot's own work needs some."""
MAX_LOOKING: Final = 128
"""Of those who may not operate the robot."""
FULL: Final = "The robot's server has no room for another connection. Close one, then try again."
MAX_HEAD: Final = 8 * 1024
"""Bytes of the head of a request, which is read before it is known who sends it."""

PATIENCE: Final = 2.0
"""Seconds beyond those that a robot says it needs for it, after which a stop that nobody answers
counts as not confirmed."""
NOTICE_SIGNALS: Final = 0.1
"""Seconds after which the main thread looks up: a signal does not always wake it, for the system
may hand it to another thread."""
_STOPS: Final = ("stopping", "stopped")

_log = logging.getLogger("robot_api.server")
# It says so, partly with a traceback, of every stranger who is refused or talks nonsense, and of
# every browser that leaves before its page has come.
_NO_NEWS: Final = ("without completing handshake", "Invalid UTF-8", "Invalid HTTP request")
_LEFT_EARLY: Final = "No response returned."


def _is_news(record: logging.LogRecord) -> bool:
    error = record.exc_info[1] if record.exc_info else None
    return str(error) != _LEFT_EARLY and not any(words in record.getMessage() for words in _NO_NEWS)


logging.getLogger("uvicorn.error").addFilter(_is_news)


class Publish(Protocol):
    """Sends an event to those who subscribed to its kind, or to one connection of them."""

    def __call__(self, kind: str, data: Event, to: str | None = None) -> None: ...


@dataclass(frozen=True)
class Context:
    """What the handler of a service is told besides its params."""

    connection: str
    """The name of the connection that the call came from."""
    stop: StopFlag
    """Set when the call is cancelled or the robot is stopped."""
    publish: Publish
    """`Server.publish`."""
    role: roles.Role = "operator"
    """What the caller may do; they have the right that the service needs."""
    who: str | None = None
    """The caller's name, if they have signed in."""


@dataclass(frozen=True)
class Service:
    """A further method on the wire, such as `program.run`.

    A service goes on when the connection that called it is lost, unless it is `for_caller`; it ends
    when it is done, when the call is cancelled, and when the robot is stopped.
    """

    handler: Callable[[dict[str, Any], Context], Any]
    """Runs in a worker thread; returns JSON data, raises a `RobotError`."""
    params: Mapping[str, Any] = field(default_factory=lambda: {"type": "object"})
    """The JSON Schema of its params, an object."""
    doc: str = ""
    """One line."""
    result: Mapping[str, Any] = field(default_factory=dict)
    """The JSON Schema of its result."""
    observes: bool = False
    """Whether it only looks, so that the right to look is enough."""
    for_caller: bool = False
    """Whether it does nothing but make its result, and need not go on without the caller."""
    right: roles.Right | None = None
    """Another right that its callers need than to look or to operate."""
    lane: Lane = "work"
    """Beside which others it runs: "control" if it is done at once, "wait" if it lasts as long as
    something else does."""
    after_stop: bool = False
    """Whether it is begun even if the robot is stopped before a thread has come to it, since it
    tells what became of something; it looks at the flag itself."""

    @property
    def needs(self) -> roles.Right:
        """The right that its callers need."""
        return self.right or ("look" if self.observes else "operate")


class Server:
    """Serves one robot.

        with Server(driver, port=0) as server:
            robot = Robot(server.address)

    `port` 0 is any free port. On another host than this machine a `token` is needed; if none is
    given one is made up. `services` are further methods by their names, `events` the kinds of
    events that they publish, each with what its data says; of those `remembered` the last one is
    sent to who subscribes later. `pages` is an application whose pages
    are served beside the wire, in a loop of its own; without one, `status_page` makes the page at
    `/`. `on_left` is told the name of each connection that is gone, in the loop thread.
    `encryption`: the port also speaks TLS, with this context, and plainly with this machine alone.
    `doors` let in who has an account. `before_call` is told who is about to call which robot
    method with which arguments, and may raise a `RobotError`; of a stop it is not told.
    The driver stays the caller's: the server stops the robot when it ends, and does not close it.
    """

    def __init__(
        self,
        driver: Driver,
        host: str = "127.0.0.1",
        port: int = DEFAULT_PORT,
        *,
        services: Mapping[str, Service] | None = None,
        events: Mapping[str, str] | None = None,
        remembered: Iterable[str] = (),
        token: str | None = None,
        pages: ASGIApp | None = None,
        on_left: Callable[[str], None] | None = None,
        status_page: Callable[[Status], str] = status_page,
        ping_seconds: float = PING_SECONDS,
        encryption: ssl.SSLContext | None = None,
        doors: Doors | None = None,
        before_call: Callable[[str | None, str, Mapping[str, Any]], None] | None = None,
    ) -> None:
        self.token = token if token or access.is_loopback(host) else access.new_token()
        """What a client must bring, or None."""
        self.own_token = access.new_token()
        """What a program of this server's own shows, of whose robot calls `before_call` is not
        told."""
        self.observer_token = access.new_token()
        """With it in place of the other, a client looks on: it moves nothing."""
        self.driver = driver
        self.services = dict(services or {})
        self.events = {**EVENTS, **(events or {})}
        self.remembered = frozenset((*REMEMBERED, *remembered))
        """Kinds of events that tell how it is from then on."""
        self.dispatcher = Dispatcher(driver)
        self.clients: set[Client] = set()
        self.methods = self._readers()
        self._host = host
        self._port = port
        self._status_page = status_page
        self._pages = Beside(pages) if pages else None
        self._on_left = on_left or _ignore
        self._before_call = before_call
        self._encrypted = encryption is not None
        self._doors = doors
        self._pose: Event | None = None
        # The frames of events that tell how it is, for who subscribes later.
        self._last: dict[str, str] = {}
        self._clients_met = 0
        self._loop: asyncio.AbstractEventLoop | None = None
        self._unsubscribe: Callable[[], None] = _nothing
        self._started = threading.Event()
        self._guard = self._app()
        config = uvicorn.Config(
            self._guard,
            log_config=None,
            access_log=False,
            http="h11",  # the other parser takes heads of any length
            h11_max_incomplete_event_size=MAX_HEAD,
            proxy_headers=False,
            timeout_graceful_shutdown=1,
            ws="websockets-sansio",
            ws_max_size=protocol.MAX_FRAME,
            ws_per_message_deflate=False,
            ws_ping_interval=ping_seconds,
            ws_ping_timeout=ping_seconds,
        )
        self._uvicorn = TwoWayServer(config, encryption)
        self._thread: threading.Thread | None = None
        self._watchdog: Watchdog | None = None

    @property
    def address(self) -> str:
        """ "host:port", with the port that it really has once it is started."""
        host = f"[{self._host}]" if ":" in self._host else self._host
        return f"{host}:{self._port}"

    # --- from start to end

    def start(self) -> None:
        """Begin to serve, in a thread of its own, if it does not yet. Raises CannotListen."""
        if self._thread is not None:
            return
        listening = listen(self._host, self._port)
        self._port = listening.getsockname()[1]
        self._unsubscribe = self.driver.subscribe(self.publish)
        self._thread = threading.Thread(
            target=self._uvicorn.run, args=([listening],), name="robot server", daemon=True
        )
        self._thread.start()
        self._started.wait()
        if self._loop is not None:
            self._watchdog = Watchdog(self._loop, lambda: self.dispatcher.moves, self._bark)

    def close(self, because: str = "The robot's server was ended.") -> None:
        """Stop the robot, leave it standing, and let every client go. Raises `StopNotConfirmed`, in
        the end, if the robot has not said that it stands."""
        if self._thread is None:
            return
        try:
            with contextlib.suppress(InternalError):  # which is in the log
                self.stop(because)
        finally:
            self._unsubscribe()
            if self._watchdog is not None:
                self._watchdog.close()
            self._uvicorn.should_exit = True
            self._thread.join(5)
            self._thread = None
            self.dispatcher.close()

    def __enter__(self) -> Server:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def serve_forever(self, started: Callable[[Server], None] | None = None) -> None:
        """Serve until Ctrl-C or SIGTERM, then stop the robot and return. Main thread only.

        `started` is called once the server can be reached; for the line that says where.
        """
        ended = threading.Event()
        with on_signals(ended.set):
            self.start()
            try:
                if started:
                    started(self)
                while not ended.wait(NOTICE_SIGNALS):
                    if self._thread is not None and not self._thread.is_alive():
                        raise InternalError(
                            "The robot's server has ended by a fault of its own. Start it again."
                        )
            finally:
                self.close()

    def publish(self, kind: str, data: Event, to: str | None = None) -> None:
        """Send an event to every client that subscribed to its kind; only to the connection of the
        name `to`, if there is one. From any thread; returns at once."""
        if kind == "pose":
            self._pose = data
        if kind in _STOPS:
            self._last.pop(UNCONFIRMED, None)
        try:
            frame = protocol.event_frame(kind, data)
        except (msgspec.MsgspecError, TypeError, ValueError):
            _log.exception("an event of the kind %s cannot be sent", kind)
            return
        if kind in self.remembered:
            self._last[kind] = frame
        self.in_loop(self._send_event, kind, frame, to)

    def wanted(self, kind: str) -> bool:
        """Whether somebody subscribed to this kind of event. From any thread."""
        return any(client.wire.wants(kind) for client in tuple(self.clients))

    def stop(self, because: str) -> None:
        """Stop the robot and every call in flight. From any thread but the loop's; returns when the
        robot has confirmed that it stands. Raises `StopNotConfirmed` if it does not in time."""
        outcome: queue.SimpleQueue[RobotError | Stopped | None] = queue.SimpleQueue()
        self.dispatcher.stop(because, lambda result, error: outcome.put(error))
        patience = self.driver.capabilities().stop_within + PATIENCE
        try:
            error = outcome.get(timeout=patience)
        except queue.Empty:
            error = StopNotConfirmed()
        if error is not None:
            raise error

    def _bark(self, because: str) -> None:
        self.dispatcher.stop(because, lambda result, error: None)

    def check_guests(self) -> None:
        """Close the connections of those whom `doors` know no more. From any thread; returns at
        once."""
        self.in_loop(self._guard.check_guests)

    def in_loop(self, task: Callable[..., None], *arguments: Any) -> None:
        """Do it in the loop thread, which alone touches connections; not at all after the end."""
        if self._loop is not None:
            with contextlib.suppress(RuntimeError):  # the loop has ended
                self._loop.call_soon_threadsafe(task, *arguments)

    def last(self, kind: str) -> str | None:
        """The frame of the last event of that kind, one of `remembered`, if it still holds."""
        return self._last.get(kind)

    def _send_event(self, kind: str, frame: str, to: str | None) -> None:
        for client in self.clients:
            if client.wire.wants(kind) and to in (None, client.name):
                client.send(frame, kind)

    # --- what can be called

    def _readers(self) -> dict[str, protocol.Reader]:
        """Each method's full name with what checks its params."""
        readers: dict[str, protocol.Reader] = {
            f"robot.{name}": _robot_reader(name) for name in METHODS
        }
        readers[protocol.STOP] = _read_stop
        for name in ("robot.capabilities", "rpc.discover"):
            readers[name] = _service_reader(name, {})
        for name, service in self.services.items():
            if name.partition(".")[0] in ("robot", "rpc", "event"):
                raise ValueError(f"a service cannot be called {name}")
            readers[name] = _service_reader(name, service.params)
        return readers

    def job(self, client: Client, call: protocol.Call) -> Job:
        """The job that does a call."""

        def done(result: Any, error: RobotError | Stopped | None) -> None:
            reply = (
                protocol.result_reply(call, result)
                if error is None
                else protocol.error_reply(call, error)
            )
            self.in_loop(client.finish, call, reply)

        name = call.method.removeprefix("robot.")
        method = METHODS.get(name) if name != call.method else None
        if method is None:
            service = self.services.get(call.method)
            fleeting = service is not None and service.for_caller
            after_stop = service is not None and service.after_stop
            run_service = self._service(client, call)
            lane = service.lane if service is not None else "control"
            if lane == "work" and not roles.may(client.guest.role, "operate"):
                lane = "look"
            return Job(
                call.method,
                run_service,
                done,
                client,
                lane,
                fleeting=fleeting,
                after_stop=after_stop,
            )

        def run(stop: StopFlag) -> Any:
            if self._before_call is not None and not client.guest.own:
                self._before_call(client.guest.name, name, call.arguments)
            return self.driver.call(name, call.arguments, stop)

        return Job(call.method, run, done, client, "robot", moves=method.moves)

    def _service(self, client: Client, call: protocol.Call) -> Callable[[StopFlag], Any]:
        if call.method == "robot.capabilities":
            return lambda stop: self.driver.capabilities()
        if call.method == "rpc.discover":
            return lambda stop: self._document()
        service, guest = self.services[call.method], client.guest
        arguments = call.arguments
        if guest.name is not None:
            known = service.params.get("properties", {})
            arguments = {**arguments, **{name: guest.name for name in CALLER if name in known}}
        return lambda stop: service.handler(
            arguments, Context(client.name, stop, self.publish, guest.role, guest.name)
        )

    def needs(self, method: str) -> roles.Right:
        """The right that a method on the wire needs; all but services and a few of the protocol's
        own are the robot's."""
        if method in roles.OF_THE_PROTOCOL:
            return "know"
        service = self.services.get(method)
        return service.needs if service else "drive"

    # --- web pages and the wire

    def _app(self) -> Guard:
        routes: list[BaseRoute] = [
            Route(OPEN_TO_ALL, self._health),
            Route("/openrpc.json", self._described),
            WebSocketRoute("/", self._serve_client),
            Mount("/", self._pages) if self._pages else Route("/", self._page),
        ]
        return Guard(
            Starlette(routes=routes, lifespan=self._lifespan),
            tokens=self._tokens,
            local=access.is_loopback(self._host),
            pages=self._pages is not None,
            encrypted=self._encrypted,
            doors=self._doors,
        )

    @contextlib.asynccontextmanager
    async def _lifespan(self, app: Starlette) -> Any:
        self._loop = asyncio.get_running_loop()
        async with self._pages.running() if self._pages else contextlib.nullcontext():
            self._started.set()
            yield

    def _tokens(self) -> access.Tokens:
        # Cookies know no ports: another robot's server on this machine has its own.
        cookie = f"robot-{self._port}"
        if self._doors is None:
            return access.Tokens(self.token, self.observer_token, cookie, self.own_token)
        known = self._doors.known
        return access.Tokens(self.token, self.observer_token, cookie, self.own_token, known)

    async def _health(self, request: Request) -> JSONResponse:
        return JSONResponse({"status": "ok"})

    async def _described(self, request: Request) -> JSONResponse:
        return JSONResponse(await asyncio.to_thread(self._document), headers=HEADERS)

    def _document(self) -> dict[str, Any]:
        return openrpc(self.driver.capabilities(), self.services, self.events)

    async def _page(self, request: Request) -> HTMLResponse:
        status = Status(
            capabilities=await asyncio.to_thread(self.driver.capabilities),
            address=self.address,
            pose=_in_words(self._pose),
            connections=len(self.clients),
            in_flight=self.dispatcher.in_flight,
            needs_token=self.token is not None,
        )
        return HTMLResponse(self._status_page(status), headers=HEADERS)

    async def _serve_client(self, socket: WebSocket) -> None:
        guest = socket.scope["state"]["guest"]
        if self._is_full(guest):
            await socket.send_denial_response(PlainTextResponse(FULL, 503))
            return
        self._clients_met += 1
        client = Client(self, f"{self._clients_met}", guest)
        self.clients.add(client)
        try:
            await client.serve(socket)
        finally:
            self.clients.discard(client)
            self.dispatcher.drop(client)
            self._on_left(client.name)

    def _is_full(self, guest: access.Guest) -> bool:
        """Whether there is no room for one more of them: who only looks on never takes the room of
        who works with the robot."""
        if roles.may(guest.role, "operate"):
            return len(self.clients) >= MAX_CLIENTS
        looking = sum(not roles.may(each.guest.role, "operate") for each in self.clients)
        return looking >= MAX_LOOKING


def _read_stop(params: protocol.Params) -> dict[str, Any]:
    """In whose name the stop is, if that is told. Whatever else comes with it, a stop is a stop."""
    who = params.get("who") if isinstance(params, dict) else None
    named = isinstance(who, str) and who.isprintable() and who.strip()
    return {"who": who.strip()[:LONGEST_NAME]} if isinstance(who, str) and named else {}


def _robot_reader(name: str) -> protocol.Reader:
    def read(params: protocol.Params) -> dict[str, Any]:
        if isinstance(params, list):
            return read_arguments(name, params)
        return read_arguments(name, named=params)

    return read


def _service_reader(name: str, schema: Mapping[str, Any]) -> protocol.Reader:
    """Params by position stand in the order of the schema's properties."""
    validator = jsonschema.Draft202012Validator(schema)
    names = list(schema.get("properties", {}))

    def read(params: protocol.Params) -> dict[str, Any]:
        if isinstance(params, list):
            if len(params) > len(names):
                raise InvalidCall(f"{name} takes {len(names)} params at most.")
            params = dict(zip(names, params, strict=False))
        given = dict(params or {})
        if is_oversize(schema, given):
            raise InvalidCall(f"{name} is given more than it can take. Send less.")
        error = jsonschema.exceptions.best_match(validator.iter_errors(given))
        if error is not None:
            at = f"{'.'.join(map(str, error.absolute_path))} of " if error.absolute_path else ""
            raise InvalidCall(f"{at}{name} is not as it should be: {error.message[:300]}.")
        return dict(with_whole_numbers(schema, given))

    return read


def _in_words(pose: Event | None) -> str:
    if pose is None:
        return "has not moved yet"
    return f"{pose.get('place') or 'on its way'} ({pose.get('x', 0):.1f}, {pose.get('y', 0):.1f})"


def _nothing() -> None:
    pass


def _ignore(name: str) -> None:
    pass
