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


HEADS = {
    "a world": "the world",
    "the robot": "robot",
    "the clock": "clock",
    "a place": "places",
    "a person": "people",
    "an object": "objects",
    "a piece of furniture": "furniture",
    "a door": "doors",
    "a contact": "contacts",
    "a question": "questions",
    "a zone": "zones",
}
"""Under which head of the table the fields of each sort of thing stand."""


def table() -> dict[str, set[str]]:
    """The fields under each head: those of a row's first cell, and of the head's own row."""
    found: dict[str, set[str]] = {}
    told: set[str] = set()
    reference = PAGE.partition("## Everything a world may say")[2].partition("\n## ")[0]
    for first, second in re.findall(r"^\| (.*?) \| (.*)\|$", reference, re.M):
        cell = first
        if head := re.fullmatch(r"\*\*(.*)\*\*", first):
            told = found[head[1]] = set()
            cell = second
        told |= set(re.findall(r"`(\w+)`", cell))
    return found


def test_every_field_is_told_and_no_other() -> None:
    told = table()
    assert set(told) == set(HEADS.values())
    for what, head in HEADS.items():
        fields = set(_Reader.FIELDS[what].split())
        assert told[head] <= fields, f"{head}: {told[head] - fields}"
        # What has a head of its own is told there, and of names the page speaks above the table.
        missing = fields - told[head] - {"name"} - (set(told) if what == "a world" else set())
        assert not missing, f"{head}: {missing}"


def test_the_fields_of_a_map_are_told() -> None:
    example = PAGE.partition("## Maps from ROS")[2].partition("```yaml")[2].partition("```")[0]
    for field in _Reader.FIELDS["a map"].split():
        assert f"{field}: " in example
    assert set(_Reader.FIELDS) == {*HEADS, "a map"}
