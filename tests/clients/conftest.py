"""Clients in other languages, run by their own tools against a server that is really served."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.console.conftest import Served, serving
from tests.played import WITH_NODE

ROOT = Path(__file__).parents[2]
CLIENT = ROOT / "nl2robot/console/static/client"
WORKSHOP = ROOT / "docs/clients/javascript"
MODULES = WORKSHOP / "node_modules"
LONGEST = 100.0
"""Seconds."""


def tool(name: str, hint: str) -> str:
    """Where a program is. Without it a test is left out, but in CI."""
    found = shutil.which(name, path=f"{WITH_NODE}:{os.environ['PATH']}:/usr/sbin")
    if found is None:
        if os.environ.get("CI"):
            pytest.fail(hint)
        pytest.skip(hint)
    return found


@pytest.fixture(scope="session")
def node() -> str:
    """Node, with the packages of the workshop."""
    hint = "The client for JavaScript is tested in Node 20 or newer, with its packages: make node"
    tool(str(MODULES / ".bin" / "tsc"), hint)
    return tool("node", hint)


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A robot that is twenty times as fast as its people."""
    with serving(tmp_path_factory.mktemp("home"), "--speed", "20") as served:
        yield served


Ran = subprocess.CompletedProcess[str]
Run = Callable[..., Ran]


@pytest.fixture
def run() -> Run:
    """Run a command and give what came of it; it has to end well unless `fails`."""

    def run(
        *command: str | Path,
        cwd: Path,
        fails: bool = False,
        typed: str | None = None,
        **environment: str,
    ) -> Ran:
        done = subprocess.run(
            command,
            cwd=cwd,
            env={**os.environ, **environment},
            input=typed,
            capture_output=True,
            encoding="utf-8",
            timeout=LONGEST,
        )
        assert (done.returncode != 0) == fails, f"{done.stdout}\n{done.stderr}"
        return done

    return run
