"""The tutorials, done: their commands are run one after the other, and say what stands there."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = sorted((ROOT / "docs" / "tutorials").glob("*.md"))
BLOCK = re.compile(r"^```(console|\w+ title=\"([\w./]+)\")\n(.*?)^```$", re.M | re.S)


def commands(block: str) -> Iterator[tuple[str, list[str]]]:
    """Each command, and the lines that it says in this order, among others."""
    for part in re.split(r"^\$ ", block, flags=re.M)[1:]:
        command, *lines = part.strip().split("\n")
        yield command, lines


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_tutorial_says_what_happens(page: Path, tmp_path: Path) -> None:
    work = tmp_path / "work"
    work.mkdir()
    environment = {
        **os.environ,
        "PYTHONPATH": str(ROOT),
        "NL2ROBOT_HOME": str(tmp_path / "home"),
        "NL2ROBOT_LANGUAGE_MODEL": "none",
        "COLUMNS": "200",
    }
    ran = 0
    for kind, name, text in BLOCK.findall(page.read_text("utf-8")):
        if kind != "console":
            (work / name).parent.mkdir(exist_ok=True)
            (work / name).write_text(text, encoding="utf-8")
            continue
        for command, lines in commands(text):
            program, *words = shlex.split(command)
            assert program == "nl2robot"
            done = subprocess.run(
                [sys.executable, "-m", "nl2robot.cli.main", *words],
                cwd=work,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                timeout=100,
            )
            assert "Traceback" not in done.stdout
            rest = " ".join(done.stdout.split())
            for line in lines:
                _, found, rest = rest.partition(" ".join(line.split()))
                assert found, f"{command}\ndoes not say: {line}\nbut:\n{done.stdout}"
            ran += 1
    assert ran > 2
