"""What became of words: a program, one for set times, a question back, or why there is none."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import msgspec

from grammar.language import load_language
from grammar.requests import Request
from nl2robot.plain import visible
from nl2robot.schedule.rhythm import Rhythm
from nl2robot.schedule.triggers import Trigger
from nl2robot.texts import texts_in
from nl2robot.words import authorship

Status = Literal["ok", "clarify", "rejected"]


class Scheduled(msgspec.Struct, frozen=True, kw_only=True):
    """What is to be done at set times, or each time that something happens, once somebody has
    approved it for them; the fields of the program are those of its `Translation`."""

    rhythm: Rhythm | None = None
    trigger: Trigger | None = None
    """What begins it instead of the clock."""
    when: str
    """The rhythm or the event in words: "every day at 08:00"."""
    sentence: str
    """What is to be done, as it was said, without the times."""
    program: str
    plan: dict[str, Any] | None
    source: str | None
    confidence: float
    explanation: str
    unused: tuple[str, ...] = ()
    own: tuple[str, ...] = ()

    @property
    def asked(self) -> dict[str, Any]:
        """At what times or what event, and in words, as plain data for a page."""
        about = {"when": self.when, "rhythm": self.rhythm, "trigger": self.trigger}
        data: dict[str, Any] = msgspec.to_builtins(about)
        return data

    @property
    def translation(self) -> Translation:
        """What is done each time."""
        return Translation(
            utterance=self.sentence,
            status="ok",
            program=self.program,
            plan=self.plan,
            source=self.source,
            confidence=self.confidence,
            explanation=self.explanation,
            message=None,
            suggestions=[],
            ms=0.0,
            unused=self.unused,
            own=self.own,
        )


class Translation(msgspec.Struct, frozen=True, kw_only=True):
    """What became of an utterance; `to_json` gives the object of `translate --json`."""

    utterance: str
    status: Status
    program: str | None
    plan: dict[str, Any] | None
    source: str | None
    """Which planner found the plan: "grammar", "model", or another."""
    confidence: float
    """How likely it is that this was meant; calibrated: of all programs at 0.9, nine in ten are."""
    explanation: str
    """What the program does, in a breath; empty if there is none."""
    message: str | None
    """Why there is no program, or the question back."""
    suggestions: Sequence[str]
    """Sentences that would be understood."""
    ms: float
    """Milliseconds it took."""
    unused: tuple[str, ...] = ()
    """Words of the utterance that the program makes nothing of."""
    own: tuple[str, ...] = ()
    """What the robot would say of a language model's own knowledge."""
    request: Request | None = None
    """What is asked of the application instead of the robot, such as to learn a routine; there
    is no program then, and the message is the answer."""
    schedule: Scheduled | None = None
    """What is asked to be done at set times or at an event. There is no program to be run now then:
    this one is reviewed and approved for those times (`schedule.add` on the wire)."""

    @classmethod
    def without_program(
        cls,
        utterance: str,
        status: Status,
        message: str | None,
        suggestions: Sequence[str] = (),
        ms: float = 0.0,
    ) -> Translation:
        """A question back, or why there is none."""
        return cls(
            utterance=utterance,
            status=status,
            program=None,
            plan=None,
            source=None,
            confidence=0.0,
            explanation="",
            message=message,
            suggestions=list(suggestions),
            ms=ms,
        )

    def at(
        self,
        when: str,
        request: Request,
        utterance: str,
        language: str,
        *,
        rhythm: Rhythm | None = None,
        trigger: Trigger | None = None,
    ) -> Translation:
        """This as what is to be done at set times, or at an event, told as that; `utterance` is all
        that was said, `when` the times or the event in words."""
        assert self.program is not None
        planned = Scheduled(
            rhythm=rhythm,
            trigger=trigger,
            when=when,
            sentence=request.sentence,
            program=self.program,
            plan=self.plan,
            source=self.source,
            confidence=self.confidence,
            explanation=self.explanation,
            unused=self.unused,
            own=self.own,
        )
        waits = texts_in(language, "schedules")["not_yet"]
        told = f"{when[:1].upper()}{when[1:]}: {self.explanation} {waits}"
        return msgspec.structs.replace(
            Translation.without_program(utterance, "ok", told),
            source="grammar",
            confidence=self.confidence,
            request=request,
            schedule=planned,
        )

    def to_json(self) -> str:
        return msgspec.json.encode(self).decode()

    def readable(self, language: str = "en") -> str:
        """For people at a terminal: the program with its explanation, or why there is none."""
        if self.program is not None:
            told = [self.explanation, *self._authorship(language)]
            return visible(self.program + "".join(f"# {line}\n" for line in told))
        if self.schedule is not None:
            return visible(f"# {self.message}\n{self.schedule.program}")
        lines = [self.message or ""]
        if self.suggestions:
            lines += [
                load_language(language).phrase("could_say"),
                *(f"  {phrase}" for phrase in self.suggestions),
            ]
        return visible("\n".join(lines))

    def _authorship(self, language: str) -> list[str]:
        if self.source == "grammar":  # nearly always, and the words take a moment to read
            return []

        return list(authorship(self, language))
