"""What is risky about a program is marked on its line before anybody approves it."""

from __future__ import annotations

from datetime import datetime

import msgspec
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from rich.console import Console

from nl2robot.cli.terminal import Terminal
from nl2robot.knowledge import Knowledge
from nl2robot.paths import PACKAGED
from nl2robot.review.rehearsal import MANY_POINTS, rehearse, watched
from nl2robot.review.review import Review, review
from nl2robot.review.risks import Risk, Situation, Tried, risks
from nl2robot.translate.translation import translate
from robot_api.drivers import simulated
from sim.simulation import Simulation
from sim.world.loading import load_world
from sim.world.model import Zone

HOSPITAL = load_world("city-hospital")
DESERTED = msgspec.structs.replace(HOSPITAL, people=())
"""In which a long time passes quickly."""
MORNING, NIGHT = datetime(2026, 3, 2, 8), datetime(2026, 3, 2, 22, 30)


def reviewed(
    program: str,
    *,
    place: str | None = None,
    clock: datetime = MORNING,
    zones: tuple[Zone, ...] = (),
    language: str = "en",
) -> Review:
    simulation = Simulation(HOSPITAL, start=clock)
    simulation.set_zones(zones)
    if place is not None:
        simulation.localize(*simulation.locate(place))
    knowledge = Knowledge(HOSPITAL, simulated(simulation).capabilities())
    return review(program, knowledge, simulation.copy(), language, seed=1)


def found(program: str, **more) -> list[tuple[int, str]]:
    return [(risk.line, risk.kind) for risk in reviewed(program, **more).risks]


def patiently(program: str, clock: datetime = MORNING) -> tuple[Risk, ...]:
    """The risks of what takes long, however busy this machine is."""
    simulation = Simulation(DESERTED, start=clock)
    tried = Tried(Situation.of(simulation), *watched(program, simulation.copy()))
    return risks(program, Knowledge(DESERTED), tried=tried)


@pytest.mark.parametrize("language", ["en", "de", "fr"])
def test_what_people_say_every_day_is_no_risk(language) -> None:
    """Every topic of the help has sentences like these; docs/how-it-works.md says how many of all
    are marked."""
    said = {
        "en": ["go to the pharmacy and say hello", "bring me the stapler", "set the volume to 80"],
        "de": ["fahr zur Apotheke und sag hallo", "bring mir den Hefter", "wie spät ist es"],
        "fr": [
            "va à la pharmacie et dis bonjour",
            "apporte-moi l'agrafeuse",
            "quelle heure est-il",
        ],
    }[language]
    knowledge = Knowledge(HOSPITAL, simulated(Simulation(HOSPITAL)).capabilities())
    for sentence in said:
        program = translate(sentence, knowledge, language).program
        assert program and found(program, language=language) == []


# --- where it goes -------------------------------------------------------------------------------


def test_who_leaves_the_ward_is_told_once_and_where_to() -> None:
    program = 'robot.goto("ward a")\nrobot.goto("ward b")\nrobot.goto("pharmacy")\n'
    told = reviewed(program, place="ward a").risks
    assert [(risk.line, risk.kind) for risk in told] == [(2, "leaves")]
    assert told[0].text == "The robot leaves ward a: ward b is outside of it."
    assert found(program, place="lobby") == []


def test_a_goal_that_only_the_dry_run_knows_leaves_as_well() -> None:
    program = 'for place in robot.places("pharmacy"):\n    robot.goto(place)\n'
    assert found(program, place="ward a") == [(2, "leaves")]
    assert found('robot.goto("ward a" if robot.battery() else "lobby")', place="ward a") == []


PHARMACY = Zone("spilled milk", ((0, 0), (7, 0), (7, 6.5), (0, 6.5)))
CORRIDOR = Zone("works", ((5, 6.6), (6, 6.6), (6, 8.9), (5, 8.9)))


def test_a_goal_in_a_keep_out_zone_is_marked() -> None:
    told = reviewed('robot.say("Off!")\nrobot.goto("drugstore")', zones=(PHARMACY,)).risks
    assert [(risk.line, risk.kind) for risk in told] == [(2, "zone"), (2, "unproven")]
    assert "pharmacy lies in the keep-out zone “spilled milk”" in told[0].text
    assert found("robot.goto(3, 4)", zones=(PHARMACY,)) == [(1, "zone"), (1, "unproven")]
    assert found("robot.goto(20, 4)", zones=(PHARMACY,)) == []


@pytest.mark.parametrize(
    "program",
    ['robot.goto("pharmacy")', "robot.move(9)", "for place in ['pharmacy']:\n  robot.goto(place)"],
)
def test_a_zone_that_is_in_the_way_is_marked(program) -> None:
    if "move" in program:
        zone = Zone("box", ((20, 4.5), (21, 4.5), (21, 6), (20, 6)))
        told = reviewed(program, place="lobby", zones=(zone,)).risks
    else:
        told = reviewed(program, zones=(CORRIDOR,)).risks
    assert [risk.kind for risk in told] == ["zone", "unproven"]
    assert "is in the way" in told[0].text


def test_a_robot_that_stands_in_a_zone_drives_out_of_it() -> None:
    told = reviewed('robot.goto("lobby")', place="pharmacy", zones=(PHARMACY,)).risks
    assert [risk.kind for risk in told] == ["zone"]
    assert "stands in the keep-out zone" in told[0].text


# --- how it drives -------------------------------------------------------------------------------


def test_faster_than_people_walk_is_fast() -> None:
    assert found("robot.drive(1.5, 0, 1)") == [(1, "speed")]
    assert found("robot.drive(linear=-1.5, angular=0, seconds=1)") == [(1, "speed")]
    assert found("robot.drive(0.8, 0, 1)") == []


def test_driving_past_somebody_without_steering_is_marked() -> None:
    simulation = Simulation(HOSPITAL)
    tom = next(h for h in simulation._hospital.people if h.name == "Tom")
    x, y = tom.position
    simulation.localize(x - 2.0, y + 0.7, 0)
    knowledge = Knowledge(HOSPITAL, simulated(simulation).capabilities())
    told = review("robot.move(3)", knowledge, simulation.copy()).risks
    assert [(risk.line, risk.kind) for risk in told] == [(1, "speed")]
    assert "Tom" in told[0].text


# --- how it speaks, and to whom ------------------------------------------------------------------


def test_what_is_loud_at_night_is_marked_where_it_gets_loud() -> None:
    loud = 'robot.set_volume(90)\nrobot.say("Hello")\n'
    assert found(loud, clock=MORNING) == []
    told = reviewed(loud, clock=NIGHT).risks
    assert [(risk.line, risk.kind) for risk in told] == [(1, "volume")]
    assert "22:3" in told[0].text and "90 %" in told[0].text


def test_speaking_at_night_as_loud_as_by_day_is_marked_once() -> None:
    assert found('robot.wait(1)\nrobot.say("A")\nrobot.say("B")', clock=NIGHT) == [(2, "volume")]
    assert found('robot.set_volume(30)\nrobot.say("A")', clock=NIGHT) == []


def test_it_gets_night_while_the_program_waits() -> None:
    program = 'robot.say("A")\nrobot.wait(600)\nrobot.say("B")'
    evening = datetime(2026, 3, 2, 21, 55)
    told = patiently(program, evening)
    assert [(risk.line, risk.kind) for risk in told] == [(2, "long"), (3, "volume")]


@pytest.mark.parametrize("person", ["Mr Smith", "Peter"])
def test_a_name_that_nobody_here_has_is_marked(person) -> None:
    program = f'if robot.sees("cup"):\n    robot.give("cup", person="{person}")\n'
    told = reviewed(program).risks
    assert [(risk.line, risk.kind) for risk in told] == [(2, "person")]
    assert person in told[0].text


@pytest.mark.parametrize("person", ["Alice", "nurse", "man waving", "Alice sitting", "person"])
def test_who_is_known_or_is_no_name_is_not_marked(person) -> None:
    assert found(f'if robot.sees("cup"):\n    robot.follow("{person}")\n') == []


# --- how long it takes ---------------------------------------------------------------------------


def test_a_long_program_is_marked_where_it_takes_long() -> None:
    told = patiently('robot.say("A")\nrobot.wait(600)\nrobot.say("B")')
    assert [(risk.line, risk.kind) for risk in told] == [(2, "long")]
    assert "10 minutes" in told[0].text
    assert found("robot.wait(60)") == []


@pytest.mark.parametrize(
    ("loop", "ends"),
    [
        ("while True:\n    robot.wait(9)", False),
        ("while 1:\n    for i in range(3):\n        break\n    robot.wait(9)", False),
        ("while True:\n    while robot.battery() > 200:\n        break\n    robot.wait(9)", False),
        ("while True:\n    if robot.battery() > 1:\n        break", True),
        ("while True:\n    for i in range(3):\n        pass\n    else:\n        break", True),
        ("while True:\n    try:\n        robot.wait(1)\n    finally:\n        break", True),
        ("while True:\n    robot.stop()", True),
        ("while robot.battery() < 1:\n    robot.wait(1)", True),
        ("while False:\n    robot.wait(1)", True),
    ],
)
def test_a_loop_that_nothing_ends_is_endless(loop, ends) -> None:
    told = risks(loop, Knowledge(HOSPITAL))
    assert [(risk.line, risk.kind) for risk in told] == ([] if ends else [(1, "endless")])


def test_an_endless_loop_is_not_called_long_as_well() -> None:
    told = found('while True:\n    robot.goto("lobby")\n    robot.goto("pharmacy")')
    assert [kind for _, kind in told] == ["endless"]


@pytest.mark.parametrize(
    ("program", "words"),
    [
        ('robot.say("A")\nrobot.grab("unicorn")', "went no further than this line"),
        ('robot.say("A")\nrobot.wait_for("unicorn")\nrobot.say("B")', "after 10 minutes"),
        ('print("A")\nwhile robot.battery() > 1:\n    robot.battery()', "after 1001 commands"),
        ("print(1)\nwhile True:\n    pass", "computed on and on"),
    ],
)
def test_where_nobody_has_seen_how_it_ends_is_a_risk_in_itself(program, words) -> None:
    told = reviewed(program)
    assert not told.came_through
    assert [words in risk.text for risk in told.risks if risk.kind == "unproven"] == [True]


@pytest.mark.parametrize(
    ("language", "words"),
    [
        ("en", "did not come within 10 minutes"),
        ("de", "kam 10 Minuten Roboterzeit lang nicht"),
        ("fr", "n'est pas venu en 10 minutes"),
    ],
)
def test_a_reception_came_through_and_says_if_nobody_came(language, words) -> None:
    welcome = 'while True:\n    robot.wait_for("{}")\n    robot.say("Welcome!")'
    told = reviewed(welcome.format("person"))
    assert told.came_through and told.dry_run.goes_on
    assert [risk.kind for risk in told.risks] == ["endless"]
    told = reviewed(welcome.format("unicorn"), language=language)
    assert told.came_through
    assert [risk.kind for risk in told.risks] == ["endless", "unproven"]
    assert words in told.risks[1].text


def test_a_program_that_comes_to_its_end_has_no_such_risk() -> None:
    for program in ('robot.say("A")', 'robot.say("A")\nrobot.stop()\nrobot.grab("unicorn")'):
        told = reviewed(program)
        assert told.came_through and told.risks == ()


def test_what_the_robot_lacks_is_an_error_and_no_risk() -> None:
    told = reviewed('robot.goto("moon base")')
    assert not told.acceptable and told.risks == ()


# --- all of it -----------------------------------------------------------------------------------


def test_without_a_simulation_the_program_itself_is_looked_at() -> None:
    program = "robot.drive(1.5, 0, 1)\nrobot.wait(900)\nwhile True:\n    robot.wait(1)\n"
    told = risks(program, Knowledge(HOSPITAL))
    assert [(risk.line, risk.kind) for risk in told] == [(1, "speed"), (2, "long"), (3, "endless")]


@pytest.mark.parametrize(("language", "words"), [("de", "Sperrzone"), ("fr", "zone interdite")])
def test_risks_are_told_in_the_language_of_the_review(language, words) -> None:
    told = reviewed('robot.goto("pharmacy")', zones=(PHARMACY,), language=language).risks
    assert words in told[0].text
    assert {"de": "Apotheke", "fr": "pharmacie"}[language] in told[0].text


def test_all_languages_have_the_same_texts() -> None:
    texts = yaml.safe_load((PACKAGED / "risks.yaml").read_text(encoding="utf-8"))
    assert set(texts) == {"en", "de", "fr"}
    assert texts["en"].keys() == texts["de"].keys() == texts["fr"].keys()


def test_the_terminal_shows_them_on_their_lines(capsys) -> None:
    terminal = Terminal(Console(width=120, highlight=False), "de")
    terminal.show_review(reviewed("robot.drive(1.5, 0, 1)", language="de"))
    assert "Risiko, Zeile 1: 1.5 m/s ist schneller, als" in capsys.readouterr().out


def test_a_long_way_has_a_path_that_can_be_drawn() -> None:
    program = "for i in range(4):\n    robot.goto('pharmacy')\n    robot.goto('kitchen')\n"
    run = rehearse(program, Simulation(DESERTED))
    assert run.metres > 200
    assert 100 < len(run.path) <= MANY_POINTS
    assert all(len(point) == 2 for point in run.path)


@settings(max_examples=200, deadline=None)
@given(st.text(max_size=60) | st.text("robot.goto()while True:\n \"'1,x", max_size=60))
def test_nothing_that_is_written_breaks_it(text) -> None:
    risks(text, Knowledge(HOSPITAL))
