"""A session at the terminal: from an utterance to a finished run.

This is the main path as the operator meets it; its stations are, in order, `Operator.translate`
(understand, write), `Operator.check` (review), the person's decision, `Operator.approve` and
`Operator.run`.
"""

from __future__ import annotations

import secrets
import threading
from collections.abc import Mapping
from typing import Any

from nl2robot.errors import ExitStatus, UserError
from nl2robot.operator import Operator
from nl2robot.runner import Approval, Status
from nl2robot.terminal import Terminal
from nl2robot.translation import Translation
from robot_api.errors import LostConnection
from sandbox.limits import MAX_PROGRAM

LAST_WORDS = 2.0
"""Seconds to wait for the events of a run that is over."""


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
        self._watching = threading.Event()
        """While a run of this session goes on; others may use the same robot in between."""
        self._told_end = threading.Event()
        operator.watch(self._show, "program")

    def perform(self, utterance: str, heard: str | None = None) -> ExitStatus:
        """Understand an utterance, have its program approved, run it."""
        translation = self.understand(utterance)
        if translation.program is None:
            self._show_answer(translation)
            return ExitStatus.OK if translation.status == "ok" else ExitStatus.NOT_UNDERSTOOD
        return self.perform_program(translation.program, translation, heard)

    def understand(self, utterance: str) -> Translation:
        """Translate, asking back once where a question is open and somebody is there to answer."""
        translation = self._translate(utterance)
        if translation.status == "clarify" and translation.request and self.approve_all:
            self._show_answer(translation)
            return self._translate(translation.suggestions[0])  # "yes", and so it is learned
        if translation.status == "clarify" and self.terminal.somebody_is_there:
            self.terminal.show_refusal(translation)
            translation = self._translate(self.terminal.ask("> "))
        return translation

    def _show_answer(self, translation: Translation) -> None:
        """What was said instead of a program."""
        request = translation.request
        if request is not None and request.kind == "help":
            self.show_help(request.part)
        elif translation.status == "ok":
            self.terminal.show_message(translation)
        else:
            self.terminal.show_refusal(translation)

    def show_help(self, about: str = "") -> None:
        """What can be said here, by topic, or about one."""
        self.terminal.show_phrases(self.operator.phrases(self.language), about)

    def perform_program(
        self, program: str, translation: Translation | None = None, heard: str | None = None
    ) -> ExitStatus:
        """Review a program, have it approved, run it."""
        explanation = translation.explanation if translation else ""
        while True:
            if len(program.encode()) > MAX_PROGRAM:
                raise UserError(
                    f"The program is longer than {MAX_PROGRAM // 1000} kB. Make it shorter."
                )
            review = self.operator.check(program)
            edited = translation is None or program != translation.program
            self.terminal.show_review(review, "" if edited else explanation)
            if self.approve_all and not review.acceptable:
                self.terminal.console.print("The program cannot be approved. Nothing was run.")
                return ExitStatus.NOT_APPROVED
            decision = "approve" if self.approve_all else self.terminal.decide(review)
            if decision == "reject":
                self.terminal.console.print("Rejected. Nothing was run.")
                return ExitStatus.NOT_APPROVED
            if decision == "approve":
                break
            program = self.terminal.edit(program)
        return self._run(self.operator.approve(review, translation, heard))

    def _run(self, approval: Approval) -> ExitStatus:
        """Run what was approved, in view, to its end. Ctrl-C stops the robot."""
        self._told_end.clear()
        self._watching.set()
        try:
            status, interrupted = self._finish(approval)
            self._told_end.wait(LAST_WORDS)
        except LostConnection as error:
            raise UserError(
                f"{error} If the robot still moves, stop it by its own button."
                " Then see whether its server is running.",
                ExitStatus.NO_ROBOT,
            ) from error
        finally:
            self._watching.clear()
        self.terminal.show_end(status.state, status.message)
        if interrupted:
            return ExitStatus.INTERRUPTED
        if status.error == LostConnection.__name__:
            return ExitStatus.NO_ROBOT
        return ExitStatus.OK if status.state == "done" else ExitStatus.FAILED

    def _finish(self, approval: Approval) -> tuple[Status, bool]:
        """Start the run and wait for its end; tells whether Ctrl-C ended it."""
        run = None
        try:
            run = self.last_run = self.operator.run(approval)
            return self.operator.wait(run), False
        except KeyboardInterrupt:
            self.operator.stop()
            if run is None:
                raise
            return self.operator.wait(run), True

    def _show(self, kind: str, data: Mapping[str, Any]) -> None:
        if self._watching.is_set():
            self.terminal.show_event(kind, data)
            if data["what"] == "state" and data["state"] not in ("running", "paused"):
                self._told_end.set()

    def _translate(self, utterance: str) -> Translation:
        return self.operator.translate(utterance, self.language, self.planner, self._talk)
