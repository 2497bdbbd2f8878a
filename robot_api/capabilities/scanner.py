"""Scanner: `scan`."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING

from robot_api.capabilities.base import Capability
from robot_api.capabilities.emulation import InEmulation
from robot_api.capabilities.simulation import InSimulation
from robot_api.driver import StopFlag
from robot_api.errors import TimedOut

if TYPE_CHECKING:
    from robot_api.capabilities.speech import Speech

_CODE = "4006381333931"
"""What the emulator scans when it has no canned answer left."""


class Scanner(Capability):
    """Reads bar codes and QR codes."""

    name = "scanner"
    lacking = "has no scanner"

    def __init__(self, speech: Speech | None) -> None:
        super().__init__()
        self._speech = speech

    @abstractmethod
    def read_code(self, stop: StopFlag, timeout: float) -> str | None:
        """What the code before the robot says, or None if there is none within `timeout` s."""

    def scan(self, stop: StopFlag, prompt: str | None, timeout: float) -> str:
        if prompt and self._speech is not None:
            self._speech.say(stop, prompt)
        code = self.read_code(stop, timeout)
        if code is None:
            raise TimedOut(
                f"Nobody held a code before me for {timeout:g} seconds. "
                "Hold it up, or let me wait longer."
            )
        return code


class EmulatedScanner(InEmulation, Scanner):
    def read_code(self, stop: StopFlag, timeout: float) -> str | None:
        code = self.emulation.next_answer(_CODE)
        self.emulation.pass_time(timeout if code is None else min(2.0, timeout), stop)
        return code


class SimulatedScanner(InSimulation, Scanner):
    def read_code(self, stop: StopFlag, timeout: float) -> str | None:
        return self.run(self.simulation.scan(timeout), stop)
