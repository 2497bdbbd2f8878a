"""From words to a program: what `nl2robot translate` answers.

Kept light, because it must answer at once: it imports the grammar and the world's names only.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal

import msgspec

from grammar.language import load_language
from grammar.plan import Plan, calls, to_data
from grammar.requests import ABOUT_RUNS, Request, agreed
from grammar.understand import understand
from grammar.understanding import Context, Understanding
from nl2robot.errors import UserError
from nl2robot.knowledge import Knowledge
from nl2robot.plain import visible

if TYPE_CHECKING:
    from nl2robot.history import History, Record
    from nl2robot.teaching import Pending, Reply

Planner = Literal["auto", "grammar", "model"]


class Translation(msgspec.Struct, frozen=True, kw_only=True):
    """What became of an utterance; `to_json` gives the object of `translate --json`."""

    utterance: str
    status: Literal["ok", "clarify", "rejected"]
    program: str | None
    plan: dict[str, Any] | None
    source: Literal["grammar", "model"] | None
    """Which planner found the plan."""
    confidence: float
    explanation: str
    """The program in plain words; empty if there is none."""
    message: str | None
    """Why there is no program, or the question back."""
    suggestions: Sequence[str]
    """Sentences that would be understood."""
    ms: float
    """Milliseconds it took."""
    request: Request | None = None
    """What is asked of the application instead of the robot, such as to learn a routine; there
    is no program then, and the message is the answer."""

    def to_json(self) -> str:
        return msgspec.json.encode(self).decode()

    def readable(self, language: str = "en") -> str:
        """For people at a terminal: the program with its explanation, or why there is none."""
        if self.program is not None:
            return visible(f"{self.program}# {self.explanation}\n")
        lines = [self.message or ""]
        if self.suggestions:
            lines += [
                load_language(language).phrase("could_say"),
                *(f"  {phrase}" for phrase in self.suggestions),
            ]
        return visible("\n".join(lines))


class Talk:
    """A conversation: "no, the pharmacy" refers to what was said before in it."""

    context: Context | None = None
    pending: Pending | None = None
    """What waits for a yes."""
    last: Translation | None = None
    """The last one with a program."""
    last_at: float = 0.0
    """When that was: seconds since the epoch."""

    def note(self, translation: Translation) -> None:
        """Remember a program, so that it is known when it was carried out."""
        self.last, self.last_at = translation, time.time()

    def carried_out(self, record: Record | None) -> bool:
        """Whether the last program has been run since."""
        return (
            record is not None
            and self.last is not None
            and record.run.started >= self.last_at
            and (
                record.run.program == self.last.program
                or record.run.utterance == self.last.utterance
            )
        )


def translate(
    utterance: str,
    knowledge: Knowledge,
    language: str = "en",
    planner: Planner = "auto",
    talk: Talk | None = None,
    history: History | None = None,
) -> Translation:
    """Understand an utterance and write it as a program. Never moves anything, never raises for
    words that are not understood: the status says so. A `talk` remembers it; `history` knows what
    was run, for questions about it.
    Raises `UserError` for a language or a planner that there is not."""
    from grammar.language import UnknownLanguage
    from grammar.program import write_program
    from nl2robot.teaching import told

    if planner == "model":
        raise UserError(
            "There is no model planner in this version."
            " Leave --planner out, or say --planner grammar."
        )
    started = time.perf_counter()
    talk = talk or Talk()
    answered = _settled(utterance, knowledge, talk)
    if answered is not None:
        return _answer(utterance, answered, None, started)
    try:
        lexicon = knowledge.lexicon(language)
        record = history.last() if history is not None else None
        if talk.context is not None and talk.carried_out(record):
            assert record is not None
            origin = record.origin(knowledge.world)
            talk.context = replace(talk.context, carried_out=True, origin=origin)
        understood = understand(utterance, lexicon, language, talk.context)
        if understood.status == "rejected":
            other = _in_another_language(utterance, knowledge, language)
            if other is not None:
                language, understood = other
    except UnknownLanguage as error:
        raise UserError(str(error)) from error
    before = talk.context.text if talk.context else ""
    talk.context = understood.context
    if understood.request is not None:
        answer = _replied(understood.request, knowledge, language, before, talk, record)
        talk.pending = answer.pending
        return _answer(utterance, answer, understood.request, started)
    plan: Plan | None = understood.plan
    program = write_program(plan) if plan else None
    explanation = told(plan, lexicon, language) if plan else ""
    translation = Translation(
        utterance=utterance,
        status=understood.status,
        program=program,
        plan=to_data(plan) if plan else None,
        source="grammar" if plan else None,
        confidence=understood.confidence,
        explanation=explanation,
        message=_with_trouble(understood.message, knowledge),
        suggestions=understood.suggestions,
        ms=round((time.perf_counter() - started) * 1000, 3),
    )
    if program is not None:
        talk.note(translation)
    return translation


def _in_another_language(
    utterance: str, knowledge: Knowledge, language: str
) -> tuple[str, Understanding] | None:
    """Who wants to be spoken to in another language, or cries stop, may do so in that one: "sprich
    Deutsch", "arrête". The language and what was understood; None for anything else."""
    from grammar.language import known_by_word

    for code in known_by_word(utterance):
        if code == language:
            continue
        understood = understand(utterance, knowledge.lexicon(code), code)
        made = {call.method for call in calls(understood.plan)} if understood.plan else set()
        if made in ({"set_language"}, {"stop"}):
            return code, understood
    return None


def _with_trouble(message: str | None, knowledge: Knowledge) -> str | None:
    """Why something was not understood; that may be because the routines could not be read."""
    if message is None or knowledge.trouble is None:
        return message
    return f"{message} {knowledge.trouble}"


def _replied(
    request: Request,
    knowledge: Knowledge,
    language: str,
    before: str,
    talk: Talk,
    record: Record | None,
) -> Reply:
    """The answer to what is asked of the application."""
    from nl2robot.history import told_of
    from nl2robot.teaching import Reply, reply

    pack = load_language(language)
    if request.kind in ABOUT_RUNS:
        answer = told_of(request, record, knowledge.lexicon(language), pack)
        return Reply("ok" if record is not None else "rejected", answer)
    match request.kind:
        case "cancel":
            talk.last = None
            return Reply("ok", pack.phrase("dropped"))
        case "undo":
            return Reply("rejected", pack.phrase("nothing_to_undo"))
        case "pace":
            return Reply("rejected", pack.phrase("one_pace"))
        case "planned":
            if talk.last is None or talk.carried_out(record):
                return Reply("rejected", pack.phrase("nothing_planned"))
            return Reply("ok", talk.last.explanation)
        case "why" if talk.last is not None and not talk.carried_out(record):
            values = {"task": talk.last.utterance, "explanation": talk.last.explanation}
            return Reply("ok", pack.phrase("because_said", **values))
        case "why":
            happened = told_of(Request("happened"), record, knowledge.lexicon(language), pack)
            return Reply("ok" if record is not None else "rejected", happened)
        case _:
            return reply(request, knowledge, language, before)


def _settled(utterance: str, knowledge: Knowledge, talk: Talk) -> Reply | None:
    """What became of the change that was waiting for a yes; None if this is no answer to it."""
    pending, talk.pending = talk.pending, None
    if pending is None:
        return None
    yes = agreed(utterance, pending.language)
    if yes is None:
        return None
    from nl2robot.teaching import settle

    return settle(pending, yes, knowledge)


def _answer(utterance: str, answer: Reply, request: Request | None, started: float) -> Translation:
    return Translation(
        utterance=utterance,
        status=answer.status,
        program=None,
        plan=None,
        source="grammar",
        confidence=1.0,
        explanation="",
        message=answer.message,
        suggestions=answer.suggestions,
        ms=round((time.perf_counter() - started) * 1000, 3),
        request=request,
    )
