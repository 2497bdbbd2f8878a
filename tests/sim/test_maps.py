"""Maps that ROS's map_server wrote become walls a robot can be simulated between."""

from __future__ import annotations

import math
import threading
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from PIL import Image

from sim.errors import Blocked, NotPossible
from sim.hospital import chart_of
from sim.pictures.drawing import svg
from sim.simulation import Simulation
from sim.world.geometry import polygon_area
from sim.world.loading import load_world
from sim.world.maps import outlines, painted
from sim.world.model import WorldError

Grey = npt.NDArray[np.uint8]
FREE, WALL, UNKNOWN = 254, 0, 205


def room() -> Grey:
    """A room of 8 x 4 m at 5 cm a pixel, with a pillar of 0.5 m, in unknown surroundings."""
    cells = np.full((120, 200), UNKNOWN, np.uint8)
    cells[20:100, 20:180] = WALL
    cells[22:98, 22:178] = FREE
    cells[60:70, 100:110] = WALL
    return cells


def write(folder: Path, cells: Grey, name: str = "floor.pgm", **fields: object) -> Path:
    Image.fromarray(cells).save(folder / name)
    values = {
        "image": name,
        "resolution": 0.05,
        "origin": [-5.0, -3.0, 0.0],
        "negate": 0,
        "occupied_thresh": 0.65,
        "free_thresh": 0.196,
        **fields,
    }
    file = folder / "map.yaml"
    file.write_text("".join(f"{field}: {value}\n" for field, value in values.items()))
    return file


def test_a_room_becomes_its_four_walls_and_its_pillar(tmp_path: Path) -> None:
    world = load_world(write(tmp_path, room()))
    assert world.bounds == pytest.approx((-5, -3, 5, 3))
    assert world.map is not None
    floor, pillar = sorted(outlines(world.map), key=polygon_area, reverse=True)
    assert len(world.walls) == 8
    assert set(floor) == {(-3.9, -1.9), (-3.9, 1.9), (3.9, -1.9), (3.9, 1.9)}
    # Row 60 from the top is 3 m from the top edge, which is at y = 3.
    assert set(pillar) == {(0.0, -0.5), (0.0, 0.0), (0.5, -0.5), (0.5, 0.0)}


@pytest.mark.parametrize("kind", ["P2", "PNG", "colour", "16 bit"])
def test_other_images_say_the_same(tmp_path: Path, kind: str) -> None:
    cells = room()
    expected = load_world(write(tmp_path, cells)).walls
    file = write(tmp_path, cells, "floor.png")
    if kind == "P2":
        rows = "\n".join(" ".join(str(value) for value in row) for row in cells)
        (tmp_path / "plain.pgm").write_text(f"P2\n# by hand\n200 120\n255\n{rows}\n")
        file.write_text(file.read_text().replace("floor.png", "plain.pgm"))
    elif kind == "colour":
        Image.fromarray(cells).convert("RGBA").save(tmp_path / "floor.png")
    elif kind == "16 bit":
        Image.fromarray(cells.astype(np.uint16) * 257).save(tmp_path / "floor.png")
    assert load_world(file).walls == expected


def test_negate_turns_black_and_white_round(tmp_path: Path) -> None:
    expected = load_world(write(tmp_path, room())).walls
    assert load_world(write(tmp_path, 255 - room(), negate=1)).walls == expected


def test_what_nobody_measured_is_no_way(tmp_path: Path) -> None:
    cells = room()
    cells[40:50, 40:50] = UNKNOWN
    world = load_world(write(tmp_path, cells))
    assert len(world.walls) == 12
    # ROS 2 writes the unknown as 205 and a threshold beside it that would make it free.
    for free_thresh in (0.25, 0.5):
        again = load_world(write(tmp_path, cells, free_thresh=free_thresh))
        assert again.walls == world.walls


def test_slanted_walls_are_a_few_segments(tmp_path: Path) -> None:
    rows, columns = np.mgrid[:120, :200]
    cells = room()
    cells[(abs(rows - 2 * columns / 3 + 10) < 2) & (columns > 60) & (columns < 90)] = WALL
    assert len(load_world(write(tmp_path, cells)).walls) < 20


def test_a_table_leg_of_one_pixel_stays_an_obstacle(tmp_path: Path) -> None:
    cells = room()
    cells[40, 40] = WALL
    assert len(load_world(write(tmp_path, cells)).walls) == 12


def test_a_turned_map(tmp_path: Path) -> None:
    world = load_world(write(tmp_path, room(), origin=[1.0, 0.0, round(math.pi / 2, 6)]))
    assert world.bounds == pytest.approx((-5, 0, 1, 10), abs=1e-3)
    assert min(x for x, *_ in world.walls) == pytest.approx(-5 + 1.1, abs=1e-3)


def test_where_the_robot_starts_on_a_bare_map(tmp_path: Path) -> None:
    at_zero = load_world(write(tmp_path, room(), origin=[-2.0, -3.0, 0.0])).start
    assert at_zero is not None
    assert (at_zero.x, at_zero.y) == (0, 0), "where mapping began"
    roomy = load_world(write(tmp_path, room(), origin=[100.0, 0.0, 0.0]))
    assert roomy.start is not None
    assert 101.1 < roomy.start.x < 108.9
    nowhere = load_world(write(tmp_path, np.zeros((10, 10), np.uint8)))
    assert nowhere.start is None
    assert nowhere.walls == ()


def test_a_world_on_a_map(tmp_path: Path) -> None:
    write(tmp_path, room())
    file = tmp_path / "world.yaml"
    for reference in (
        "map.yaml",
        "{image: floor.pgm, resolution: 0.05, origin: [-5, -3, 0]}",
    ):
        file.write_text(
            f"name: on a map\nmap: {reference}\nunits: cm\n"
            "places: [{name: ward, pose: [200, -100, 90]}]\n"
        )
        world = load_world(file)
        assert len(world.walls) == 8, "the map is in metres whatever the world's unit"
        assert world.start is not None
        assert (world.start.x, world.start.y) == (2.0, -1.0)


def test_a_pose_off_the_map_is_refused(tmp_path: Path) -> None:
    write(tmp_path, room())
    file = tmp_path / "world.yaml"
    file.write_text("map: map.yaml\nplaces: [{name: ward, pose: [50, 0]}]\n")
    with pytest.raises(WorldError, match="outside the map"):
        load_world(file)


def test_a_pose_beside_a_turned_map_is_refused(tmp_path: Path) -> None:
    write(tmp_path, room(), origin=[0, 0, math.pi / 4])
    file = tmp_path / "world.yaml"
    file.write_text("map: map.yaml\nplaces: [{name: ward, pose: [0.5, 6]}]\n")
    assert load_world(file).place("ward")
    file.write_text("map: map.yaml\nplaces: [{name: ward, pose: [6, 1]}]\n")
    with pytest.raises(WorldError, match=r"world.yaml:2: .*outside the map"):
        load_world(file)


def test_the_unknown_and_walls_are_drawn_as_what_they_are(tmp_path: Path) -> None:
    cells = room()
    cells[40:50, 40:50] = UNKNOWN
    world = load_world(write(tmp_path, cells, free_thresh=0.25))
    assert world.map is not None
    assert [what for what, _ in painted(world.map)] == [
        *("unknown", "occupied", "unknown", "free"),  # all, the walls, what they stand around
        *("unknown", "unknown", "occupied"),  # what is unknown in the room; the pillar
    ]
    drawing = svg(world, Simulation(world).record)
    assert "<title>unknown</title>" in drawing and "<title>occupied</title>" in drawing


@pytest.mark.parametrize(
    ("content", "part"),
    [
        (None, "cannot be read"),
        (b"", "no PGM or PNG"),
        (b"P5\n200 120\n255\nabc", "cut short"),
        (b"P5\n99999 1\n255\n" + b"\0" * 99999, "more than 8192"),
        (b"P5\n0 0\n255\n", "no pixels"),
        (b"P2\n3 3\n255\n1 2", "no PGM or PNG"),
        (b"\x89PNG\r\n\x1a\nnonsense", "no PGM or PNG"),
        (b"hello", "no PGM or PNG"),
    ],
)
def test_a_broken_image_is_refused_in_words(
    tmp_path: Path, content: bytes | None, part: str
) -> None:
    file = write(tmp_path, room())
    (tmp_path / "floor.pgm").unlink()
    if content is not None:
        (tmp_path / "floor.pgm").write_bytes(content)
    with pytest.raises(WorldError, match=part) as caught:
        load_world(file)
    assert caught.value.problems[0].line == 1


def test_a_wrong_field_of_a_map_is_told(tmp_path: Path) -> None:
    with pytest.raises(WorldError, match=r"map.yaml:2: .*resolution.*should be a number"):
        load_world(write(tmp_path, room(), resolution="fine"))
    for field, value, told in (
        ("mode", "binary", r"map.yaml:7: .*should be .trinary., .scale. or .raw."),
        ("resolution", "nan", r"map.yaml:2: .*resolution.*should be a number"),
        ("resolution", "inf", r"map.yaml:2: .*resolution.*from 0.001 to 10"),
        ("resolution", 10, r"map.yaml:2: .*2000 metres wide"),
        ("origin", "[0, .nan, 0]", r"map.yaml:3: .*origin.*should be a number"),
        ("origin", "[0, 0, nan]", r"map.yaml:3: .*origin.*should be a number"),
        ("origin", "[0, 0, 1, 2]", r"map.yaml:3: .*origin.*\[x, y, radians\]"),
        ("free_thresh", 0.7, r"map.yaml:6: free_thresh is 0.7 and .*swapped"),
        ("occupied_thresh", 0.1, r"map.yaml:6: .*occupied_thresh 0.1.*swapped"),
        ("free_thresh", "nan", r"map.yaml:6: .*should be a number"),
        ("negate", 2, r"map.yaml:4: .*true or false"),
    ):
        with pytest.raises(WorldError, match=told):
            load_world(write(tmp_path, room(), **{field: value}))


def test_what_is_wrong_in_the_maps_own_file_is_told_with_its_line(tmp_path: Path) -> None:
    write(tmp_path, room(), free_thresh=0.9)
    file = tmp_path / "world.yaml"
    file.write_text("name: ours\nmap: map.yaml\n")
    with pytest.raises(WorldError, match=r"world.yaml:2: The map map.yaml, line 6: .*swapped"):
        load_world(file)
    file.write_text("name: ours\nmap: gone.yaml\n")
    with pytest.raises(WorldError, match=r"world.yaml:2: The map gone.yaml is not there"):
        load_world(file)


@pytest.mark.parametrize(
    "elsewhere", ["/home/turtle/maps/floor.pgm", "../maps/floor.pgm", r"C:\maps\floor.pgm"]
)
def test_the_image_of_a_map_from_another_machine_lies_beside_it(
    tmp_path: Path, elsewhere: str
) -> None:
    file = write(tmp_path, room())
    expected = load_world(file).walls
    file.write_text(file.read_text().replace("image: floor.pgm", f"image: {elsewhere}"))
    assert load_world(file).walls == expected
    (tmp_path / "floor.pgm").unlink()
    with pytest.raises(WorldError, match=r"cannot be read.*or put it into that folder"):
        load_world(file)


def test_the_robot_does_not_drive_in_what_nobody_measured(tmp_path: Path) -> None:
    simulation = Simulation(load_world(write(tmp_path, room(), free_thresh=0.25)))
    outside = (-4.5, 0.0)
    with pytest.raises(NotPossible, match="no room"):
        simulation.localize(*outside, 0)
    with pytest.raises((NotPossible, Blocked)):
        simulation.run(simulation.drive_to(*outside), threading.Event())
    file = tmp_path / "world.yaml"
    file.write_text("name: ours\nmap: map.yaml\nrobot: {start: [-4.5, 0]}\n")
    with pytest.raises(NotPossible, match="the map shows no floor"):
        Simulation(load_world(file))


def test_walls_drawn_beside_a_map_stand_around_floor_as_well(tmp_path: Path) -> None:
    write(tmp_path, room())
    file = tmp_path / "world.yaml"
    file.write_text("name: ours\nmap: map.yaml\nwalls: [[6, 0, 9, 0, 9, 3, 6, 3, 6, 0]]\n")
    chart = chart_of(load_world(file))
    assert chart.is_floor(7, 1) and chart.is_floor(-1, 1)
    assert not chart.is_floor(-4.5, 0), "what the map does not know"


def test_a_map_full_of_specks_is_driven_in(tmp_path: Path) -> None:
    cells = np.full((600, 600), FREE, np.uint8)
    cells[[0, -1]] = cells[:, [0, -1]] = WALL
    spots = np.random.default_rng(1).integers(20, 580, (120, 2))
    for row, column in spots:
        cells[row : row + 2, column : column + 2] = WALL
    world = load_world(write(tmp_path, cells))
    assert len(world.walls) > 400
    x1, y1, x2, y2 = world.bounds
    start, goal = (x1 + 0.6, y1 + 0.6), (x2 - 0.6, y2 - 0.6)
    route = chart_of(world).route(start, goal)
    assert route is not None
    # Specks are driven around; they do not make the way much longer.
    assert math.dist(start, goal) < route.length < 1.1 * math.dist(start, goal)


def test_a_map_of_nothing_but_specks_is_refused_in_words(tmp_path: Path) -> None:
    noise = np.random.default_rng(1).integers(0, 2, (400, 400), np.uint8) * np.uint8(FREE)
    world = load_world(write(tmp_path, noise))
    with pytest.raises(NotPossible, match="too many specks"):
        Simulation(world)
