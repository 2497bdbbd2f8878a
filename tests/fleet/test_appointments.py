"""Appointments that any robot of the fleet may do: once at most, and told where it was not done."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from nl2robot.schedule.outcomes import Outcome
from tests.fleet.conftest import FakeNetwork, begun
from tests.fleet.keeper import Keeper, copied, goes_on, is_busy
from tests.fleet.test_once import happens, steps

ROUND = 'robot.say("Good morning.")\n'
EVERY_FIVE = "FREQ=MINUTELY;INTERVAL=5"
NAMES = ("Ada", "Ben", "Cleo")


def ward() -> tuple[FakeNetwork, list[Keeper]]:
    net = FakeNetwork()
    robots = [Keeper(net, name, x=float(number)) for number, name in enumerate(NAMES)]
    robots[1].drift = 600.0  # his clock is ten minutes ahead
    goes_on(net, 2.0)
    return net, robots


def ends(robot: Keeper, status: str = "done") -> None:
    """All that it does comes to an end."""
    robot.over |= dict.fromkeys(range(1, len(robot.runs) + 1), status)


def test_what_was_approved_at_one_console_is_done_by_the_best_robot_in_time() -> None:
    net, (ada, ben, cleo) = ward()
    is_busy(ada)
    ben.standing = replace(ben.standing, x=9.0)
    ada.plans('robot.goto("pharmacy")\n', after=60.0)
    goes_on(net, 30.0)
    assert list(begun(net)) == []
    assert [each.told for each in ben.knows_of(ada)] == [""]
    goes_on(net, 35.0)
    [run] = ben.runs + cleo.runs
    assert run.by == "Nurse Kim (appointment 1) (fleet, from Ada)"
    for each in (ben, cleo):
        ends(each)
    goes_on(net, 5.0)
    [time] = ada.times
    assert (time.state, time.done_by, time.run) == ("done", "Ben", None)
    assert ada.told() == []
    assert cleo.knows_of(ada) == []  # it was for once, and is over


def test_all_consoles_show_it_and_whose_it_is_and_what_came_of_it() -> None:
    net, (ada, ben, cleo) = ward()
    is_busy(ben)
    is_busy(cleo)
    ada.plans(ROUND, after=60.0, rule=EVERY_FIVE)
    goes_on(net, 5.0)
    [seen] = cleo.knows_of(ada)
    assert seen.when.startswith("every 5 minutes") and seen.unknown is None
    goes_on(net, 60.0)
    ends(ada)
    goes_on(net, 5.0)
    [seen] = ben.knows_of(ada)
    assert seen.told == "done, by Ada"
    ada.schedule.pause(1)
    goes_on(net, 5.0)
    assert [each.plan.paused for each in ben.knows_of(ada)] == [True]
    ada.schedule.remove(1)
    goes_on(net, 5.0)
    assert ben.knows_of(ada) == []


def test_while_its_keeper_is_away_nobody_claims_to_know_whether_it_was_done() -> None:
    net, (ada, ben, cleo) = ward()
    ada.plans(ROUND, after=60.0, rule=EVERY_FIVE)
    goes_on(net, 5.0)
    ada.alive = False
    cleo.starts()  # who was started anew meanwhile knows of it all the same
    goes_on(net, 120.0)
    for each in (ben, cleo):
        [seen] = each.knows_of(ada)
        assert seen.unknown is not None
    assert list(begun(net)) == []  # it is Ada's to hand out, and nobody else's
    ada.starts()
    goes_on(net, 5.0)
    [seen] = cleo.knows_of(ada)
    assert seen.unknown is None and seen.told == "missed: nl2robot was not running"
    assert ada.told() == ["missed"]


def test_what_nobody_could_do_in_time_is_missed_and_told_with_their_reasons() -> None:
    net, (ada, ben, cleo) = ward()
    is_busy(ada)
    ben.refuses = "I have no hands."
    cleo.refuses = "It is not free (busy)."
    ada.plans(ROUND, after=10.0)
    goes_on(net, 140.0)
    [time] = ada.times
    assert (time.state, time.note) == ("missed", "nobody")
    [notice] = ada.schedule.notices()
    assert notice.parts["refused"]["Ben"] == "I have no hands."
    ben.refuses = cleo.refuses = None
    is_busy(ada, False)
    goes_on(net, 60.0)
    assert list(begun(net)) == []  # what was told as missed is not done after all


def test_what_is_paused_or_removed_while_a_robot_is_looked_for_is_not_begun() -> None:
    net, (ada, ben, cleo) = ward()
    for each in (ada, ben, cleo):
        is_busy(each)
    first = ada.plans(ROUND, after=10.0, rule=EVERY_FIVE)
    second = ada.plans(ROUND, after=10.0)
    goes_on(net, 20.0)
    assert [each.state for each in ada.times] == ["claimed", "claimed"]
    ada.schedule.pause(first.id)
    ada.schedule.remove(second.id)
    goes_on(net, 3.0)
    for each in (ada, ben, cleo):
        is_busy(each, False)
    goes_on(net, 60.0)
    assert sorted((each.state, each.note) for each in ada.times) == [
        ("skipped", "paused"),
        ("skipped", "removed"),
    ]
    assert list(begun(net)) == []


def test_a_round_is_not_begun_anew_while_another_robot_still_does_it() -> None:
    net, (ada, ben, cleo) = ward()
    is_busy(ada)
    ada.plans(ROUND, after=10.0, rule=EVERY_FIVE)
    goes_on(net, 340.0)
    assert len(list(begun(net))) == 1
    assert [each.state for each in ada.times] == ["running", "due"]
    assert ada.told() == ["waits"]
    # Of a robot that is gone nobody knows whether it still does it: the round goes on without it.
    [doer] = [each for each in (ben, cleo) if each.runs]
    doer.alive = False
    goes_on(net, 30.0)
    assert len(list(begun(net))) == 2
    assert [each.state for each in ada.times] == ["running", "running"]
    doer.starts()
    for each in (ben, cleo):
        ends(each)
    goes_on(net, 10.0)
    assert [each.state for each in ada.times] == ["done", "done"]


def test_what_came_of_a_reminder_comes_back_to_whoever_keeps_it() -> None:
    net, (ada, ben, cleo) = ward()
    is_busy(ada)
    is_busy(cleo)
    ada.plans(ROUND, after=10.0)
    goes_on(net, 15.0)
    ben.reminders[1] = (Outcome(person="Alice", result="silent", question="Have you done it?"),)
    ends(ben)
    goes_on(net, 5.0)
    [time] = ada.times
    assert (time.state, time.note, time.reminded) == ("done", "reminder_silent", ben.reminders[1])
    assert ada.told() == ["reminder_silent"]


def test_two_robots_that_both_think_it_is_theirs_hand_nothing_out(tmp_path: Path) -> None:
    net, (ada, *_) = ward()
    ada.plans(ROUND, after=60.0)
    goes_on(net, 5.0)
    twin = copied(net, ada, tmp_path, "Ada's copy")
    goes_on(net, 200.0)
    assert list(begun(net)) == []
    for each in (ada, twin):
        [time] = each.times
        assert (time.state, time.note) == ("missed", "doubled"), each.name
        assert "missed" in each.told()


def test_a_copy_that_is_another_robot_by_now_asks_for_an_approval_of_its_own(
    tmp_path: Path,
) -> None:
    net, (ada, *_) = ward()
    ada.plans(ROUND, after=60.0)
    copied(net, ada, tmp_path, "Ada's copy").alive = False
    del net.robots[-1]
    (tmp_path / "book.sqlite").unlink()  # as both were told
    copy = Keeper(net, "Dora", book=tmp_path / "book.sqlite", schedule=tmp_path / "schedule.sqlite")
    goes_on(net, 80.0)
    assert [each.state for each in copy.times] == ["asked"] and copy.told() == ["moved"]
    assert len(list(begun(net))) == 1 and [each.state for each in ada.times] == ["running"]


at_the_keeper = st.one_of(
    st.tuples(st.just("plan"), st.integers(0, 90)),
    st.tuples(st.just("plan"), st.integers(0, 90)),
    st.tuples(st.just("round"), st.integers(0, 90)),
    st.tuples(st.just("looks"), st.integers(0, 2)),
    st.tuples(st.just("looks"), st.integers(0, 2)),
    st.tuples(st.just("looks"), st.integers(0, 2)),
    st.tuples(st.just("dies at its claim"), st.integers(0, 2)),
    st.tuples(st.just("dies at its hand"), st.integers(0, 2)),
    st.tuples(st.just("minutes"), st.integers(0, 4)),
    st.tuples(st.just("pause"), st.integers(0, 2)),
)


def test_each_time_is_done_once_at_most_and_what_is_told_is_true(soak: bool) -> None:
    courses = st.lists(st.one_of(steps, at_the_keeper), min_size=5, max_size=80)
    tried = settings(max_examples=5_000 if soak else 150, deadline=None)(given(courses)(ends_well))
    tried()


def ends_well(course: list[tuple[str, float]]) -> None:
    net, robots = ward()
    ada = robots[0]
    ada.plans('robot.say("appointment 0")\n', after=5.0)
    for what, number in course:
        robot = robots[int(number) % len(robots)]
        if what in ("plan", "round"):
            count = len(robot.schedule.appointments(removed=True))
            rule = "FREQ=MINUTELY;INTERVAL=5" if what == "round" else None
            robot.plans(f'robot.say("{what} {count} of {robot.name}")\n', number, rule)
        elif what == "looks":
            if robot.alive:
                robot.looks()
        elif what in ("dies at its claim", "dies at its hand"):
            robot.dies_at = what.rpartition(" ")[2]
        elif what == "minutes":
            goes_on(net, 60.0 * number, step=5.0)
        elif what == "pause":
            for each in robot.schedule.appointments():
                robot.schedule.pause(each.id, not each.paused)
        else:
            happens(net, what, number)
        check(net, robots)
    # In the end all are there again, and all is well.
    net.cut.clear()
    for robot in robots:
        robot.dies_at = robot.refuses = None
        if not robot.alive:
            robot.starts()
        for each in robot.schedule.appointments():
            if each.rhythm is not None and each.rhythm.rule is not None:
                robot.schedule.remove(each.id)
    for _ in range(12):
        goes_on(net, 15.0, step=1.0)
        for robot in robots:
            ends(robot)
    check(net, robots)
    for robot in robots:
        assert robot.schedule.begun("robot") == [] == robot.schedule.waiting("robot")


def check(net: FakeNetwork, robots: list[Keeper]) -> None:
    """Of each appointment no more was begun than came, and nothing of what was told as not done."""
    runs = Counter(what for _, what in begun(net))
    for robot in robots:
        for kept in robot.schedule.appointments(removed=True):
            came = [each for each in robot.times if each.appointment == kept.id]
            done = sum(each.state == "done" for each in came)
            may = sum(each.state in ("done", "failed", "claimed", "running") for each in came)
            assert done <= runs[kept.program] <= may, (kept, came)
