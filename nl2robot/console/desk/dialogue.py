"""What one operator and the robot say to each other, and the program that lies before them.

The main path as the page has it: `say` (understand, write) -> `review` -> `approve` -> the run.
It lives at the server, so that a page that is reloaded finds it again; it knows nothing of pages.
Its methods block as long as translation and dry run take, and may be called from any thread. Only
`cancel` does not: it ends a translation that a language model thinks about.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Final, Literal

import msgspec

from grammar.plan import from_data
from grammar.planning.planner import Interrupted
from grammar.samples import samples
from nl2robot.console.desk.thought import Thought
from nl2robot.console.visitor import texts
from nl2robot.errors import UserError
from nl2robot.proposals.proposals import Proposal
from nl2robot.review.review import Review, digest
from nl2robot.run.answers import answer
from nl2robot.run.going_on import asks_to_go_on
from nl2robot.run.going_on import texts as going_on_texts
from nl2robot.run.state import HELD
from nl2robot.run.trouble import told
from nl2robot.schedule.rhythm import next_begin
from nl2robot.station.harmless import approver, needs_no_question
from nl2robot.station.part import Backstage
from nl2robot.translate.other_language import accepted, declined, language_of, question
from nl2robot.translate.outcome import Scheduled, Translation
from nl2robot.translate.teaching import told as told_in_words
from nl2robot.translate.translation import STOP, translate
from nl2robot.words import words_in
from robot_api.driver import StopFlag
from robot_api.errors import AccessDenied, NotPossible, RobotError, Stopped
from robot_api.methods import MAX_TEXT

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
    planned: int | None = None
    """The appointment that it is about."""


@dataclass(frozen=True)
class Draft:
    """A program that waits for a decision."""

    program: str
    translation: Translation | None = None
    """What it was made of; None if somebody wrote it."""
    heard: str | None = None
    review: Review | None = None
    """Of exactly this program; None while it is being reviewed."""
    continues: int | None = None
    """The run that was broken off, with which it goes on."""
    said: str | None = None
    """What somebody would have said who wants this, where they clicked on the map instead."""
    proposed: str | None = None
    """The program as it was laid before them, if somebody has changed it since."""
    changed_by: str | None = None
    times: Scheduled | None = None
    """The set times at which it is to be done, if some were said."""
    proposal: int | None = None
    """The proposal that it is, if an assistant made it."""

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
        self.thought: Thought | None = None
        """While words are being understood."""
        self.dropped: Thought | None = None
        """The last one that was cancelled, whose words somebody may want to send otherwise."""
        self.runs: set[int] = set()
        """Runs that were started here and are not over."""
        self._offered: tuple[str, str] | None = None
        """A language that was offered, and what was said in it."""
        self._declined: set[str] = set()
        """The languages that nobody wanted to go on in."""
        self._language: tuple[str, str] | None = None
        """A page's language, and the one that is spoken on it instead."""
        self._backstage = backstage
        self._watchers: list[Callable[[], None]] = []
        self._onlookers: list[Callable[[], None]] = []
        self._present = 0
        self._state = threading.Lock()
        """Around what changes while something is thought about."""
        self._words = threading.Lock()
        """Sentences are understood one after the other."""
        self._turn = threading.RLock()
        """One thing is decided at a time; also while something is thought about."""

    def watch(self, watcher: Callable[[], None]) -> Callable[[], None]:
        """Be told, from any thread, that something changed; returns what ends it."""
        self._watchers.append(watcher)
        return lambda: self._watchers.remove(watcher)

    def look_on(self, onlooker: Callable[[], None]) -> Callable[[], None]:
        """Be told, from any thread and often, that a thought has grown; returns what ends it."""
        self._onlookers.append(onlooker)
        return lambda: self._onlookers.remove(onlooker)

    def attend(self, language: str) -> Callable[[], None]:
        """Somebody is there from now on; returns what ends it. Nothing is thought about for
        nobody."""
        with self._state:
            self._present += 1

        def leave() -> None:
            with self._state:
                self._present -= 1
                alone = self._present == 0
            if alone:
                self.cancel(language)
                self._changed()

        self._changed()
        return leave

    @property
    def attended(self) -> bool:
        """Whether somebody is there."""
        return self._present > 0

    # --- understand

    def say(self, words: str, language: str, who: str, harmless: bool = False) -> None:
        """Take what somebody typed. `harmless`: what only looks or tells needs no
        question."""
        words, language = self._spoken_in(words, language)
        if asks_to_go_on(words, language) and self._goes_on(language):
            return
        thought = self._begin(Thought(words, self._grown), language)
        with self._words:
            try:
                translation = self._understood(thought, language)
            except UserError as error:
                self._tell(Line("robot", str(error), "trouble"))
                return
            if translation is None:
                self._drop(thought, language)
                return
            if translation.program != STOP:
                translation = self._offering(words, translation, language)
                with self._turn:
                    self._take(translation, None, language, who, harmless)
                return
        self._stop(language, who)

    def _spoken_in(self, words: str, page: str) -> tuple[str, str]:
        """What is to be understood, and in which language: the page's, or the one that was offered
        on it and accepted. What was said before such an offer is answered comes first."""
        self._tell(Line("you", words))
        offered, self._offered = self._offered, None
        if offered is not None and declined(words, offered[0], page):
            code, words = offered
            self._declined.add(code)
        elif offered is not None and accepted(words, offered[0], page):
            code, words = offered
            self._language = (page, code)
            if self._backstage.runner.present.state.run is None:
                with suppress(RobotError):  # one without a voice for it is written to in it
                    self._backstage.driver.call("set_language", {"code": code}, StopFlag())
        if self._language is not None and self._language[0] == page:
            return words, self._language[1]
        if self._declined and language_of(words, page) in self._declined:
            self._backstage.talks.of(self.name).refused = words  # meant as it stands
        return words, page

    def _offering(self, words: str, translation: Translation, language: str) -> Translation:
        """What was not understood may be in another language: then that one is offered."""
        code = language_of(words, language) if translation.status == "rejected" else None
        if code is None or code in self._declined:
            return translation
        self._offered = (code, words)
        yes = words_in(code)["accept"]
        return msgspec.structs.replace(
            translation, status="clarify", message=question(code, language), suggestions=(yes,)
        )

    def _understood(self, thought: Thought, language: str) -> Translation | None:
        """What was made of a sentence; None if it was dropped, and then it is as if nobody had
        said it."""
        talk, runner = self._backstage.talks.of(self.name), self._backstage.runner
        mine = talk.copy()
        try:
            made = translate(
                thought.words,
                runner.knowledge,
                language,
                "auto",
                mine,
                runner,
                thought.watch,
                runner.think,
                self._backstage.schedule,
            )
        except Interrupted:
            return None
        finally:
            wanted = self._end(thought)
        if thought.deep and not wanted:  # cancelled when all was written
            return None
        talk.adopt(mine)
        return made

    def hear(
        self,
        words: str,
        translation: Translation,
        language: str,
        who: str,
        harmless: bool = False,
    ) -> None:
        """Take what the microphone heard, which was translated in this conversation."""
        thought = self.thought
        if thought is not None and thought.heard is not None and thought.words == words:
            self._end(thought)
        else:
            self.cancel(language)
            self._tell(Line("you", words))
        if translation.program == STOP:
            self._stop(language, who)
            return
        with self._turn:
            self._take(translation, words, language, who, harmless)

    def ponder(self, microphone: int, words: str, program: str, language: str) -> None:
        """A microphone has heard this, and it is thought about where it was heard, so far with
        this program. `hear` tells what came of it; `give_up` that nothing will."""
        if self.dropped is not None and self.dropped.heard == microphone:
            return  # told late
        thought = self.thought
        if thought is None or thought.heard != microphone:
            thought = self._begin(Thought(words, self._grown, microphone), language)
            self._tell(Line("you", words))
        thought.write(program)

    def give_up(self, language: str) -> None:
        """Nothing comes of what a microphone has heard."""
        thought = self.thought
        if thought is not None and thought.heard is not None:
            self.cancel(language)

    # --- think

    def cancel(self, language: str) -> None:
        """Drop the sentence that is thought about, if there is one."""
        with self._state:
            thought, self.thought = self.thought, None
        if thought is None:
            return
        thought.cancel()
        if thought.deep:
            self._drop(thought, language)

    def _begin(self, thought: Thought, language: str) -> Thought:
        """Who says something new has done with what they said before."""
        self.cancel(language)
        with self._state:
            self.thought = thought
        return thought

    def _end(self, thought: Thought) -> bool:
        """It is no longer thought about. Whether anybody still wants to know what came of it."""
        with self._state:
            wanted = self.thought is thought
            if wanted:
                self.thought = None
        self._grown()
        return wanted

    def _drop(self, thought: Thought, language: str) -> None:
        with self._state:
            told, thought.told_dropped = thought.told_dropped, True
        if not told:
            self.dropped = thought
            self._tell(Line("robot", _said("thought_dropped", language)))

    def _grown(self) -> None:
        for onlooker in tuple(self._onlookers):
            onlooker()

    def _take(
        self, translation: Translation, heard: str | None, language: str, who: str, harmless: bool
    ) -> None:
        request = translation.request
        if translation.program is not None:
            self._tell(Line("robot", translation.explanation))
            self._review(Draft(translation.program, translation, heard), language)
            self._let_through(language, who, harmless)
        elif translation.schedule is not None:
            times = translation.schedule
            self._tell(
                Line("robot", f"{times.when[:1].upper()}{times.when[1:]}: {times.explanation}")
            )
            self._review(Draft(times.program, times.translation, heard, times=times), language)
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

    def _stop(self, language: str, who: str) -> None:
        """Nobody need approve that the robot stands still. Whoever says it again is not kept
        waiting until the robot has confirmed the first."""
        self.draft = None
        self._changed()
        try:
            named = who != texts("frame", language)["somebody"]
            self._backstage.stop(
                f"{who} told the robot to stop." if named else "The robot was told to stop."
            )
        except RobotError as error:
            lexicon = self._backstage.runner.knowledge.lexicon(language)
            why = told(type(error).__name__, str(error), language, lexicon)
            self._tell(Line("robot", why, "trouble"))
        else:
            self._tell(Line("robot", _said("stopped", language), "done"))

    def topics(self, language: str) -> dict[str, list[str]]:
        """What can be said here, by topic."""
        return samples(self._backstage.runner.knowledge.lexicon(language), language)

    # --- review

    def propose(
        self,
        program: str,
        language: str,
        who: str = "",
        at_once: bool = False,
        said: str | None = None,
        note: str = "",
    ) -> None:
        """Lay a program before the operator that came from elsewhere: the map, a run to be done
        again. `at_once`: they chose not to be asked if there is nothing against it. `said` puts
        what they did into words, `note` is what the robot has to say to that."""
        with self._turn:
            if said:
                self._tell(Line("you", said))
            if note:
                self._tell(Line("robot", note))
            self._review(Draft(program, said=said), language)
            draft = self.draft
            if at_once and draft and draft.review and draft.may_run and not draft.review.risks:
                self.approve(draft.program, who, language, draft.review.sha256)

    def _goes_on(self, language: str) -> bool:
        """Go on with what is paused, or propose what is left of the last run; whether there is
        any of it."""
        runner = self._backstage.runner
        if runner.present.state.state in HELD:
            with suppress(NotPossible):  # it was over in that very moment
                runner.resume()
            return True
        if runner.unfinished() is None:
            return False
        self.go_on(None, language)
        return True

    def go_on(self, run: int | None, language: str) -> None:
        """Lay what is left of a run that was broken off before the operator, the last one if none
        is named."""
        runner = self._backstage.runner
        rest = runner.unfinished(run)
        if rest is None:
            self._tell(Line("robot", going_on_texts(language)["nothing_left"]))
            return
        self._tell(Line("robot", " ".join(runner.told_of(rest, language))))
        with self._turn:
            self._review(Draft(rest.program, continues=rest.run), language)

    def perform_routine(self, name: str, said_in: str, language: str) -> None:
        """Lay a routine before the operator, as if they had said its name in its language."""
        self.cancel(language)
        self._tell(Line("you", name))
        runner = self._backstage.runner
        knowledge = runner.knowledge
        try:
            translation = translate(name, knowledge, said_in, "grammar", do=runner.think)
        except UserError as error:
            self._tell(Line("robot", str(error), "trouble"))
            return
        if translation.plan is not None and said_in != language:
            plan = from_data(translation.plan)
            told_here = told_in_words(plan, knowledge.lexicon(language), language)
            translation = msgspec.structs.replace(translation, explanation=told_here)
        with self._turn:
            self._take(translation, None, language, "", harmless=False)

    def take_up(self, number: int, language: str) -> None:
        """Lay a program before the operator that an assistant proposes."""
        try:
            proposal = self._backstage.proposals.one(number)
        except UserError as error:
            self._tell(Line("robot", str(error), "trouble"))
            return
        self._tell(Line("robot", proposed_in_words(proposal, language)))
        if proposal.state != "waiting":
            self._tell(Line("robot", _said("proposal_over", language)))
            return
        with self._turn:
            self._review(Draft(proposal.program, proposal=number), language)

    def touch(self, program: str, who: str) -> None:
        """Somebody is changing the program: from now on there is nothing that could be approved."""
        draft = self.draft
        if draft is not None:
            self.draft = _changed_by_hand(draft, program, who)
            self._changed()

    def edit(self, program: str, language: str, who: str) -> None:
        """Review the program as somebody has changed it."""
        with self._turn:
            draft = self.draft
            if draft is None:
                return
            if draft.continues is not None:
                self._tell(Line("robot", going_on_texts(language)["changed"]))
            changed = replace(_changed_by_hand(draft, program, who), continues=None)
            self._review(changed, language)

    def review(self, language: str) -> None:
        """Review the program that waits, where that was never finished."""
        with self._turn:
            draft = self.draft
            if draft is not None and draft.review is None:
                self._review(draft, language)

    def _review(self, draft: Draft, language: str) -> None:
        self.draft = draft
        self._changed()
        schedule = self._backstage.schedule
        now = schedule.clock() if schedule is not None else time.time()
        at = next_begin(draft.times.rhythm, now) if draft.times is not None else None
        review = self._backstage.runner.check(draft.program, language, draft.continues, at)
        if self.draft is draft:
            self.draft = replace(draft, review=review)
        self._changed()

    # --- decide

    def _let_through(self, language: str, who: str, harmless: bool) -> None:
        draft = self.draft
        if harmless and draft and draft.review:
            made = None if draft.edited else draft.translation
            if draft.may_run and needs_no_question(draft.review, made):
                by = approver(who, language)
                self.approve(draft.program, by, language, draft.review.sha256)

    def approve(
        self, program: str, who: str, language: str, shown: str, insists: bool = False
    ) -> None:
        """Approve exactly this program and start it. `shown`: the digest of the program whose
        review they saw. `insists`: though it did not come to its end when it was tried."""
        with self._turn:
            draft, runner = self.draft, self._backstage.runner
            if draft is None:
                return
            review = draft.review
            if (
                review is None
                or not draft.may_run
                or not (digest(program) == review.sha256 == shown)
            ):
                self._tell(Line("robot", _said("changed_meanwhile", language), "trouble"))
                return
            if not (review.came_through or insists):
                self._tell(Line("robot", _said("must_insist", language), "trouble"))
                return
            try:
                self.runs.add(self._begun(draft, program, who, language, insists))
            except AccessDenied as error:
                if insists:
                    self._tell(Line("robot", str(error), "trouble"))
                    return
                # The world has changed since, and with it what comes of the program.
                self._review(replace(draft, review=None), language)
                now = self.draft.review if self.draft else None
                open_end = now is not None and not now.came_through
                why = _said("must_insist", language) if open_end else str(error)
                self._tell(Line("robot", why, "trouble"))
                return
            except (RobotError, UserError) as error:
                busy = runner.present.state.run is not None
                why = _said("busy", language) if busy else str(error)
                self._tell(Line("robot", why, "trouble"))
                return
            self.draft = None
            self._changed()

    def _begun(self, draft: Draft, program: str, who: str, language: str, insists: bool) -> int:
        """Approve a program that was reviewed, and start it; returns the run's number."""
        runner = self._backstage.runner
        if draft.proposal is not None:
            decided = self._backstage.proposals.approve(
                draft.proposal, digest(program), who, program=program, insists=insists
            )
            assert decided.run is not None
            return decided.run
        translation = draft.translation
        plan = None if draft.edited or translation is None else translation.plan
        approval = runner.approve(
            program,
            digest(program),
            who,
            utterance=translation.utterance if translation else draft.said,
            heard=draft.heard,
            language=language,
            plan=msgspec.json.encode(plan).decode() if plan is not None else None,
            continues=draft.continues,
            proposed=draft.proposed,
            changed_by=draft.changed_by,
            insists=insists,
        )
        return runner.run(approval.id)

    def reject(self, language: str, who: str = "", reason: str = "") -> None:
        """Nothing of it is done. `reason`: for whoever proposed it."""
        with self._turn:
            if self.draft is not None:
                if self.draft.proposal is not None:
                    with suppress(UserError):  # somebody else was faster
                        proposals = self._backstage.proposals
                        why = " ".join(reason.split())[:MAX_TEXT]
                        proposals.decline(self.draft.proposal, who, why or None)
                self.draft = None
                self._tell(Line("robot", _said("rejected", language)))

    def planned(self, appointment: int, when: str, language: str) -> None:
        """What lay here was approved for set times, and is an appointment now."""
        with self._turn:
            self.draft = None
            text = _said("planned", language).format(when=when)
            self._tell(Line("robot", text, "done", planned=appointment))

    # --- watch

    def ended(self, run: int, state: str, message: str | None, language: str) -> None:
        """A run is over; told if it was started here."""
        if run in self.runs:
            self.runs.discard(run)
            status = self._backstage.runner.state()
            error = status.error if status and status.run == run else None
            lexicon = self._backstage.runner.knowledge.lexicon(language)
            plain = state == "stopped" and message == Stopped().because  # that says no more
            why = told(error, message, language, lexicon) if message and not plain else None
            end = " ".join(filter(None, (_said(f"ended_{state}", language), why)))
            runner = self._backstage.runner
            came = [each.text for each in answer(runner.log, runner.knowledge, run, language)]
            text = "\n".join([*came, end] if state != "done" or not came else came)
            self._tell(Line("robot", text, "done" if state == "done" else "trouble", run=run))

    def _tell(self, line: Line) -> None:
        with self._state:  # what is said while another thing is thought about
            self.lines = [*self.lines, line][-LINES_KEPT:]
        self._changed()

    def _changed(self) -> None:
        for watcher in tuple(self._watchers):
            watcher()


def _changed_by_hand(draft: Draft, program: str, who: str) -> Draft:
    """It needs a new review; the program that was proposed is not forgotten."""
    proposed = draft.program if draft.proposed is None else draft.proposed
    return replace(draft, program=program, review=None, proposed=proposed, changed_by=who)


def _said(key: str, language: str) -> str:
    return texts("desk", language)[key]


def proposed_in_words(proposal: Proposal, language: str) -> str:
    """Who proposes it and what for, as they say: marked as theirs."""
    told = _said("proposed", language).format(by=proposal.by, sentence=proposal.sentence)
    if proposal.why:
        told += "\n" + _said("proposed_why", language).format(why=proposal.why)
    return told
