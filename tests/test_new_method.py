"""Adding a robot method touches the table, a capability, the words of each language, and a test.

docs/drivers.md adds one, a light. Here that is done to a copy of the project, in which the tests
then run that a method has to pass, and what is told in `with_a_light.py`.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from grammar.language import languages

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "drivers.md").read_text(encoding="utf-8")
TABLE = "robot_api/methods.py"
CAPABILITY = "robot_api/capabilities/light.py"
WORDS = {f"grammar/languages/{code}/light.yaml" for code in languages()}
TEST = "tests/robot_api/test_light.py"
FILES = {
    name: text
    for name, text in re.findall(
        r"^`([\w/]+\.\w+)`\n```\w+\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE
    )
    if "/" in name
}
"""What the page writes, by name."""
COMMANDS = re.findall(r"^python (-m robot_api\.\w+ --write)$", PAGE, re.MULTILINE)
GENERATED = ("robot_api/calls.py", "docs/methods.md")
STORIES = (
    TEST,
    "tests/with_a_light.py",
    *("tests/robot_api/test_methods.py", "tests/robot_api/test_reference.py"),
    "tests/robot_api/test_stub.py::test_the_clients_methods_are_made_from_the_table_as_it_stands",
    "tests/robot_api/test_drivers_composed.py::test_every_capability_of_the_table_has_an_interface",
    "tests/grammar/test_explain.py::test_every_method_has_words_in_every_language",
    "tests/grammar/test_understand.py::test_every_robot_method_can_be_asked_for",
    "tests/grammar/test_samples.py::test_all_help_is_understood",
)


def test_the_page_touches_the_table_a_capability_a_language_each_and_a_test() -> None:
    assert FILES.keys() == {TABLE, CAPABILITY, *WORDS, TEST}
    assert not any((ROOT / name).exists() for name in FILES.keys() - {TABLE})


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A copy of the project, with the method added and nothing else."""
    for name in ("nl2robot", "sandbox", "sim", "pyproject.toml"):
        (tmp_path / name).symlink_to(ROOT / name)
    ignored = shutil.ignore_patterns("__pycache__")
    for name in ("robot_api", "grammar", "tests"):
        shutil.copytree(ROOT / name, tmp_path / name, copy_function=os.symlink, ignore=ignored)
    (tmp_path / "docs").mkdir()
    for name in (TABLE, *GENERATED):  # the links would be written through
        (tmp_path / name).unlink(missing_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    for name, text in FILES.items():
        if name != TABLE:
            (tmp_path / name).write_text(text, encoding="utf-8")
    table, last = (ROOT / TABLE).read_text(encoding="utf-8"), "        # --- itself\n"
    assert table.count(last) == 1
    row = textwrap.indent(FILES[TABLE].rstrip() + ",\n", " " * 8)
    table = table.replace(last, row + last)
    (tmp_path / TABLE).write_text(table, encoding="utf-8")
    return tmp_path


def python(project: Path, *arguments: str) -> str:
    environment = {**os.environ, "PYTHONPATH": str(project), "NL2ROBOT_HOME": str(project / "home")}
    done = subprocess.run(
        [sys.executable, *arguments],
        cwd=project,
        env=environment,
        capture_output=True,
        text=True,
        timeout=110,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_nothing_else_is_needed(project: Path) -> None:
    assert len(COMMANDS) == len(GENERATED)
    for command in COMMANDS:
        python(project, *command.split())
    python(project, "-m", "pytest", "-p", "no:cacheprovider", *STORIES)
