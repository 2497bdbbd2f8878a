"""Telepresence: `call`, `hang_up`."""

from __future__ import annotations

import threading
from abc import abstractmethod
from collections.abc import Mapping
from typing import Any

from robot_api.capabilities.base import Capability
from robot_api.capabilities.emulation import InEmulation
from robot_api.capabilities.names import one_of, unknown_contact
from robot_api.capabilities.simulation import InSimulation
from robot_api.driver import StopFlag

_RINGING = 4.0
"""Seconds until somebody answers, where nobody really does."""


class Telepresence(Capability):
    """Video calls, one at a time; with a real tablet they are real. The event "call" tells their
    state: "calling", "connected", "ended"."""

    name = "telepresence"
    lacking = "cannot make video calls"

    def __init__(self) -> None:
        super().__init__()
        self._contact: str | None = None
        self._lock = threading.Lock()  # for the above

    @abstractmethod
    def contacts(self) -> Mapping[str, str]:
        """For each name and alias, the contact of that name."""

    @abstractmethod
    def ring(self, stop: StopFlag, contact: str) -> None:
        """Call; returns when somebody answers. Raises `TimedOut`."""

    @abstractmethod
    def tell(self, contact: str, state: str) -> None:
        """Tell those who subscribed."""

    def call(self, stop: StopFlag, contact: str) -> None:
        known = self.contacts()
        name = one_of(contact, known)
        if name is None:
            raise unknown_contact(contact, known)
        self.hang_up(stop)
        with self._lock:
            self._contact = known[name]
        self.tell(known[name], "calling")
        try:
            if not self.tablet.ring(stop, known[name], self._over):
                self.ring(stop, known[name])
        except BaseException:
            self.hang_up(stop)
            raise
        self.tell(known[name], "connected")

    def hang_up(self, stop: StopFlag) -> None:
        """Does nothing if there is no call."""
        self.tablet.hang_up()
        self._over()

    def _over(self) -> None:
        with self._lock:
            ended, self._contact = self._contact, None
        if ended is not None:
            self.tell(ended, "ended")

    def declares(self) -> dict[str, Any]:
        return {"contacts": tuple(dict.fromkeys(self.contacts().values()))}


class EmulatedTelepresence(InEmulation, Telepresence):
    def contacts(self) -> Mapping[str, str]:
        return {name: name for name in self.emulation.contacts}

    def ring(self, stop: StopFlag, contact: str) -> None:
        self.emulation.pass_time(_RINGING, stop)

    def tell(self, contact: str, state: str) -> None:
        self.emulation.publish("call", contact=contact, state=state)


class SimulatedTelepresence(InSimulation, Telepresence):
    def contacts(self) -> Mapping[str, str]:
        contacts = self.simulation.world.contacts
        names = {contact.name: contact.name for contact in contacts}
        return names | {
            alias: contact.name
            for contact in contacts
            for aliases in contact.aliases.values()
            for alias in aliases
            if alias not in names
        }

    def ring(self, stop: StopFlag, contact: str) -> None:
        self.run(self.simulation.wait(_RINGING), stop)

    def tell(self, contact: str, state: str) -> None:
        self.simulation.emit("call", {"contact": contact, "state": state})
