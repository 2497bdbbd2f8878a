"""Worlds as people write them: read as meant, or refused with every mistake on its line."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from sim.simulation import Simulation
from sim.world.builtin import builtin_worlds
from sim.world.checks import cut_doors, kind_of
from sim.world.loading import load_world
from sim.world.model import World, WorldError

SMALL = """\
name: demo
walls: [[0, 0, 10, 0, 10, 8, 0, 8, 0, 0], [0, 4, 10, 4]]
doors: [{at: ward a, from: [2, 4], to: [3.2, 4]}]
robot: {start: charger}
places:
  - {name: charger, pose: [1, 1, 180], area: [0, 0, 2, 2], in: corridor}
  - {name: corridor, pose: [5, 2], area: [0, 0, 10, 4], aliases: {de: [Flur, Gang], fr: couloir}}
  - {name: ward a, pose: [5, 6, 90], area: [[0, 4], [10, 4], [10, 8], [0, 8]], in: Corridor}
  - {name: alice’s office}
furniture:
  - {name: table, pose: [8, 7, 90], size: [1.2, 0.8]}
people:
  - {name: Alice, kind: nurse, at: Flur, is: [sitting], answers: [yes, no, 12:30]}
  - {name: Tom, pose: [5, 6]}
objects:
  - {name: cup, at: table, is: [red], code: 0042}
  - {name: cup, at: ward a, on: table}
"""


@pytest.fixture
def load(tmp_path: Path):  # type: ignore[no-untyped-def]
    def load_text(text: str | bytes) -> World:
        file = tmp_path / "demo.yaml"
        file.write_bytes(text if isinstance(text, bytes) else text.encode())
        return load_world(file)

    return load_text


@pytest.fixture
def problems(load):  # type: ignore[no-untyped-def]
    """The problems of a text, each as "line: message"."""

    def problems_of(text: str | bytes) -> list[str]:
        with pytest.raises(WorldError) as caught:
            load(text)
        return [f"{problem.line}: {problem.message}" for problem in caught.value.problems]

    return problems_of


# --- read as meant -------------------------------------------------------------------------------


def test_a_place_with_a_name_alone_serves_for_translation(load):  # type: ignore[no-untyped-def]
    world = load("places: [{name: alice's office}, {name: ward b}, {name: lift}]")
    assert [place.kind for place in world.places] == ["office", "ward", "lift"]
    assert not world.has_geometry
    assert world.start is None
    assert world.name == "demo"


def test_the_example_of_the_design_is_a_world(load):  # type: ignore[no-untyped-def]
    world = load(
        "name: city-hospital\nunits: m\nplaces:\n"
        "  - {name: pharmacy, kind: room, pose: [12.0, 3.5, 90], in: ground floor, "
        "aliases: {en: [drugstore], de: [Apotheke], fr: [pharmacie]}}\n"
        "  - {name: alice's office}\n  - {name: supply room}\n"
        'people:\n  - {name: Alice, kind: nurse, at: alice\'s office, answers: ["yes", "coffee"]}\n'
        "objects:\n  - {name: stapler, kind: tool, at: supply room, is: [red, small], "
        'code: "4006381333931"}\n'
    )
    assert world.has_geometry
    assert world.places[0].inside == "ground floor"
    assert world.people[0].answers == ("yes", "coffee")
    assert world.objects[0].code == "4006381333931"


def test_names_stay_what_they_look_like(load):  # type: ignore[no-untyped-def]
    world = load(SMALL)
    assert world.people[0].answers == ("yes", "no", "12:30")
    assert world.objects[0].code == "0042"


def test_its_clocks_show_what_the_file_says(load):  # type: ignore[no-untyped-def]
    daily = load(SMALL + 'clock: {start: "18:30", zone: Europe/Zurich}\n')
    opening = Simulation(daily).clock()
    assert f"{opening:%Y-%m-%d %H:%M %Z}" == "2026-03-02 18:30 CET"
    summer = load(SMALL + 'clock: {start: "2026-07-01 06:00", zone: Europe/Zurich}\n')
    assert f"{Simulation(summer).clock():%Y-%m-%d %H:%M %Z}" == "2026-07-01 06:00 CEST"
    assert f"{Simulation(load(SMALL)).clock():%H:%M %Z}" == "08:00 UTC"


def test_clocks_that_there_are_not_are_refused(problems):  # type: ignore[no-untyped-def]
    lines = SMALL.count("\n")
    assert problems(SMALL + "clock:\n  start: half past six\n  zone: Zürich\n") == [
        f'{lines + 2}: "half past six" is no time to start at. Write "08:00", or with the day'
        ' "2026-12-24 18:00", in quotes.',
        f'{lines + 3}: "Zürich" is no time zone. Write one such as "Europe/Zurich".',
    ]


def test_references_become_exact_names(load):  # type: ignore[no-untyped-def]
    world = load(SMALL)
    assert world.people[0].at == "corridor", "given by its German alias"
    assert world.people[1].at == "ward a", "told by the pose"
    assert (world.objects[0].at, world.objects[0].on) == ("ward a", "table")
    assert world.furniture[0].at == "ward a"
    assert world.place("COULOIR") is world.place("corridor")
    assert world.place("Alice's Office") is world.places[3], "whichever apostrophe"
    assert world.places[2].inside == "corridor"


def test_centimetres_become_metres(load):  # type: ignore[no-untyped-def]
    world = load(
        "units: cm\nwall_thickness: 10\nwalls: [[-900, -1300, 500, 300]]\n"
        "places: [{name: pharmacy, pose: [-605, -1027, -74.5]}]\n"
        "objects: [{name: box, size: [12, 8, 5]}]\n"
    )
    assert world.places[0].pose is not None
    assert (world.places[0].pose.x, world.places[0].pose.y) == (-6.05, -10.27)
    assert world.places[0].pose.theta == -74.5
    assert world.objects[0].size == (0.12, 0.08, 0.05)
    assert world.bounds == (-9.0, -13.0, 5.0, 3.0)
    assert world.units == "cm"


def test_where_a_point_is(load):  # type: ignore[no-untyped-def]
    world = load(SMALL)

    def at(x: float, y: float) -> str | None:
        place = world.place_at(x, y)
        return place.name if place else None

    assert at(5, 2) == "corridor"
    assert at(1, 1) == "charger", "the smaller of the two"
    assert at(5, 6) == "ward a"
    assert at(20, 20) is None


def test_doors_are_cut_out_of_walls(load):  # type: ignore[no-untyped-def]
    walls = load(SMALL).walls
    assert (0.0, 4.0, 2.0, 4.0) in walls
    assert (3.2, 4.0, 10.0, 4.0) in walls
    assert cut_doors([(0, 0, 0, 10)], [(0, 8, 0, 9), (0, 2, 0, 1), (5, 5, 6, 6)]) == (
        (0, 0, 0, 1),
        (0, 2, 0, 8),
        (0, 9, 0, 10),
    )
    assert cut_doors([(0, 0, 4, 0)], [(-1, 0, 5, 0)]) == (), "nothing is left of it"


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("alice's office", "office"),
        ("ward c", "ward"),
        ("room 101", "room"),
        ("Blood Lab", "lab"),
        ("42", "42"),
    ],
)
def test_the_end_of_a_name_tells_its_kind(name: str, kind: str) -> None:
    assert kind_of(name) == kind


# --- bad days ------------------------------------------------------------------------------------


def test_all_mistakes_are_told_at_once_each_on_its_line(problems):  # type: ignore[no-untyped-def]
    found = problems(
        "name: demo\n"
        "units: feet\n"
        "walls: [[0, 0, 10, 0, 10, 10, 0, 10, 0, 0], [1, 2, 3]]\n"
        "robot: {start: chager}\n"
        "places:\n"
        "  - {name: charger, pose: [1, 1]}\n"
        "  - {name: pharmacy, pose: [100, 100], knd: room, aliases: {en: [charger]}}\n"
        "  - {name: Charger}\n"
        "  - {kind: office}\n"
        "  - {name: lab, pose: [1, two]}\n"
        "people:\n"
        "  - {name: Bob, at: pharmcy, walks: [lab, nowhere at all]}\n"
        "  - {name: bob}\n"
        "objects:\n"
        "  - {name: cup, at: lab, on: tabel, weight: -3}\n"
        "furniture: [{name: table, at: lab}]\n"
        "doors: [{from: [2, 1], to: [3, 1]}]\n"
        "map: {image: nope.pgm, resolution: 0.05, origin: [0, 0, 0]}\n"
        "pepole: []\n"
    )
    for line, part in [
        (2, '"feet" is unknown. Use "m"'),
        (3, "It should be [x1, y1, x2, y2, ...]"),
        (4, '"chager", but there is no such place. Did you mean "charger"?'),
        (7, 'no field "knd". Did you mean "kind"?'),
        (7, '"charger" of the place "pharmacy" is also a name of the place'),
        (7, "outside the map"),
        (8, 'The place "Charger" is on line 6 already'),
        (9, "A place has no name"),
        (10, 'is "two". It should be a number'),
        (12, 'Did you mean "pharmacy"?'),
        (12, '"nowhere at all", but there is no such place'),
        (13, 'The person "bob" is on line 12 already'),
        (15, 'Did you mean "table"?'),
        (15, "from 0 to"),
        (17, "The door lies in no wall"),
        (18, "nope.pgm cannot be read"),
        (19, 'no field "pepole". Did you mean "people"?'),
    ]:
        assert any(told.startswith(f"{line}:") and part in told for told in found), (line, part)
    assert found == sorted(found, key=lambda told: int(told.split(":")[0]))


def test_a_mistake_reads_as_file_line_and_advice(load):  # type: ignore[no-untyped-def]
    with pytest.raises(WorldError) as caught:
        load("places:\n  - {name: lobby, colour: red}\n")
    assert str(caught.value).endswith(
        'demo.yaml:2: A place has no field "colour". '
        "The fields are: name, kind, pose, area, in, aliases."
    )


@pytest.mark.parametrize(
    ("text", "line", "part"),
    [
        ("places: [\n", 2, "not valid YAML"),
        ("name: x\n\tplaces: 3", 2, "not valid YAML"),
        ("", None, "empty"),
        ("- a\n", 1, "A world is a list"),
        ("name: a\n---\nname: b\n", 2, "second world"),
        ("[" * 100_000, 1, "nested too deep"),
        ("{a: " * 50_000, 1, "nested too deep"),
        ("- " * 50_000, 1, "nested too deep"),
        ("name: !!python/object/apply:os.system [ls]\n", 1, "has no meaning here"),
        ("name: *nothing\n", 1, "named nowhere"),
        ("name: [a\0b]", None, "not valid YAML"),
        (b"name: \xff\xfe", None, "UTF-8"),
        ("name: a\nname: b\n", 2, "here twice"),
        ("places: [{name: " + "x" * 300 + "}]", 1, "longer than 200"),
        ("places: [{name: a, pose: [1e9, 0]}]", 1, "from -1000 to 1000"),
        ("places: [{name: a, pose: [.nan, 0]}]", 1, "should be a number"),
        ("places: [{name: a, pose: [inf, 0]}]", 1, "from -1000 to 1000"),
        ("places: [" + "{name: a}," * 1001 + "]", 1, "more than 1000"),
        ("x" * 1_000_001, None, "larger than"),
        ("scale: 0\n", 1, "from 0.0001"),
        ("questions: [{ask: Hello?}]", 1, 'no "answer"'),
        ("places: [{name: a, aliases: {german: [b]}}]", 1, "no language code"),
        ("places: [{name: a, area: [0, 0, 0, 5]}]", 1, "no extent"),
        ("doors: [{from: [0, 0], to: [1, 0], open: maybe}]", 1, "true or false"),
        ("map: {image: a.pgm}", 1, 'no "resolution"'),
        ("map: gone.yaml", 1, "gone.yaml"),
    ],
)
def test_a_broken_file_is_refused_in_words(problems, text, line, part):  # type: ignore[no-untyped-def]
    found = problems(text)
    assert any(told.startswith(f"{line}: ") and part in told for told in found), found


def test_anchors_cannot_blow_a_file_up(problems):  # type: ignore[no-untyped-def]
    lists = "a0: &a0 [" + "x, " * 900 + "]\n"
    text = lists + "places:\n" + "  - {name: p, aliases: {en: *a0}}\n" * 500
    assert any("more than 200000 values" in told for told in problems(text))


def test_what_is_quoted_from_a_file_does_nothing_to_the_terminal(problems):  # type: ignore[no-untyped-def]
    (found,) = problems('units: "\\e[31m\\n"\n')
    assert found.isprintable()


def test_no_flood_of_problems(problems):  # type: ignore[no-untyped-def]
    found = problems("places:\n" + "  - {nam: x}\n" * 900)
    assert len(found) <= 51
    assert any("more problems than these" in told for told in found)


@pytest.mark.parametrize(
    ("name", "part"),
    [
        ("city-hospitl", 'Did you mean "city-hospital"?'),
        ("/no/such/world.yaml", "no such world"),
        ("a\0b", "cannot be read"),
        ("", "cannot be read"),
    ],
)
def test_a_world_that_is_not_there(name: str, part: str) -> None:
    with pytest.raises(WorldError, match=r".") as caught:
        load_world(name)
    assert part in str(caught.value)


def test_loading_needs_nothing_heavy() -> None:
    """`nl2robot translate` must start at once."""
    code = (
        "import sys; from sim.world.loading import load_world; load_world('city-hospital'); "
        "print([m for m in ('numpy', 'scipy', 'shapely', 'pymunk', 'PIL') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_the_builtin_worlds_are_these() -> None:
    assert builtin_worlds() == ["city-hospital", "household", "lab-tour", "ward"]


def test_translating_needs_only_the_names(tmp_path) -> None:
    file = tmp_path / "sketch.yaml"
    file.write_text(
        "name: sketch\n"
        "map: {image: not-drawn-yet.pgm, resolution: 0.05, origin: [0, 0, 0]}\n"
        "robot: {start: charger}\n"
        "places: [{name: pharmacy, pose: [12, 3, 90]}]\n"
        "people: [{name: Alice, at: her office}]\n"
        "objects: [{name: stapler, at: pharmacy, on: a shelf}]\n"
    )
    world = load_world(str(file), names_only=True)
    assert [place.name for place in world.places] == ["pharmacy"]
    assert [person.name for person in world.people] == ["Alice"]
    with pytest.raises(WorldError) as wrong:
        load_world(str(file))
    assert [problem.line for problem in wrong.value.problems] == [2, 3, 5, 6]


def test_a_misspelt_field_matters_even_for_the_names(tmp_path) -> None:
    file = tmp_path / "sketch.yaml"
    file.write_text("name: sketch\nplaces: [{name: pharmacy, colour: red}]\n")
    with pytest.raises(WorldError, match=r":2:.*colour"):
        load_world(str(file), names_only=True)
