"""Somebody who proposes programs over the wire, and whoever decides on them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

from robot_api.client import Robot

HELLO: Final = 'robot.goto("ward a")\nrobot.say("Hello!")\n'


@dataclass
class Asked:
    """A server that is asked about proposals."""

    robot: Robot

    def ask(self, method: str, **given: Any) -> Any:
        return self.robot.request(f"proposal.{method}", given)

    def propose(self, program: str = HELLO, **given: Any) -> Any:
        values = {"program": program, "sentence": "say hello in ward a", "by": "Sam", **given}
        return self.ask("make", **values)

    def approve(self, proposal: Any, by: str = "Nurse Kim", **given: Any) -> Any:
        return self.ask("approve", id=proposal["id"], sha256=proposal["sha256"], by=by, **given)
