"""A session at the terminal: from an utterance to a finished run.

This is the main path as the operator meets it; its stations are, in order, `Operator.translate`
(understand, write), `Operator.check` (review), the person's decision, `Operator.approve` and
`Operator.run`.
"""

from __future__ import annotations

import secrets

from nl2robot.errors import ExitStatus
from nl2robot.operator import Operator
from nl2robot.terminal import Terminal
from nl2robot.translation import Translation


class Session:
    """One operator at one terminal; what was said before is remembered within a session."""

    def __init__(
        self,
        operator: Operator,
        terminal: Terminal,
        *,
        language: str = "en",
        planner: str = "auto",
        approve_all: bool = False,
    ) -> None:
        self.operator = operator
        self.terminal = terminal
        self.language = language
        self.planner = planner
        self.approve_all = approve_all
        self.last_run: int | None = None
        self._talk = secrets.token_hex(8)
        operator.watch(terminal.show_event, "program")

    def perform(self, utterance: str, heard: str | None = None) -> ExitStatus:
        """Understand an utterance, have its program approved, run it."""
        translation = self.understand(utterance)
        if translation.program is None:
            self.terminal.show_refusal(translation)
            return ExitStatus.NOT_UNDERSTOOD
        return self.perform_program(translation.program, translation, heard)

    def understand(self, utterance: str) -> Translation:
        """Translate, asking back once where a question is open and somebody is there to answer."""
        translation = self._translate(utterance)
        if translation.status == "clarify" and self.terminal.somebody_is_there:
            self.terminal.show_refusal(translation)
            translation = self._translate(self.terminal.ask("> "))
        return translation

    def show_help(self) -> None:
        """What can be said here, by topic."""
        self.terminal.show_phrases(self.operator.phrases(self.language))

    def perform_program(
        self, program: str, translation: Translation | None = None, heard: str | None = None
    ) -> ExitStatus:
        """Review a program, have it approved, run it."""
        explanation = translation.explanation if translation else ""
        while True:
            review = self.operator.check(program)
            edited = translation is None or program != translation.program
            self.terminal.show_review(review, "" if edited else explanation)
            if self.approve_all and not review.acceptable:
                return ExitStatus.NOT_APPROVED
            decision = "approve" if self.approve_all else self.terminal.decide(review)
            if decision == "reject":
                self.terminal.console.print("Rejected. Nothing was run.")
                return ExitStatus.NOT_APPROVED
            if decision == "approve":
                break
            program = self.terminal.edit(program)
        approval = self.operator.approve(review, translation, heard)
        return self._watch(self.operator.run(approval))

    def _watch(self, run: int) -> ExitStatus:
        self.last_run = run
        try:
            status = self.operator.wait(run)
        except KeyboardInterrupt:
            self.operator.stop()
            status = self.operator.wait(run)
            self.terminal.show_end(status.state, status.message)
            return ExitStatus.INTERRUPTED
        self.terminal.show_end(status.state, status.message)
        return ExitStatus.OK if status.state == "done" else ExitStatus.FAILED

    def _translate(self, utterance: str) -> Translation:
        return self.operator.translate(utterance, self.language, self.planner, self._talk)
