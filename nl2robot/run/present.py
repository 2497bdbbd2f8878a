"""The present state of a station: kept in one place, told to everybody in order."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping
from typing import Any, Final

from nl2robot.run import state as happenings
from nl2robot.run.state import Happening, State, after, on_wire

KIND: Final = "state"
"""The kind of the event that tells of each new state."""
EVENTS: Final[Mapping[str, str]] = {
    KIND: "sequence (rises with every change; what has a lower one is old), state (idle, reviewing,"
    " running, pausing, paused, stopping, stopped, lost, charging), since (seconds since the"
    " epoch), because, run and line of the program that goes on, unconfirmed (whether the robot has"
    " not confirmed the last stop), lost_since, charging, driven_by (who drives it by hand, or"
    " null): how the robot and its program stand. On subscribing the present one is sent",
}
MOVES_FROM: Final = 0.02
"""Metres a second from which on a pose says that the robot drives."""


class Present:
    """`tell` is told each new state, in order, and must return at once. Any thread may call it."""

    def __init__(self, tell: Callable[[State], None], now: Callable[[], float] = time.time) -> None:
        self._tell = tell
        self._now = now
        self._changed = threading.Condition()
        began = now()
        self._state = State(sequence=round(1000 * began), since=began)

    @property
    def state(self) -> State:
        return self._state

    def begin(self) -> None:
        """Tell of the first state."""
        with self._changed:
            self._tell(self._state)

    def happened(self, happening: Happening) -> State:
        """Something has happened; returns the state that came of it."""
        with self._changed:
            before, self._state = self._state, after(self._state, happening, self._now())
            if self._state.sequence != before.sequence:
                # Within the lock, so that they arrive in their order.
                self._tell(self._state)
                self._changed.notify_all()
            return self._state

    def wait_until(self, fits: Callable[[State], bool], seconds: float) -> bool:
        """Wait until the state is such a one, at most so long."""
        with self._changed:
            return self._changed.wait_for(lambda: fits(self._state), seconds)

    def on_event(self, kind: str, data: Mapping[str, Any]) -> None:
        """One of the robot's own events."""
        match kind:
            case "stopping":
                self.happened(happenings.StopAsked(_why(data)))
            case "stopped":
                self.happened(happenings.StopConfirmed(_why(data)))
            case "stop_not_confirmed":
                self.happened(happenings.StopNotConfirmed(str(data.get("message", _why(data)))))
            case "link" if data["state"] == "lost":
                self.happened(happenings.Lost(data["since"], _why(data)))
            case "link":
                self.happened(happenings.Found())
            case "battery":
                self.happened(happenings.Charging(bool(data.get("charging"))))
            case "pose" if self._state.stands and abs(data.get("speed") or 0.0) > MOVES_FROM:
                self.happened(happenings.Moving())

    def on_wire(self) -> dict[str, Any]:
        """The present state, as the event tells it."""
        return on_wire(self._state)


def _why(data: Mapping[str, Any]) -> str:
    return str(data.get("because", ""))
