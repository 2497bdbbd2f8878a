"""What map_server writes is read as map_server reads it, and what is unknown stays unknown."""

from __future__ import annotations

import itertools
import tempfile
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from sim.hospital import chart_of
from sim.world.geometry import GridMap
from sim.world.loading import load_world
from sim.world.maps import cell_at, free_cells, middle_of, occupancy, occupied_cells
from sim.world.model import World

Cells = npt.NDArray[np.int8]

cells_of_a_map = st.integers(1, 12).flatmap(
    lambda width: st.lists(
        st.lists(st.integers(-1, 100), min_size=width, max_size=width), min_size=1, max_size=9
    ).map(lambda rows: np.array(rows, np.int8))
)
thresholds = st.tuples(st.floats(0, 1), st.floats(0, 1)).map(sorted)


def saved(folder: Path, cells: Cells, mode: str, **fields: object) -> Path:
    """The files that Nav2's map_saver makes of these cells, whose first row is the lowest."""
    upside = cells[::-1]
    if mode == "trinary":
        grey = np.full(upside.shape, 205, np.uint8)
        grey[(upside >= 0) & (upside <= 25)] = 254
        grey[upside >= 65] = 0
        image = Image.fromarray(grey)
    elif mode == "scale":
        grey = np.rint((100 - upside.astype(float)) / 100 * 255).astype(np.uint8)
        grey[upside < 0] = 127
        alpha = np.where(upside < 0, 0, 255).astype(np.uint8)
        image = Image.fromarray(np.dstack([grey, alpha]), "LA")
    else:
        image = Image.fromarray(np.where(upside < 0, 255, upside).astype(np.uint8))
    name = "floor.png" if mode == "scale" else "floor.pgm"
    image.save(folder / name)
    values = {
        "image": name,
        "mode": mode,
        "resolution": 0.05,
        "origin": [-1.5, 2.0, 0],
        "negate": 0,
        "occupied_thresh": 0.65,
        "free_thresh": 0.25,
        **fields,
    }
    file = folder / "floor.yaml"
    file.write_text("".join(f"{field}: {value}\n" for field, value in values.items()))
    return file


def read(file: Path) -> GridMap:
    grid = load_world(file).map
    assert grid is not None
    return grid


@given(cells_of_a_map, st.sampled_from(["trinary", "scale", "raw"]), thresholds, st.booleans())
def test_the_unknown_is_unknown_in_every_mode_whatever_the_thresholds(
    cells: Cells, mode: str, thresholds: list[float], deep: bool
) -> None:
    free, occupied = thresholds
    with tempfile.TemporaryDirectory() as folder:
        file = saved(Path(folder), cells, mode, free_thresh=free, occupied_thresh=occupied)
        if deep and mode != "scale":
            with Image.open(Path(folder) / "floor.pgm") as image:
                values = np.asarray(image).astype(np.uint16) * 257
            Image.fromarray(values).save(Path(folder) / "floor.png")
            file.write_text(file.read_text().replace("floor.pgm", "floor.png"))
        grid = read(file)
        unknown = cells < 0 if mode != "trinary" else (cells < 0) | ((cells > 25) & (cells < 65))
        assert (occupancy(grid)[unknown] == -1).all()
        assert not free_cells(grid)[unknown].any()
        assert not (free_cells(grid) & occupied_cells(grid)).any()


@given(cells_of_a_map)
def test_what_map_saver_writes_is_what_map_server_publishes(cells: Cells) -> None:
    with tempfile.TemporaryDirectory() as folder:
        trinary = np.where((cells >= 0) & (cells <= 25), 0, np.where(cells >= 65, 100, -1))
        assert (occupancy(read(saved(Path(folder), cells, "trinary"))) == trinary).all()
        assert (occupancy(read(saved(Path(folder), cells, "raw"))) == cells).all()
        file = saved(Path(folder), cells, "scale", free_thresh=0, occupied_thresh=1)
        assert abs(occupancy(read(file)).astype(int) - cells).max() <= 1, "grey has 256 steps"


@given(cells_of_a_map)
def test_negate_turns_the_grey_round_and_nothing_else(cells: Cells) -> None:
    with tempfile.TemporaryDirectory() as folder:
        file = saved(Path(folder), cells, "trinary")
        expected = occupancy(read(file))
        path = Path(folder) / "floor.pgm"
        with Image.open(path) as image:
            turned = 255 - np.asarray(image)
        Image.fromarray(turned).save(path)
        file.write_text(file.read_text().replace("negate: 0", "negate: 1"))
        assert (occupancy(read(file)) == expected).all()


@pytest.mark.parametrize("mode", ["trinary", "scale", "raw"])
def test_what_is_transparent_is_unknown(tmp_path: Path, mode: str) -> None:
    file = saved(tmp_path, np.zeros((3, 4), np.int8), mode)
    white = np.full((3, 4, 4), 0 if mode == "raw" else 255, np.uint8)
    white[..., 3] = 255
    white[0, 0, 3] = 254
    white[2, 3, 3] = 0
    Image.fromarray(white).save(tmp_path / "clear.png")
    text = file.read_text().splitlines()[1:]
    file.write_text("\n".join(["image: clear.png", *text]))
    unknown = occupancy(read(file)) == -1
    assert unknown.sum() == 2 and unknown[2, 0] and unknown[0, 3], "the first row is the lowest"


@pytest.mark.parametrize(
    ("head", "deep"),
    [
        ("P5\n# CREATOR: map_saver.cpp 0.050 m/pix\n3 2\n255\n", False),
        ("P5 3 2 255\n", False),
        ("P5\n3 # wide\n2\n# high\n255\n", False),
        ("P5\n3 2\n65535\n", True),
        ("P2\n# by hand\n3 2\n255\n", False),
        ("P2\n3 2\n# deep\n65535\n", True),
    ],
)
def test_every_sort_of_pgm(tmp_path: Path, head: str, deep: bool) -> None:
    values = [254, 0, 205, 205, 254, 0]
    if deep:
        values = [257 * value for value in values]
    if head.startswith("P2"):
        pixels = " ".join(map(str, values)).encode()
    else:
        pixels = b"".join(value.to_bytes(2 if deep else 1, "big") for value in values)
    file = saved(tmp_path, np.zeros((2, 3), np.int8), "trinary")
    (tmp_path / "floor.pgm").write_bytes(head.encode() + pixels)
    assert occupancy(read(file)).tolist() == [[-1, 0, 100], [0, 100, -1]]


def test_a_picture_of_no_whole_numbers_is_refused(tmp_path: Path) -> None:
    file = saved(tmp_path, np.zeros((2, 2), np.int8), "trinary")
    pixels = np.array([[np.nan, 1], [0, np.inf]], "<f4").tobytes()
    (tmp_path / "floor.pgm").write_bytes(b"Pf\n2 2\n-1.0\n" + pixels)
    with pytest.raises(ValueError, match="no PGM or PNG"):
        read_or_why(file)


def read_or_why(file: Path) -> GridMap:
    from sim.world.model import WorldError

    try:
        return read(file)
    except WorldError as error:
        raise ValueError(str(error)) from None


# --- where it lies -------------------------------------------------------------------------------


@given(
    st.floats(-900, 900),
    st.floats(-900, 900),
    st.floats(-720, 720),
    st.floats(0.01, 1),
    st.integers(0, 99),
    st.integers(0, 49),
)
def test_a_cell_and_its_spot_belong_together_however_the_map_is_turned(
    x: float, y: float, degrees: float, resolution: float, column: int, row: int
) -> None:
    grid = GridMap(image="", resolution=resolution, origin=(x, y, degrees), size=(100, 50))
    assert cell_at(grid, *middle_of(grid, column, row)) == (column, row)
    assert cell_at(grid, *middle_of(grid, -2, row)) is None
    assert cell_at(grid, *middle_of(grid, column, 51)) is None


BLOCK = 12
"""Pixels of a block: more than straightening takes away."""


@given(
    st.lists(st.lists(st.booleans(), min_size=4, max_size=4), min_size=3, max_size=3),
    st.floats(-180, 180),
    st.floats(-50, 50),
)
def test_floor_and_walls_are_where_the_turned_map_has_them(
    free: list[list[bool]], degrees: float, x: float
) -> None:
    blocks = np.kron(np.array(free), np.ones((BLOCK, BLOCK), bool))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "floor.pgm"
        Image.fromarray(np.where(blocks[::-1], 254, 0).astype(np.uint8)).save(path)
        size = (blocks.shape[1], blocks.shape[0])
        grid = GridMap(image=str(path), resolution=0.1, origin=(x, 7.0, degrees), size=size)
        chart = chart_of(World(name="turned", map=grid))
        for row, column in itertools.product(range(3), range(4)):
            spot = middle_of(grid, column * BLOCK + BLOCK // 2, row * BLOCK + BLOCK // 2)
            assert chart.is_floor(*spot) == chart.fits(*spot) == free[row][column]
            for beside, ahead in ((row, column + 1), (row + 1, column)):
                if beside == 3 or ahead == 4:
                    continue
                other = middle_of(grid, ahead * BLOCK + BLOCK // 2, beside * BLOCK + BLOCK // 2)
                both = free[row][column] and free[beside][ahead]
                assert chart.in_sight(spot, other) == (free[row][column] == free[beside][ahead])
                assert (chart.route(spot, other) is not None and chart.clear(spot, other)) == both
