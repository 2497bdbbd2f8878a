"""No message shows the number of a system's error: "[Errno 2]" tells a nurse nothing."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from robot_api.errors import cause

ROOT = Path(__file__).parents[2]
PACKAGES = ("nl2robot", "robot_api", "sim", "grammar", "sandbox")
OF_THE_SYSTEM = {
    *("OSError", "IOError", "ConnectionError", "TimeoutError", "Exception", "BaseException"),
    *(each.__name__ for each in OSError.__subclasses__()),
}
LOGS = ("_book.write", "_log.", "traceback")


def test_a_cause_has_no_number() -> None:
    for error in (FileNotFoundError(2, "No such file or directory", "x.yaml"), ValueError("a\nb")):
        assert "Errno" not in cause(error) and "\n" not in cause(error)
    assert cause(TimeoutError()) == "TimeoutError"


@pytest.mark.parametrize("package", PACKAGES)
def test_no_error_of_the_system_is_shown_as_it_is(package) -> None:
    found = [
        f"{path.relative_to(ROOT)}:{line}"
        for path in sorted((ROOT / package).rglob("*.py"))
        if "training" not in path.parts
        for line in _shown_as_they_are(path.read_text(encoding="utf-8"))
    ]
    assert not found, "say cause(error) instead"


def _shown_as_they_are(source: str) -> Iterator[int]:
    lines = source.splitlines()
    for handler in ast.walk(ast.parse(source)):
        if not isinstance(handler, ast.ExceptHandler) or not handler.name or not handler.type:
            continue
        caught = {getattr(each, "id", getattr(each, "attr", "")) for each in ast.walk(handler.type)}
        if not caught & OF_THE_SYSTEM:
            continue
        for node in ast.walk(handler):
            shown = None
            if isinstance(node, ast.FormattedValue):
                shown = node.value
            elif isinstance(node, ast.Call) and getattr(node.func, "id", "") == "str":
                shown = node.args[0] if node.args else None
            if isinstance(shown, ast.Name) and shown.id == handler.name:
                line = lines[node.lineno - 1]
                if "strerror" not in line and not any(log in line for log in LOGS):
                    yield node.lineno


@pytest.mark.parametrize(
    "arguments",
    [
        ("test", "no-such-file.yaml"),
        ("run", "--program", "no-such-file.py"),
        ("translate", "--world", "no-such-file.yaml", "wave"),
        ("hotword", "--wav", "no-such-file.wav"),
        ("run", "--robot-file", "no-such-file.yaml", "wave"),
        ("paraphrases", "no-such-file.tsv"),
        ("world", "check", "no-such-file.yaml"),
        ("test", "/"),
        ("translate", "--world", "/", "wave"),
    ],
)
def test_a_file_that_is_missing_is_said_in_a_sentence(nl2robot, arguments) -> None:
    status, out, err = nl2robot(*arguments)
    assert status != 0
    told = out + err
    assert "Errno" not in told and "Traceback" not in told
    assert told.rstrip().endswith((".", "…")), told
