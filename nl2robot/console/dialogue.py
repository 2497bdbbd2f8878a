"""What one operator and the robot say to each other, and the program that lies before them.

The main path as the page has it: `say` (understand, write) -> `review` -> `approve` -> the run.
It lives at the server, so that a page that is reloaded finds it again; it knows nothing of pages.
Its methods block as long as translation and dry run take, and may be called from any thread.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final, Literal

import msgspec

from nl2robot.console.harmless import is_harmless
from nl2robot.console.part import Backstage
from nl2robot.console.trouble import told
from nl2robot.console.visitor import texts
from nl2robot.errors import UserError
from nl2robot.review import Review, digest
from nl2robot.session import STOP
from nl2robot.translation import Translation, translate
from robot_api.errors import RobotError

LINES_KEPT: Final = 200

Tone = Literal["plain", "question", "trouble", "done"]


@dataclass(frozen=True)
class Line:
    """Something that was said."""

    by: Literal["you", "robot"]
    text: str
    tone: Tone = "plain"
    suggestions: Sequence[str] = ()
    """Sentences that may be said next."""
    topics: Mapping[str, Sequence[str]] = field(default_factory=dict)
    """What can be said, by topic."""
    run: int | None = None
    """The run that it is about."""


@dataclass(frozen=True)
class Draft:
    """A program that waits for a decision."""

    program: str
    translation: Translation | None = None
    """What it was made of; None if somebody wrote it."""
    heard: str | None = None
    review: Review | None = None
    """Of exactly this program; None while it is being reviewed."""

    @property
    def edited(self) -> bool:
        return self.translation is None or self.program != self.translation.program

    @property
    def may_run(self) -> bool:
        return self.review is not None and self.review.acceptable


class Dialogue:
    """One operator's, in one browser."""

    def __init__(self, backstage: Backstage, name: str) -> None:
        self.name = name
        """Of the conversation, for `Talks` and for the microphone."""
        self.lines: list[Line] = []
        self.draft: Draft | None = None
        self.busy = False
        """While words are being understood."""
        self.runs: set[int] = set()
        """Runs that were started here and are not over."""
        self._backstage = backstage
        self._watchers: list[Callable[[], None]] = []
        self._turn = threading.RLock()
        """One thing is said or decided at a time."""

    def watch(self, watcher: Callable[[], None]) -> Callable[[], None]:
        """Be told, from any thread, that something changed; returns what ends it."""
        self._watchers.append(watcher)
        return lambda: self._watchers.remove(watcher)

    # --- understand

    def say(self, words: str, language: str, who: str, harmless: bool = False) -> None:
        """Take what somebody typed. `harmless`: what does no harm need not be approved."""
        with self._turn:
            self._tell(Line("you", words), busy=True)
            talk = self._backstage.talks.of(self.name)
            runner = self._backstage.runner
            try:
                translation = translate(words, runner.knowledge, language, "auto", talk, runner)
            except UserError as error:
                self._tell(Line("robot", str(error), "trouble"))
                return
            self._take(translation, None, language, who, harmless)

    def hear(
        self,
        words: str,
        translation: Translation,
        language: str,
        who: str,
        harmless: bool = False,
    ) -> None:
        """Take what the microphone heard, which was translated in this conversation."""
        with self._turn:
            self._tell(Line("you", words))
            self._take(translation, words, language, who, harmless)

    def _take(
        self, translation: Translation, heard: str | None, language: str, who: str, harmless: bool
    ) -> None:
        request = translation.request
        if translation.program == STOP:  # nobody need approve that the robot stands still
            self._backstage.stop(_said("stopped", language))
            self.draft = None
            self._tell(Line("robot", _said("stopped", language), "done"))
        elif translation.program is not None:
            self._tell(Line("robot", translation.explanation))
            self._review(Draft(translation.program, translation, heard), language)
            self._let_through(language, who, harmless)
        elif request is not None and request.kind == "help":
            self._tell(Line("robot", _said("can_say", language), topics=self.topics(language)))
        else:
            if request is not None and request.kind == "cancel":
                self.draft = None
            tone: Tone = {"ok": "plain", "clarify": "question"}.get(translation.status, "trouble")  # type: ignore[assignment]
            text = translation.message or ""
            near = tuple(translation.suggestions)
            if tone == "trouble" and not near:
                near = (_said("what_can_i_say", language),)
            self._tell(Line("robot", text, tone, near))

    def topics(self, language: str) -> dict[str, list[str]]:
        """What can be said here, by topic."""
        from grammar.samples import samples

        return samples(self._backstage.runner.knowledge.lexicon(language), language)

    # --- review

    def propose(self, program: str, language: str, who: str = "", at_once: bool = False) -> None:
        """Lay a program before the operator that came from elsewhere: the map, a run to be done
        again. `at_once`: they chose not to be asked if there is nothing against it."""
        with self._turn:
            self._review(Draft(program), language)
            draft = self.draft
            if at_once and draft and draft.review and draft.may_run and not draft.review.risks:
                self.approve(draft.program, who, language)

    def touch(self, program: str) -> None:
        """Somebody is changing the program: from now on there is nothing that could be approved."""
        draft = self.draft
        if draft is not None:
            self.draft = replace(draft, program=program, review=None)
            self._changed()

    def edit(self, program: str, language: str) -> None:
        """Review the program as somebody has changed it."""
        with self._turn:
            draft = self.draft
            if draft is None:
                return
            self._review(Draft(program, draft.translation, draft.heard), language)

    def review(self, language: str) -> None:
        """Review the program that waits, where that was never finished."""
        with self._turn:
            draft = self.draft
            if draft is not None and draft.review is None:
                self._review(draft, language)

    def _review(self, draft: Draft, language: str) -> None:
        self.draft = draft
        self._changed()
        review = self._backstage.runner.check(draft.program, language)
        if self.draft is draft:
            self.draft = replace(draft, review=review)
        self._changed()

    # --- decide

    def _let_through(self, language: str, who: str, harmless: bool) -> None:
        draft = self.draft
        if harmless and draft and draft.review and is_harmless(draft.review):
            self.approve(draft.program, who, language)

    def approve(self, program: str, who: str, language: str) -> None:
        """Approve exactly this program and start it."""
        with self._turn:
            draft, runner = self.draft, self._backstage.runner
            if draft is None:
                return
            if draft.program != program or draft.review is None or not draft.may_run:
                self._tell(Line("robot", _said("changed_meanwhile", language), "trouble"))
                return
            translation = draft.translation
            plan = None if draft.edited or translation is None else translation.plan
            try:
                approval = runner.approve(
                    program,
                    digest(program),
                    who,
                    utterance=translation.utterance if translation else None,
                    heard=draft.heard,
                    language=language,
                    plan=msgspec.json.encode(plan).decode() if plan is not None else None,
                )
                self.runs.add(runner.run(approval.id))
            except (RobotError, UserError) as error:
                self._tell(Line("robot", str(error), "trouble"))
                return
            self.draft = None
            self._changed()

    def reject(self, language: str) -> None:
        """Nothing of it is done."""
        with self._turn:
            if self.draft is not None:
                self.draft = None
                self._tell(Line("robot", _said("rejected", language)))

    # --- watch

    def ended(self, run: int, state: str, message: str | None, language: str) -> None:
        """A run is over; told if it was started here."""
        if run in self.runs:
            self.runs.discard(run)
            status = self._backstage.runner.state()
            error = status.error if status and status.run == run else None
            why = told(error, message, language) if message else None
            text = " ".join(filter(None, (_said(f"ended_{state}", language), why)))
            self._tell(Line("robot", text, "done" if state == "done" else "trouble", run=run))

    def _tell(self, line: Line, busy: bool = False) -> None:
        self.lines = [*self.lines, line][-LINES_KEPT:]
        self.busy = busy
        self._changed()

    def _changed(self) -> None:
        for watcher in tuple(self._watchers):
            watcher()


def _said(key: str, language: str) -> str:
    return texts("desk", language)[key]
