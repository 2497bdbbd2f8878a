"""A house that lists its rooms, and not who works in them: whoever has a room is known by it."""

from __future__ import annotations

from pathlib import Path

import pytest

from nl2robot.knowledge import Knowledge
from nl2robot.translate.translation import translate
from sim.world.loading import load_world

ROOMS = """
name: office floor
places:
  - {name: reception, kind: reception}
  - {name: "Arthur's office", kind: office, aliases: {de: [Büro von Arthur], fr: [bureau d'Arthur]}}
  - {name: "Dr. Weber's office", kind: office}
  - {name: "children's ward", kind: ward}
  - {name: "visitors' lounge", kind: lounge}
robot: {start: reception}
"""


@pytest.fixture
def house(tmp_path: Path) -> Knowledge:
    file = tmp_path / "floor.yaml"
    file.write_text(ROOMS, encoding="utf-8")
    return Knowledge(load_world(file, names_only=True))


@pytest.mark.parametrize("language", ["en", "de", "fr"])
def test_only_people_own_rooms_by_name(house: Knowledge, language: str) -> None:
    owners = [person.name for person in house.lexicon(language).people]
    assert owners == ["Arthur", "Dr. Weber"]


@pytest.mark.parametrize(
    ("language", "sentence"),
    [
        ("en", "ask Arthur whether he has time"),
        ("en", "go to Arthur's office and ask him whether he has time"),
        ("de", "frag Arthur, ob er Zeit hat"),
        ("fr", "demande à Arthur s'il a le temps"),
    ],
)
def test_the_owner_of_a_room_can_be_asked(house: Knowledge, language: str, sentence: str) -> None:
    program = translate(sentence, house, language).program or ""
    assert 'person="Arthur"' in program


def test_who_has_no_room_is_unknown_still(house: Knowledge) -> None:
    refused = translate("ask Zorro whether he has time", house, "en")
    assert refused.program is None
    assert "Zorro" in refused.message


PATIENTS = """
name: small ward
places: [{name: reception, kind: reception}]
people: [{name: Eve Miller, kind: patient}, {name: Tom Miller}, {name: Dr. Weber}, {name: Weber}]
robot: {start: reception}
"""


@pytest.mark.parametrize(
    ("sentence", "person"),
    [
        ("tell Eve that lunch is ready", "Eve Miller"),
        ("tell Tom Miller that lunch is ready", "Tom Miller"),
        ("tell Dr Weber that lunch is ready", "Dr. Weber"),
        ("tell Weber that lunch is ready", "Weber"),
    ],
)
def test_a_part_of_a_name_is_enough_where_nobody_else_has_it(
    tmp_path: Path, sentence: str, person: str
) -> None:
    file = tmp_path / "ward.yaml"
    file.write_text(PATIENTS, encoding="utf-8")
    program = translate(sentence, Knowledge(load_world(file, names_only=True)), "en").program
    assert f'robot.find("{person}")' in (program or "")


def test_two_of_the_same_name_are_asked_about(tmp_path: Path) -> None:
    file = tmp_path / "ward.yaml"
    file.write_text(PATIENTS, encoding="utf-8")
    ward = Knowledge(load_world(file, names_only=True))
    asked = translate("tell Mrs Miller that lunch is ready", ward, "en")
    assert asked.program is None
    assert "Eve Miller or Tom Miller?" in asked.message
