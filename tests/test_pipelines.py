"""What runs elsewhere when something is pushed is what everybody runs."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

ROOT = Path(__file__).parents[1]
FILES = (*ROOT.glob(".git*/workflows/*.yml"), *ROOT.glob(".git*-ci.yml"))


def commands(part: Any) -> Iterator[str]:
    """All that a pipeline runs."""
    if isinstance(part, list):
        for each in part:
            yield from commands(each)
    elif isinstance(part, dict):
        for name, value in part.items():
            if name in ("run", "script"):
                yield from [value] if isinstance(value, str) else value
            else:
                yield from commands(value)


def test_the_pipelines_run_the_gate_the_audit_ten_minutes_of_the_soak_and_the_site() -> None:
    targets = set(re.findall(r"^([a-z0-9-]+):", (ROOT / "Makefile").read_text("utf-8"), re.M))
    assert len(FILES) == 2
    for file in FILES:
        run = set(commands(yaml.safe_load(file.read_text("utf-8"))))
        assert run >= {".ci/run", "make audit", "make attacks MINUTES=10", "make docs"}, file
        assert all(each.startswith((".ci/run", "make ", "git ")) for each in run), file
        made = {each.split()[1] for each in run if each.startswith("make ")}
        assert made <= targets and (ROOT / ".ci/run").stat().st_mode & 0o100


REPORTS = {
    "nobody answers": ("", "cannot be reached", 0),
    "nothing is known": (
        {"dependencies": [{"name": "nicegui", "skip_reason": "not found"}]},
        "cannot be reached",
        0,
    ),
    "all is well": (
        {
            "dependencies": [
                {"name": "nicegui", "version": "3.1", "vulns": []},
                {"name": "nl2robot", "skip_reason": "not found"},
            ]
        },
        "1 packages were looked up; no known faults.\nNot in the database: nl2robot.",
        0,
    ),
    "a fault": (
        {
            "dependencies": [
                {
                    "name": "nicegui",
                    "version": "3.1",
                    "vulns": [{"id": "CVE-1", "fix_versions": ["3.2"]}],
                }
            ]
        },
        "nicegui 3.1: CVE-1, mended in 3.2",
        1,
    ),
}


@pytest.mark.parametrize("what", REPORTS)
def test_known_faults_of_what_is_installed_are_told(what: str, tmp_path: Path) -> None:
    """With a program in the place of pip-audit that prints such a report."""
    report, said, status = REPORTS[what]
    pip_audit = tmp_path / "pip-audit"
    text = json.dumps(report) if report else "a connection error"
    pip_audit.write_text(f"#!{sys.executable}\nprint({text!r})\n")
    pip_audit.chmod(0o755)
    command = [sys.executable, str(ROOT / "docs/deploy/audit.py"), str(pip_audit), "."]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (said in done.stdout, done.stderr, done.returncode) == (True, "", status)
