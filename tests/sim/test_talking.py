"""Speaking takes its time; people answer what the world says, then something sensible."""

from __future__ import annotations

import msgspec
import pytest

from sim.errors import NotFound


@pytest.fixture
def ward_a(small_ward, living):
    ward = living(small_ward)
    ward.goes_to("ward a")
    return ward


@pytest.fixture
def alice(ward_a):
    return ward_a.person("Alice")


def test_a_long_sentence_takes_longer_and_is_heard_by_those_who_listen(ward_a) -> None:
    told = []
    ward_a.simulation.subscribe(lambda kind, data: told.append((kind, data)))
    before = ward_a.simulation.time
    ward_a.does(ward_a.simulation.speak("Good morning, Alice. How are you today?"))
    assert ward_a.simulation.time - before == pytest.approx(39 * 0.06, abs=0.05)
    assert told[0] == (
        "speech",
        {"text": "Good morning, Alice. How are you today?", "language": "en"},
    )


def test_alice_turns_to_the_robot_when_it_speaks(ward_a, alice) -> None:
    alice.theta = 0.0
    ward_a.does(ward_a.simulation.speak("Hello, Alice. Nice to see you."))
    robot = ward_a.simulation.robot
    assert robot.x < alice.position[0] and abs(alice.theta) > 90


def test_answers_come_in_order_and_then_something_sensible(ward_a) -> None:
    said = [ward_a.does(ward_a.simulation.hear(question="?")) for _ in range(4)]
    assert said == ["yes", "ward b", "no", "yes"]
    assert ward_a.does(ward_a.simulation.hear(options=["tea", "coffee"])) in ("tea", "coffee")
    ward_a.simulation.set_language("de")
    assert ward_a.does(ward_a.simulation.hear()) == "ja"


def test_what_was_heard_is_told_with_the_name(ward_a) -> None:
    told = []
    ward_a.simulation.subscribe(lambda kind, data: told.append((kind, data)))
    ward_a.does(ward_a.simulation.hear())
    assert ("heard", {"text": "yes", "person": "Alice"}) in told
    assert ward_a.simulation.record.happenings[-1].kind == "heard"


def test_where_nobody_is_nobody_answers(small_ward, living) -> None:
    ward = living(small_ward)
    assert ward.does(ward.simulation.hear(timeout=5)) is None
    assert ward.simulation.time == pytest.approx(5, abs=0.05)
    assert ward.does(ward.simulation.touch(["yes", "no"], timeout=5)) is None


def test_somebody_in_particular_must_be_here(ward_a) -> None:
    with pytest.raises(NotFound, match="Henry"):
        ward_a.does(ward_a.simulation.hear(person="Henry"))
    assert ward_a.does(ward_a.simulation.hear(person="nurse")) == "yes"


def test_somebody_who_keeps_silent_once(corridor, living) -> None:
    world = corridor("people: [{name: Tom, pose: [3, 1.25, 180]}]")
    tom = msgspec.structs.replace(world.people[0], answers=("", "tea"))
    ward = living(msgspec.structs.replace(world, people=(tom,)))
    before = ward.simulation.time
    assert ward.does(ward.simulation.hear(timeout=4)) is None
    assert ward.simulation.time - before == pytest.approx(4, abs=0.05)
    assert ward.does(ward.simulation.hear(timeout=4)) == "tea"


def test_they_press_what_they_said(ward_a) -> None:
    assert ward_a.does(ward_a.simulation.hear()) == "yes"
    assert ward_a.does(ward_a.simulation.touch(["No", "Yes"])) == "Yes"


def test_they_press_what_they_would_say_next(ward_a) -> None:
    ward_a.does(ward_a.simulation.hear())
    assert ward_a.does(ward_a.simulation.touch(["Ward A", "Ward B"])) == "Ward B"
    # That answer is given now.
    assert ward_a.does(ward_a.simulation.hear()) == "no"


def test_a_code_is_read_from_the_hand_the_table_and_what_is_held_up(small_ward, living) -> None:
    ward = living(small_ward)
    assert ward.does(ward.simulation.scan(timeout=3)) is None
    assert ward.simulation.time == pytest.approx(3, abs=0.05)
    assert ward.does(ward.simulation.find("book"))
    assert ward.does(ward.simulation.scan()) == "2000000000428"
    ward.does(ward.simulation.grab("blue cup"))
    assert ward.does(ward.simulation.scan()) == "2000000000411"
    ward.does(ward.simulation.give("cup", "Henry"))
    assert ward.does(ward.simulation.scan()) == "2000000000411"


def test_screen_emotion_and_joints_are_kept_and_told(small_ward, living) -> None:
    simulation = living(small_ward).simulation
    told = []
    simulation.subscribe(lambda kind, data: told.append((kind, data)))
    simulation.set_emotion("happy")
    simulation.show({"text": "Welcome"})
    simulation.set_joint("head_yaw", 20)
    simulation.set_volume(30)
    robot = simulation.robot
    assert (robot.emotion, robot.screen, robot.joints, robot.volume) == (
        "happy",
        {"text": "Welcome"},
        {"head_yaw": 20},
        30,
    )
    assert told == [
        ("emotion", {"name": "happy"}),
        ("screen", {"text": "Welcome"}),
        ("joint", {"name": "head_yaw", "degrees": 20}),
        ("volume", {"percent": 30}),
    ]
    assert [h.kind for h in simulation.record.happenings] == [kind for kind, _ in told]
