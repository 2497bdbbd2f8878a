"""A session at the terminal: from an utterance to a finished run.

This is the main path as the operator meets it; its stations are, in order, `Operator.translate`
(understand, write), `Operator.check` (review), the person's decision, `Operator.approve` and
`Operator.run`.
"""

from __future__ import annotations

import contextlib
import secrets
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

import msgspec

from grammar.language import languages
from grammar.planning.rules import NAME as RULES
from grammar.requests import ABOUT_RUNS
from nl2robot.cli.operator import Operator, Wish
from nl2robot.cli.terminal import Decision, Terminal
from nl2robot.cli.waiting import GivenUp
from nl2robot.errors import ExitStatus, UserError
from nl2robot.review.review import Review
from nl2robot.run.answers import Sentence
from nl2robot.run.going_on import asks_to_go_on
from nl2robot.run.going_on import texts as going_on_texts
from nl2robot.run.runs import Approval, Status
from nl2robot.run.state import GOING, HELD
from nl2robot.schedule.rhythm import next_begin
from nl2robot.station.harmless import approver, needs_no_question
from nl2robot.translate.other_language import accepted, hint, language_of, question
from nl2robot.translate.outcome import Scheduled, Translation
from nl2robot.translate.translation import STOP
from robot_api.errors import (
    AccessDenied,
    InvalidCall,
    LostConnection,
    NotPossible,
    RobotError,
    StopNotConfirmed,
    Stopped,
)
from robot_api.methods import MAX_TEXT
from sandbox.limits import MAX_PROGRAM

if TYPE_CHECKING:
    from sim.world.model import World

T = TypeVar("T")

MOST_QUESTIONS = 5
"""Questions back that are asked before the command is left alone."""
LOOK_EVERY = 0.1
"""Seconds between two looks whether a run is over."""
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
        world: World | None = None,
        ask_always: bool = False,
    ) -> None:
        """`world` is where the robot drives, for the names of places."""
        self.operator = operator
        self.terminal = terminal
        self.language = language
        self.planner = planner
        self.approve_all = approve_all
        self.ask_always = ask_always
        """Also before what only looks or tells."""
        self.last_run: int | None = None
        self.listens = False
        """Whether what is typed while a program runs is heard at once: "stop"."""
        self._typed: list[str] = []
        """What was typed meanwhile and can wait."""
        self._talk = secrets.token_hex(8)
        self.is_asked = False
        """Whether a question back is open."""
        self._watching = threading.Event()
        """While a run of this session goes on; others may use the same robot in between."""
        self._told_end = threading.Event()
        self._state: Mapping[str, Any] = {}
        self._declined: set[str] = set()
        """The languages that nobody wanted to go on in."""
        operator.watch(self._show, "program")
        with contextlib.suppress(InvalidCall):  # a server that tells nothing of it
            operator.watch(self._show_state, "state")
        terminal.accompany(operator, world)

    def perform(self, utterance: str, heard: str | None = None) -> ExitStatus:
        """Understand an utterance, have its program approved, run it."""
        if asks_to_go_on(utterance, self.language):
            rest = self.operator.unfinished(self.language)
            if rest is not None:
                for sentence in rest.told:
                    self.terminal.console.print(sentence, markup=False)
                return self.perform_program(rest.program, continues=rest.run)
        try:
            translation = self.understand(utterance)
        except GivenUp as given_up:
            self.terminal.show_given_up()
            return given_up.status
        self.is_asked = translation.status == "clarify"
        if translation.schedule is not None:
            return self.make_appointment(
                wished(translation.schedule), translation.schedule.translation
            )
        if translation.program is None:
            self._show_answer(translation)
            return ExitStatus.OK if translation.status == "ok" else ExitStatus.NOT_UNDERSTOOD
        if translation.program == STOP:  # nobody need approve that the robot stands still
            if not self._stop():
                return ExitStatus.NO_ROBOT
            self.terminal.show_end("stopped", None)
            return ExitStatus.OK
        return self.perform_program(translation.program, translation, heard)

    def make_appointment(self, wish: Wish, translation: Translation) -> ExitStatus:
        """Have a program approved for set times, and put it in the book."""
        assert translation.program is not None
        return self.perform_program(translation.program, translation, wish=wish)

    def next_line(self) -> str | None:
        """What was typed while a program ran and waits for its turn."""
        return self._typed.pop(0) if self._typed else None

    def understand(self, utterance: str) -> Translation:
        """Translate, asking back while a question is open and somebody is there to answer. Raises
        `GivenUp`."""
        translation = self._in_their_language(utterance, self._translate(utterance))
        if translation.status == "clarify" and translation.request and self.approve_all:
            self._show_answer(translation)
            return self._translate(translation.suggestions[0])  # "yes", and so it is learned
        for _ in range(MOST_QUESTIONS):
            if translation.status != "clarify" or not self.terminal.somebody_is_there:
                break
            self.terminal.show_refusal(translation)
            translation = self._translate(self.terminal.ask("> "))
        return translation

    def _in_their_language(self, utterance: str, translation: Translation) -> Translation:
        """What was not understood may be in another language: then it is asked, once for each,
        whether to go on in that. Where nobody can be asked, they are told."""
        if translation.status != "rejected":
            return translation
        code = language_of(utterance, self.language)
        if code is None:
            return translation
        if self.approve_all or not self.terminal.somebody_is_there:
            message = f"{translation.message or ''} {hint(code, self.language)}".strip()
            return msgspec.structs.replace(translation, message=message)
        if code not in self._declined:
            answer = self.terminal.ask(f"{question(code, self.language)} ")
            if not accepted(answer, code, self.language):
                self._declined.add(code)
        if code in self._declined:
            return self._translate(utterance)  # said again: as it stands
        with contextlib.suppress(RobotError):  # one without a voice for it is written to in it
            self.operator.robot.set_language(code)
        self.language = code
        self.terminal.speak(code)
        return self._translate(utterance)

    def _show_answer(self, translation: Translation) -> None:
        """What was said instead of a program."""
        request = translation.request
        if request is not None and request.kind == "help":
            self.show_help(request.part)
        elif translation.status == "ok":
            self.terminal.show_message(translation)
            self._tell_aloud([translation.message or ""])
        else:
            self.terminal.show_refusal(translation)

    def show_help(self, about: str = "") -> None:
        """What can be said here, by topic, or about one."""
        self.terminal.show_phrases(self.operator.phrases(self.language), about)

    def perform_program(
        self,
        program: str,
        translation: Translation | None = None,
        heard: str | None = None,
        continues: int | None = None,
        wish: Wish | None = None,
    ) -> ExitStatus:
        """Review a program, have it approved, run it; what is left of it, if it `continues` a run.
        With a `wish` it is approved for set times, and put in the book instead. A correction
        instead of a decision makes another program of it, which is reviewed in its place."""
        asked, proposed = self.ask_always, program
        while True:
            if len(program.encode()) > MAX_PROGRAM:
                words = self.terminal.words["program_too_long"]
                raise UserError(words.format(kilobytes=MAX_PROGRAM // 1000))
            at = next_begin(wish.rhythm, time.time()) if wish is not None else None
            review = self.operator.check(program, self.language, continues, at)
            edited = translation is None or program != translation.program
            if wish is not None:
                self.terminal.show_when(wish.when)
            self.terminal.show_review(review, None if edited else translation)
            if self.approve_all and not review.acceptable:
                self.terminal.console.print(self.terminal.words["cannot_be_approved"])
                return ExitStatus.NOT_APPROVED
            no_question = not (asked or self.approve_all or edited or continues is not None or wish)
            if no_question and needs_no_question(review, translation):
                by = approver(self.operator.name, self.language)
                approval = self._approve(review, translation, heard, by=by)
                if approval is not None:
                    break
            self.operator.reviewing(True)
            try:
                decision, said = self._decision(review)
            finally:
                self.operator.reviewing(False)
            asked = True
            if decision == "approve" and wish is not None:
                return self._put_in_book(review, wish)
            if decision == "approve":
                approval = self._approve(review, translation, heard, continues, proposed=proposed)
                if approval is not None:
                    break
                continue  # it waits here until the other program is over
            if decision == "edit":
                before, program = program, self.terminal.edit(program)
                if continues is not None and program != before:
                    continues = None
                    told = going_on_texts(self.language)["changed"]
                    self.terminal.console.print(told, markup=False)
                continue
            if decision is None:
                try:
                    changed = self.understand(said)
                except GivenUp:
                    self.terminal.show_given_up()
                    continue
                if changed.schedule is not None:
                    wish = wished(changed.schedule)
                    changed = changed.schedule.translation
                if changed.program is not None and changed.program != STOP:
                    translation, program, continues = changed, changed.program, None
                    proposed = program
                    continue
                if not self._is_dropped(changed):
                    self._show_answer(changed)
                    if changed.status == "rejected":
                        told = self.terminal.words["still_waits"]
                        self.terminal.console.print(told, markup=False)
                    continue
            self.terminal.console.print(self.terminal.words["rejected"])
            return ExitStatus.NOT_APPROVED
        return self._run(approval)

    def _approve(
        self,
        review: Review,
        translation: Translation | None,
        heard: str | None,
        continues: int | None = None,
        by: str | None = None,
        proposed: str | None = None,
    ) -> Approval | None:
        """None while another program runs, or where it is not as it was when they decided, which
        is said. What did not come to its end is only approved here by who insists."""
        insists = not review.came_through
        try:
            return self.operator.approve(
                review,
                translation,
                heard,
                continues,
                by,
                proposed,
                insists=insists,
                language=self.language,
            )
        except NotPossible:
            if self.approve_all:
                raise
            self.terminal.console.print(self.terminal.words["busy"], markup=False)
            return None
        except AccessDenied:
            if self.approve_all or insists:
                raise
            self.terminal.console.print(self.terminal.words["not_as_it_was"], markup=False)
            return None

    def _put_in_book(self, review: Review, wish: Wish) -> ExitStatus:
        insists = not review.came_through
        kept = self.operator.put_in_book(review, wish, self.language, insists)
        self.terminal.show_appointment(kept)
        return ExitStatus.OK

    def _decision(self, review: Review) -> tuple[Decision | None, str]:
        return ("approve", "") if self.approve_all else self.terminal.decide(review)

    @staticmethod
    def _is_dropped(translation: Translation) -> bool:
        """Whether nothing is to be done after all."""
        request = translation.request
        return translation.program == STOP or (request is not None and request.kind == "cancel")

    def _run(self, approval: Approval) -> ExitStatus:
        """Run what was approved, in view, to its end. Ctrl-C stops the robot."""
        self._told_end.clear()
        self._watching.set()
        try:
            status, interrupted = self._finish(approval)
            self._told_end.wait(LAST_WORDS)
        except LostConnection as error:
            words = self.terminal.words["lost_while_running"].format(because=error)
            raise UserError(words, ExitStatus.NO_ROBOT) from error
        finally:
            self._watching.clear()
        answer = self._answer(status)
        self.terminal.show_answer(answer, status.state, status.message, status.error)
        if not interrupted:
            self._tell_aloud([each.text for each in answer if not each.spoken])
        if interrupted:
            return ExitStatus.INTERRUPTED
        if status.error in (LostConnection.__name__, StopNotConfirmed.__name__):
            return ExitStatus.NO_ROBOT
        return ExitStatus.OK if status.state == "done" else ExitStatus.FAILED

    def _tell_aloud(self, sentences: Sequence[str]) -> None:
        """Say what the robot has not said itself, where whoever asked listens. A stop ends it."""
        if not (self.terminal.aloud and any(sentences)):
            return

        def say() -> None:
            with contextlib.suppress(RobotError, Stopped):
                self.operator.robot.say(" ".join(sentences)[:MAX_TEXT])

        if self.terminal.hears:
            self._with_an_open_ear(say)
        else:
            say()

    def _answer(self, status: Status) -> list[Sentence]:
        """What came of a run; nothing where the robot can no longer be asked."""
        try:
            return self.operator.answer(status.run, self.language)
        except (RobotError, Stopped):
            return []

    def _finish(self, approval: Approval) -> tuple[Status, bool]:
        """Start the run and wait for its end; tells whether Ctrl-C ended it."""
        run = None
        try:
            run = self.last_run = self.operator.run(approval)
            return self._wait(run), False
        except KeyboardInterrupt:
            self._stop()
            if run is None:
                raise
            return self.operator.wait(run), True

    def _stop(self) -> bool:
        """Stop the robot; says so, and returns False, if it does not confirm that it stands."""
        try:
            self.operator.stop()
        except StopNotConfirmed:
            self.terminal.show_unconfirmed()
            return False
        return True

    def _show_state(self, kind: str, data: Mapping[str, Any]) -> None:
        """How the robot stands, where that is news."""
        if data["sequence"] <= self._state.get("sequence", 0):
            return
        before, self._state = self._state, data
        was_lost = before.get("lost_since") is not None
        if was_lost != (data["lost_since"] is not None):
            self.terminal.show_link(data)
        if self._watching.is_set() and data["state"] != before.get("state"):
            self.terminal.show_state(data["state"], before.get("state"))

    def _wait(self, run: int) -> Status:
        """Wait for the end of a run, with an open ear where somebody may type meanwhile."""
        if not self.listens:
            return self.operator.wait(run)
        return self._with_an_open_ear(lambda: self.operator.wait(run))

    def _with_an_open_ear(self, wait: Callable[[], T]) -> T:
        """Wait for something, and see to what is said or typed meanwhile."""
        ended: list[T] = []
        failed: list[BaseException] = []

        def run() -> None:
            try:
                ended.append(wait())
            except BaseException as error:  # noqa: BLE001 - raised again below
                failed.append(error)

        waiting = threading.Thread(target=run, name="waiting", daemon=True)
        waiting.start()
        waiting.join(LOOK_EVERY)
        while waiting.is_alive():
            line = self.terminal.typed(LOOK_EVERY)
            if line and waiting.is_alive():
                self._answer_meanwhile(line)
            elif line:
                self._typed.append(line)
        if failed:
            raise failed[0]
        return ended[0]

    def _answer_meanwhile(self, line: str) -> None:
        """What is typed while a program runs, or is thought of: a stop at once, answers to
        questions about it; the rest waits for its turn. Only the rules are asked, who answer at
        once: a language model may be at work on another sentence."""
        if asks_to_go_on(line, self.language) and self._state.get("state") in HELD:
            with contextlib.suppress(NotPossible):  # it was over in that very moment
                self.operator.resume()
            return
        heard = self.operator.translate(line, self.language, RULES)
        if heard.program == STOP:
            self._stop()
        elif heard.request is not None and heard.request.kind in ABOUT_RUNS:
            self.terminal.show_message(heard)
        else:
            self._typed.append(line)
            self.terminal.console.print(
                self.terminal.words["next"].format(words=line), markup=False
            )

    def _show(self, kind: str, data: Mapping[str, Any]) -> None:
        if self._watching.is_set():
            self.terminal.show_event(kind, data)
            if data["what"] == "result" and data["method"] == "set_language":
                self._follow(data)
            if data["what"] == "state" and data["state"] not in GOING:
                self._told_end.set()

    def _follow(self, result: Mapping[str, Any]) -> None:
        """Whom the robot speaks German with speaks German with it."""
        code = str(result["arguments"]["code"])[:2]
        if not result.get("error") and code in languages():
            self.language = code
            self.terminal.speak(code)

    def _translate(self, utterance: str) -> Translation:
        """Raises `GivenUp` if Ctrl-C or a stop ends it while a language model works."""
        with self.terminal.waiting() as waiting:

            def ask() -> Translation:
                return self.operator.translate(
                    utterance, self.language, self.planner, self._talk, waiting
                )

            try:
                return self._with_an_open_ear(ask) if self.terminal.hears else ask()
            except (KeyboardInterrupt, Stopped) as error:
                self.operator.give_up()
                if isinstance(error, KeyboardInterrupt) and not waiting.begun:
                    raise
                raise GivenUp(self.language) from error


def wished(planned: Scheduled) -> Wish:
    """What somebody has asked for in a sentence."""
    return Wish(
        rhythm=planned.rhythm,
        trigger=planned.trigger,
        when=planned.when,
        sentence=planned.sentence,
        plan=planned.plan,
    )
