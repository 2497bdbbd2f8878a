"""What a program does in a scene: it runs in the sandbox, on a robot on paper."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final, Literal

from nl2robot.deliberation.paper_robot import Event, PaperRobot, Scene
from sandbox.execution import Execution
from sandbox.limits import Limits

SEED: Final = 0
LIMITS: Final = Limits(rounds=200_000, computing=30.0, calls=1000)
"""Counted in rounds, so that votes do not depend on how busy the machine is."""

End = Literal["done", "over", "failed"]
"""How a program ends: by itself, never (it waits or goes on for ever), or with an error."""


@dataclass(frozen=True)
class Course:
    """What happened, and how it ended."""

    events: tuple[Event, ...]
    end: End
    message: str = ""
    """What it failed at."""


def played(program: str, scene: Scene) -> Course:
    """Run a program in a scene; a few milliseconds. Never raises for any program."""
    robot = PaperRobot(scene)

    def call(method: str, arguments: dict[str, Any], line: int) -> Any:
        return getattr(robot, method)(**arguments)

    outcome = Execution(program, call, seed=SEED, limits=LIMITS).run()
    ends: dict[str, End] = {"done": "done", "stopped": "over", "limit": "over"}
    end = ends.get(outcome.status, "failed")
    return Course(tuple(robot.events), end, outcome.message if end == "failed" else "")
