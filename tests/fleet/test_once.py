"""No robot does a thing twice, and no two robots do it, whatever the network and the power do."""

from __future__ import annotations

from collections import Counter

from hypothesis import given, settings
from hypothesis import strategies as st

from tests.fleet.conftest import FakeNetwork, begun, errand

NAMES = ("Ada", "Ben", "Cleo")
steps = st.one_of(
    st.tuples(st.just("time"), st.sampled_from((0.1, 0.6, 3.0, 25.0))),
    st.tuples(st.just("come"), st.integers(0, 40)),
    st.tuples(st.just("come"), st.integers(0, 40)),
    st.tuples(st.just("twice"), st.integers(0, 40)),
    st.tuples(st.just("lose"), st.integers(0, 40)),
    st.tuples(st.just("all"), st.just(0)),
    st.tuples(st.just("cut"), st.integers(0, 2)),
    st.tuples(st.just("mend"), st.just(0)),
    st.tuples(st.just("restart"), st.integers(0, 2)),
    st.tuples(st.just("dies at its note"), st.integers(0, 2)),
    st.tuples(st.just("dies at its run"), st.integers(0, 2)),
    st.tuples(st.just("over"), st.integers(0, 2)),
    st.tuples(st.just("refuses"), st.integers(0, 2)),
    st.tuples(st.just("errand"), st.integers(0, 2)),
)


def happens(net: FakeNetwork, what: str, number: float) -> None:
    under_way = int(number) % len(net.under_way) if net.under_way else None
    robot = net.robots[int(number) % len(net.robots)]
    match what:
        case "time":
            net.now += number
            for each in net.robots:
                if each.alive:
                    each.hub.tick(net.now)
        case "come" | "twice" if under_way is not None:
            net.hand_on(under_way, keep=what == "twice")
        case "lose" if under_way is not None:
            del net.under_way[under_way]
        case "all":
            while net.under_way:
                net.hand_on()
        case "cut":
            net.cut = {
                frozenset((robot.id, other.id)) for other in net.robots if other is not robot
            }
        case "mend":
            net.cut.clear()
        case "restart":
            robot.dies_at = None
            robot.starts()
        case "dies at its note" | "dies at its run":
            robot.dies_at = what.rpartition(" ")[2]
        case "over":
            robot.over |= dict.fromkeys(range(1, len(robot.runs) + 1), "done")
        case "refuses":
            robot.refuses = None if robot.refuses else "I have no hands."
        case "errand" if robot.alive:
            count = sum(len(each.book.errands()) for each in net.robots)
            robot.hub.dispatcher.add(errand(f'robot.say("{count}")\n'), net.now)


def test_each_thing_is_begun_once_at_most_and_all_come_to_an_end(soak: bool) -> None:
    courses = st.lists(steps, min_size=5, max_size=80)
    tried = settings(max_examples=10_000 if soak else 150, deadline=None)(given(courses)(ends_well))
    tried()


def ends_well(course: list[tuple[str, float]]) -> None:
    net = FakeNetwork()
    for number, name in enumerate(NAMES):
        net.robot(name, x=float(number))
    net.robots[1].drift = 600.0  # his clock is ten minutes ahead
    net.goes_on(1.5)
    net.robots[0].hub.dispatcher.add(errand('robot.say("0")\n'), net.now)
    for what, number in course:
        happens(net, what, number)
        assert all(times == 1 for times in Counter(what for _, what in begun(net)).values())
    # In the end all are there again, and all is well.
    net.cut.clear()
    for robot in net.robots:
        robot.dies_at = robot.refuses = None
        if not robot.alive:
            robot.starts()
    for _ in range(3):
        net.goes_on(15.0, step=0.5)
        for robot in net.robots:
            robot.over |= dict.fromkeys(range(1, len(robot.runs) + 1), "done")
    net.goes_on(130.0, step=1.0)
    done = Counter(what for _, what in begun(net))
    assert all(times == 1 for times in done.values())
    for robot in net.robots:
        for each in robot.book.errands():
            assert each.state in ("done", "nobody", "broken_off"), each
            # Whoever is told that it was not done can rely on it.
            assert (each.state == "nobody") <= (done[each.program] == 0)
            assert (each.state == "done") <= (done[each.program] == 1)
