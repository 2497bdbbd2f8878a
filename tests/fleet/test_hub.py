"""Robots of a ward that hear of each other: whom they believe, what they know, who is asked."""

from __future__ import annotations

from collections import Counter

import pytest

from nl2robot.fleet.choosing import called, first_place, ranked
from nl2robot.fleet.messages import Order, Standing, Stop, packed
from nl2robot.fleet.sealing import Sealer
from tests.fleet.conftest import KEY, FakeNetwork, FakeRobot, begun, errand

WAY = 'robot.goto("pharmacy")\nrobot.say("Here I am.")\n'


@pytest.fixture
def net() -> FakeNetwork:
    return FakeNetwork()


def states(robot: FakeRobot) -> list[str]:
    return [each.state for each in robot.book.errands()]


def test_they_hear_of_each_other_and_of_who_is_silent(net: FakeNetwork) -> None:
    ada, ben = net.robot("Ada"), net.robot("Ben", x=3.0)
    net.goes_on(3.0)
    known = ada.hub.roll.members[ben.id]
    assert known.known(net.now) and known.name == "Ben"
    assert known.standing is not None and known.standing.x == 3.0
    ben.alive = False
    net.goes_on(6.0)
    assert not ada.hub.roll.members[ben.id].known(net.now)
    assert net.now - ada.hub.roll.members[ben.id].heard > 5.0
    ben.starts()
    net.goes_on(3.0)
    assert ada.hub.roll.members[ben.id].known(net.now)


def test_the_nearest_that_can_do_it_does_it(net: FakeNetwork) -> None:
    ada = net.robot("Ada", x=100.0)
    net.robot("Ben", x=30.0)
    net.robot("Cleo", x=9.0, methods=("say",))
    net.robot("Dora", x=9.0, map="another floor")
    net.robot("Emil", x=9.5).standing = Standing(state="running", x=9.5, y=0, waits="busy")
    net.goes_on(2.0)
    ada.hub.dispatcher.add(errand(WAY), net.now)
    net.goes_on(3.0)
    assert list(begun(net)) == [("Ben", WAY)]
    net.robots[1].over[1] = "done"
    net.goes_on(3.0)
    assert states(ada) == ["done"]
    [done] = ada.book.errands()
    assert (done.robot_name, done.run) == ("Ben", 1)


def test_who_says_no_is_not_asked_at_once_again_and_the_next_one_is(net: FakeNetwork) -> None:
    ada, ben = net.robot("Ada", x=0.0), net.robot("Ben", x=9.0)
    ben.refuses = "Here it would also work at “ward b”."
    net.goes_on(2.0)
    ada.hub.dispatcher.add(errand(WAY), net.now)
    net.goes_on(3.0)
    assert list(begun(net)) == [("Ada", WAY)]
    [given] = ada.book.errands()
    assert given.refused == {"Ben": ben.refuses}


def test_nobody_can_do_it_and_that_is_said(net: FakeNetwork) -> None:
    ada, ben = net.robot("Ada"), net.robot("Ben")
    ada.refuses = ben.refuses = "I have no hands."
    net.goes_on(2.0)
    ada.hub.dispatcher.add(errand(WAY), net.now)
    net.goes_on(125.0)
    [given] = ada.book.errands()
    assert given.state == "nobody" and given.refused == dict.fromkeys(("Ada", "Ben"), ada.refuses)
    ada.refuses = ben.refuses = None
    net.goes_on(10.0)
    assert list(begun(net)) == []


def test_what_a_stranger_says_is_not_believed(net: FakeNetwork) -> None:
    ada, ben = net.robot("Ada"), net.robot("Ben")
    net.goes_on(2.0)
    stranger = Sealer(b"another key, which somebody has guessed", ben.id, ben.hub.sealer.session)
    stranger.number = 500
    ada.hub.hear(stranger.seal("stop", packed(Stop("1", "Stand.")), ada.id), net.now)
    assert ada.stood == [] and ada.hub.refused["forged"] == 1
    # Nor is a message that was changed on its way.
    honest = Sealer(KEY, ben.id, ben.hub.sealer.session)
    honest.number = 500
    raw = bytearray(honest.seal("stop", packed(Stop("1", "Stand.")), ada.id))
    raw[raw.index(b"Stand.")] ^= 1
    ada.hub.hear(bytes(raw), net.now)
    ada.hub.hear(b"\x00" * 20, net.now)
    ada.hub.hear(b"x" * 400_000, net.now)
    assert ada.stood == []
    assert (ada.hub.refused["forged"], ada.hub.refused["garbled"]) == (2, 2)


def test_what_was_recorded_is_worth_nothing_later(net: FakeNetwork) -> None:
    ada, ben = net.robot("Ada"), net.robot("Ben")
    net.goes_on(2.0)
    ben.hub.stops.begin([ada.id], "Kim stops her.", net.now)
    net.goes_on(2.0)
    assert set(ada.stood) == {"Kim stops her."}
    recorded, stood = list(net.heard_of), list(ada.stood)
    for raw in recorded:
        ada.hub.hear(raw, net.now)
    assert ada.stood == stood and ada.hub.refused["replayed"] > 0
    # She is started anew, and remembers no numbers; his old process is gone as well.
    ada.starts()
    ben.starts()
    net.goes_on(2.0)
    for raw in recorded:
        ada.hub.hear(raw, net.now)
        while net.under_way:
            net.hand_on()
    assert ada.stood == stood and ada.hub.refused["unproven"] > 0


def test_two_of_one_name_are_told_apart(net: FakeNetwork) -> None:
    ada, one, other = net.robot("Ada"), net.robot("Ben", x=1), net.robot("Ben", x=2)
    net.goes_on(2.0)
    assert ada.hub.roll.twins() == {"Ben": sorted((one.id, other.id))}
    assert one.hub.roll.twins() == {"Ben": sorted((one.id, other.id))}
    assert len(ada.hub.roll.called("Ben")) == 2
    assert [each.id for each in ada.hub.roll.called(one.id)] == [one.id]


def test_a_robot_whose_data_folder_was_copied_does_it_once(net: FakeNetwork) -> None:
    """Two with one id, as two computers that were set up from one image."""
    ada = net.robot("Ada", methods=("say",))
    ben, copy = net.robot("Ben", x=9), net.robot("Ben", x=9)
    copy.id = copy.book.robot = ben.id
    net.goes_on(4.0)
    for number in range(5):
        program = f'robot.goto("pharmacy")\nrobot.say("{number}")\n'
        ada.hub.dispatcher.add(errand(program), net.now)
        net.goes_on(0.2 if number == 0 else 40.0)
        if number == 0:  # from now on both are there
            copy.starts()
        for robot in net.robots:
            robot.over |= dict.fromkeys(range(1, len(robot.runs) + 1), "done")
        net.goes_on(40.0)
    done = Counter(program for _, program in begun(net))
    assert set(done.values()) == {1}, done
    assert states(ada).count("begun") == 1  # the first, of which the other knows nothing
    copy.alive = False
    net.goes_on(10.0)
    assert states(ada) == ["done"] * 5


def test_clocks_ten_minutes_apart_do_not_matter(net: FakeNetwork) -> None:
    ada, ben = net.robot("Ada", x=0.0), net.robot("Ben", x=9.0)
    ben.drift = 600.0
    net.goes_on(2.0)
    ada.hub.dispatcher.add(errand(WAY), net.now)
    net.goes_on(3.0)
    assert list(begun(net)) == [("Ben", WAY)]


def test_a_robot_behind_a_cut_keeps_what_it_was_told_to_do(net: FakeNetwork) -> None:
    ada, ben = net.robot("Ada", x=0.0), net.robot("Ben", x=9.0)
    net.goes_on(2.0)
    ada.hub.dispatcher.add(errand(WAY), net.now)
    net.goes_on(1.0)
    assert list(begun(net)) == [("Ben", WAY)]
    net.cut = {frozenset((ada.id, ben.id))}
    net.goes_on(3600.0, step=5.0)
    [given] = ada.book.errands()
    assert (given.state, given.robot_name) == ("begun", "Ben")
    assert not ada.hub.roll.members[ben.id].known(net.now)
    ben.over[1] = "done"
    net.cut.clear()
    net.goes_on(5.0)
    assert states(ada) == ["done"] and len(list(begun(net))) == 1


def test_a_robot_that_is_killed_in_mid_run_says_so_when_it_is_back(net: FakeNetwork) -> None:
    ada, ben = net.robot("Ada", x=0.0), net.robot("Ben", x=9.0)
    ben.dies_at = "run"
    net.goes_on(2.0)
    ada.hub.dispatcher.add(errand(WAY), net.now)
    net.goes_on(300.0, step=1.0)
    assert states(ada) == ["given"]  # nobody knows, so nobody else is told to
    ben.dies_at = None
    ben.over[1] = "broken_off"
    ben.starts()
    net.goes_on(5.0)
    assert states(ada) == ["broken_off"] and len(list(begun(net))) == 1


def test_an_order_for_nothing_that_was_offered_begins_nothing(net: FakeNetwork) -> None:
    ada, ben = net.robot("Ada"), net.robot("Ben")
    answer = ben.answers(ada.id, Order(offer="7", what="go"))
    assert answer.stand == "expired"
    late = Order(offer="7", what="offer", program=WAY)
    assert ben.answers(ada.id, late).stand == "expired"
    assert ben.answers(ada.id, Order(offer="8", what="offer")).stand == "accepted"
    assert ben.answers(ada.id, Order(offer="9", what="offer")).stand == "refused"
    assert ben.answers("somebody else", Order(offer="8", what="go")).stand == "refused"
    net.now += 30.0
    assert ben.answers(ada.id, Order(offer="8", what="go")).stand == "expired"
    assert list(begun(net)) == []


def test_a_stop_is_said_until_all_have_confirmed_it(net: FakeNetwork) -> None:
    ada, ben, cleo = net.robot("Ada"), net.robot("Ben"), net.robot("Cleo")
    net.goes_on(2.0)
    net.cut = {frozenset((ada.id, cleo.id))}
    made = ada.hub.stops.begin([ada.id, ben.id, cleo.id], "Stop.", net.now)
    net.goes_on(2.0)
    assert made.results.keys() == {ada.id, ben.id} and not made.over.is_set()
    net.goes_on(4.0)
    assert made.over.is_set() and cleo.stood == []
    net.cut.clear()
    net.goes_on(2.0)
    assert set(cleo.stood) == set(ben.stood) == {"Stop."}


def test_zones_are_the_same_in_the_end_wherever_they_were_drawn(net: FakeNetwork) -> None:
    ada, ben = net.robot("Ada"), net.robot("Ben")
    abroad = net.robot("Cleo", map="another floor")
    wet, bed = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0)), ((5.0, 5.0), (6.0, 5.0), (6.0, 6.0))
    net.goes_on(2.0)
    net.cut = {frozenset((ada.id, ben.id))}
    ada.hub.zones.drawn({"wet floor": wet})
    ben.hub.zones.drawn({"bed": bed, "wet floor": bed})
    ben.hub.zones.drawn({"bed": bed})
    net.goes_on(5.0)
    net.cut.clear()
    net.goes_on(3.0)
    assert ada.hub.zones.digest == ben.hub.zones.digest != abroad.hub.zones.digest
    # Ben drew it and took it away again: that is the later word.
    kept = {each.name: each.polygon for each in ada.hub.zones.message.entries}
    assert kept == {"bed": bed, "wet floor": None}
    assert abroad.hub.zones.message.entries == ()
    # What could not be drawn here was not removed by anybody.
    assert not ada.hub.zones.drawn({}, ["bed"])


@pytest.mark.parametrize(
    ("program", "methods", "place"),
    [
        (WAY, {"goto", "say"}, "pharmacy"),
        ('for w in ["a", "b"]:\n    robot.goto(w)\nrobot.goto("pharmacy")\n', {"goto"}, "pharmacy"),
        ('robot.say("goto")\n', {"say"}, None),
    ],
)
def test_what_a_program_needs_is_read_from_it(
    program: str, methods: set[str], place: str | None
) -> None:
    assert called(program) == methods
    assert first_place(program) == place


def test_half_a_battery_counts_as_much_as_thirty_metres(net: FakeNetwork) -> None:
    near, full, low = net.robot("near", x=0), net.robot("full", x=40), net.robot("low", x=0)
    near.standing = Standing(state="idle", x=0.0, y=0.0, battery=40.0)
    full.standing = Standing(state="idle", x=25.0, y=0.0, battery=95.0)
    low.standing = Standing(state="idle", x=0.0, y=0.0, battery=10.0)
    driven = net.robot("driven")
    driven.standing = Standing(state="idle", x=0.0, y=0.0, waits="driven", driven_by="Kim")
    net.goes_on(2.0)
    members = near.hub.roll.members.values()
    best, why = ranked(members, {"say"}, "ward", (0.0, 0.0), net.now)
    assert best == [full.id, near.id]
    assert why == {low.id: "low", driven.id: "driven"}


def test_what_is_old_is_forgotten_but_not_that_it_was_begun(net: FakeNetwork) -> None:
    ada, ben = net.robot("Ada", x=0.0), net.robot("Ben", x=9.0)
    net.goes_on(2.0)
    ada.hub.dispatcher.add(errand(WAY), net.now)
    net.goes_on(2.0)
    net.cut = {frozenset((ada.id, ben.id))}
    ben.over[1] = "done"
    [begun_there] = ada.book.errands()
    for number in range(3):
        old = Order(offer=f"{number}", what="offer", program=WAY, by="Nurse Kim")
        ben.answers("another", old)
        ben.answers("another", Order(offer=f"{number}", what="withdraw"))
        ada.book.keep(errand(f'robot.say("{number}")\n', state="done"))
    for robot in (ada, ben):
        robot.book.forget(kept=1)
    assert begun_there.offer is not None
    kept = ben.book.offer(begun_there.offer)
    assert kept is not None and (kept.program, kept.by, kept.stand) == ("", "", "begun")
    assert sorted(states(ada)) == ["begun", "done"]
    net.cut.clear()
    net.goes_on(3.0)
    assert sorted(states(ada)) == ["done", "done"] and len(list(begun(net))) == 1
