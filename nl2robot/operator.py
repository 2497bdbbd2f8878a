"""The operator's side of the wire: translate, check, approve, run and watch programs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

import msgspec

from nl2robot.review import Review
from nl2robot.runner import Approval, Status
from nl2robot.translation import Translation
from robot_api.client import Robot
from robot_api.errors import Stopped

T = TypeVar("T")


# Learned before there are threads, see `robot_api.schema`.
msgspec.json.Decoder(tuple[Translation, Review, Approval, Status])


class Operator:
    """Somebody who has programs reviewed and run, over a client's connection."""

    def __init__(self, robot: Robot, name: str) -> None:
        self.robot = robot
        self.name = name

    def translate(
        self, utterance: str, language: str = "en", planner: str = "auto", talk: str | None = None
    ) -> Translation:
        """`talk` names a conversation: "no, the pharmacy" refers to what was said in it."""
        parameters = {
            "utterance": utterance,
            "language": language,
            "planner": planner,
            "talk": talk,
        }
        return self._request("program.translate", parameters, Translation)

    def phrases(self, language: str = "en") -> dict[str, list[str]]:
        """What can be said here: sentences by topic."""
        return self._request("program.phrases", {"language": language}, dict[str, list[str]])

    def check(self, program: str, language: str = "en") -> Review:
        """Review a program; nothing moves."""
        return self._request("program.check", {"program": program, "language": language}, Review)

    def approve(
        self, review: Review, translation: Translation | None = None, heard: str | None = None
    ) -> Approval:
        """Approve exactly the program that was reviewed."""
        parameters: dict[str, Any] = {
            "program": review.program,
            "sha256": review.sha256,
            "by": self.name,
            "heard": heard,
        }
        if translation is not None:
            parameters["utterance"] = translation.utterance
            if review.program == translation.program:  # edited, it is no longer what was planned
                parameters["plan"] = msgspec.json.encode(translation.plan).decode()
        return self._request("program.approve", parameters, Approval)

    def run(self, approval: Approval) -> int:
        """Start it; returns the run's number."""
        number: int = self.robot.request("program.run", {"approval": approval.id})
        return number

    def wait(self, run: int) -> Status:
        """Wait until the run is over."""
        try:
            return self._request("program.wait", {"run": run}, Status)
        except Stopped:
            # A stop of the robot breaks off every call, this one too; the run is about to be over.
            return self._request("program.wait", {"run": run}, Status)

    def stop(self) -> None:
        """Stop the robot and the program."""
        self.robot.stop()

    def watch(self, listener: Callable[[str, Mapping[str, Any]], None], *kinds: str) -> None:
        """Be told of events: `program` and those of `robot_api.driver.EVENTS`."""
        self.robot.subscribe(kinds, listener)

    def _request(self, method: str, parameters: dict[str, Any], kind: type[T]) -> T:
        return msgspec.convert(self.robot.request(method, parameters), kind)
