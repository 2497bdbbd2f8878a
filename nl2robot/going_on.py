"""Going on with a program that was broken off: by a stop, by an error, by the end of its server.

The same program runs again from its first line, but the robot calls that were done are answered
from the log (`Recall`) and move nothing; from the call that was broken off it runs as any other.
A program that does not make the same calls again, in the same order, is ended before it does
anything new.
"""

from __future__ import annotations

import functools
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import msgspec

from nl2robot.knowledge import Knowledge
from nl2robot.pausing import PAUSED
from nl2robot.review import reading
from nl2robot.runlog import LoggedCall, RunLog
from robot_api.errors import RobotError, Stopped, error_named

DATA: Final = Path(__file__).parent / "data" / "going_on.yaml"
BROKEN_OFF: Final = ("Stopped", "LostConnection", "StopNotConfirmed")
"""The errors of a call that was not done."""
DEVIATES: Final = (
    "The program did not come to the same point again: where it had called {before}, it now calls"
    " {now}. It was ended before it did anything. Have it done from the beginning instead."
)
STEPS_TOLD: Final = 8


class DoneCall(msgspec.Struct, frozen=True):
    """A robot call that came back, as the program made it."""

    method: str
    arguments: dict[str, Any]
    line: int
    result: Any = None
    error: str | None = None
    """Its name and sentence, as the log has it."""


class Unfinished(msgspec.Struct, frozen=True, kw_only=True):
    """What is left of a run that was broken off."""

    run: int
    program: str
    sha256: str
    utterance: str | None
    done: tuple[DoneCall, ...]
    again: DoneCall | None
    """The call that was broken off, and is made again in full."""

    @property
    def line(self) -> int:
        """Where it goes on."""
        if self.again is not None:
            return self.again.line
        return self.done[-1].line if self.done else 1


def unfinished(log: RunLog, number: int | None = None) -> Unfinished | None:
    """What is left of that run, or of the last; None if it came to its end, goes on, or failed
    through no fault of the robot's. Raises `LogError`."""
    newest = log.runs(1)
    run = log.run(number) if number is not None else (newest[0] if newest else None)
    if run is None or run.status == "done" or run.going_on:
        return None
    done, again = _done(log, run.id)
    if run.status == "failed" and again is None:
        if not done or done[-1].error is None:
            return None  # the program's own fault: it would fail again
        again = done.pop()
    return Unfinished(
        run=run.id,
        program=run.program,
        sha256=run.sha256,
        utterance=run.utterance,
        done=tuple(done),
        again=again,
    )


def _done(log: RunLog, number: int) -> tuple[list[DoneCall], DoneCall | None]:
    """The calls that were done, those of the runs that it went on from among them, and the one that
    was broken off."""
    run = log.run(number)
    done: list[DoneCall] = []
    if run is not None and run.continues is not None:
        before = unfinished(log, run.continues)
        done = list(before.done) if before is not None else []
    begun: LoggedCall | None = None
    """A call that a pause has broken off: what comes next makes the rest of it."""
    for call in log.calls(number):
        first = begun or call
        kind = (call.error or "").partition(":")[0]
        if kind == PAUSED:
            begun = first
            continue
        begun = None
        made = _made(first, call)
        if call.seconds is None or kind in BROKEN_OFF:
            return done, made
        done.append(made)
    return done, _made(begun, begun) if begun is not None else None


def _made(first: LoggedCall, last: LoggedCall) -> DoneCall:
    result = msgspec.json.decode(last.result) if last.result is not None else None
    arguments = msgspec.json.decode(first.arguments)
    return DoneCall(first.method, arguments, first.line, result, last.error)


class Recall:
    """Answers the calls of a program from what was done before, in their order."""

    def __init__(self, done: Sequence[DoneCall]) -> None:
        self._done = list(done)
        self._next = 0
        self.deviation: str | None = None
        """Why it was ended, if the program made other calls than before."""

    @property
    def goes_on(self) -> bool:
        """Whether there is more that was done."""
        return self._next < len(self._done)

    def answer(self, method: str, arguments: Mapping[str, Any]) -> Any:
        """What came of this call; raises what it raised then. Raises `Stopped` if it is another."""
        before = self._done[self._next]
        self._next += 1
        now = msgspec.json.decode(msgspec.json.encode(arguments))
        if (method, now) != (before.method, before.arguments):
            self.deviation = DEVIATES.format(
                before=_written(before.method, before.arguments), now=_written(method, now)
            )
            raise Stopped(self.deviation)
        if before.error is not None:
            name, _, sentence = before.error.partition(": ")
            error = error_named(name)
            raise (error if issubclass(error, RobotError) else RobotError)(sentence)
        return before.result


def _written(method: str, arguments: Mapping[str, Any]) -> str:
    given = ", ".join(f"{name}={value!r}" for name, value in arguments.items() if value is not None)
    return f"{method}({given})"


def asks_to_go_on(words: str, language: str) -> bool:
    """Whether somebody says "go on"."""
    return words.lower().strip(" .!,") in texts(language)["words"]


def told(rest: Unfinished, knowledge: Knowledge, language: str) -> list[str]:
    """What is done of it and what is left, in sentences."""
    words = texts(language)
    read = {
        each.line: each.text.rstrip(".:") for each in reading(rest.program, knowledge, language)
    }
    lines = Counter(call.line for call in rest.done)
    steps = [
        words["times"].format(step=read[line], number=number) if number > 1 else read[line]
        for line, number in lines.items()
        if line in read
    ]
    if len(steps) > STEPS_TOLD:
        more = words["more"].format(number=len(steps) - STEPS_TOLD)
        steps = [*steps[:STEPS_TOLD], more]
    sentences = [
        words["done"].format(steps="; ".join(steps) + ".") if steps else words["nothing_done"],
        words["left"].format(line=rest.line, reading=f"{read.get(rest.line, '')}."),
    ]
    if rest.again is not None and rest.done:
        sentences.append(words["again"])
    return sentences


@functools.cache
def texts(language: str) -> Mapping[str, Any]:
    """What is said here in a language; in English where there is nothing in that."""
    import yaml

    known: dict[str, dict[str, Any]] = yaml.safe_load(DATA.read_text(encoding="utf-8"))
    found: Mapping[str, Any] = known.get(language, known["en"])
    return found
