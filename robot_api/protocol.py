"""The wire without the wire: JSON-RPC 2.0 as both ends speak it, with no input or output.

One text frame of a WebSocket holds one message, or a batch of them. A client sends requests,

    {"jsonrpc": "2.0", "id": 7, "method": "robot.goto", "params": {"place": "pharmacy"}}

and each one with an id is answered once, with its result or with an error that names its class:

    {"jsonrpc": "2.0", "id": 7, "result": null}
    {"jsonrpc": "2.0", "id": 7, "error": {"code": -32005, "message": "A bed blocks the way.",
                                          "data": {"error": "Blocked"}}}

Methods are `robot.<name in the method table>`, `robot.capabilities`, the server's services such as
`program.run`, and four of the protocol's own:

    rpc.discover                         the OpenRPC document
    rpc.cancel {"id": 7}                 true if call 7 was in flight; it ends with `Stopped`
    rpc.subscribe {"events": ["pose"]}   the events subscribed to from now on; "*" is every event
    rpc.unsubscribe {"events": [...]}    the events still subscribed to

Events are notifications: {"jsonrpc": "2.0", "method": "event.pose", "params": {"x": 1.5, ...}}.
The calls of a connection, those of a batch too, run side by side; `robot.stop` overtakes them all.

`Connection` is the server's side of one connection: it is fed frames and says what to do and what
to send. Nothing that a client sends makes it raise. The client's side is `request` and
`read_message`.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from typing import Any, Final

import msgspec

from robot_api.errors import (
    AccessDenied,
    InternalError,
    InvalidCall,
    NotPossible,
    RobotError,
    Stopped,
    error_named,
)
from robot_api.frame import MAX_FRAME as MAX_FRAME
from robot_api.frame import NoJson, TooMuch, read_frame
from robot_api.schema import did_you_mean, no_such_method

MAX_CALLS: Final = 64
"""Most calls in flight on one connection, and most messages in a batch."""
MAX_ID: Final = 200
"""Longest id, in characters."""
EVERY_EVENT: Final = "*"

NOT_ALLOWED: Final = (
    "Your role does not allow this. Sign in as somebody who may, or ask for the operators' link."
)
PARSE_ERROR: Final = -32700
INVALID_REQUEST: Final = -32600
METHOD_NOT_FOUND: Final = -32601
INVALID_PARAMS: Final = InvalidCall.code

Id = str | int | float | None
Params = Mapping[str, Any] | list[Any] | None
Reader = Callable[[Params], dict[str, Any]]
"""Checks the params of one method and returns its arguments by name, or raises InvalidCall."""

STOP: Final = "robot.stop"
CANCEL: Final = "rpc.cancel"
SUBSCRIBE: Final = "rpc.subscribe"
UNSUBSCRIBE: Final = "rpc.unsubscribe"
OWN_METHODS: Final = {CANCEL: "id", SUBSCRIBE: "events", UNSUBSCRIBE: "events"}
"""The methods that a connection answers by itself, each with its parameter."""


# --- what a frame asks for -----------------------------------------------------------------------


class _Batch:
    """The replies to a batch, until the last one is there."""

    def __init__(self, expected: int) -> None:
        self.expected = expected
        self.replies: list[str] = []


@dataclass(frozen=True, eq=False)
class Call:
    """A call to be made; answered with `Connection.finish`."""

    method: str
    arguments: dict[str, Any]
    id: Id
    """What it is answered under and cancelled by."""
    answered: bool
    """False for a notification: nobody hears how it went."""
    batch: _Batch | None


@dataclass(frozen=True)
class Cancel:
    """The call in flight is to be stopped; it is answered in its own time."""

    call: Call


@dataclass(frozen=True)
class Send:
    """A frame to send back now."""

    frame: str


Action = Call | Cancel | Send


class _Refused(Exception):
    """A message that is answered with an error and asks for nothing."""

    def __init__(self, code: int, message: str, id: Id = None) -> None:
        super().__init__(message)
        self.code = code
        self.id = id


class Connection:
    """The server's side of one connection."""

    def __init__(
        self,
        methods: Mapping[str, Reader],
        events: Collection[str],
        may_call: Callable[[str], bool] = lambda method: True,
    ) -> None:
        # What can be called, with what checks its params.
        self._methods = methods
        # Whether this client may call a method: asked before its params are looked at.
        self._may_call = may_call
        # The kinds of events that can be subscribed to.
        self._events = events
        # Calls in flight under their ids.
        self._by_id: dict[Id, Call] = {}
        # All calls in flight, notifications too; `robot.stop` is never counted.
        self._in_flight: set[Call] = set()
        # Kinds of events that the client wants, or EVERY_EVENT.
        self._subscribed: set[str] = set()

    @property
    def calls(self) -> Collection[Call]:
        """The calls in flight."""
        return self._in_flight

    def wants(self, kind: str) -> bool:
        """Whether the client subscribed to this kind of event."""
        return kind in self._subscribed or (
            EVERY_EVENT in self._subscribed and kind in self._events
        )

    def receive(self, frame: str | bytes) -> list[Action]:
        """What a frame from the client asks for, in its order."""
        try:
            content = _parse(frame)
            if isinstance(content, list):
                return self._receive_batch(content)
        except _Refused as refused:
            return [Send(_refusal(refused))]
        return self._receive_message(content, None)

    def finish(self, call: Call, reply: str) -> str | None:
        """The frame to send now that a call has ended, if there is one: nothing for a
        notification, and for a call of a batch only with the last of them.
        `reply` comes from `result_reply` or `error_reply`."""
        if call not in self._in_flight and call.method != STOP:
            return None
        self._in_flight.discard(call)
        if self._by_id.get(call.id) is call:
            del self._by_id[call.id]
        return _collect(reply, call.batch) if call.answered else None

    def _receive_batch(self, messages: list[Any]) -> list[Action]:
        if not messages:
            raise _Refused(INVALID_REQUEST, "The batch is empty.")
        if len(messages) > MAX_CALLS:
            raise _Refused(INVALID_REQUEST, f"A batch holds {MAX_CALLS} messages at most.")
        batch = _Batch(sum(_expects_reply(message) for message in messages))
        return [action for message in messages for action in self._receive_message(message, batch)]

    def _receive_message(self, message: Any, batch: _Batch | None) -> list[Action]:
        """What one message asks for. Each message that expects a reply either becomes a call or is
        answered here, once."""
        try:
            call = self._read_call(message, batch)
            if call.method in OWN_METHODS:
                return self._answer(call)
            if call.method != STOP:
                self._admit(call)
            return [call]
        except _Refused as refused:
            if not _expects_reply(message):
                return []
            return _sent(_collect(_refusal(refused), batch))

    def _read_call(self, message: Any, batch: _Batch | None) -> Call:
        if not isinstance(message, dict):
            raise _Refused(INVALID_REQUEST, "A message must be a JSON object.")
        id = message.get("id")
        if not _is_id(id):
            raise _Refused(
                INVALID_REQUEST, f"An id must be a number or a text of at most {MAX_ID} characters."
            )
        method = message.get("method")
        if id in self._by_id and "id" in message and method != STOP:
            # Answered under no id: under this one the client awaits the first call's result.
            raise _Refused(INVALID_REQUEST, f"The id {id!r} belongs to a call that is in flight.")
        if message.get("jsonrpc") != "2.0":
            raise _Refused(INVALID_REQUEST, 'A message must say "jsonrpc": "2.0".', id)
        if not isinstance(method, str):
            raise _Refused(INVALID_REQUEST, "The method must be given as a text.", id)
        params = message.get("params")
        if not isinstance(params, dict | list) and "params" in message:
            raise _Refused(INVALID_REQUEST, "The params must be an object or an array.", id)
        return Call(method, self._read_params(method, params, id), id, "id" in message, batch)

    def _read_params(self, method: str, params: Params, id: Id) -> dict[str, Any]:
        if method in OWN_METHODS:
            if isinstance(params, list):
                return dict(zip([OWN_METHODS[method]], params, strict=False))
            return dict(params or {})
        read = self._methods.get(method)
        if read is None:
            known = [*self._methods, *OWN_METHODS]
            raise _Refused(METHOD_NOT_FOUND, no_such_method(method, known), id)
        if not self._may_call(method):
            raise _Refused(AccessDenied.code, NOT_ALLOWED, id)
        try:
            return read(params)
        except InvalidCall as error:
            raise _Refused(INVALID_PARAMS, str(error), id) from None

    def _admit(self, call: Call) -> None:
        if len(self._in_flight) >= MAX_CALLS:
            sentence = f"{MAX_CALLS} calls are in flight already. Wait until one of them has ended."
            raise _Refused(NotPossible.code, sentence, call.id)
        self._in_flight.add(call)
        if call.answered:
            self._by_id[call.id] = call

    # --- the protocol's own methods

    def _answer(self, call: Call) -> list[Action]:
        actions: list[Action] = []
        result: Any
        if call.method == CANCEL:
            cancelled = self._cancelled(call)
            actions += [Cancel(cancelled)] if cancelled else []
            result = cancelled is not None
        else:
            result = self._change_subscriptions(call)
        if call.answered:
            actions += _sent(_collect(result_reply(call, result), call.batch))
        return actions

    def _cancelled(self, call: Call) -> Call | None:
        id = call.arguments.get("id")
        if "id" not in call.arguments or not _is_id(id):
            raise _Refused(INVALID_PARAMS, f"{CANCEL} needs the id of a call.", call.id)
        return self._by_id.get(id)

    def _change_subscriptions(self, call: Call) -> list[str]:
        kinds = call.arguments.get("events")
        if not isinstance(kinds, list) or not all(isinstance(kind, str) for kind in kinds):
            sentence = f'{call.method} needs events, a list such as ["pose", "speech"].'
            raise _Refused(INVALID_PARAMS, sentence, call.id)
        known = [*self._events, EVERY_EVENT]
        for kind in kinds:
            if kind not in known:
                sentence = f"There is no event {kind[:60]!r}{did_you_mean(kind, known)}"
                raise _Refused(INVALID_PARAMS, sentence, call.id)
        if call.method == SUBSCRIBE:
            self._subscribed.update(kinds)
        else:
            self._subscribed.difference_update(kinds)
        return sorted(self._subscribed)


# --- reading frames ------------------------------------------------------------------------------


def _parse(frame: str | bytes) -> Any:
    try:
        return read_frame(frame)
    except TooMuch as much:
        raise _Refused(INVALID_REQUEST, str(much)) from None
    except NoJson as none:
        id = none.message.get("id") if isinstance(none.message, dict) else None
        raise _Refused(PARSE_ERROR, str(none), id if _is_id(id) else None) from None


def _is_id(id: Any) -> bool:
    if isinstance(id, str):  # with half a sign in it, nothing can be answered under it
        return len(id) <= MAX_ID and not any("\ud800" <= sign <= "\udfff" for sign in id)
    return id is None or (isinstance(id, int | float) and not isinstance(id, bool))


def _expects_reply(message: Any) -> bool:
    """By the standard a notification is a request without an id, and what is no request at all
    is answered."""
    return not (
        isinstance(message, dict)
        and "id" not in message
        and message.get("jsonrpc") == "2.0"
        and isinstance(message.get("method"), str)
    )


# --- writing frames ------------------------------------------------------------------------------


def result_reply(call: Call, result: Any) -> str:
    """The reply that carries a result; one that says so if it cannot be written as JSON."""
    try:
        return _write({"jsonrpc": "2.0", "id": call.id, "result": result})
    except (msgspec.MsgspecError, TypeError, ValueError, RecursionError):
        sentence = f"The result of {call.method} cannot be sent. The robot's software has a fault."
        return error_reply(call, InternalError(sentence))


def error_reply(call: Call, error: RobotError | Stopped) -> str:
    """The reply that carries an error."""
    return _error(call.id, error.code, str(error), type(error).__name__)


def event_frame(kind: str, data: Mapping[str, Any]) -> str:
    """The frame of an event. Raises TypeError or ValueError if the data cannot be JSON."""
    return _write({"jsonrpc": "2.0", "method": f"event.{kind}", "params": data})


_NAMES: Final = {kind.code: kind.__name__ for kind in (NotPossible, AccessDenied)}


def _refusal(refused: _Refused) -> str:
    name = _NAMES.get(refused.code, "InvalidCall")
    return _error(refused.id, refused.code, str(refused), name)


def _error(id: Id, code: int, message: str, name: str) -> str:
    message = message.encode(errors="replace").decode()
    error = {"code": code, "message": message, "data": {"error": name}}
    return _write({"jsonrpc": "2.0", "id": id, "error": error})


def _write(content: Any) -> str:
    return msgspec.json.encode(content).decode()


def _collect(reply: str, batch: _Batch | None) -> str | None:
    """The frame for a reply: itself, or the whole batch with its last one."""
    if batch is None:
        return reply
    batch.replies.append(reply)
    return f"[{','.join(batch.replies)}]" if len(batch.replies) == batch.expected else None


def _sent(frame: str | None) -> list[Action]:
    return [] if frame is None else [Send(frame)]


# --- the client's side ---------------------------------------------------------------------------


@dataclass(frozen=True)
class Reply:
    """A call has ended."""

    id: Id
    result: Any = None
    error: RobotError | Stopped | None = None


@dataclass(frozen=True)
class Event:
    """Something happened that the client subscribed to."""

    kind: str
    data: dict[str, Any]


def request(id: int, method: str, params: Params = None) -> str:
    """The frame of a request. Raises InvalidCall if the params cannot be sent."""
    return _request({"jsonrpc": "2.0", "id": id, "method": method}, method, params)


def notification(method: str, params: Params = None) -> str:
    """The frame of a request that is not answered. Raises InvalidCall as `request` does."""
    return _request({"jsonrpc": "2.0", "method": method}, method, params)


def _request(content: dict[str, Any], method: str, params: Params) -> str:
    try:
        frame = _write(content if params is None else {**content, "params": params})
    except (msgspec.MsgspecError, TypeError, ValueError, RecursionError):
        raise InvalidCall(f"What was given to {method} cannot be sent to a robot.") from None
    if len(frame.encode()) > MAX_FRAME:
        raise InvalidCall(f"What was given to {method} is too long.")
    return frame


def read_message(frame: str) -> Reply | Event | None:
    """What a frame from the server says; None for what a newer server may say."""
    try:
        message = msgspec.json.decode(frame)
    except (msgspec.MsgspecError, ValueError, RecursionError):
        return None
    match message:
        case {"method": str(method), "params": dict(data)} if method.startswith("event."):
            return Event(method.removeprefix("event."), data)
        case {"id": id, "error": {"message": str(sentence), **error}} if _is_id(id):
            match error:
                case {"data": {"error": str(name)}}:
                    return Reply(id, error=error_named(name)(sentence))
            return Reply(id, error=RobotError(sentence))
        case {"id": id, "result": result} if _is_id(id):
            return Reply(id, result)
    return None
