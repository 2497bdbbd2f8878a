"""What a page of the docs says, done: its files are written, its commands run one after the other.

A file is a block with a `title="..."`, of whatever kind. A command of a ```console block begins
with "$ " and goes on while its lines end with a backslash; what stands below it are lines that it
says, in this order, among others. One with nothing below it ends well.
"""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from pathlib import Path

ROOT = Path(__file__).parents[1]
WITH_NODE = ROOT / ".venv-node" / "bin"
"""Where `make node` puts Node if there is none, or an old one."""
_BLOCK = re.compile(r"^```(?:(console)|\w+ title=\"([\w./-]+)\")\n(.*?)^```$", re.M | re.S)
_COMMAND = re.compile(r"^\$ ((?:.*\\\n)*.*)\n?((?:(?!\$ ).*\n?)*)", re.M)
_OURS = f'#!/bin/sh\nexec "{sys.executable}" -m nl2robot.cli.main "$@"\n'
_PYTHON = f'#!/bin/sh\nexec "{sys.executable}" "$@"\n'
_PIP = f'#!/bin/sh\nexec "{sys.executable}" -m tests.pretended_pip "$@"\n'


def blocks(page: str) -> Iterator[tuple[str | None, str]]:
    """The files of a page, by their names, and its blocks of commands, by none."""
    for console, name, text in _BLOCK.findall(page):
        yield (None if console else name), text


def commands(block: str) -> Iterator[tuple[str, list[str]]]:
    """Each command, and the lines that it says."""
    for command, lines in _COMMAND.findall(block):
        yield command, [line for line in lines.split("\n") if line.strip()]


def play(page: Path, folder: Path, installed: Path | None = None) -> int:
    """Do what the page says, in a folder that is empty. How many commands there were. With the
    commands of this checkout, or those `installed` in that folder."""
    work = folder / "work"
    work.mkdir()
    environment = {
        **os.environ,
        "PATH": os.pathsep.join(
            (str(installed or _tools(folder)), str(WITH_NODE), os.environ["PATH"])
        ),
        "PYTHONPATH": "" if installed else os.pathsep.join((str(ROOT), str(work))),
        "NL2ROBOT_HOME": str(folder / "home"),
        "NL2ROBOT_LANGUAGE_MODEL": "none",
        "COLUMNS": "200",
    }
    ran = 0
    with ExitStack() as left:  # what a command has left running ends with the page
        for name, text in blocks(page.read_text("utf-8")):
            if name is not None:
                (work / name).parent.mkdir(parents=True, exist_ok=True)
                (work / name).write_text(text, encoding="utf-8")
                continue
            for command, lines in commands(text):
                status, said = _done(command, work, environment, left)
                assert lines or status == 0, f"{command}\nfails:\n{said}"
                rest = " ".join(said.split())
                for line in lines:
                    _, found, rest = rest.partition(" ".join(line.split()))
                    assert found, f"{command}\ndoes not say: {line}\nbut:\n{said}"
                ran += 1
    return ran


def _tools(folder: Path) -> Path:
    """`nl2robot` and `python` of this checkout, and a `pip` that only puts a package where it is
    found."""
    tools = folder / "tools"
    tools.mkdir()
    for name, script in (("nl2robot", _OURS), ("python", _PYTHON), ("pip", _PIP)):
        (tools / name).write_text(script, encoding="utf-8")
        (tools / name).chmod(0o755)
    return tools


def _done(
    command: str, work: Path, environment: dict[str, str], left: ExitStack
) -> tuple[int, str]:
    """How it ended, and what it said."""
    started = subprocess.Popen(
        ["bash", "-c", command],
        cwd=work,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )
    left.callback(_end, started.pid)
    said = started.communicate(timeout=100)[0]
    assert "Traceback" not in said, said
    assert started.returncode != 127, f"{command}\nis not there:\n{said}"
    return started.returncode, said


def _end(session: int) -> None:
    with suppress(ProcessLookupError):
        os.killpg(session, signal.SIGTERM)
