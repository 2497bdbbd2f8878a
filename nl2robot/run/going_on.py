"""Going on with a program that was broken off: by a stop, by an error, by the end of its server.

The same program runs again from its first line, but the robot calls that were done are answered
from the log (`Recall`) and move nothing; from the call that was broken off it runs as any other.
Of a movement that is measured only the rest is made, as after a pause. A program that does not make
the same calls again, in the same order, is ended before it does anything new.
"""

from __future__ import annotations

import dataclasses
import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, Final

import msgspec
from msgspec import structs

from grammar.language import load_language
from grammar.naming import listed, naming
from nl2robot.knowledge import Knowledge
from nl2robot.review.review import reading
from nl2robot.run.history import NOTES
from nl2robot.run.pausing import MEASURED, Made, rest_of
from nl2robot.run.rounds_left import rounds
from nl2robot.run.runlog import LoggedCall, RunLog
from nl2robot.run.state import PAUSED
from nl2robot.texts import texts_in
from nl2robot.words import decimal
from robot_api.errors import RobotError, Stopped, error_named
from sandbox.execution import Outcome

BROKEN_OFF: Final = ("Stopped", "LostConnection", "StopNotConfirmed")
"""The errors of a call that was not done."""
DEVIATES: Final = (
    "The program did not come to the same point again: where it had called {before}, it now calls"
    " {now}. It was ended before it did anything. Have it done from the beginning instead."
)
STEPS_TOLD: Final = 8
ASIDE: Final = 0.3
"""Metres that a robot may be away from where it stopped without a word of it."""
TURNED: Final = 20.0
"""The same in degrees."""


class DoneCall(msgspec.Struct, frozen=True):
    """A robot call that came back, as the program made it."""

    method: str
    arguments: dict[str, Any]
    line: int
    result: Any = None
    error: str | None = None
    """Its name and sentence, as the log has it."""
    left: dict[str, Any] | None = None
    """Of one that was broken off: the arguments that make the rest of it; None if nothing is
    left."""


class Unfinished(msgspec.Struct, frozen=True, kw_only=True):
    """What is left of a run that was broken off."""

    run: int
    program: str
    sha256: str
    utterance: str | None
    done: tuple[DoneCall, ...]
    again: DoneCall | None
    """The call that was broken off, of which what is `left` is made."""
    stood: dict[str, float] | None
    """The pose in which the robot came to stand, if that is known."""

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
    if again is not None and again.left is None:  # broken off at its very end
        done.append(structs.replace(again, error=None))
        again = None
    return Unfinished(
        run=run.id,
        program=run.program,
        sha256=run.sha256,
        utterance=run.utterance,
        done=tuple(done),
        again=again,
        stood=msgspec.json.decode(run.stood) if run.stood is not None else None,
    )


def _done(log: RunLog, number: int) -> tuple[list[DoneCall], DoneCall | None]:
    """The calls that were done, those of the runs that it went on from among them, and the one that
    was broken off."""
    run = log.run(number)
    done: list[DoneCall] = []
    begun: DoneCall | None = None
    """A call that was broken off: what comes next makes the rest of it."""
    if run is not None and run.continues is not None:
        before = unfinished(log, run.continues)
        if before is not None:
            done, begun = list(before.done), before.again
    for whole, last in whole_calls(log.calls(number)):
        made = _made(whole, last, begun)
        begun = None
        if whole.seconds is None or _kind(whole) in BROKEN_OFF:
            return done, made
        done.append(made)
    return done, begun


def whole_calls(calls: Iterable[LoggedCall]) -> Iterator[tuple[LoggedCall, LoggedCall]]:
    """The calls as the program made them: a pause has broken some into pieces, of which each comes
    with its last. One that was still to go on reads as one that never came back."""
    pieces: list[LoggedCall] = []
    for call in calls:
        pieces.append(call)
        paused = _kind(call) == PAUSED
        if paused and _left(call) is not None:
            continue
        first, pieces = pieces[0], []
        whole = structs.replace(call, number=first.number, arguments=first.arguments)
        yield structs.replace(whole, error=None, result="null") if paused else whole, call
    if pieces:
        last = pieces[-1]
        yield structs.replace(pieces[0], seconds=None, error=None), last


def _made(whole: LoggedCall, last: LoggedCall, begun: DoneCall | None) -> DoneCall:
    """A call as the program made it, which may have `begun` in a run before."""
    return DoneCall(
        whole.method,
        msgspec.json.decode(whole.arguments) if begun is None else begun.arguments,
        whole.line,
        msgspec.json.decode(whole.result) if whole.result is not None else None,
        whole.error,
        _left(last),
    )


def _left(piece: LoggedCall) -> dict[str, Any] | None:
    """The arguments that make what is left of what was broken off; None if nothing is."""
    made = msgspec.json.decode(piece.made, type=Made) if piece.made is not None else None
    return rest_of(piece.method, msgspec.json.decode(piece.arguments), made)


def _kind(call: LoggedCall) -> str:
    return (call.error or "").partition(":")[0]


def recall_of(log: RunLog, run: int | None) -> Recall | None:
    """What was done in a run that another one `continues`; None without one."""
    rest = unfinished(log, run) if run is not None else None
    return Recall(rest.done, rest.again) if rest is not None else None


class Recall:
    """Answers the calls of a program from what was done before, in their order."""

    def __init__(self, done: Sequence[DoneCall], again: DoneCall | None = None) -> None:
        """`again` comes after those, and is made as far as it is left."""
        self._done = list(done)
        self._again = again
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
        self._compare(before, method, arguments)
        if before.error is not None:
            name, _, sentence = before.error.partition(": ")
            error = error_named(name)
            raise (error if issubclass(error, RobotError) else RobotError)(sentence)
        return before.result

    def left_of(self, method: str, arguments: dict[str, Any]) -> dict[str, Any]:
        """The arguments that make what is left of a call that was not done. Raises `Stopped` if it
        is another than the one that was broken off."""
        again, self._again = self._again, None
        if again is None:
            return arguments
        self._compare(again, method, arguments)
        return arguments if again.left is None else again.left

    def judged(self, outcome: Outcome) -> Outcome:
        """How a run really ended that was to go on: one that deviated was not stopped."""
        if self.deviation is None:
            return outcome
        return dataclasses.replace(
            outcome, status="failed", message=self.deviation, error="Deviates"
        )

    def _compare(self, before: DoneCall, method: str, arguments: Mapping[str, Any]) -> None:
        now = msgspec.json.decode(msgspec.json.encode(arguments))
        if (method, now) != (before.method, before.arguments):
            self.deviation = DEVIATES.format(
                before=_written(before.method, before.arguments), now=_written(method, now)
            )
            raise Stopped(self.deviation)


def _written(method: str, arguments: Mapping[str, Any]) -> str:
    given = ", ".join(f"{name}={value!r}" for name, value in arguments.items() if value is not None)
    return f"{method}({given})"


def asks_to_go_on(words: str, language: str) -> bool:
    """Whether somebody says "go on"."""
    return words.lower().strip(" .!,") in texts(language)["words"]


def told(
    rest: Unfinished,
    knowledge: Knowledge,
    language: str,
    here: Mapping[str, float] | None = None,
) -> list[str]:
    """What is done of it and what is left, in sentences. `here` is where the robot is now, if that
    is known."""
    words = texts(language)
    read = {
        each.line: each.text.rstrip(".:") for each in reading(rest.program, knowledge, language)
    }
    pack = load_language(language)
    called = naming(knowledge.lexicon(language), pack).called
    came = rounds(rest.program, rest.done, rest.line, rest.again)
    within = {line for each in came for line in each.lines}
    lines = Counter(
        call.line for call in rest.done if call.method not in NOTES and call.line not in within
    )
    told = {
        line: words["times"].format(step=read[line], number=number) if number > 1 else read[line]
        for line, number in lines.items()
        if line in read
    }
    told |= {
        each.lines.start: listed([*map(called, each.done)], pack) for each in came if each.done
    }
    steps = [told[line] for line in sorted(told)]
    if len(steps) > STEPS_TOLD:
        more = words["more"].format(number=len(steps) - STEPS_TOLD)
        steps = [*steps[:STEPS_TOLD], more]
    part = _left_in_words(rest.again, words, language)
    left = words["left"].format(line=rest.line, reading=f"{read.get(rest.line, '')}.")
    for each in came:
        if each.left:
            names = [*map(called, each.left)]
            gaps = {"names": listed(names, pack), "first": names[0], "line": rest.line}
            left = words["left_of_round"].format(**gaps)
    sentences = []
    if steps:
        sentences.append(words["done"].format(steps="; ".join(steps) + "."))
    elif part is None:
        sentences.append(words["nothing_done"])
    sentences.append(left)
    if part is not None:
        sentences.append(words["rest"].format(left=part))
    elif rest.again is not None and rest.done:
        sentences.append(words["again"])
    if rest.stood is not None and here is not None:
        sentences += _moved(rest.stood, here, words, language)
    return sentences


def _left_in_words(again: DoneCall | None, words: Mapping[str, Any], language: str) -> str | None:
    """How much is left of a movement of which a part was made."""
    if again is None or again.method not in MEASURED or again.left in (None, again.arguments):
        return None
    assert again.left is not None
    [(name, value)] = [
        (name, value) for name, value in again.left.items() if value != again.arguments.get(name)
    ]
    sort: str = words["amounts"][name]
    return sort.format(amount=decimal(round(abs(value), 1), language))


def _moved(
    stood: Mapping[str, float], here: Mapping[str, float], words: Mapping[str, Any], language: str
) -> list[str]:
    """That the robot is not where it stopped any more, if it is not."""
    away = math.hypot(here["x"] - stood["x"], here["y"] - stood["y"])
    if away > ASIDE:
        return [words["moved"].format(metres=decimal(round(away, 1), language))]
    turned = (here["theta"] - stood["theta"] + 180.0) % 360.0 - 180.0
    return [words["turned"]] if abs(turned) > TURNED else []


def texts(language: str) -> Mapping[str, Any]:
    """What is said here in a language; in English where there is nothing in that."""
    return texts_in(language, "going_on")
