"""The operator's side of the wire: translate, check, approve, run and watch programs."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Mapping
from datetime import datetime
from typing import Any, TypeVar

import msgspec

from nl2robot.proposals.proposals import Proposal
from nl2robot.review.review import Review
from nl2robot.run.answers import Sentence
from nl2robot.run.runs import Approval, Status
from nl2robot.run.state import GOING
from nl2robot.schedule.appointments import Appointment
from nl2robot.schedule.rhythm import Rhythm
from nl2robot.schedule.schedule import Listed
from nl2robot.schedule.triggers import Trigger
from nl2robot.schedule.wire import Happens
from nl2robot.translate.outcome import Translation
from nl2robot.translate.thinking import EVENT, OnProgress, Progress
from robot_api.client import Robot
from robot_api.errors import InvalidCall, RobotError, Stopped

T = TypeVar("T")


class Wish(msgspec.Struct, frozen=True, kw_only=True):
    """What is to be done at set times or at an event, besides its program."""

    rhythm: Rhythm | None = None
    trigger: Trigger | None = None
    when: str
    """In words."""
    sentence: str
    plan: dict[str, Any] | None = None
    more: dict[str, Any] = {}
    """Further parameters of `schedule.add`: until, priority, makes_up."""


class Left(msgspec.Struct, frozen=True):
    """What is left of a run that was broken off."""

    run: int
    program: str
    utterance: str | None
    told: list[str]
    """What is done and what is left, in sentences."""


def _continuing(run: int | None) -> dict[str, int]:
    return {} if run is None else {"continues": run}  # which older servers do not know


# Learned before there are threads, see `robot_api.schema`.
msgspec.json.Decoder(
    tuple[
        Translation,
        Review,
        Approval,
        Status,
        Sentence,
        Left,
        Appointment,
        Listed,
        Proposal,
        Happens,
    ]
)


class Operator:
    """Somebody who has programs reviewed and run, over a client's connection."""

    def __init__(self, robot: Robot, name: str) -> None:
        self.robot = robot
        self.name = name
        # Who is told how far a language model is, by conversation and sentence.
        self._waiting: dict[tuple[str | None, str], OnProgress] = {}
        self._is_told = False

    def translate(
        self,
        utterance: str,
        language: str = "en",
        planner: str = "auto",
        talk: str | None = None,
        on_progress: OnProgress | None = None,
    ) -> Translation:
        """`talk` names a conversation: "no, the pharmacy" refers to what was said in it. A language
        model may take seconds: `on_progress` is told, from another thread, and Ctrl-C or `give_up`
        ends it. Raises `Stopped` then, and where somebody stops the robot meanwhile."""
        parameters = {
            "utterance": utterance,
            "language": language,
            "planner": planner,
            "talk": talk,
        }
        if on_progress is None:
            return self._request("program.translate", parameters, Translation)
        self._have_me_told()
        self._waiting[talk, utterance] = on_progress
        try:
            return self._request("program.translate", parameters, Translation)
        finally:
            self._waiting.pop((talk, utterance), None)

    def give_up(self) -> None:
        """Wait no longer for what was asked of the server. From any thread; returns at once."""
        self.robot.cancel()

    def _have_me_told(self) -> None:
        """Of what language models are at, from now on."""
        if not self._is_told:
            with contextlib.suppress(InvalidCall):  # a server that has none to tell of
                self.robot.subscribe(EVENT, self._tell)
            self._is_told = True

    def _tell(self, kind: str, data: Mapping[str, Any]) -> None:
        waiting = self._waiting.get((data.get("talk"), data.get("utterance", "")))
        if waiting is not None:
            waiting(Progress(data["what"], data.get("text", "")))

    def phrases(self, language: str = "en") -> dict[str, list[str]]:
        """What can be said here: sentences by topic."""
        return self._request("program.phrases", {"language": language}, dict[str, list[str]])

    def check(
        self,
        program: str,
        language: str = "en",
        continues: int | None = None,
        at: datetime | None = None,
    ) -> Review:
        """Review a program, or what is left of it after a run, as if it began now or `at` some
        time; nothing moves."""
        parameters: dict[str, Any] = {"program": program, "language": language}
        parameters |= _continuing(continues)
        if at is not None:
            parameters["at"] = at.isoformat()
        return self._request("program.check", parameters, Review)

    def unfinished(self, language: str = "en") -> Left | None:
        """What is left of the last run, if it was broken off."""
        try:
            left = self.robot.request("program.unfinished", {"language": language})
        except InvalidCall:  # a server that cannot go on
            return None
        return None if left is None else msgspec.convert(left, Left)

    def pause(self) -> None:
        self.robot.request("program.pause")

    def resume(self) -> None:
        self.robot.request("program.resume")

    def state(self) -> str:
        """How the robot and its program stand, see `nl2robot.run.state`."""
        state: str = self.robot.request("station.state")["state"]
        return state

    def reviewing(self, lies: bool) -> None:
        """Tell that a program lies before somebody here who decides on it, or no longer."""
        with contextlib.suppress(RobotError):  # a server that shows it nobody
            self.robot.request("program.reviewing", {"lies": lies})

    def approve(
        self,
        review: Review,
        translation: Translation | None = None,
        heard: str | None = None,
        continues: int | None = None,
        by: str | None = None,
        proposed: str | None = None,
        insists: bool = False,
        language: str | None = None,
    ) -> Approval:
        """Approve exactly the program that was reviewed; with `continues`, what is left of it.
        `by`: how the log calls whoever does. `proposed`: the program from before, if it was changed
        here by hand. `insists`: somebody wants it run though it did not come to its end when it
        was tried. `language`: theirs, in which the run reports and speaks."""
        parameters: dict[str, Any] = {
            "program": review.program,
            "sha256": review.sha256,
            "by": by or self.name,
            "heard": heard,
            "language": language,
            **_continuing(continues),
        }
        if translation is not None:
            proposed = proposed or translation.program
            parameters["utterance"] = translation.utterance
            if review.program == translation.program:  # edited, it is no longer what was planned
                parameters["plan"] = msgspec.json.encode(translation.plan).decode()
        if proposed is not None and proposed != review.program:
            parameters |= {"proposed": proposed, "changed_by": self.name}
        if insists:
            parameters["insists"] = True
        return self._request("program.approve", parameters, Approval)

    def put_in_book(
        self, review: Review, wish: Wish, language: str = "en", insists: bool = False
    ) -> Listed:
        """Approve exactly the program that was reviewed for set times; returns the appointment."""
        plan = None if wish.plan is None else msgspec.json.encode(wish.plan).decode()
        parameters = {
            "program": review.program,
            "sha256": review.sha256,
            "by": self.name,
            "sentence": wish.sentence,
            "language": language,
            "rhythm": msgspec.to_builtins(wish.rhythm),
            "trigger": msgspec.to_builtins(wish.trigger),
            "plan": plan,
            "insists": insists,
            **{name: value for name, value in wish.more.items() if value is not None},
        }
        number = self._request("schedule.add", parameters, Appointment).id
        return next(each for each in self.appointments(language) if each.appointment.id == number)

    def happens(self, trigger: Trigger, language: str = "en") -> tuple[Trigger, str]:
        """The event as this robot would keep it, and what it is in words. Raises `InvalidCall` for
        one that it would never notice."""
        about = {"trigger": msgspec.to_builtins(trigger), "language": language}
        found = self._request("schedule.event", about, Happens)
        return found.trigger, found.when

    def appointments(self, language: str = "en") -> list[Listed]:
        """Those of this robot."""
        return self._request("schedule.list", {"language": language}, list[Listed])

    def approve_anew(self, kept: Appointment, until: float | None, insists: bool) -> None:
        """Approve an appointment once more, as its program was just reviewed."""
        parameters = {
            "id": kept.id,
            "sha256": kept.sha256,
            "by": self.name,
            "until": until,
            "insists": insists,
        }
        self.robot.request("schedule.approve", parameters)

    def proposals(self) -> list[Proposal]:
        """Programs that assistants have proposed, the newest last."""
        return self._request("proposal.list", {}, list[Proposal])

    def approve_proposal(self, proposal: Proposal, review: Review, insists: bool) -> Proposal:
        """Approve exactly the program that was reviewed, maybe changed by hand, and start it."""
        parameters = {
            "id": proposal.id,
            "sha256": review.sha256,
            "by": self.name,
            "insists": insists,
        }
        if review.program != proposal.program:
            parameters["program"] = review.program
        return self._request("proposal.approve", parameters, Proposal)

    def decline_proposal(self, proposal: Proposal, reason: str | None = None) -> Proposal:
        """Say no to it."""
        parameters = {"id": proposal.id, "by": self.name}
        if reason:
            parameters["reason"] = reason
        return self._request("proposal.decline", parameters, Proposal)

    def run(self, approval: Approval) -> int:
        """Start it; returns the run's number."""
        number: int = self.robot.request("program.run", {"approval": approval.id})
        return number

    def wait(self, run: int) -> Status:
        """Wait until the run is over."""
        while True:
            # A stop of the robot breaks off every call, this one too; the run is about to be over.
            with contextlib.suppress(Stopped):
                status = self._request("program.wait", {"run": run}, Status)
                if status.state not in GOING:
                    return status

    def answer(self, run: int, language: str = "en") -> list[Sentence]:
        """What came of a run, for whoever asked for it; nothing from a server that cannot say."""
        about = {"run": run, "language": language}
        try:
            return self._request("program.answer", about, list[Sentence])
        except InvalidCall:
            return []
        except Stopped:  # as in `wait`
            return self._request("program.answer", about, list[Sentence])

    def stop(self) -> None:
        """Stop the robot and the program."""
        self.robot.stop()

    def watch(self, listener: Callable[[str, Mapping[str, Any]], None], *kinds: str) -> None:
        """Be told of events: `program` and those of `robot_api.driver.EVENTS`."""
        self.robot.subscribe(kinds, listener)

    def _request(self, method: str, parameters: dict[str, Any], kind: type[T]) -> T:
        return msgspec.convert(self.robot.request(method, parameters), kind)
