"""One state of the robot and its program, from whatever happens in whatever order."""

import pytest
from hypothesis import settings
from hypothesis import strategies as some
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule

from nl2robot.run.present import Present
from nl2robot.run.state import (
    FOLLOWS,
    AtLine,
    Began,
    Charging,
    EndAsked,
    Ended,
    Found,
    Halted,
    Lost,
    Moving,
    PauseAsked,
    Resumed,
    Reviewing,
    State,
    StopAsked,
    StopConfirmed,
    StopNotConfirmed,
    after,
    may_begin,
    on_wire,
)


def story(*happenings) -> list[str]:
    """The states that these lead through."""
    state, states = State(sequence=1), []
    for happening in happenings:
        state = after(state, happening, state.since + 1)
        states.append(state.state)
    return states


STOP, STANDS = StopAsked("The robot was stopped."), StopConfirmed("The robot was stopped.")

STUCK = ["stopping", "lost", "stopping"]


@pytest.mark.parametrize(
    ("happenings", "states"),
    [
        (
            [Reviewing("desk", True), Began(1), Reviewing("desk", False), Ended(1, "done")],
            ["reviewing", "running", "running", "idle"],
        ),
        (
            [Began(1), PauseAsked(), Halted(), Resumed(), Ended(1, "done")],
            ["running", "pausing", "paused", "running", "idle"],
        ),
        ([Began(1), STOP, STANDS, Ended(1, "stopped")], ["running", *["stopping"] * 2, "stopped"]),
        ([Began(1), STOP, Ended(1, "stopped"), STANDS], ["running", *["stopping"] * 2, "stopped"]),
        ([Began(1), EndAsked("Enough."), STOP], ["running", "stopping", "stopping"]),
        ([Began(1), STOP, STANDS, Ended(1, "failed")], ["running", *["stopping"] * 2, "idle"]),
        ([STOP, STOP, STANDS, STANDS], ["stopping"] * 3 + ["stopped"]),
        ([STOP, StopNotConfirmed("?"), Began(1), STOP, STANDS], ["stopping"] * 4 + ["stopped"]),
        ([STOP, STANDS, Moving()], ["stopping", "stopped", "idle"]),
        ([STOP, STANDS, Reviewing("desk", True)], ["stopping", "stopped", "reviewing"]),
        ([Began(1), Lost(0, "Gone."), Found()], ["running", "lost", "stopping"]),
        # Of a stop that was on its way when the robot was lost nobody may ever hear again.
        ([STOP, Lost(0, "Gone."), Found(), STOP, STANDS], [*STUCK, "stopping", "stopped"]),
        ([Lost(0, "Gone."), Began(1), STOP], ["lost", "lost", "stopping"]),
        ([Charging(True), Began(1), Ended(1, "done")], ["charging", "running", "charging"]),
        ([Halted(), Resumed(), PauseAsked()], ["idle"] * 3),
        ([Began(1), Began(2), Ended(2, "done")], ["running"] * 3),
    ],
)
def test_a_day_at_the_ward(happenings, states) -> None:
    assert story(*happenings) == states


def test_the_table_of_the_docs_is_the_one_of_the_program() -> None:
    from nl2robot.run import state

    rows = [line.split("|")[1:-1] for line in state.__doc__.splitlines() if line.startswith("|")]
    told, name = {}, ""
    for first, _, follow in rows[2:]:
        name = first.strip() or name
        told[name] = f"{told.get(name, '')} {follow.strip()}".strip()
    for name, words in told.items():
        excepted = {word.strip() for word in words.removeprefix("all but ").split(",")}
        assert set(FOLLOWS) - excepted - {name} == FOLLOWS[name] - {name}, name


HAPPENINGS = some.one_of(
    some.builds(Reviewing, some.sampled_from(["desk", "terminal"]), some.booleans()),
    some.builds(Began, some.integers(1, 3)),
    some.builds(AtLine, some.integers(1, 9)),
    some.builds(
        Ended, some.integers(1, 3), some.sampled_from(["done", "failed", "stopped", "limit"])
    ),
    some.sampled_from(
        [
            *(PauseAsked(), Halted(), Resumed(), EndAsked("Enough."), STOP, STANDS, Moving()),
            *(StopNotConfirmed("It may still move."), Lost(7.0, "Gone."), Found()),
            *(Charging(True), Charging(False)),
        ]
    ),
)


class Anything(RuleBasedStateMachine):
    """Whatever happens."""

    def __init__(self) -> None:
        super().__init__()
        self.state = State(sequence=1)
        self.confirmed = False
        """Whether the robot has said that it stands since something last put that in doubt."""

    @rule(happening=HAPPENINGS)
    def happens(self, happening) -> None:
        before, self.state = self.state, after(self.state, happening, self.state.since + 1)
        now = self.state
        assert now.state == before.state or now.state in FOLLOWS[before.state]
        assert (now.sequence > before.sequence) == (on_wire(now) != on_wire(before))
        assert now.sequence >= before.sequence
        match happening:
            case StopAsked():
                assert now.state == "stopping"
            case StopNotConfirmed():
                assert now.state in ("stopping", "lost")
            case Began() if now.run != before.run:
                assert may_begin(before)
                self.confirmed = False
        match happening:
            case StopConfirmed():
                self.confirmed = True
            case StopAsked() | StopNotConfirmed() | Lost():
                self.confirmed = False

    @precondition(lambda self: self.state.state == "stopped")
    @rule()
    def stands(self) -> None:
        assert self.confirmed

    @invariant()
    def no_program_runs_while_it_is_stopped_or_lost(self) -> None:
        if self.state.state in ("stopped", "idle", "reviewing", "charging"):
            assert self.state.run is None
            assert self.state.lost_since is None
            assert not self.state.unconfirmed
        if self.state.state in ("running", "pausing", "paused"):
            assert self.state.run is not None
        if self.state.state == "stopped":
            assert self.confirmed


TestAnything = Anything.TestCase
TestAnything.settings = settings(max_examples=300, stateful_step_count=40, deadline=None)


def test_who_is_told_is_told_in_order_and_of_news_only() -> None:
    told: list[State] = []
    present = Present(told.append, now=lambda: 100.0)
    present.begin()
    present.happened(Began(1))
    present.happened(Began(1))
    present.on_event("stopping", {"because": "The robot was stopped."})
    present.on_event("pose", {"speed": 0.5})
    assert [each.state for each in told] == ["idle", "running", "stopping"]
    assert [each.sequence for each in told] == [100_000, 100_001, 100_002]
    assert present.on_wire()["because"] == "The robot was stopped."
