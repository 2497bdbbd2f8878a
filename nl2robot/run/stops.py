"""Where a stop begins among a robot's events."""

from __future__ import annotations

import threading


class Stops:
    """Tells the first event of each stop from the later ones.

    A driver says `stopping` at once, and `stopped` or `stop_not_confirmed` when it knows, which may
    take seconds, in which somebody may already have started something new. One that only ever says
    `stopped` is understood, too. Any thread may call it.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._open = 0

    def begins(self, kind: str) -> bool:
        """Whether an event of this kind is the first of a stop; to be asked once for each event."""
        with self._lock:
            match kind:
                case "stopping":
                    self._open += 1
                    return True
                case "stopped" | "stop_not_confirmed" if self._open:
                    self._open -= 1
                case "stopped":
                    return True
        return False
