"""What the robot is doing and has done, for questions about it: "what did she say?".

The answers come from the log of what really happened, never from what a program meant to do.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Protocol

from grammar.explain import explain_program
from grammar.language import Language
from grammar.lexicon import Lexicon
from grammar.naming import Naming, joined_up, naming, place_called, the
from grammar.requests import Request
from nl2robot.run.sightings import Sightings
from nl2robot.run.trouble import told
from sim.world.model import World

if TYPE_CHECKING:
    from nl2robot.run.runlog import LoggedCall, Run

ASKING: Final = frozenset({"ask", "listen", "touch"})
FINDING: Final = frozenset({"find", "sees", "wait_for"})
MOVING: Final = frozenset({"goto", "guide", "follow", "find", "move", "drive", "dock"})

NOTES: Final = frozenset({"location", "places", "clock", "battery", "log"})
"""What a program looks up for itself; it is an answer only where there is no other."""


@dataclass(frozen=True)
class Done:
    """A robot call that came back."""

    method: str
    arguments: dict[str, Any]
    result: Any
    line: int
    error: str | None = None


@dataclass(frozen=True)
class Record:
    """A run of the log: the present one, or the last."""

    run: Run
    running: bool
    line: int | None
    """Where it is, or was when it ended."""
    calls: Sequence[Done]

    @property
    def moved(self) -> bool:
        return any(call.method in MOVING for call in self.calls)

    @property
    def failed(self) -> bool:
        return not self.running and self.run.status != "done"

    def origin(self, world: World) -> str | None:
        """The name of the place where it began, if that is known and the robot left it."""
        if self.run.start is None or not self.moved:
            return None
        start = json.loads(self.run.start)
        place = world.place_at(start["x"], start["y"])
        return place.name if place is not None else None


class History(Protocol):
    """Who knows what was run: the runner."""

    @property
    def sightings(self) -> Sightings:
        """Whom and what the robot has seen just now."""

    def last(self) -> Record | None:
        """The present run, or the last; None if there was none."""


def done_calls(calls: Iterable[LoggedCall]) -> list[Done]:
    """The calls of a log that came back, with their values."""
    return [
        Done(
            call.method,
            json.loads(call.arguments),
            json.loads(call.result) if call.result is not None else None,
            call.line,
            call.error,
        )
        for call in calls
        if call.seconds is not None
    ]


def told_of(request: Request, record: Record | None, lexicon: Lexicon, pack: Language) -> str:
    """The answer to a question about what was done."""
    if record is None:
        return pack.phrase("nothing_done")
    return Witness(record, lexicon, pack).told(request)


class Witness:
    """Tells what happened in one run."""

    def __init__(self, record: Record, lexicon: Lexicon, pack: Language) -> None:
        self.record = record
        self.lexicon = lexicon
        self.pack = pack
        self.naming: Naming = naming(lexicon, pack)

    def told(self, request: Request) -> str:
        match request.kind:
            case "doing":
                return self.doing()
            case "done":
                return self.done()
            case "said":
                return self.said(request.name)
            case "who said":
                return self.who_said(request.part)
            case "how many said":
                return self.how_many_said(request.part)
            case "counted":
                return self.counted()
            case "found":
                return self.found()
            case _:
                return self.happened()

    # --- how it stands

    def doing(self) -> str:
        if not self.record.running:
            return self.join(self.pack.phrase("doing_nothing"), self.ended())
        return self.pack.phrase("doing_this", what=self.step(), task=self.task())

    def done(self) -> str:
        if self.record.running:
            return self.pack.phrase("not_done_yet", what=self.step(), task=self.task())
        return self.ended()

    def ended(self) -> str:
        run = self.record.run
        if run.status == "done":
            return self.pack.phrase("run_done", task=self.task())
        reason = told(None, run.message or "", self.pack.code, self.lexicon)
        name = "run_stopped" if run.status == "stopped" else "run_failed"
        return self.pack.phrase(name, task=self.task(), reason=reason)

    def happened(self) -> str:
        told = [self.doing() if self.record.running else self.ended()]
        if any(call.method in ASKING for call in self.record.calls):
            told.append(self.said(""))
        if self.numbers():
            told.append(self.counted())
        if self.sought():
            told.append(self.found())
        return self.join(*told)

    def task(self) -> str:
        run = self.record.run
        return run.utterance or run.program.strip().splitlines()[0]

    def step(self) -> str:
        """What it is doing just now, in words."""
        line = self.record.line or 1
        lines = explain_program(self.record.run.program, self.pack.code, self.naming.called)
        at = [each.text for each in lines if each.line <= line]
        return at[-1] if at else self.task()

    # --- what was heard

    def answers(self) -> list[tuple[str, str, str]]:
        """Everything somebody answered: who, the question, the answer. Who has no name goes by
        where they are, as far as that is known."""
        found, place = [], ""
        for call in self.record.calls:
            if call.method in ASKING and call.error is None and call.result:
                who = str(call.arguments.get("person") or "")
                question = call.arguments.get("question") or call.arguments.get("prompt") or ""
                unnamed = who in ("", "person")
                found.append((place if unnamed else who, str(question), str(call.result)))
            elif call.error is None and call.method in ("goto", "find", "guide", "dock"):
                where = call.arguments.get("place")
                place = where if isinstance(where, str) and call.result is not False else ""
        return found

    def said(self, name: str) -> str:
        if not any(call.method in ASKING for call in self.record.calls):
            missing = any(not found for _, found in self.sought())
            return self.join(self.pack.phrase("nobody_asked"), self.found() if missing else "")
        answers = self.answers()
        if name:
            answers = [answer for answer in answers if answer[0].lower() == name.lower()]
        if not answers:
            return self.pack.phrase("no_answer")
        return self.join(*(self.answered(*answer) for answer in answers))

    def answered(self, person: str, question: str, answer: str) -> str:
        name = self.person(person)
        if not question:
            return self.pack.phrase("said_by", person=name, answer=answer)
        return self.pack.phrase("answered_by", person=name, question=question, answer=answer)

    def person(self, name: str) -> str:
        known = any(each.name.lower() == name.lower() for each in self.lexicon.people)
        if known:
            return name
        words = self.naming.called(name) if name and name != "person" else ""
        return f"{words[:1].upper()}{words[1:]}" if words else self.pack.phrase("somebody_said")

    def who_said(self, answer: str) -> str:
        if not self.answers():
            return self.said("")
        people = [self.person(who) for who, _, said in self.answers() if self.same(said, answer)]
        if not people:
            return self.pack.phrase("nobody_answered_so", answer=answer)
        return self.pack.phrase("these_said", people=", ".join(people), answer=answer)

    def how_many_said(self, answer: str) -> str:
        answers = self.answers()
        if not answers:
            return self.said("")
        number = sum(self.same(said, answer) for _, _, said in answers)
        return self.pack.phrase("so_many_said", number=number, all=len(answers), answer=answer)

    def same(self, said: str, answer: str) -> bool:
        """Whether an answer is the one that is asked about, or has its words in it."""
        words, sought = self.pack.tokens_of(said), self.pack.tokens_of(answer)
        return any(
            words[at : at + len(sought)] == sought for at in range(len(words) - len(sought) + 1)
        )

    # --- what was seen

    def numbers(self) -> list[tuple[str, str, Any]]:
        """Everything that was counted: what, where, how many."""
        place, found = "", []
        for call in self.record.calls:
            if call.error is not None:
                continue
            if call.method == "goto":
                where = call.arguments.get("place")
                place = where if isinstance(where, str) else ""
            elif call.method == "count":
                found.append((str(call.arguments["thing"]), place, call.result))
        return found

    def counted(self) -> str:
        if not self.numbers():
            return self.pack.phrase("nothing_counted")
        told = []
        for thing, place, number in self.numbers():
            things = self.pack.phrase("people") if thing == "person" else self.naming.called(thing)
            if place:
                name = place_called(place, self.lexicon, self.pack)
                told.append(self.pack.phrase("counted_at", things=things, place=name, value=number))
            else:
                told.append(self.pack.phrase("counted", things=things, value=number))
        return joined_up(self.join(*told), self.pack)

    def sought(self) -> list[tuple[str, bool]]:
        return [
            (str(call.arguments["thing"]), bool(call.result))
            for call in self.record.calls
            if call.method in FINDING and call.error is None
        ]

    def found(self) -> str:
        sought = self.sought()
        if not sought:
            return self.pack.phrase("nothing_sought")
        told = (
            self.pack.phrase("was_found" if found else "not_found", thing=self.thing(thing))
            for thing, found in sought
        )
        return joined_up(self.join(*told), self.pack)

    def thing(self, name: str) -> str:
        words = self.naming.called(name)
        known = any(each.name.lower() == name.lower() for each in self.lexicon.people)
        return words if known else the(words, self.pack)

    @staticmethod
    def join(*sentences: str) -> str:
        return re.sub(r"\s+", " ", " ".join(sentences)).strip()
