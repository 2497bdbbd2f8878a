"""A keep-out mask becomes zones that cover all of it, and little more."""

from __future__ import annotations

import math
import tempfile
import threading
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from sim.errors import Blocked, NotPossible
from sim.simulation import Simulation
from sim.world.geometry import GridMap, Polygon, contains
from sim.world.loading import load_world
from sim.world.maps import free_cells, middle_of, occupied_cells, to_metres
from sim.world.masks import masked_areas, tolerance
from sim.world.model import WorldError
from sim.world.zones import distance_to, trouble_with

Cells = npt.NDArray[np.bool_]


def mask(folder: Path, cells: Cells, resolution: float = 0.05, degrees: float = 0.0) -> GridMap:
    """A mask of these cells, whose first row is the lowest."""
    path = folder / "mask.pgm"
    Image.fromarray(np.where(cells[::-1], 0, 254).astype(np.uint8)).save(path)
    return GridMap(
        image=str(path),
        resolution=resolution,
        origin=(-1.0, 2.0, degrees),
        size=(cells.shape[1], cells.shape[0]),
    )


def check(grid: GridMap, cells: Cells) -> tuple[Polygon, ...]:
    masked_areas.cache_clear()  # every mask of a test lies in the same file
    areas = masked_areas(grid)
    assert [trouble_with(area) for area in areas] == [None] * len(areas)
    if not cells.any():
        assert areas == ()
        return areas
    place = to_metres(grid)
    squares = [
        shapely.Polygon([place(c, r), place(c + 1, r), place(c + 1, r + 1), place(c, r + 1)])
        for r, c in np.argwhere(cells)
    ]
    zones = np.array([shapely.Polygon(area) for area in areas], object)
    whole = np.zeros(len(squares), bool)
    for zone in zones:
        shapely.prepare(zone)
        whole |= shapely.covers(zone, squares)
    assert whole.all(), "every masked cell is in a zone"
    masked = shapely.union_all(squares)
    corners = shapely.points([corner for area in areas for corner in area])
    assert shapely.distance(corners, masked).max(initial=0) <= tolerance(grid)
    others = shapely.points([middle_of(grid, c, r) for r, c in np.argwhere(~cells)] or [(0, 0)])
    far = others[shapely.distance(others, masked) > tolerance(grid)]
    assert not shapely.intersects(shapely.union_all(zones), far).any(), "little else is in one"
    return areas


def noise(seed: int, size: int, coarse: int) -> Cells:
    dots = np.random.default_rng(seed).random((size // coarse + 1, size // coarse + 3)) < 0.25
    return np.kron(dots, np.ones((coarse, coarse), bool))


@given(
    st.integers(0, 10_000),
    st.integers(2, 24),
    st.integers(1, 5),
    st.sampled_from([0.01, 0.05, 0.1, 0.5]),
    st.floats(-180, 180),
)
def test_zones_are_never_smaller_than_the_mask(
    seed: int, size: int, coarse: int, resolution: float, degrees: float
) -> None:
    cells = noise(seed, size, coarse)
    with tempfile.TemporaryDirectory() as folder:
        check(mask(Path(folder), cells, resolution, degrees), cells)


def test_a_room_that_is_masked_all_around_stays_free_inside(tmp_path: Path) -> None:
    cells = np.zeros((80, 120), bool)
    cells[10:70, 10:110] = True
    cells[16:64, 16:104] = False
    areas = check(mask(tmp_path, cells), cells)
    assert len(areas) == 2, "a ring is two zones"
    middle = middle_of(mask(tmp_path, cells), 60, 40)
    assert min(distance_to(area, *middle) for area in areas) > 0.8


def test_round_areas_have_few_corners_and_a_dot_is_large_enough(tmp_path: Path) -> None:
    rows, columns = np.mgrid[:100, :100]
    disc = np.hypot(rows - 50, columns - 50) < 40
    (area,) = check(mask(tmp_path, disc), disc)
    assert len(area) < 60
    dot = np.zeros((40, 40), bool)
    dot[20, 20] = True
    (area,) = check(mask(tmp_path, dot, 0.02), dot)
    assert len(area) == 4


def test_a_brush_stroke_of_many_turns_is_cut_into_sound_zones(tmp_path: Path) -> None:
    rows, columns = np.mgrid[:160, :160]
    far = np.hypot(rows - 80, columns - 80)
    spiral = ((far + np.arctan2(rows - 80, columns - 80) * 16 / math.tau) % 16 < 5) & (far < 75)
    assert len(check(mask(tmp_path, spiral), spiral)) > 5


def world(folder: Path, cells: Cells, keep_out: str = "mask.yaml", **fields: object) -> Path:
    """A hall of 10 x 5 m and a mask over it."""
    hall = np.full((100, 200), 254, np.uint8)
    hall[[0, -1]] = hall[:, [0, -1]] = 0
    Image.fromarray(hall).save(folder / "hall.pgm")
    mask(folder, cells)
    about = {"resolution": 0.05, "origin": [0, 0, 0], **fields}
    told = "".join(f"{name}: {value}\n" for name, value in about.items())
    (folder / "mask.yaml").write_text(f"image: mask.pgm\n{told}")
    file = folder / "world.yaml"
    file.write_text(
        "name: hall\nmap: {image: hall.pgm, resolution: 0.05, origin: [0, 0, 0]}\n"
        f"keep_out: {keep_out}\nrobot: {{start: [1, 2.5]}}\n"
        "places: [{name: desk, pose: [9, 2.5]}, {name: stairs, pose: [5, 2.5]}]\n"
    )
    return file


def test_the_robot_drives_around_what_is_masked(tmp_path: Path) -> None:
    cells = np.zeros((100, 200), bool)
    cells[0:70, 90:110] = True
    simulation = Simulation(load_world(world(tmp_path, cells)))
    assert [zone.name for zone in simulation.world.zones] == ["area 1"]
    stop = threading.Event()
    with pytest.raises((Blocked, NotPossible), match="keep-out zone"):
        simulation.run(simulation.drive_to(5, 2.5), stop)
    simulation.run(simulation.drive_to(9, 2.5), stop)
    masked = shapely.box(4.5, 0, 5.5, 3.5)
    way = [shapely.Point(sample.x, sample.y) for sample in simulation.record.samples]
    assert min(masked.distance(spot) for spot in way) > simulation.world.robot.radius


def test_in_a_mask_what_is_unknown_or_halfway_is_no_zone(tmp_path: Path) -> None:
    file = world(tmp_path, np.zeros((100, 200), bool))
    grey = np.full((100, 200), 254, np.uint8)
    grey[10:30, 10:30] = 205
    grey[50:60, 50:60] = 120
    Image.fromarray(grey).save(tmp_path / "mask.pgm")
    assert load_world(file).zones == ()


def test_a_mask_in_scale_mode_as_nav2s_own_example_has_it(tmp_path: Path) -> None:
    cells = np.zeros((100, 200), bool)
    cells[40:60, 50:60] = True
    fields = {"mode": "scale", "free_thresh": 0.0, "occupied_thresh": 1.0}
    file = world(tmp_path, cells, **fields)
    white = Image.open(tmp_path / "mask.pgm").point(lambda value: 255 if value else 0)
    white.save(tmp_path / "mask.pgm")
    (zone,) = load_world(file).zones
    assert contains(zone.polygon, 2.75, 2.5)


def test_bad_masks_are_told_with_their_line(tmp_path: Path) -> None:
    cells = np.zeros((100, 200), bool)
    file = world(tmp_path, cells, "gone.yaml")
    with pytest.raises(WorldError, match=r"world.yaml:3: The keep-out mask gone.yaml is not there"):
        load_world(file)
    file = world(tmp_path, cells, free_thresh=0.8)
    with pytest.raises(WorldError, match=r"world.yaml:3: The keep-out mask mask.yaml, line 4: "):
        load_world(file)
    cells[::4, ::4] = True
    with pytest.raises(WorldError, match=r"world.yaml:3: .*more than 200 separate areas"):
        load_world(world(tmp_path, cells))


def test_names_alone_need_no_mask(tmp_path: Path) -> None:
    file = world(tmp_path, np.zeros((100, 200), bool))
    (tmp_path / "mask.pgm").unlink()
    assert load_world(file, names_only=True).zones == ()


def test_a_mask_is_as_free_as_it_is_masked(tmp_path: Path) -> None:
    cells = noise(1, 30, 3)
    grid = mask(tmp_path, cells)
    assert (occupied_cells(grid) == cells).all() and (free_cells(grid) == ~cells).all()
