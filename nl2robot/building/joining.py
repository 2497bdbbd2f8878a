"""A robot that has joined the broker of its house."""

from __future__ import annotations

import logging
import re
import secrets
import threading
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from typing import Any, Protocol

from nl2robot import __version__
from nl2robot.building.broker import Broker, BrokerAddress
from nl2robot.building.reporter import Reporter
from nl2robot.building.twins import SERVER, Twins
from nl2robot.schedule.telling import trouble
from robot_api.errors import RobotError

_log = logging.getLogger(__name__)


class Stage(Protocol):
    """What is needed of a station, `nl2robot.station.part.Backstage`."""

    @property
    def stop(self) -> Callable[[str], None]: ...

    @property
    def publish(self) -> Callable[[str, Mapping[str, Any]], None]: ...

    def subscribe(
        self, listener: Callable[[str, Mapping[str, Any]], None]
    ) -> Callable[[], None]: ...


class House:
    """Tells a broker of this robot while it is entered, and stops the robot when it is told to
    there. What else is said where somebody listens, `heard(topic, text)` is told."""

    def __init__(
        self,
        address: BrokerAddress,
        robot: str,
        stage: Stage,
        heard: Callable[[str, str], None] = lambda topic, text: None,
        stands: Callable[[], Iterable[tuple[str, Mapping[str, Any]]]] = tuple,
        trouble: Callable[[str], Mapping[str, Any]] = trouble,
    ) -> None:
        """`stands`: asks the robot how it stands, and answers as its events `battery` and `pose`
        would; it may take its time. `trouble` makes an event `notice` of a sentence."""
        self._stage = stage
        self._trouble = trouble
        self._heard = heard
        self._stands = stands
        # Two clients of one name push each other out for ever, so each process has its own, in the
        # 23 letters that every broker takes.
        me = secrets.token_hex(4)
        name = f"{re.sub(r'[^A-Za-z0-9]+', '-', address.prefix)[-14:]}-{me}"
        self.broker = Broker(address, name, self._on_message, self._on_link)
        self._server = address.topic(SERVER)
        self._twins = Twins(
            me, address.prefix, lambda who: self.broker.publish(self._server, who), self._tell
        )
        self._notice: Mapping[str, Any] | None = None
        """The latest of our own."""
        self._reporter = Reporter(address, robot, __version__, self.broker.publish, self._stop)
        self._topics: frozenset[str] = frozenset()
        # From the first event on: who joins later hears how it stands.
        self._unsubscribe = stage.subscribe(self._on_event)

    def __enter__(self) -> House:
        for topic in (*self._reporter.topics, self._server):
            self.broker.listen(topic)
        self.broker.open()
        threading.Thread(target=self._look, name="how it stands, for MQTT", daemon=True).start()
        return self

    def __exit__(self, *_: object) -> None:
        self._unsubscribe()
        self.broker.close()

    def listen_to(self, topics: frozenset[str]) -> None:
        """Hear these topics besides our own, and no others. Our own are never left: by one
        of them the robot is stopped."""
        others = frozenset(each for each in topics if not self._reporter.is_own(each))
        topics = others - frozenset(self._reporter.topics)
        for topic in self._topics - topics:
            self.broker.leave(topic)
        for topic in topics - self._topics:
            self.broker.listen(topic)
        self._topics = topics

    def _look(self) -> None:
        """A robot that nobody uses tells of nothing by itself."""
        for kind, data in self._stands():
            self._reporter.at_first(kind, data)

    # --- told by the broker, in its thread

    def _on_message(self, topic: str, text: str, before: bool) -> None:
        # What was said before we came is over: nobody stops or begins anything for it now.
        if before:
            return
        self._reporter.heard(topic, text)
        if topic == self._server:
            self._twins.heard(text)
        elif not self._reporter.is_own(topic):
            self._heard(topic, text)

    def _on_link(self, connected: bool, because: str) -> None:
        if connected:
            self._twins.joined()
            self._reporter.connected()
        else:
            self._tell(because)

    def _on_event(self, kind: str, data: Mapping[str, Any]) -> None:
        if data is not self._notice:  # the house need not hear, once it can, that it could not
            self._reporter.on_event(kind, data)

    def _tell(self, sentence: str) -> None:
        """The people here, by a notice."""
        _log.warning("%s", sentence)
        self._notice = self._trouble(sentence)
        self._stage.publish("notice", self._notice)

    def _stop(self, because: str) -> None:
        """Without keeping the broker until the robot stands."""

        def stop() -> None:
            with suppress(RobotError):  # one that is not confirmed is a state, which all are told
                self._stage.stop(because)

        threading.Thread(target=stop, name="stop by MQTT", daemon=True).start()
