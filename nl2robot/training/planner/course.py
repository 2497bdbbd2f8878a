"""How a training goes: what is told meanwhile, and what is known of it afterwards."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Final

import msgspec

from nl2robot.errors import UserError

OFTEN: Final = 10.0
"""Seconds between two lines, at least."""


class Measured(msgspec.Struct, frozen=True):
    """What it made of sentences that it never learned from, after a pass."""

    step: int
    loss: float
    """Of a token."""
    word_for_word: float
    """The share of programs."""


class Course(msgspec.Struct):
    steps: int
    device: str
    step: int = 0
    """How many are done."""
    seconds: float = 0.0
    """Of learning, without what lay between interruptions."""
    measured: list[Measured] = []

    def save(self, path: Path) -> None:
        path.write_bytes(msgspec.json.format(msgspec.json.encode(self)) + b"\n")

    @classmethod
    def load(cls, path: Path) -> Course:
        """Raises `UserError` if nothing was learned there."""
        try:
            return msgspec.json.decode(path.read_bytes(), type=cls)
        except FileNotFoundError as error:
            raise UserError(
                f"In {path.parent} nothing has been learned to its end. Run `python -m"
                " nl2robot.training.planner train` first; it goes on where it was interrupted."
            ) from error


class Steps:
    """Tells how far a training is, and when it will be done."""

    def __init__(self, course: Course, tell: Callable[[str], None]) -> None:
        self._course, self._tell = course, tell
        self._begun, self._first = time.monotonic(), course.step
        self._told = float("-inf")
        self._losses: list[float] = []
        if course.step:
            tell(f"It goes on after step {course.step} of {course.steps}.")

    def step(self, loss: float | None) -> None:
        """A step is done, or a measurement."""
        course, now = self._course, time.monotonic()
        if loss is None:
            last = course.measured[-1]
            self._tell(
                f"A pass is over: on what it never learns the loss is {last.loss:.3f}, and"
                f" {last.word_for_word:.0%} of the programs are right word for word."
            )
            return
        self._losses.append(loss)
        if now - self._told < OFTEN and course.step < course.steps:
            return
        mean = sum(self._losses) / len(self._losses)
        left = (now - self._begun) / (course.step - self._first) * (course.steps - course.step)
        self._tell(f"Step {course.step} of {course.steps}: loss {mean:.3f}, {lasting(left)} left.")
        self._told, self._losses = now, []


def lasting(seconds: float) -> str:
    """How long something takes, as somebody who waits wants to know it."""
    minutes = round(seconds / 60)
    if minutes < 1:
        return f"{seconds:.0f} s"
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes} min" if hours else f"{minutes} min"
