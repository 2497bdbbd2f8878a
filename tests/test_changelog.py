"""What users are told of a version: written with each change, gathered when it is released."""

import re
import tomllib
from pathlib import Path

import nl2robot

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))


def test_every_fragment_has_a_name_that_the_changelog_finds() -> None:
    settings = PROJECT["tool"]["towncrier"]
    kinds = "|".join(kind["directory"] for kind in settings["type"])
    for file in (ROOT / settings["directory"]).iterdir():
        if file.name not in settings["ignore"]:
            assert re.fullmatch(rf"\+[a-z0-9-]+\.({kinds})\.md", file.name), file.name
            assert file.read_text("utf-8").strip(), f"{file.name} says nothing"


def test_the_changelog_says_what_this_version_brought() -> None:
    changelog = (ROOT / "CHANGELOG.md").read_text("utf-8")
    marker = PROJECT["tool"]["towncrier"]["start_string"]
    assert changelog.count(marker) == 1
    newest = re.search(r"^## (\S+) \(\d{4}-\d\d-\d\d\)$", changelog.partition(marker)[2], re.M)
    assert newest and newest[1] == nl2robot.__version__
