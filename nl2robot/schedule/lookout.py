"""What happens around a robot, told to the book: a trigger that fits makes its appointment due.

Events come from everywhere (the robot, its runs, its face, the house's broker) and are kept until
the timekeeper looks, in whose thread all else is done. What nobody tells of is looked for while the
robot is free: who is there, and how full the battery is.
"""

from __future__ import annotations

import logging
import math
import queue
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any, Final

from nl2robot.schedule.appointments import Appointment
from nl2robot.schedule.book import Book
from nl2robot.schedule.triggers import Trigger, Watch
from robot_api.errors import RobotError

KEPT: Final = 1_000
"""Events that wait for the next look; of a flood the rest are dropped."""
ASKS_BATTERY_EVERY: Final = 30.0
"""Seconds."""
HEARD: Final = frozenset({"pose", "battery", "heard"})
"""The robot's own events that a trigger may be about."""

Ask = Callable[[str, dict[str, Any]], Any]
"""Calls a method of the robot that only looks; raises `RobotError`."""

_log = logging.getLogger(__name__)


class Lookout:
    """Of one robot. `note` may be called from any thread; the rest by the timekeeper's alone."""

    def __init__(
        self,
        ask: Ask,
        clock: Callable[[], float],
        listen: Callable[[frozenset[str]], None] = lambda topics: None,
        wake: Callable[[], None] = lambda: None,
    ) -> None:
        """`listen`: have these topics of the broker heard, and no others; `wake`: somebody should
        look soon."""
        self._ask = ask
        self._clock = clock
        self._listen = listen
        self._wake = wake
        self._came: queue.Queue[tuple[str, Mapping[str, Any], float]] = queue.Queue(KEPT)
        self._watch: Watch | None = None
        self._triggers: dict[int, Trigger] = {}
        self._topics: frozenset[str] = frozenset()
        self._asked_battery = -math.inf
        """By the monotonic clock."""
        self._place: str | None = None
        self._located = False
        """Whether the robot has told where it is; it tells only when it moves."""

    def note(self, kind: str, data: Mapping[str, Any]) -> None:
        """Something has happened: an event of the robot or the runner, or one of
        `nl2robot.schedule.triggers`."""
        if kind == "pose":  # ten a second, of which the place is of interest
            if self._located and data.get("place") == self._place:
                return
            self._place, self._located = data.get("place"), True
        if kind == "program":
            if data.get("what") != "result" or data.get("method") != "scan" or "result" not in data:
                return
            kind, data = "scanned", {"code": str(data["result"])}
        elif kind not in HEARD | {"pressed", "message"}:
            return
        try:
            self._came.put_nowait((kind, data, self._clock()))
        except queue.Full:
            return
        self._wake()

    @property
    def buttons(self) -> list[str]:
        """Those that the face shows."""
        watch = self._watch
        return watch.buttons() if watch is not None else []

    def rests(self, button: str) -> bool:
        """Whether a press of this button would begin nothing yet."""
        watch = self._watch
        return watch is not None and watch.rests(button, self._clock())

    def look(self, book: Book, appointments: list[Appointment], free: bool, charging: bool) -> None:
        """Write down what is due by what came since the last look. `free`: the robot does nothing,
        so it may be asked what it sees; `charging`: it stands at its charger."""
        self._refresh(book, appointments)
        watch = self._watch
        if watch is None:
            self._forget_what_came()
            return
        while True:
            try:
                kind, data, at = self._came.get_nowait()
            except queue.Empty:
                break
            self._happened(book, watch, kind, data, at)
        if free:
            if not self._located:
                self._locate(book, watch)
            for kind, data in self._looked(watch, charging):
                self._happened(book, watch, kind, data, self._clock())

    # --- inside

    def _refresh(self, book: Book, appointments: list[Appointment]) -> None:
        triggers = {
            each.id: each.trigger
            for each in appointments
            if each.trigger is not None and not each.paused and each.asked is None
        }
        if triggers == self._triggers:
            return
        self._triggers = triggers
        if self._watch is None:
            last = {number: book.history(number, 1) for number in triggers}
            due = {of: came[0].due for of, came in last.items() if came}
            self._watch = Watch(triggers, due, self._place, self._located)
        else:
            self._watch.now(triggers)
        topics = frozenset(self._watch.topics())
        if topics != self._topics:
            self._topics = topics
            self._listen(topics)

    def _forget_what_came(self) -> None:
        while not self._came.empty():
            self._came.get_nowait()

    def _happened(
        self, book: Book, watch: Watch, kind: str, data: Mapping[str, Any], at: float
    ) -> None:
        for number in watch.happened(kind, data, at):
            book.come(number, at)

    def _locate(self, book: Book, watch: Watch) -> None:
        """Ask it where it is, once."""
        self._located = True
        with suppress(RobotError):
            self._place = self._ask("location", {}).place
            self._happened(book, watch, "pose", {"place": self._place}, self._clock())

    def _looked(self, watch: Watch, charging: bool) -> list[tuple[str, Mapping[str, Any]]]:
        """What is to be seen now, and how full the battery is from time to time."""
        found: list[tuple[str, Mapping[str, Any]]] = []
        try:
            for thing in watch.looks_for():
                found.append(
                    ("seen", {"thing": thing, "there": bool(self._ask("sees", {"thing": thing}))})
                )
            now = time.monotonic()
            wanted = any(each.what == "battery" for each in self._triggers.values())
            if wanted and now - self._asked_battery >= ASKS_BATTERY_EVERY:
                self._asked_battery = now
                percent = self._ask("battery", {})
                found.append(("battery", {"percent": percent, "charging": charging}))
        except RobotError as error:
            _log.info("nothing is seen for triggers: %s", error)
        return found
