"""A server's connections, each with what it waits for and what waits for it."""

from __future__ import annotations

import asyncio
from collections import deque
from typing import TYPE_CHECKING, Any, Final

from starlette.websockets import WebSocket

from robot_api import protocol
from robot_api.errors import RobotError, Stopped
from robot_api.serving import roles
from robot_api.serving.access import Guest
from robot_api.serving.dispatch import Job

if TYPE_CHECKING:
    from robot_api.server import Server

MAX_WAITING: Final = 512
"""Most frames that wait for a slow client; older events are dropped first, poses before others."""
UNCONFIRMED: Final = "stop_not_confirmed"
REMEMBERED: Final = ("link", UNCONFIRMED)
"""Kinds of events that tell how it is from then on: the last one is sent to who subscribes later.
A stop is not confirmed until the next one."""


class Client:
    """One connection. Only the loop thread touches it."""

    def __init__(self, server: Server, name: str, guest: Guest) -> None:
        self.name = name
        self.guest = guest
        self.wire = protocol.Connection(
            server.methods,
            [kind for kind in server.events if roles.may_hear(guest.role, kind)],
            lambda method: roles.may(guest.role, server.needs(method)),
        )
        self._server = server
        # The job of each call in flight, for a cancel.
        self._jobs: dict[protocol.Call, Job] = {}
        # Frames to send, each with the kind of event it is, None for a reply.
        self._waiting: deque[tuple[str | None, str]] = deque()
        self._something_waits = asyncio.Event()
        # The client does not read its replies; it is not served any more.
        self._overrun = False

    async def serve(self, socket: WebSocket) -> None:
        await socket.accept()
        sender = asyncio.create_task(self._send_waiting(socket))
        try:
            while not self._overrun:
                message = await socket.receive()
                if message["type"] != "websocket.receive":
                    return
                frame = message.get("text")
                self._act(message["bytes"] if frame is None else frame)
            # Not closed with a goodbye, which would wait to be read like all the rest.
        finally:
            sender.cancel()

    def _act(self, frame: str | bytes) -> None:
        before = self._states_wanted()
        self._do(frame)
        for kind in self._states_wanted() - before:  # who has just subscribed learns how it is
            last = self._server.last(kind)
            if last is not None:
                self.send(last, kind)

    def _states_wanted(self) -> set[str]:
        return {kind for kind in self._server.remembered if self.wire.wants(kind)}

    def _do(self, frame: str | bytes) -> None:
        for action in self.wire.receive(frame):
            match action:
                case protocol.Send():
                    self.send(action.frame)
                case protocol.Cancel():
                    job = self._jobs.get(action.call)  # a stop is none: it cannot be cancelled
                    if job is not None:
                        self._server.dispatcher.cancel(job)
                case protocol.Call(method=protocol.STOP):
                    self._stop(action)
                case protocol.Call():
                    job = self._jobs[action] = self._server.job(self, action)
                    self._server.dispatcher.start(job)

    def _stop(self, call: protocol.Call) -> None:
        because = _stopped_by(self.guest, call.arguments.get("who"))

        def done(result: Any, error: RobotError | Stopped | None) -> None:
            reply = (
                protocol.error_reply(call, error) if error else protocol.result_reply(call, None)
            )
            self._server.in_loop(self.finish, call, reply)

        self._server.dispatcher.stop(because, done)

    def finish(self, call: protocol.Call, reply: str) -> None:
        self._jobs.pop(call, None)
        frame = self.wire.finish(call, reply)
        if frame is not None:
            self.send(frame)

    def send(self, frame: str, event: str | None = None) -> None:
        """Put a frame into the queue; the client gets it when it can take it."""
        if len(self._waiting) >= MAX_WAITING:
            self._make_room()
        self._waiting.append((event, frame))
        self._something_waits.set()

    def _make_room(self) -> None:
        kinds = [kind for kind, _ in self._waiting]
        dropped = next(
            (
                index
                for wanted in (lambda kind: kind == "pose", lambda kind: kind is not None)
                for index, kind in enumerate(kinds)
                if wanted(kind)
            ),
            None,
        )
        if dropped is None:
            self._overrun = True
            dropped = 0
        del self._waiting[dropped]

    async def _send_waiting(self, socket: WebSocket) -> None:
        """Send what waits, at the client's pace."""
        while True:
            await self._something_waits.wait()
            self._something_waits.clear()
            while self._waiting:
                _, frame = self._waiting.popleft()
                await socket.send_text(frame)


def _stopped_by(guest: Guest, named: str | None) -> str:
    """Who stopped the robot, in a sentence, as far as that is known: who has signed in cannot call
    themselves otherwise."""
    if guest.role == "face":
        return "Somebody stopped the robot at its face."
    who = guest.name or named
    return f"{who} stopped the robot." if who else "The robot was stopped."
