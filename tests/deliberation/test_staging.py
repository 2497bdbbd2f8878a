"""The scenes in which drafts are tried hold what the drafts speak of, there and not there."""

from __future__ import annotations

from collections.abc import Collection

from nl2robot.deliberation.paper_robot import START, Scene
from nl2robot.deliberation.playing import played
from nl2robot.deliberation.staging import VARIATIONS, scenes
from nl2robot.knowledge import Knowledge
from sim.world.loading import load_world
from tests.deliberation.drafting import WARD

LEXICON = WARD.lexicon("en")


def staged(*programs: str, people: Collection[str] = ()) -> list[Scene]:
    return scenes(LEXICON, programs, people)


def differently(one: str, other: str, people: Collection[str] = ()) -> bool:
    """Whether two programs do different things in one of the scenes that are made for them."""
    return any(
        played(one, scene).events != played(other, scene).events
        for scene in staged(one, other, people=people)
    )


def test_places_are_those_of_the_world() -> None:
    for scene in staged('robot.goto("ward a")'):
        assert scene.places["ward a"] == "ward"
        assert {*scene.places} == {place.name for place in WARD.world.places}


def test_in_the_first_scene_all_is_well() -> None:
    program = (
        'robot.find("cup")\nrobot.grab("cup")\nrobot.goto("ward b")\n'
        'robot.give("cup", person="person")\n'
    )
    first, *_ = staged(program)
    assert played(program, first).end == "done"


def test_people_and_things_are_there_or_not() -> None:
    program = 'robot.goto("ward a")\nrobot.sees("person")\nrobot.sees("cup")\n'
    somebody = {bool(scene.people) for scene in staged(program)}
    something = {bool(scene.things) for scene in staged(program)}
    assert somebody == something == {True, False}


def test_somebody_may_be_missing_though_things_are_there() -> None:
    """Who is not there must not be taken for a thing."""
    looks = 'robot.goto("ward a")\nrobot.say("Yes." if robot.sees("person") else "No.")\n'
    answers = {
        (bool(scene.people), played(looks, scene).events[-1].what) for scene in staged(looks)
    }
    assert answers == {(True, "Yes."), (False, "No.")}


def test_somebody_is_there_also_where_the_robot_is_told() -> None:
    assert differently(
        'if robot.sees("person"):\n    robot.say("Hello!")\n',
        'if robot.sees("person"):\n    robot.gesture("wave")\n',
    )


def test_people_fit_the_words_for_them() -> None:
    assert differently(
        'if robot.sees("person with Glasses"):\n    robot.say("Hello!")\n',
        'if robot.sees("person with Glasses"):\n    robot.gesture("wave")\n',
        people={"person with Glasses"},
    )


def test_people_are_at_home_where_a_place_is_called_after_them(tmp_path) -> None:
    file = tmp_path / "home.yaml"
    file.write_text(
        "places: [{name: hannah's office}, {name: gym}, {name: Anna's office}]\n"
        "people: [{name: Anna}, {name: Ann}]\n"
    )
    lexicon = Knowledge(load_world(str(file), names_only=True)).lexicon("en")
    scene, *_ = scenes(lexicon, ['robot.say("Hello!")'])
    assert scene.people["Anna"] == "Anna's office"
    assert scene.people["Ann"] == "gym"  # not the office of Hannah


def test_every_answer_is_given_in_some_scene() -> None:
    asks = 'robot.say(robot.ask("What?", ["tea", "coffee", "water"]))\n'
    assert {played(asks, scene).events[-1].what for scene in staged(asks)} == {
        "tea",
        "coffee",
        "water",
    }


def test_open_questions_are_answered_as_drafts_hope_and_otherwise() -> None:
    listens = (
        'if "yes" in robot.ask("Tea?").lower():\n    robot.say("Yes!")\n'
        'else:\n    robot.say("No!")\n'
    )
    assert {played(listens, scene).events[-1].what for scene in staged(listens)} == {"Yes!", "No!"}


def test_who_is_waited_for_comes_or_does_not() -> None:
    waits = 'robot.goto("ward a")\nrobot.wait_for("Alice")\nrobot.say("Lunch!")\n'
    assert {played(waits, scene).end for scene in staged(waits)} == {"done", "over"}
    assert differently(waits, waits.replace("Lunch!", "Fire!"))


def test_visitors_come_one_by_one() -> None:
    waits = (
        'robot.goto("corridor")\nfor number in range(3):\n    robot.wait_for("visitor")\n'
        '    robot.say("Welcome!")\n'
    )
    scene = staged(waits)[1]
    welcomed = [event.whom for event in played(waits, scene).events if event.kind == "says"]
    assert len({*welcomed}) == 3


def test_times_of_day_come() -> None:
    for time in ("00:05", "23:59"):
        waits = f'while robot.clock().time < "{time}":\n    robot.wait(10)\nrobot.goto("ward a")\n'
        decides = f'if robot.clock().time < "{time}":\n    robot.goto("ward a")\n'
        for program in (waits, decides, decides.replace("<", ">=")):
            assert differently(program, program.replace("ward a", "ward b")), program


def test_days_of_the_week_come_and_others_too() -> None:
    for day in ("Monday", "Tuesday", "sunday"):
        decides = (
            f'if robot.clock().weekday.lower() == "{day.lower()}":\n    robot.goto("ward a")\n'
            'else:\n    robot.goto("ward b")\n'
        )
        ends = {played(decides, scene).events[-1].at for scene in staged(decides)}
        assert ends == {"ward a", "ward b"}


def test_the_battery_is_full_or_nearly_empty() -> None:
    for percent in (5, 20, 50):
        decides = f"if robot.battery() < {percent}:\n    robot.dock()\n"
        assert {len(played(decides, scene).events) for scene in staged(decides)} == {0, 1}


def test_the_robot_meets_nobody_at_places_that_are_only_named() -> None:
    """What a draft does not go to needs nobody in it."""
    scene, *_ = staged('robot.say("ward b")')
    assert not [who for who, at in scene.people.items() if "person" in who and at != START]


def test_odd_arguments_upset_nobody() -> None:
    for odd in ("{[]: 1}", "[['ward a']]", "{'place': 'ward a'}", "x", "1e400", "*[1]", "**{}"):
        assert len(staged(f"robot.goto({odd})\nrobot.find({odd}, {odd})\n")) == len(VARIATIONS)
    assert len(staged("")) == len(VARIATIONS)
