"""The worlds in the docs are worlds, and the page tells every field that there is."""

from __future__ import annotations

import re
from pathlib import Path

from PIL import Image

from sim.pictures.drawing import png
from sim.world.loading import load_world
from sim.world.reader import _Reader

PAGE = (Path(__file__).parents[2] / "docs" / "worlds.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)


def test_the_examples_load_and_can_be_drawn(tmp_path: Path) -> None:
    assert len(EXAMPLES) == 3
    Image.new("L", (400, 300), 254).save(tmp_path / "floor.pgm")
    for number, text in enumerate(EXAMPLES):
        file = tmp_path / f"world{number}.yaml"
        file.write_text(text, encoding="utf-8")
        world = load_world(file)
        assert world.places
        png(world, None, tmp_path / "world.png")
    second = load_world(tmp_path / "world1.yaml")
    assert second.start == second.place("charger").pose  # type: ignore[union-attr]
    assert (second.furniture[1].pose.x, second.furniture[1].pose.y) == (4.8, 7.3)  # type: ignore[union-attr]


def test_every_field_is_told() -> None:
    for what, fields in _Reader.FIELDS.items():
        for field in fields.split():
            assert re.search(rf"[`{{\s]{field}[`:]", PAGE), f"{field} of {what}"
