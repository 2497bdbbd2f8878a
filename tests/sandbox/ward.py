"""A robot on a ward for the sandbox's tests: it does nothing but remember what it was asked."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

from robot_api.errors import Stopped, UnknownPlace
from robot_api.values import Clock, Location
from sandbox.execution import CallRecord, Execution, Outcome
from sandbox.limits import Limits

TIGHT = Limits(computing=0.4, total_computing=1.0, memory=20_000_000, calls=500, output=20_000)


class Ward:
    """Answers the calls of one run."""

    def __init__(self, answers: tuple[str, ...] = ("yes",)) -> None:
        self.said: list[str] = []
        self.calls: list[tuple[str, int]] = []
        self.printed: list[str] = []
        self.lines: list[int] = []
        self.records: list[CallRecord] = []
        self.gone_to: list[Any] = []
        self.waiting = threading.Event()
        """Set when a call that takes time has begun."""
        self.cancelled = threading.Event()
        self._answers = list(answers)

    def __call__(self, method: str, arguments: dict[str, Any], line: int) -> Any:
        self.calls.append((method, line))
        match method:
            case "say":
                self.said.append(arguments["text"])
            case "ask" | "listen":
                return self._answers.pop(0) if self._answers else "no"
            case "location":
                return Location(1.5, 2.0, 90.0, "ward")
            case "clock":
                return Clock("14:05", "Friday", "2026-11-20")
            case "places":
                return ["office 1", "office 2"]
            case "people":
                return ["Alice", "Bob"]
            case "battery" | "count":
                return 80
            case "sees" | "find":
                return False
            case "goto":
                if arguments.get("place") == "moon":
                    raise UnknownPlace("There is no place called moon. Say one of its places.")
                self.gone_to.append(arguments)
            case "wait_for":
                self.waiting.set()
                if self.cancelled.wait(20):
                    raise Stopped("The robot was stopped.")
        return None

    def run(
        self,
        program: str,
        limits: Limits | None = None,
        during: Callable[[Execution], None] | None = None,
        **more: Any,
    ) -> Outcome:
        """Run the program; `during(execution)` in a thread of its own at the same time."""
        execution = self.execution(program, limits, **more)
        helper = threading.Thread(target=during, args=(execution,)) if during else None
        if helper:
            helper.start()
        outcome = execution.run()
        if helper:
            helper.join(10)
            assert not helper.is_alive()
        return outcome

    def execution(self, program: str, limits: Limits | None = None, **more: Any) -> Execution:
        return Execution(
            program,
            self,
            limits=limits or TIGHT,
            on_line=self.lines.append,
            on_print=self.printed.append,
            on_call=self.records.append,
            **more,
        )


def children() -> set[int]:
    """The processes that this one has started and that still exist."""
    found: set[int] = set()
    for task in Path(f"/proc/{os.getpid()}/task").iterdir():
        try:
            found |= set(map(int, (task / "children").read_text().split()))
        except FileNotFoundError:
            continue
    return found
