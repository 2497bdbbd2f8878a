"""A Furhat that is not there: its Realtime API over real WebSockets, with good days and bad ones.

It says what a Furhat says, in the words of the maker's own package, which drives it in
`test_furhat_stand_in.py`.
"""

from __future__ import annotations

import json
import socket
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable
from contextlib import suppress
from typing import Any, Self

from websockets.exceptions import ConnectionClosed
from websockets.sync.server import ServerConnection, serve

Message = dict[str, Any]

SOON = 20.0
"""Seconds; what is waited for comes within milliseconds."""

VOICES = [
    {"voice_id": "amy", "name": "Amy", "language": "en-GB", "gender": "female"},
    {"voice_id": "vicki", "name": "Vicki", "language": "de-DE", "gender": "female"},
]
FACES = ["adult - Alex", "adult - Isabel"]
GESTURES = {
    *("Nod", "Shake", "Roll", "GazeAway", "Smile", "BigSmile", "Wink", "Blink", "CloseEyes"),
    *("OpenEyes", "BrowRaise", "BrowFrown", "Oh", "Thoughtful", "Surprise"),
    *("ExpressSad", "ExpressAnger", "ExpressFear", "ExpressDisgust"),
}


class FurhatStandIn:
    """Speaks, listens and looks as it is told. A `with` block ends it.

    `key`: what it asks for. `users`: who is before it. `hears`: what people say to it, in order;
    None is silence.
    """

    def __init__(
        self,
        *,
        key: str | None = None,
        users: Iterable[str] = (),
        hears: Iterable[str | None] = (),
    ) -> None:
        self.key = key
        self.users = list(users)
        self.hears = deque(hears)
        self.seconds_a_letter = 0.001
        self.gesture_seconds = 0.02
        self.never: set[str] = set()
        """Requests that it does not react to."""
        self.late: dict[str, float] = {}
        """Seconds after which it reacts to a request."""
        self.nonsense: list[str | bytes] = []
        """What it says before everything else that it says."""
        self.fails_to_speak = False
        self.thinks: threading.Event | None = None
        """It begins to speak when this is set: its voice comes from far away."""
        self.words_end = True
        """Whether it tells the end of what it hears."""
        self.aborted = 0
        """How many times it was silenced."""
        self.gestures_made = 0
        self.tells_all = False
        """Whether it answers everybody who is connected, and not only who asked."""
        self.ends_listening: deque[str] = deque()
        """Why it ends listening before anybody has spoken, the next times."""
        self.voice = VOICES[0]
        self.voices: Any = VOICES
        self.received: list[Message] = []
        self.said: list[str] = []
        self.attends: Any = None
        self.light: str | None = None
        self._changed = threading.Condition()
        self._silence: threading.Event | None = None
        self._deaf: threading.Event | None = None
        self._connections: set[ServerConnection] = set()
        self._server = serve(self._serve, "127.0.0.1", 0)
        self.port: int = self._server.socket.getsockname()[1]
        self._thread = threading.Thread(target=self._server.serve_forever, daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *ended: object) -> None:
        self.vanish()
        self._thread.join(SOON)

    def vanish(self) -> None:
        """It is switched off."""
        with self._changed:
            connections = list(self._connections)
        for connection in connections:
            with suppress(OSError):
                connection.socket.shutdown(socket.SHUT_RDWR)
        self._server.shutdown()

    @property
    def speaking(self) -> bool:
        return self._silence is not None

    @property
    def listening(self) -> bool:
        return self._deaf is not None

    @property
    def clients(self) -> int:
        return len(self._connections)

    def until(self, what: Callable[[FurhatStandIn], bool]) -> None:
        """Wait for it; fails if it does not come."""
        with self._changed:
            assert self._changed.wait_for(lambda: what(self), SOON), self.received[-5:]

    def asked(self, kind: str) -> list[Message]:
        """The requests of that kind that it was sent."""
        with self._changed:
            return [message for message in self.received if message["type"] == kind]

    # --- the protocol ----------------------------------------------------------------------------

    def _serve(self, connection: ServerConnection) -> None:
        assert connection.request is not None
        if connection.request.path != "/v1/events":
            return
        with self._changed:
            self._connections.add(connection)
            self._changed.notify_all()
        try:
            with suppress(ConnectionClosed, OSError):
                for text in connection:
                    self._take(connection, json.loads(text))
        finally:
            with self._changed:
                self._connections.discard(connection)
                self._changed.notify_all()

    def _take(self, connection: ServerConnection, message: Message) -> None:
        kind = message["type"]
        with self._changed:
            self.received.append(message)
            self._changed.notify_all()
        if kind in self.never:
            return
        react: Callable[[ServerConnection, Message], None] = getattr(
            self, f"_{kind.removeprefix('request.').replace('.', '_')}"
        )
        if kind in self.late:
            time.sleep(self.late[kind])
        react(connection, message)

    def _say(self, connection: ServerConnection, to: Message, kind: str, **fields: Any) -> None:
        message = {"type": f"response.{kind}", **fields}
        if "request_id" in to:
            message["request_id"] = to["request_id"]
        for listener in list(self._connections) if self.tells_all else [connection]:
            with suppress(ConnectionClosed, OSError):
                for data in self.nonsense:
                    listener.send(data)
                listener.send(json.dumps(message))

    def _auth(self, connection: ServerConnection, message: Message) -> None:
        access = self.key is None or message.get("key") == self.key
        self._say(connection, message, "auth", access=access, scope="full" if access else None)

    def _speak_text(self, connection: ServerConnection, message: Message) -> None:
        silence, text = threading.Event(), message["text"]
        lasts = self.seconds_a_letter * len(text)

        def speak() -> None:
            if self.thinks is not None:
                self.thinks.wait(SOON)
            with self._changed:
                self._silence = silence
                self._changed.notify_all()
            self._say(connection, message, "speak.start", text=text, gen_time=3)
            aborted = silence.wait(lasts)
            with self._changed:
                if aborted:
                    self.aborted += 1
                else:
                    self.said.append(text)
                if self._silence is silence:
                    self._silence = None
                self._changed.notify_all()
            self._say(
                connection,
                message,
                "speak.end",
                text=text,
                aborted=aborted,
                failed=self.fails_to_speak,
            )

        threading.Thread(target=speak, daemon=True).start()

    def _speak_stop(self, connection: ServerConnection, message: Message) -> None:
        silence = self._silence
        if silence is not None:
            silence.set()

    def _listen_config(self, connection: ServerConnection, message: Message) -> None: ...

    def _listen_start(self, connection: ServerConnection, message: Message) -> None:
        deaf = threading.Event()
        with self._changed:
            self._deaf = deaf
            early = self.ends_listening.popleft() if self.ends_listening else None
            words = self.hears.popleft() if self.hears and not early else None
            self._changed.notify_all()

        def listen() -> None:
            self._say(connection, message, "listen.start")
            cause = early
            if early is None and words is not None:
                self._say(connection, message, "hear.start")
                if message["partial"]:
                    self._say(connection, message, "hear.partial", text=words.split()[0])
                if self.words_end:
                    self._say(connection, message, "hear.end", text=words)
                cause = "speech_end"
            elif early is None:
                stopped = deaf.wait(message["no_speech_timeout"])
                cause = "stopped" if stopped else "silence_timeout"
            with self._changed:
                if self._deaf is deaf:
                    self._deaf = None
                self._changed.notify_all()
            self._say(connection, message, "listen.end", cause=cause)

        threading.Thread(target=listen, daemon=True).start()

    def _listen_stop(self, connection: ServerConnection, message: Message) -> None:
        deaf = self._deaf
        if deaf is not None:
            deaf.set()

    def _voice_status(self, connection: ServerConnection, message: Message) -> None:
        fields: Message = {}
        if message.get("voice_id"):
            fields["voice_id"] = self.voice["voice_id"]
        if message.get("voice_list"):
            fields["voice_list"] = self.voices
        self._say(connection, message, "voice.status", **fields)

    def _voice_config(self, connection: ServerConnection, message: Message) -> None:
        for voice in VOICES:
            if voice["name"] == message.get("name") or voice["language"] == message.get("language"):
                self.voice = voice
        self._say(connection, message, "voice.status", voice_id=self.voice["voice_id"])

    def _attend_user(self, connection: ServerConnection, message: Message) -> None:
        self.attends = message["user_id"]

    def _attend_location(self, connection: ServerConnection, message: Message) -> None:
        self.attends = (message["x"], message["y"], message["z"])

    def _gesture_start(self, connection: ServerConnection, message: Message) -> None:
        if message["name"] not in GESTURES:
            return

        def move() -> None:
            if message["monitor"]:
                self._say(connection, message, "gesture.start")
            time.sleep(self.gesture_seconds)
            self.gestures_made += 1
            if message["monitor"]:
                self._say(connection, message, "gesture.end")

        threading.Thread(target=move, daemon=True).start()

    def _face_status(self, connection: ServerConnection, message: Message) -> None:
        fields: Message = {"face_id": FACES[0]} if message.get("face_id") else {}
        if message.get("face_list"):
            fields["face_list"] = FACES
        self._say(connection, message, "face.status", **fields)

    def _face_reset(self, connection: ServerConnection, message: Message) -> None: ...

    def _led_set(self, connection: ServerConnection, message: Message) -> None:
        self.light = message["color"]

    def _users_once(self, connection: ServerConnection, message: Message) -> None:
        users = [{"id": user, "x": 0.0, "y": 0.0, "z": 1.0} for user in self.users]
        self._say(connection, message, "users.data", users=users)


class Cable:
    """The network between the server and a robot at `port`: it can be cut and mended, or hold back
    everything without a word, as a network does in which a plug was pulled."""

    def __init__(self, port: int) -> None:
        self._to = port
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port: int = self._listener.getsockname()[1]
        self._sockets: set[socket.socket] = set()
        self._lock = threading.Lock()
        self._passes = threading.Event()
        self._passes.set()
        self._cut = False
        threading.Thread(target=self._accept, daemon=True).start()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *ended: object) -> None:
        self._passes.set()
        self.cut()
        self._listener.close()

    def cut(self) -> None:
        with self._lock:
            self._cut = True
            sockets, self._sockets = self._sockets, set()
        for each in sockets:
            with suppress(OSError):
                each.shutdown(socket.SHUT_RDWR)
            each.close()

    def mend(self) -> None:
        self._passes.set()
        self._cut = False

    def hold_back(self) -> None:
        self._passes.clear()

    def _accept(self) -> None:
        with suppress(OSError):
            while True:
                near, _ = self._listener.accept()
                if self._cut:
                    near.close()
                    continue
                far = socket.create_connection(("127.0.0.1", self._to))
                with self._lock:
                    self._sockets |= {near, far}
                for pair in ((near, far), (far, near)):
                    threading.Thread(target=self._pass, args=pair, daemon=True).start()

    def _pass(self, near: socket.socket, far: socket.socket) -> None:
        with suppress(OSError):
            while data := near.recv(65536):
                self._passes.wait()
                far.sendall(data)
        for each in (near, far):
            with suppress(OSError):
                each.shutdown(socket.SHUT_RDWR)
