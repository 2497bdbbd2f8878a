"""What came of a reminder, read from the calls of its run and from nothing else.

A program reminds somebody if it keeps the answer to a question of its own as `reminder_done`
(`grammar.reminders.reminding` writes it so). What is found out is by person: what was said to them,
when and where, and what they answered.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from typing import Any, Final, Literal

import msgspec

from nl2robot.run.runlog import LoggedCall
from robot_api.capabilities.hearing import NOT_UNDERSTOOD
from robot_api.errors import NotFound

ANSWER: Final = "reminder_done"
"""The name of the answer, which makes a program one that reminds somebody."""

Result = Literal["yes", "no", "unclear", "silent", "away", "gone", "broken_off"]
"""They answered yes, or no; or nothing that was understood; or nothing. They were not found; they
were no longer there when they were asked. It was broken off before they answered."""
ACTED_ON: Final[Sequence[Result]] = ("no", "unclear", "silent", "away", "gone")
"""What somebody has to know who was not there; what was broken off is told anyway."""
_WORST: Final[Sequence[Result]] = ("broken_off", "away", "gone", "silent", "unclear", "no", "yes")


class Outcome(msgspec.Struct, frozen=True, kw_only=True):
    """What came of reminding one person."""

    person: str
    """Their name, or whom the robot looked for: "nurse"; empty if the program names nobody."""
    result: Result
    what: str = ""
    """What was said to them; empty if it did not come to that."""
    said: float | None = None
    """When, in seconds since the epoch."""
    place: str | None = None
    """Where, by the name of the place."""
    question: str = ""
    answer: str | None = None
    """As the program got it."""


class Asking(msgspec.Struct, frozen=True):
    """What can be read from a program that reminds somebody."""

    asks: frozenset[int]
    """The lines with the question."""
    finds: frozenset[int]
    """The lines that look for who is asked."""
    persons: tuple[str, ...]
    """Whom it names."""
    what: str
    """What it says to them; empty if that is put together when it runs."""
    question: str


@lru_cache(maxsize=256)
def asking_of(program: str) -> Asking | None:
    """None for a program that reminds nobody, or is none."""
    if ANSWER not in program:
        return None
    try:
        tree = ast.parse(program)
    except (SyntaxError, ValueError, RecursionError):
        return None
    asks: set[int] = set()
    finds: set[int] = set()
    persons: dict[str, None] = {}
    questions: list[str] = []
    for ask, around in _asked(tree, ()):
        asks.update(_lines(ask))
        questions += _texts(ask.args[:1])
        persons.update(dict.fromkeys(_texts(_given(ask, "person"))))
        for outer in around:
            if isinstance(outer, ast.For):
                persons.update(dict.fromkeys(_texts(getattr(outer.iter, "elts", ()))))
            if isinstance(outer, ast.If):
                for call in _calls(outer.test, "find"):
                    finds.update(_lines(call))
                    persons.update(dict.fromkeys(_texts(call.args[:1])))
    if not asks:
        return None
    before = (call for call in _calls(tree, "say") if call.lineno < min(asks))
    said = sorted(before, key=lambda call: call.lineno)
    texts = _texts(said[-1].args[:1]) if said else []
    return Asking(
        frozenset(asks),
        frozenset(finds),
        tuple(persons),
        texts[0] if texts else "",
        questions[0] if questions else "",
    )


def outcomes(program: str, calls: Sequence[LoggedCall]) -> list[Outcome]:
    """What came of it, person by person in the order in which they were looked for or asked; empty
    for a program that reminds nobody."""
    asking = asking_of(program)
    if asking is None:
        return []
    reading = _Reading(asking)
    for call in calls:
        reading.read(call)
    reading.close()
    return reading.found


def worst(found: Sequence[Outcome]) -> Result | None:
    """Of several persons, what somebody has to know first; None if nobody was reminded."""
    results = {each.result for each in found}
    return next((each for each in _WORST if each in results), None)


class _Reading:
    """Goes through the calls of a run."""

    def __init__(self, asking: Asking) -> None:
        self.asking = asking
        self.found: list[Outcome] = []
        self._looked_for: str | None = None
        """Whom it has found, and not asked yet."""
        self._asked: Outcome | None = None
        """Who is being asked."""
        self._said: tuple[str, float, str | None] | None = None

    def read(self, call: LoggedCall) -> None:
        given: Mapping[str, Any] = msgspec.json.decode(call.arguments)
        if call.method == "find" and call.line in self.asking.finds:
            self._look(str(given.get("thing", "")), call)
        elif call.method == "say" and self._asked is None:
            self._said = (str(given.get("text", "")), call.started, call.place)
        elif call.method == "ask" and call.line in self.asking.asks:
            self._ask(given, call)

    def close(self) -> None:
        """There are no more calls, or they are about somebody else."""
        if self._asked is not None:
            self.found.append(self._asked)
        elif self._looked_for is not None:
            what, said, place = self._said or ("", None, None)
            self.found.append(
                Outcome(
                    person=self._looked_for,
                    result="broken_off",
                    what=what,
                    said=said,
                    place=place,
                    question=self.asking.question,
                )
            )
        self._asked = self._looked_for = None

    def _look(self, thing: str, call: LoggedCall) -> None:
        self.close()
        self._said = None
        found = call.result is not None and msgspec.json.decode(call.result) is True
        if found or call.result is None:
            self._looked_for = thing
        else:
            away = Outcome(person=thing, result="away", question=self.asking.question)
            self.found.append(away)

    def _ask(self, given: Mapping[str, Any], call: LoggedCall) -> None:
        person = str(given.get("person") or self._looked_for or "")
        if self._asked is not None and self._asked.person != person:
            self.close()
        self._looked_for = None
        what, said, place = self._said or ("", None, None)
        answer = msgspec.json.decode(call.result) if call.result is not None else None
        result = _result(call, answer, given.get("options"))
        before = self._asked.result if self._asked is not None else None
        if result == "silent" and before == "unclear":  # they did say something
            result = before
        self._asked = Outcome(
            person=person,
            result=result,
            what=what,
            said=said,
            place=call.place or place,
            question=str(given.get("question", "")),
            answer=str(answer) if answer is not None else None,
        )


def _result(call: LoggedCall, answer: Any, options: Any) -> Result:
    if answer is not None:
        first = options[0] if isinstance(options, list) and options else "yes"
        return "yes" if answer == first else "no"
    error = call.error or ""
    if NOT_UNDERSTOOD in error:
        return "unclear"
    if error.startswith(f"{NotFound.__name__}:"):
        return "gone"
    return "silent" if error.startswith("TimedOut:") else "broken_off"


# --- what stands in a program


_Around = tuple[ast.AST, ...]


def _asked(node: ast.AST, around: _Around) -> Iterator[tuple[ast.Call, _Around]]:
    """The questions whose answer is kept as `ANSWER`, each with what is around it."""
    if isinstance(node, ast.Assign) and _keeps_answer(node) and isinstance(node.value, ast.Call):
        yield from ((call, around) for call in _calls(node.value, "ask"))
    for inner in ast.iter_child_nodes(node):
        yield from _asked(inner, (*around, node))


def _keeps_answer(node: ast.Assign) -> bool:
    return any(isinstance(each, ast.Name) and each.id == ANSWER for each in node.targets)


def _calls(node: ast.AST, method: str) -> Iterator[ast.Call]:
    """The calls of a method of the robot, in order."""
    for each in ast.walk(node):
        if (
            isinstance(each, ast.Call)
            and isinstance(each.func, ast.Attribute)
            and isinstance(each.func.value, ast.Name)
            and (each.func.value.id, each.func.attr) == ("robot", method)
        ):
            yield each


def _given(call: ast.Call, name: str) -> list[ast.expr]:
    return [each.value for each in call.keywords if each.arg == name]


def _texts(values: Sequence[ast.expr]) -> list[str]:
    return [
        each.value
        for each in values
        if isinstance(each, ast.Constant) and isinstance(each.value, str)
    ]


def _lines(node: ast.expr) -> range:
    return range(node.lineno, (node.end_lineno or node.lineno) + 1)
