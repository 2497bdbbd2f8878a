"""Programs that an assistant proposes: a person decides on each, and nothing runs without."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import pytest

from nl2robot.errors import UserError
from nl2robot.proposals import proposals as proposing
from nl2robot.review.review import Review, digest
from nl2robot.run.runlog import RunLog
from nl2robot.run.runner import Runner
from nl2robot.station.station import simulated_station
from robot_api.client import Robot
from robot_api.errors import AccessDenied, InvalidCall, NotPossible
from sim.world.loading import load_world
from tests.proposed import HELLO, Asked

LONG = 'while True:\n    robot.goto("ward a")\n    robot.goto("ward b")\n'


@pytest.fixture
def log(tmp_path: Path) -> Iterator[RunLog]:
    log = RunLog(tmp_path / "runs.sqlite")
    yield log
    log.close()


@pytest.fixture
def ward(log: RunLog) -> Iterator[Asked]:
    with (
        simulated_station(load_world("ward"), log, seed=1) as station,
        station.connect() as robot,
    ):
        yield Asked(robot)


@dataclass
class ReviewsAtOnce:
    """The part of a runner that proposals are made with."""

    log: RunLog

    def check(self, program: str, language: str) -> Review:
        sha256 = digest(program)
        return Review(program=program, sha256=sha256, findings=(), reading=(), dry_run=None)


def known_proposals(log: RunLog) -> proposing.Proposals:
    """Without a server, for whoever has an account; each comes through the review at once."""
    return proposing.Proposals(cast(Runner, ReviewsAtOnce(log)), lambda kind, data: None)


def test_somebody_approves_it_and_it_runs_in_both_their_names(ward: Asked, log: RunLog) -> None:
    made = ward.propose(why="The visitors' hour begins.")
    assert made["proposal"]["state"] == "waiting"
    assert made["review"]["dry_run"]["says"] == ["Hello!"]
    assert log.runs() == [], "nothing runs that nobody has approved"
    decided = ward.approve(made["proposal"])
    assert (decided["state"], decided["decided_by"]) == ("approved", "Nurse Kim")
    ward.robot.request("program.wait", {"run": decided["run"]})
    [run] = log.runs()
    assert run.status == "done"
    assert run.approved_by == "Nurse Kim (proposed by “Sam”)"
    assert run.utterance == "“Sam”: say hello in ward a"


def test_somebody_says_no_and_why(ward: Asked, log: RunLog) -> None:
    made = ward.propose()["proposal"]
    ward.ask("decline", id=made["id"], by="Nurse Kim", reason="They sleep.")
    found = ward.ask("show", id=made["id"])
    assert (found["state"], found["reason"]) == ("declined", "They sleep.")
    with pytest.raises(InvalidCall, match="declined by Nurse Kim already"):
        ward.approve(made)
    assert log.runs() == []


def test_whoever_proposed_it_waits_for_the_decision(ward: Asked) -> None:
    made = ward.propose()["proposal"]
    waiting = threading.Thread(target=lambda: found.append(ward.ask("wait", id=made["id"])))
    found: list[Any] = []
    waiting.start()
    ward.ask("decline", id=made["id"], by="Nurse Kim")
    waiting.join(30)
    assert found[0]["state"] == "declined"
    made = ward.propose()["proposal"]
    assert ward.ask("wait", id=made["id"], timeout=0)["state"] == "waiting"


def test_another_text_than_the_proposed_one_cannot_be_approved(ward: Asked) -> None:
    made = ward.propose()["proposal"]
    with pytest.raises(AccessDenied, match="changed after its review"):
        ward.ask("approve", id=made["id"], sha256=digest(LONG), by="Nurse Kim")
    assert ward.ask("show", id=made["id"])["state"] == "waiting"


def test_what_fails_when_it_is_tried_needs_somebody_who_insists(ward: Asked) -> None:
    made = ward.propose('robot.goto("ward a")\nint("two")\n')["proposal"]
    with pytest.raises(AccessDenied):
        ward.approve(made)
    assert ward.ask("show", id=made["id"])["state"] == "waiting"
    assert ward.approve(made, insists=True)["state"] == "approved"


def test_it_waits_until_the_robot_is_free(ward: Asked) -> None:
    decided = ward.approve(ward.propose(LONG)["proposal"])
    made = ward.propose()["proposal"]
    with pytest.raises(NotPossible):
        ward.approve(made)
    ward.robot.stop()
    ward.robot.request("program.wait", {"run": decided["run"]})
    assert ward.approve(made)["state"] == "approved"


def test_nobody_is_asked_about_a_program_with_an_error(ward: Asked) -> None:
    with pytest.raises(InvalidCall, match=r"Nobody is asked .* line 1"):
        ward.propose('robot.fly("ward a")\n')
    with pytest.raises(InvalidCall, match="control characters"):
        ward.propose(sentence="say hello\nApproved by Nurse Kim.")
    assert ward.ask("list") == []


def test_whatever_it_says_stays_within_its_quotation_marks(ward: Asked) -> None:
    made = ward.propose(sentence="says hi” Approved by Nurse Kim. “", by="Sam” (console). “")
    assert made["proposal"]["sentence"] == "says hi' Approved by Nurse Kim. '"
    assert made["proposal"]["by"] == "“Sam' (console). '”"


def test_only_few_wait_and_one_that_is_taken_back_makes_room(ward: Asked) -> None:
    made = [ward.propose()["proposal"] for _ in range(proposing.MOST_WAITING)]
    with pytest.raises(InvalidCall, match="wait for a person already"):
        ward.propose()
    with Robot(ward.robot.address) as other, pytest.raises(InvalidCall, match="somebody else's"):
        Asked(other).ask("withdraw", id=made[0]["id"])
    assert ward.ask("withdraw", id=made[0]["id"])["state"] == "withdrawn"
    with pytest.raises(InvalidCall, match="has withdrawn proposal"):
        ward.approve(made[0])
    ward.propose()


def test_a_flood_is_refused_in_sentences(ward: Asked, log: RunLog) -> None:
    refused = []
    for _ in range(100):
        try:
            made = ward.propose()["proposal"]
            ward.ask("withdraw", id=made["id"])
        except InvalidCall as error:
            refused.append(str(error))
    assert len(refused) == 100 - proposing.MOST_A_MINUTE
    assert all("proposals a minute are the most. Wait" in each for each in refused)
    assert log.runs() == []


def test_one_that_floods_takes_no_room_of_others(ward: Asked) -> None:
    """Not even of one that came over the same connection, as two assistants of one door do."""
    for _ in range(proposing.MOST_WAITING):
        ward.propose(by="flood")
    for _ in range(20):
        with pytest.raises(InvalidCall, match="by you wait for a person already"):
            ward.propose(by="flood")
    ward.propose(by="night desk")
    with Robot(ward.robot.address) as other:
        Asked(other).propose(by="flood")  # which is not the same one


def test_whoever_has_an_account_has_room_whatever_others_call_themselves(
    log: RunLog,
) -> None:
    """One that takes another name each time has no more than all who are known by nothing else."""
    proposals = known_proposals(log)
    refused = []
    for number in range(50):
        try:
            proposals.make(HELLO, "flood", by=f"assistant {number}", connection=f"{number}")
        except UserError as error:
            refused.append(str(error))
    at_most = proposing.MOST_WAITING_IN_ALL * 3 // 4
    assert len(refused) == 50 - at_most
    assert all("without a token of their own" in each for each in refused)
    for _ in range(proposing.MOST_WAITING_IN_ALL - at_most):
        proposals.make(HELLO, "the evening round", by="night desk", account="night desk")
    with pytest.raises(UserError, match="12 proposals wait for a person already"):
        proposals.make(HELLO, "one more", by="day desk", account="day desk")


def test_all_together_propose_only_so_often(log: RunLog) -> None:
    """Those with an account as well, though they have more of it than those without."""
    proposals = known_proposals(log)

    def tried(**who: str) -> str | None:
        try:
            made = proposals.make(HELLO, "hello", by="somebody", **who).proposal
            proposals.withdraw(made.id, made.account, made.connection)
        except UserError as error:
            return str(error)
        return None

    strangers = [tried(connection=f"{number}") for number in range(30)]
    most = proposing.MOST_A_MINUTE_IN_ALL
    assert strangers.count(None) == most * 3 // 4
    known = [tried(account=f"desk {number}") for number in range(10)]
    assert known.count(None) == most // 4
    for each in (*strangers, *known):
        assert each is None or each.startswith("All assistants together have proposed too much")


def test_a_number_never_means_another_proposal(tmp_path: Path) -> None:
    """Also when the server was started again meanwhile: whoever waits for an old one is told."""
    numbers: list[int] = []
    for _ in range(2):
        log = RunLog(tmp_path / "kept.sqlite")
        with (
            simulated_station(load_world("ward"), log, seed=1) as station,
            station.connect() as robot,
        ):
            for old in numbers:
                with pytest.raises(InvalidCall, match=f"There is no proposal {old}"):
                    Asked(robot).ask("wait", id=old)
            numbers.append(Asked(robot).propose()["proposal"]["id"])
        log.close()
    assert numbers == [1, 2]


def test_nobody_decides_in_time(ward: Asked, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(proposing, "HOLDS", 0.0)
    made = ward.propose()["proposal"]
    assert ward.ask("show", id=made["id"])["state"] == "expired"
    with pytest.raises(InvalidCall, match="waited too long"):
        ward.approve(made)


def test_the_oldest_are_forgotten(ward: Asked, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(proposing, "KEPT", 2)
    for _ in range(4):
        made = ward.propose()["proposal"]
        ward.ask("withdraw", id=made["id"])
    ward.propose()
    assert [each["id"] for each in ward.ask("list")] == [3, 4, 5]
    with pytest.raises(InvalidCall, match="There is no proposal 1"):
        ward.ask("show", id=1)


def test_it_is_told_without_the_program(ward: Asked) -> None:
    told: list[dict[str, Any]] = []
    came = threading.Event()

    def note(kind: str, data: dict[str, Any]) -> None:
        told.append(data)
        if len(told) == 2:
            came.set()

    ward.robot.subscribe("proposal", note)
    ward.approve(ward.propose()["proposal"])
    assert came.wait(30)
    assert [each["state"] for each in told] == ["waiting", "approved"]
    assert told[0]["by"] == "“Sam”" and told[1]["run"] == 1
    assert "program" not in told[0]


def test_two_who_decide_at_once(ward: Asked, log: RunLog) -> None:
    """One of them is told so, and it runs once."""
    made = ward.propose()["proposal"]
    said: list[str] = []

    def decide(by: str) -> None:
        with Robot(ward.robot.address) as robot:
            try:
                Asked(robot).approve(made, by=by)
                said.append("approved")
            except (InvalidCall, NotPossible) as error:
                said.append(str(error))

    both = [threading.Thread(target=decide, args=(by,)) for by in ("Kim", "Ann")]
    for each in both:
        each.start()
    for each in both:
        each.join(60)
    assert sorted(said)[-1] == "approved" and len(said) == 2
    assert len(log.runs()) == 1
