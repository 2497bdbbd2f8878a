"""The MQTT broker of the house: what its systems say there is heard, and the robot is heard there.

A thin shell around paho-mqtt: it connects by itself, again and again, and knows nothing of what the
messages mean. Every topic of the robot's own begins with the prefix of the address,

    mqtt://robot@broker.hospital.example:1883/nl2robot/ward-a

with `mqtts` for an encrypted connection. What is said to have been published while the broker
cannot be reached is sent when it can be.
"""

from __future__ import annotations

import os
import re
import sys
import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import unquote, urlsplit

from nl2robot.errors import UserError
from nl2robot.schedule.topics import is_topic
from robot_api.errors import cause

if TYPE_CHECKING:
    from paho.mqtt.client import Client

PASSWORD: Final = "NL2ROBOT_MQTT_PASSWORD"
"""The environment variable with the password: an address is seen by others."""
PORTS: Final = {"mqtt": 1883, "mqtts": 8883}
PREFIX: Final = "nl2robot"
ALIVE: Final = "available"
"""The topic below the prefix that says "online" or "offline"; the broker itself says the latter
when the robot's server is gone."""
LONGEST_MESSAGE: Final = 65_536
"""Bytes; what is longer is not for us."""
KEPT_UNSENT: Final = 1_000
"""Messages that wait for a broker that is away; then the oldest are lost."""
ASKS_EVERY: Final = 20
"""Seconds between two signs of life: a broker that is gone without a word is noticed after one and
a half of it."""
AWAY: Final = (
    "The broker {address} cannot be reached ({because}). It is tried again and again; check its"
    " address and the network."
)
REFUSED: Final = (
    "The broker {address} refuses this server ({because}). It is tried again and again; check its"
    " login: the name in the address, and the password in NL2ROBOT_MQTT_PASSWORD."
)
TRIES_AFTER: Final = (1, 60)
"""Seconds before it is tried again, the first time and at most."""


_SCHEME_ALONE: Final = re.compile(r"//|mqtts?:(?!\d)", re.IGNORECASE)
"""Where somebody meant to write a scheme; a host may be called mqtt, too."""


class BadBroker(UserError):
    """It is no address of a broker; the message says what to write instead."""


@dataclass(frozen=True)
class BrokerAddress:
    host: str
    port: int
    encrypted: bool = False
    user: str | None = None
    prefix: str = PREFIX

    def __str__(self) -> str:
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"{'mqtts' if self.encrypted else 'mqtt'}://{host}:{self.port}/{self.prefix}"

    def topic(self, *parts: str) -> str:
        """A topic of the robot's own."""
        return "/".join((self.prefix, *parts))


def parse_broker(text: str) -> BrokerAddress:
    """Read an address. Raises `BadBroker`."""
    written = text.strip()
    if "://" not in written and not _SCHEME_ALONE.match(written):
        written = f"mqtt://{written}"
    try:
        parts = urlsplit(written)
    except ValueError:
        parts = urlsplit("mqtt:")  # no host
    if parts.password is not None:
        raise BadBroker(
            "A password must not stand in an address, where others see it. Put it into the"
            f" environment variable {PASSWORD}."
        )
    if parts.scheme not in PORTS or not written.startswith(f"{parts.scheme}://"):
        raise BadBroker(
            f"{text!r} does not begin with mqtt:// or mqtts://. Write it as"
            " mqtt://HOST:PORT/PREFIX."
        )
    try:
        port = parts.port
    except ValueError:
        port = 0
    if port == 0:
        raise BadBroker(
            f"The port in {text!r} is no number from 1 to 65535. Write it as"
            " mqtt://HOST:PORT/PREFIX."
        )
    prefix = unquote(written.partition("://")[2].partition("/")[2]).strip("/") or PREFIX
    if "+" in prefix or "#" in prefix:
        raise BadBroker(
            f"The prefix {prefix!r} has a wildcard, + or #, but the robot says something at one"
            " place alone. Write it as mqtt://HOST:PORT/PREFIX."
        )
    host = parts.hostname or ""
    if not host or "?" in text or "#" in text or not is_topic(f"{prefix}/{ALIVE}"):
        raise BadBroker(f"{text!r} is no address of a broker. Write it as mqtt://HOST:PORT/PREFIX.")
    return BrokerAddress(
        host=host,
        port=port or PORTS[parts.scheme],
        encrypted=parts.scheme == "mqtts",
        user=unquote(parts.username) if parts.username else None,
        prefix=prefix,
    )


class Broker:
    """A connection to a broker that comes back by itself.

    `heard(topic, text, before)` and `linked(connected, because)` are called in its thread, which
    they must not keep: `before` says that it was said before we listened, and kept for us;
    `because` is a sentence, empty while it is connected. That it is away or refuses us is told once
    each, until it is connected again.
    """

    def __init__(
        self,
        address: BrokerAddress,
        name: str,
        heard: Callable[[str, str, bool], None],
        linked: Callable[[bool, str], None] = lambda connected, because: None,
        password: str | None = None,
    ) -> None:
        """`name` is how the broker tells us from others. Nothing happens before `open`. The
        password is the environment's unless it is given."""
        self.address = address
        self._heard = heard
        self._linked = linked
        self._lock = threading.Lock()
        self._topics = {address.topic(ALIVE)}
        self._connected = threading.Event()
        self._refused = False
        """Whether the connection that ends next was refused, which is told already."""
        self._subscribing: int | None = None
        """The number of what we said first on this connection: where we listen."""
        self._told: set[str] = set()
        """What was told since it was connected last."""
        self._closing = False
        self._client = self._made(name, password or os.environ.get(PASSWORD))

    def _made(self, name: str, password: str | None) -> Client:
        from paho.mqtt.client import Client
        from paho.mqtt.enums import CallbackAPIVersion

        client = Client(CallbackAPIVersion.VERSION2, client_id=name, clean_session=True)
        if self.address.user is not None:
            client.username_pw_set(self.address.user, password)
        if self.address.encrypted:
            client.tls_set()
        client.will_set(self.address.topic(ALIVE), "offline", qos=1, retain=True)
        client.reconnect_delay_set(*TRIES_AFTER)
        client.max_queued_messages_set(KEPT_UNSENT)
        client.on_connect = self._on_connect
        client.on_connect_fail = self._on_failure
        client.on_disconnect = self._on_disconnect
        client.on_subscribe = self._on_subscribe
        client.on_message = self._on_message
        return client

    def open(self) -> None:
        """Begin to connect, and go on trying."""
        self._client.connect_async(self.address.host, self.address.port, keepalive=ASKS_EVERY)
        self._client.loop_start()

    def close(self) -> None:
        """Say that we go, and go."""
        self._closing = True
        if self.connected:
            last = self._client.publish(self.address.topic(ALIVE), "offline", qos=1, retain=True)
            last.wait_for_publish(timeout=1.0)
        self._client.disconnect()
        self._client.loop_stop()

    @property
    def connected(self) -> bool:
        return self._connected.is_set()

    def wait(self, seconds: float) -> bool:
        """Until it is connected, or the time is up; whether it is."""
        return self._connected.wait(seconds)

    def listen(self, topic: str) -> None:
        """Hear what is said there, from now on; `+` and `#` stand for levels."""
        with self._lock:
            self._topics.add(topic)
            connected = self.connected
        if connected:
            self._client.subscribe(topic, qos=1)

    def leave(self, topic: str) -> None:
        """Hear it no more."""
        with self._lock:
            self._topics.discard(topic)
        if self.connected:
            self._client.unsubscribe(topic)

    def publish(self, topic: str, text: str, *, kept: bool = False) -> None:
        """Say it there. `kept`: whoever comes later hears the last one, too."""
        self._client.publish(topic, text, qos=1, retain=kept)

    # --- told by paho, in its thread

    def _on_connect(self, client: Client, _data: Any, _flags: Any, reason: Any, _more: Any) -> None:
        if reason.is_failure:
            self._refused = True
            self._lost(REFUSED, str(reason))
            return
        with self._lock:  # who listens from now on subscribes by itself
            topics = sorted(self._topics)
            self._connected.set()
        _, self._subscribing = client.subscribe([(topic, 1) for topic in topics])
        client.publish(self.address.topic(ALIVE), "online", qos=1, retain=True)

    def _on_subscribe(
        self, _client: Client, _data: Any, number: int, _reasons: Any, _more: Any
    ) -> None:
        if number == self._subscribing:  # from now on nothing escapes us
            self._subscribing = None
            self._told.clear()
            self._linked(True, "")

    def _on_failure(self, _client: Client, _data: Any) -> None:
        error = sys.exception()  # paho calls this where it has caught it
        self._lost(AWAY, cause(error) if error is not None else "nothing answers there")

    def _on_disconnect(
        self, _client: Client, _data: Any, _flags: Any, reason: Any, _more: Any
    ) -> None:
        self._connected.clear()
        if reason.is_failure and not self._refused:
            self._lost(AWAY, str(reason))
        self._refused = False

    def _lost(self, sentence: str, because: str) -> None:
        self._connected.clear()
        if sentence not in self._told:
            self._told.add(sentence)
            self._linked(False, sentence.format(address=self.address, because=because))

    def _on_message(self, client: Client, _data: Any, message: Any) -> None:
        if len(message.payload) > LONGEST_MESSAGE:
            return
        try:
            text = message.payload.decode("utf-8")
        except UnicodeDecodeError:
            return
        alive = self.address.topic(ALIVE)
        if message.topic != alive:
            self._heard(message.topic, text, bool(message.retain))
        elif text == "offline" and not message.retain and not self._closing:
            # Of a connection of ours that the broker gives up late, or of a server that is gone
            # and went by the same prefix.
            client.publish(alive, "online", qos=1, retain=True)
