"""Stopping at once, several callers, a clock, copies, and the same run for the same seed."""

from __future__ import annotations

import threading
import time
from datetime import datetime
from zoneinfo import ZoneInfo

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.errors import Interrupted, SimError
from sim.record import to_json
from sim.simulation import Simulation
from sim.world.loading import load_world


class After:
    """A stop that is pressed after so many looks at it: one for each step."""

    def __init__(self, looks: int) -> None:
        self.looks = looks

    def is_set(self) -> bool:
        self.looks -= 1
        return self.looks < 0


def test_a_stop_in_full_drive_is_a_stop_within_a_step(small_ward) -> None:
    simulation = Simulation(small_ward)
    with pytest.raises(Interrupted):
        simulation.run(simulation.drive_to(11, 1.5), After(240))
    stopped = simulation.robot
    assert stopped.x > 2 and stopped.speed == 0
    assert simulation.time == pytest.approx(4)
    # At rest for good: time may go on, the robot stays.
    simulation.run(simulation.wait(1), threading.Event())
    assert simulation.robot.x == pytest.approx(stopped.x, abs=1e-6)
    simulation.run(simulation.drive_to(11, 1.5), threading.Event())
    assert simulation.robot.x == pytest.approx(11, abs=0.05)


def test_halt_comes_through_while_time_races(small_ward) -> None:
    """From another thread, in the middle of a behaviour that would take for ever."""
    simulation = Simulation(small_ward)
    ended = threading.Event()

    def wait_for_ever() -> None:
        with pytest.raises(Interrupted):
            simulation.run(simulation.wait_for("unicorn"), threading.Event())
        ended.set()

    thread = threading.Thread(target=wait_for_ever)
    thread.start()
    while simulation.time < 1:
        pass
    simulation.halt()
    assert ended.wait(5)
    thread.join()


def test_halt_interrupts_all_and_no_except_exception_swallows_it(small_ward) -> None:
    outcomes = []
    with Simulation(small_ward, speed=1) as simulation:  # nothing ends before all have begun

        def caller(behaviour) -> None:
            try:
                simulation.run(behaviour, threading.Event())
            except Exception:  # noqa: BLE001 - what a program may do
                outcomes.append("swallowed")
            except Interrupted:
                outcomes.append("interrupted")

        behaviours = [
            simulation.drive_to(11, 1.5),
            simulation.wait(1e6),
            simulation.speak("x" * 2000),
        ]
        threads = [threading.Thread(target=caller, args=(each,)) for each in behaviours]
        for thread in threads:
            thread.start()
        while len(simulation._runner._tasks) < len(threads):
            pass
        simulation.halt()
        for thread in threads:
            thread.join(5)
        assert outcomes == ["interrupted"] * 3
        assert simulation.robot.speed == 0


def test_several_callers_share_the_same_time(small_ward) -> None:
    simulation = Simulation(small_ward)
    ended: dict[float, float] = {}

    def caller(seconds: float) -> None:
        simulation.run(simulation.wait(seconds), threading.Event())
        ended[seconds] = simulation.time

    threads = [threading.Thread(target=caller, args=(s,)) for s in (40.0, 80.0, 120.0)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(20)
    assert sorted(ended) == [40, 80, 120]
    # They began at nearly the same simulated time, so all are over when the longest is.
    assert simulation.time <= 240.1
    assert ended[120.0] == simulation.time


def test_one_that_is_stopped_leaves_the_others_running(small_ward) -> None:
    simulation = Simulation(small_ward)
    talk_stop = threading.Event()
    talked = []

    def talk() -> None:
        try:
            simulation.run(simulation.wait(1e5), talk_stop)
        except Interrupted:
            talked.append("stopped")

    thread = threading.Thread(target=talk)
    thread.start()
    while not simulation._runner._tasks:
        pass
    simulation.run(simulation.drive_to(11, 1.5), threading.Event())
    talk_stop.set()
    thread.join(5)
    assert talked == ["stopped"]
    assert simulation.robot.x == pytest.approx(11, abs=0.05)


def test_what_goes_wrong_in_a_behaviour_is_raised_where_it_was_run(small_ward) -> None:
    simulation = Simulation(small_ward)

    def broken():
        yield
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        simulation.run(broken(), threading.Event())
    simulation.run(simulation.wait(1), threading.Event())


def test_without_a_speed_no_time_passes_by_itself(small_ward) -> None:
    simulation = Simulation(small_ward)
    assert simulation.time == 0
    simulation.run(simulation.wait(2), threading.Event())
    assert simulation.time == pytest.approx(2)
    assert simulation.time == pytest.approx(2)


def test_the_clock_shows_a_fixed_morning_or_the_one_asked_for(small_ward) -> None:
    simulation = Simulation(small_ward)
    assert simulation.clock().strftime("%A %H:%M") == "Monday 08:00"
    simulation.run(simulation.wait(90), threading.Event())
    assert simulation.clock().strftime("%H:%M:%S") == "08:01:30"
    christmas = Simulation(small_ward, start=datetime(2026, 12, 24, 18, 0))
    assert christmas.clock().year == 2026 and christmas.clock().hour == 18


def test_its_clocks_are_set_in_the_night_of_daylight_saving_and_may_be_set_by_hand(
    small_ward,
) -> None:
    zurich = ZoneInfo("Europe/Zurich")
    night = Simulation(small_ward, start=datetime(2026, 3, 29, 1, 59, 30, tzinfo=zurich))
    night.run(night.wait(60), threading.Event())
    assert f"{night.clock():%H:%M %Z}" == "03:00 CEST"
    night.set_clock(datetime(2026, 12, 24, 18, 0, tzinfo=zurich))
    night.run(night.wait(60), threading.Event())
    assert f"{night.clock():%d.%m. %H:%M %Z}" == "24.12. 18:01 CET"


# --- with a clock --------------------------------------------------------------------------------


def test_a_clock_thread_lets_time_pass_and_a_halt_comes_through(small_ward) -> None:
    with Simulation(small_ward, speed=100) as simulation:
        simulation.run(simulation.drive_to(6, 1.5), threading.Event())
        assert simulation.robot.x == pytest.approx(6, abs=0.05)
        begin = time.monotonic()
        interrupted = threading.Event()

        def drive() -> None:
            with pytest.raises(Interrupted):
                simulation.run(simulation.wait(1e6), threading.Event())
            interrupted.set()

        thread = threading.Thread(target=drive)
        thread.start()
        while not simulation._runner._tasks:
            pass
        simulation.halt()
        assert interrupted.wait(5)
        thread.join()
        assert time.monotonic() - begin < 5


def test_a_stop_flag_is_seen_though_the_clock_stands_nearly_still(small_ward) -> None:
    stop = threading.Event()
    with Simulation(small_ward, speed=0.001) as simulation:
        threading.Timer(0.05, stop.set).start()
        with pytest.raises(Interrupted):
            simulation.run(simulation.move(5), stop)
        assert simulation.robot.speed == 0


def test_all_hear_of_events_in_the_order_in_which_they_happened(small_ward) -> None:
    """Also if who tells of the first is held up meanwhile; the other is not held up with them."""
    simulation = Simulation(small_ward)
    told: list[str] = []
    telling, go_on = threading.Event(), threading.Event()

    def listener(kind: str, data: object) -> None:
        if kind == "stopping":
            telling.set()
            assert go_on.wait(5)
        told.append(kind)

    simulation.subscribe(listener)
    slow = threading.Thread(target=simulation.emit, args=("stopping", {}))
    slow.start()
    assert telling.wait(5)
    simulation.emit("stopped", {})
    assert told == []
    go_on.set()
    slow.join()
    assert told == ["stopping", "stopped"]


def test_what_a_listener_tells_comes_after_what_it_was_told(small_ward) -> None:
    simulation = Simulation(small_ward)
    told: list[str] = []

    def answering(kind: str, data: object) -> None:
        if kind == "speech":
            simulation.emit("heard", {})

    simulation.subscribe(answering)
    simulation.subscribe(lambda kind, data: told.append(kind))
    simulation.emit("speech", {})
    assert told == ["speech", "heard"]


def test_many_who_tell_at_the_same_time_take_nothing_from_each_other(small_ward) -> None:
    simulation = Simulation(small_ward)
    told: list[tuple[int, int]] = []
    simulation.subscribe(lambda kind, data: told.append((data["who"], data["number"])))
    failed: list[BaseException] = []

    def tell(who: int) -> None:
        try:
            for number in range(300):
                simulation.emit("heard", {"who": who, "number": number})
        except BaseException as error:  # noqa: BLE001 - of a thread that nobody would hear of
            failed.append(error)

    threads = [threading.Thread(target=tell, args=(who,)) for who in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failed
    for who in range(4):
        assert [number for each, number in told if each == who] == list(range(300))
    assert len(told) == 1200


def test_what_breaks_under_a_clock_is_raised_in_the_caller(small_ward) -> None:
    with Simulation(small_ward, speed=100) as simulation:
        simulation._hospital.people[0].body = None  # cannot be
        with pytest.raises(AttributeError):
            simulation.run(simulation.wait(10), threading.Event())
    with pytest.raises(Interrupted, match="ended"):
        simulation.run(simulation.wait(1), threading.Event())


# --- copies and seeds ----------------------------------------------------------------------------


def morning(simulation: Simulation) -> list[object]:
    """A bit of everything; returns what came of it."""
    never = threading.Event()
    results: list[object] = []
    for behaviour in (
        simulation.drive_to(*simulation.locate("reception")),
        simulation.wait_for("person"),
        simulation.hear(10, "Where to?", ["radiology", "pharmacy"]),
        simulation.guide("person", *simulation.locate("pharmacy")),
        simulation.find("stapler"),
        simulation.grab("stapler"),
        simulation.find("Maria"),
        simulation.hear(10, "Tea?", ["tea", "coffee"]),
        simulation.follow("Maria"),
        simulation.give("stapler", "Maria"),
    ):
        try:
            results.append(simulation.run(behaviour, never))
        except SimError as error:
            results.append(str(error))
    return [*results, simulation.time, simulation.robot]


def test_the_same_seed_gives_the_same_record(hospital) -> None:
    first, second, other = (Simulation(hospital, seed) for seed in (3, 3, 4))
    assert morning(first) == morning(second)
    assert to_json(first.record) == to_json(second.record)
    morning(other)
    assert to_json(first.record) != to_json(other.record)


def test_a_copy_goes_on_as_the_original_does_and_leaves_it_alone(hospital) -> None:
    simulation = Simulation(hospital, 5)
    simulation.run(simulation.drive_to(*simulation.locate("ward c")), threading.Event())
    before = simulation.robot, simulation.time, len(simulation.record.samples)
    twin = simulation.copy()
    foreseen = morning(twin)
    assert (simulation.robot, simulation.time, len(simulation.record.samples)) == before
    happened = morning(simulation)
    assert foreseen[:-2] == happened[:-2]
    assert foreseen[-2] == pytest.approx(happened[-2], abs=1)
    # The record of a copy begins with the copy.
    assert twin.record.samples[0].time == pytest.approx(before[1], abs=0.01)


def test_a_copy_knows_what_is_held_said_met_and_shown(small_ward) -> None:
    never = threading.Event()
    simulation = Simulation(small_ward)
    simulation.run(simulation.find("Alice"), never)
    simulation.run(simulation.wait_for("Alice"), never)
    simulation.run(simulation.hear(), never)
    simulation.run(simulation.grab("cup"), never)
    simulation.show({"text": "hello"})
    twin = simulation.copy()
    assert twin.robot == simulation.robot
    assert twin.clock() == simulation.clock()
    assert twin.run(twin.hear(), never) == "ward b"
    assert twin.run(twin.wait_for("Alice", 0), never) is False
    twin.run(twin.put("cup"), never)
    assert simulation.robot.holding == ["cup"]
    assert simulation.run(simulation.hear(), never) == "ward b"


def test_a_copy_taken_in_full_drive_comes_to_rest(small_ward) -> None:
    simulation = Simulation(small_ward)
    copies = []

    def copy_once(kind, data) -> None:
        if kind == "pose" and data["x"] > 4 and not copies:
            copies.append(simulation.copy())

    simulation.subscribe(copy_once)
    simulation.run(simulation.drive_to(11, 1.5), threading.Event())
    (twin,) = copies
    assert twin.robot.speed > 0.5
    twin.run(twin.wait(2), threading.Event())
    assert twin.robot.speed == 0 and twin.robot.x < 5


SMALL = load_world("ward")
ACTIONS = st.lists(
    st.one_of(
        st.builds(lambda x, y: ("drive_to", x, y), st.floats(0.5, 11.5), st.floats(0.5, 7.5)),
        st.builds(lambda m: ("move", m), st.floats(-2, 2)),
        st.builds(lambda d: ("turn", d), st.floats(-400, 400)),
        st.builds(lambda t: ("find", t), st.sampled_from(["cup", "nurse", "book", "cow"])),
        st.builds(lambda t: ("grab", t), st.sampled_from(["cup", "book"])),
        st.builds(lambda t: ("guide", "person", *t), st.just((9.0, 5.0))),
        st.just(("hear",)),
    ),
    max_size=5,
)


@settings(max_examples=12, deadline=None)
@given(ACTIONS, st.integers(0, 3))
def test_whatever_is_asked_the_same_calls_give_the_same_record(actions, seed) -> None:
    def play() -> bytes:
        simulation = Simulation(SMALL, seed)
        for name, *arguments in actions:
            try:
                simulation.run(getattr(simulation, name)(*arguments), threading.Event())
            except SimError:
                assert simulation.robot.speed == 0
        return to_json(simulation.record)

    assert play() == play()


def test_the_benchmark_tells_how_fast_a_busy_floor_runs() -> None:
    from sim.benchmark import measure

    figures = measure(20)
    assert figures["people"] == 10 and figures["rays"] == 36
    assert figures["simulated_seconds"] >= 20 and figures["metres_driven"] > 3
    assert figures["times_real_time"] > 0
