"""What the house is told of the robot, and what it may tell it: topics and their payloads.

Without I/O: what happens goes in, messages come out. Below the robot's own prefix

| topic                | payload                                                                |
|----------------------|------------------------------------------------------------------------|
| `available`          | "online", "offline" (by the broker, see `broker`)                       |
| `state`              | the event `state` as JSON, kept: `state`, `since`, `because`, `run` ... |
| `battery`            | `{"percent": 80, "charging": false}`, kept                             |
| `place`              | the name of the place that it is at, kept; empty: at none              |
| `notice`             | each notice as JSON: what somebody has to know while not looking       |
| `stop`               | anything that is said here stops the robot                             |

and, for Home Assistant, `homeassistant/device/<robot>/config`, by which it finds all of that.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from typing import Any, Final, Protocol

from nl2robot.building.broker import ALIVE, BrokerAddress
from nl2robot.schedule.topics import is_below

DISCOVERY: Final = "homeassistant"
"""The prefix of Home Assistant's MQTT discovery, unless somebody changed it there."""
BORN: Final = f"{DISCOVERY}/status"
"""Where Home Assistant says "online" when it begins: then it is told anew."""
STOP: Final = "stop"
_NOTICE: Final = "{{ {'event_type': 'notice', 'told': value_json.told} | tojson }}"
STATES: Final = (
    *("idle", "reviewing", "charging", "running", "pausing", "paused"),
    *("stopping", "stopped", "lost"),
)


class Publish(Protocol):
    def __call__(self, topic: str, text: str, *, kept: bool = False) -> None: ...


class Reporter:
    """Tells a broker of one robot.

    `publish` says something there; `stop(because)` stops the robot. Any thread may call it.
    """

    def __init__(
        self,
        address: BrokerAddress,
        robot: str,
        version: str,
        publish: Publish,
        stop: Callable[[str], None],
    ) -> None:
        self._address = address
        self._robot = robot
        self._version = version
        self._publish = publish
        self._stop = stop
        self._last: dict[str, str] = {}
        """What is kept at the broker, by topic."""

    @property
    def topics(self) -> tuple[str, ...]:
        """Where it has to listen."""
        return (self._address.topic(STOP), BORN)

    def connected(self) -> None:
        """The broker is there, perhaps again, and may have forgotten all of it."""
        self._keep(self._discovery_topic, json.dumps(self.discovery()))
        for topic, text in tuple(self._last.items()):
            self._publish(topic, text, kept=True)

    def on_event(self, kind: str, data: Mapping[str, Any]) -> None:
        """Something has happened, as on the wire."""
        if kind in ("state", "battery"):
            self._keep(self._address.topic(kind), json.dumps(dict(data)))
        elif kind == "notice":
            self._publish(self._address.topic(kind), json.dumps(dict(data)))
        elif kind == "pose":
            topic, place = self._address.topic("place"), data.get("place") or ""
            if self._last.get(topic) != place:
                self._keep(topic, place)

    def at_first(self, kind: str, data: Mapping[str, Any]) -> None:
        """How it stood when we asked, unless an event has told it since."""
        if self._address.topic("place" if kind == "pose" else kind) not in self._last:
            self.on_event(kind, data)

    def _keep(self, topic: str, text: str) -> None:
        """Say it for those as well who come later."""
        self._last[topic] = text
        self._publish(topic, text, kept=True)

    def heard(self, topic: str, text: str) -> None:
        """Something was said there."""
        if topic == self._address.topic(STOP):
            self._stop("A system of the house has stopped it.")
        elif topic == BORN and text == "online":
            self.connected()

    def is_own(self, topic: str) -> bool:
        """Whether it is one of the robot's own: what is said there begins nothing, or what it says
        of a run would begin the next."""
        return is_below(topic, self._address.prefix) or topic == self._discovery_topic

    def discovery(self) -> dict[str, Any]:
        """What Home Assistant wants to know of a device: its entities and their topics."""
        topic = self._address.topic
        return {
            "device": {
                "identifiers": [self._id],
                "name": self._robot,
                "manufacturer": "nl2robot",
                "sw_version": self._version,
            },
            "origin": {"name": "nl2robot", "sw_version": self._version},
            "availability_topic": topic(ALIVE),
            "components": {
                "state": self._entity(
                    "sensor",
                    "State",
                    state_topic=topic("state"),
                    value_template="{{ value_json.state }}",
                    json_attributes_topic=topic("state"),
                    device_class="enum",
                    options=list(STATES),
                ),
                "battery": self._entity(
                    "sensor",
                    "Battery",
                    state_topic=topic("battery"),
                    value_template="{{ value_json.percent }}",
                    device_class="battery",
                    unit_of_measurement="%",
                ),
                "place": self._entity("sensor", "Place", state_topic=topic("place")),
                "notice": self._entity(
                    "event",
                    "Notice",
                    state_topic=topic("notice"),
                    event_types=["notice"],
                    value_template=_NOTICE,
                ),
                "stop": self._entity(
                    "button", "Stop", command_topic=topic(STOP), payload_press="stop"
                ),
            },
        }

    def _entity(self, platform: str, name: str, **more: Any) -> dict[str, Any]:
        of = re.sub(r"\W+", "_", name.lower())
        return {"platform": platform, "name": name, "unique_id": f"{self._id}_{of}", **more}

    @property
    def _id(self) -> str:
        return re.sub(r"[^A-Za-z0-9_-]+", "_", self._address.prefix)

    @property
    def _discovery_topic(self) -> str:
        return f"{DISCOVERY}/device/{self._id}/config"
