"""docs/robots/pepper.md is true."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

from robot_api.robots.pepper import PEPPER
from robot_api.robots.reading import read_robot_file
from tests.robots.pepper.conftest import call

PAGE = Path(__file__).parents[3] / "docs" / "robots" / "pepper.md"


def test_its_robot_file_drives_a_pepper(
    standing_in: Callable[..., Any], drive: Callable[..., Any], tmp_path: Path
) -> None:
    [example] = re.findall("```yaml\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)
    file = tmp_path / "pepper.yaml"
    file.write_text(example, "utf-8")
    read = read_robot_file(file, PEPPER)
    pepper = standing_in(hurry=1.0)
    driver = drive(pepper, file=read.file, settings=read.settings)
    driver.hold(read.file)
    has = driver.capabilities()
    assert has.name == "Pia"
    assert has.joints["HeadYaw"] == (-60, 60)
    assert has.limits == {"speed": 0.35, "turn_rate": 60, "acceleration": 0.3, "volume": 70}
    call(driver, "gesture", name="dance")
    call(driver, "emotion", name="proud")
    call(driver, "set_volume", percent=100)
    assert pepper.volume == 70
    call(driver, "goto", x=0.3, y=0)


def test_its_table_names_what_pepper_has_and_lacks(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    from robot_api.capabilities.sound import Sound
    from robot_api.methods import CAPABILITIES, METHODS

    rows = dict(re.findall(r"^\| (\w+) +\| (works|lacks) ", PAGE.read_text("utf-8"), re.MULTILINE))
    driver = drive(standing_in(), sound=Sound(ears_at=lambda _: object()))
    offered = {METHODS[name].capability for name in driver.capabilities().methods}
    assert offered <= rows.keys() <= {*CAPABILITIES}  # others have come since that it lacks
    assert rows == {name: "works" if name in offered else "lacks" for name in rows}
