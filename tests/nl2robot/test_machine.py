"""What a server wants of its machine."""

from __future__ import annotations

import subprocess
import sys

import pytest

from nl2robot.station.machine import OPEN_FILES, outdated_python


@pytest.mark.parametrize(
    ("version", "told"),
    [
        ((3, 11, 7), "3.11.10"),
        ((3, 12, 5), "3.12.6"),
        ((3, 11, 10), None),
        ((3, 12, 6), None),
        ((3, 13, 0), None),
    ],
)
def test_a_python_with_known_faults_is_told_of(monkeypatch, version, told) -> None:
    monkeypatch.setenv("LANG", "de_CH.UTF-8")
    monkeypatch.delenv("LC_ALL", raising=False)
    monkeypatch.delenv("LC_MESSAGES", raising=False)
    sentence = outdated_python(version)
    assert (sentence is None) == (told is None)
    if sentence is not None and told is not None:
        assert sentence.startswith("Dieses Python, 3.1") and told in sentence


def test_a_server_may_open_as_many_files_as_the_system_allows() -> None:
    code = """
import resource
from nl2robot.station.machine import allow_open_files
_, most = resource.getrlimit(resource.RLIMIT_NOFILE)
resource.setrlimit(resource.RLIMIT_NOFILE, (64, most))
allow_open_files()
print(*resource.getrlimit(resource.RLIMIT_NOFILE))
"""
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    now, most = map(int, told.stdout.split())
    assert now == (OPEN_FILES if most < 0 else min(OPEN_FILES, most))
