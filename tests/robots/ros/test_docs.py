"""What docs/robots/ros.md says is so."""

from __future__ import annotations

import re
from pathlib import Path

from robot_api.robots.reading import read_robot_file
from robot_api.robots.ros import ROS1, ROS2
from robot_api.robots.ros.settings import RosSettings

PAGE = (Path(__file__).parents[3] / "docs" / "robots" / "ros.md").read_text(encoding="utf-8")


def test_its_robot_file_is_one(tmp_path) -> None:
    file = tmp_path / "porter.yaml"
    file.write_text(re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)[0], encoding="utf-8")
    for kind in (ROS1, ROS2):
        read = read_robot_file(file, kind)
        assert isinstance(read.settings, RosSettings)
        assert read.settings.controllers == {"/head_controller": ["head_pan", "head_tilt"]}
        assert read.file.joints == {"head_pan": (-60, 60)}


def test_its_times_and_distances_are_the_usual_ones() -> None:
    usual = RosSettings()
    assert (usual.patience, usual.arrival, usual.drift) == (60, 1, 5)
    assert (usual.stop_within, usual.lost_after) == (2, 2)
