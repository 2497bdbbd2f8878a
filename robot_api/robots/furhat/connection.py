"""One connection to a Furhat: the messages of its Realtime API, JSON over a WebSocket.

A message is an object with a `type`: ours begin with "request.", the robot's with "response.". What
the robot answers carries the `request_id` of what was asked, if that had one.
"""

from __future__ import annotations

import json
import logging
import threading
import time
import uuid
from collections.abc import Callable
from contextlib import ExitStack, suppress
from typing import Any, Final

from websockets.exceptions import ConnectionClosed, InvalidHandshake, InvalidURI
from websockets.sync.client import ClientConnection, connect

from robot_api.errors import AccessDenied, LostConnection

Message = dict[str, Any]

OPENS_WITHIN: Final = 5.0
"""Seconds for the robot to take a connection, and as many to let us in."""
PING_EVERY: Final = 1.0
"""Seconds between two pings. They find out that a robot is gone whose plug was pulled: no network
says so."""
PONG_WITHIN: Final = 2.0
"""Seconds after a ping after which the robot counts as gone."""
_CLOSES_WITHIN: Final = 0.5
_LARGEST: Final = 2**20
"""Bytes of a message; nothing that is asked for here comes near."""
_QUIET: Final = logging.Logger("furhat", logging.CRITICAL)
"""That a robot is gone is told by its link; how the library came to know it is nobody's matter."""
_REFUSED: Final = 1008
"""The code of a connection that is closed since it may not be."""

GONE: Final = "The Furhat does not answer any more."
_NO_ANSWER = "The Furhat at {} does not answer. See that it is switched on and in the network."
_NO_FURHAT = (
    "What answers at {} is no Furhat, or its Realtime API is switched off. Check the address, and"
    " switch the API on in the robot's settings."
)
_WRONG_KEY = (
    "The Furhat does not take this key. Copy the Realtime API's key from the robot's settings into"
    " the environment variable NL2ROBOT_ROBOT_PASSWORD."
)


class Connection:
    """A connection that the robot has accepted.

    `heard` gets each message, `ended` is called once when the connection ends without our having
    closed it; both in a thread of the connection's own, and must not block. Raises
    `LostConnection` and `AccessDenied`. Any thread may call any of it.
    """

    def __init__(
        self,
        where: str,
        key: str | None,
        heard: Callable[[Message], None],
        ended: Callable[[], None],
    ) -> None:
        self._heard = heard
        self._ended = ended
        self._closed = False
        self._until_closed = ExitStack()
        self._socket = self._until_closed.enter_context(_opened(where))
        try:
            self._sign_in(where, key)
        except BaseException:
            self._until_closed.close()
            raise
        threading.Thread(target=self._read, name=f"furhat {where}", daemon=True).start()

    def send(self, kind: str, **fields: Any) -> None:
        """Send a message. Raises `LostConnection`."""
        try:
            self._socket.send(json.dumps({"type": kind, **fields}))
        except (ConnectionClosed, OSError) as error:
            raise LostConnection(GONE) from error

    def close(self) -> None:
        self._closed = True
        self._until_closed.close()

    def _sign_in(self, where: str, key: str | None) -> None:
        number = new_id()
        asking: Message = {"type": "request.auth", "request_id": number}
        if key is not None:
            asking["key"] = key
        try:
            self._socket.send(json.dumps(asking))
            end = time.monotonic() + OPENS_WITHIN
            answer = None
            while answer is None or answer["type"] != "response.auth":
                answer = read_message(self._socket.recv(max(0.0, end - time.monotonic())))
        except ConnectionClosed as error:
            if error.rcvd is not None and error.rcvd.code == _REFUSED:
                raise AccessDenied(_WRONG_KEY) from error
            raise LostConnection(_NO_FURHAT.format(where)) from error
        except (TimeoutError, OSError) as error:
            raise LostConnection(_NO_FURHAT.format(where)) from error
        if answer.get("access") is not True:
            raise AccessDenied(_WRONG_KEY)

    def _read(self) -> None:
        with suppress(ConnectionClosed, OSError):
            while True:
                message = read_message(self._socket.recv())
                if message is not None:
                    self._heard(message)
        if not self._closed:
            self._ended()


def _opened(where: str) -> ClientConnection:
    try:
        return connect(
            f"ws://{where}/v1/events",
            open_timeout=OPENS_WITHIN,
            ping_interval=PING_EVERY,
            ping_timeout=PONG_WITHIN,
            close_timeout=_CLOSES_WITHIN,
            max_size=_LARGEST,
            compression=None,
            logger=_QUIET,
            proxy=None,  # the robot is in the house
        )
    except (InvalidHandshake, InvalidURI, EOFError) as error:
        raise LostConnection(_NO_FURHAT.format(where)) from error
    except (OSError, TimeoutError) as error:
        raise LostConnection(_NO_ANSWER.format(where)) from error


def new_id() -> str:
    return uuid.uuid4().hex


def read_message(data: str | bytes) -> Message | None:
    """A message as it came; None if it is none."""
    try:
        message = json.loads(data)
    except (ValueError, RecursionError):
        return None
    known = isinstance(message, dict) and isinstance(message.get("type"), str)
    return message if known else None
