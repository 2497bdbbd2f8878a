"""The example in Java, as the page of the clients has it run."""

from __future__ import annotations

import queue
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.clients.conftest import LONGEST, ROOT, Run, tool
from tests.console.conftest import Served, serving

TOUR = ROOT / "docs/clients/java/Tour.java"


@pytest.fixture
def java() -> str:
    return tool("java", "The example in Java is played with a JDK: make java")


@pytest.fixture
def ward(tmp_path: Path) -> Iterator[Served]:
    """A robot that takes its time."""
    with serving(tmp_path / "home", "--speed", "1") as served:
        yield served


def test_it_compiles_for_java_11_without_a_warning(tmp_path: Path, run: Run) -> None:
    javac = tool("javac", "The example in Java is compiled with a JDK: make java")
    run(javac, "--release", "11", "-Xlint:all", "-Werror", "-d", tmp_path, TOUR, cwd=tmp_path)


def test_the_tour_is_done(served: Served, java: str, tmp_path: Path, run: Run) -> None:
    said = run(java, TOUR, f"ws://{served.address}", cwd=tmp_path).stdout.splitlines()
    assert said[:2] == ["On the way to ward a.", "It says: Good evening."]
    assert "The answer: yes" in said or "The answer: no" in said
    assert any(line.startswith("As expected: I know no place called") for line in said)
    with served.robot() as robot:
        assert robot.location().place == "lobby"


def test_what_is_in_the_way_is_a_sentence(
    served: Served, java: str, tmp_path: Path, run: Run
) -> None:
    said = run(java, TOUR, "ws://127.0.0.1:1", cwd=tmp_path, fails=True).stderr
    assert said == "LostConnection: There is no robot at ws://127.0.0.1:1.\n"
    said = run(java, TOUR, f"ws://{served.address}", "wrong", cwd=tmp_path, fails=True).stderr
    assert said.startswith("AccessDenied: ")


def test_ctrl_c_stops_the_robot(ward: Served, java: str, tmp_path: Path) -> None:
    moves: queue.SimpleQueue[str] = queue.SimpleQueue()
    with ward.robot() as robot:
        robot.subscribe("pose", lambda kind, data: moves.put(kind))
        robot.subscribe("stopped", lambda kind, data: moves.put(data["because"]))
        tour = subprocess.Popen(
            [java, TOUR, f"ws://{ward.address}"], stdout=subprocess.PIPE, text=True, cwd=tmp_path
        )
        assert moves.get(timeout=LONGEST) == "pose"
        tour.send_signal(signal.SIGINT)
        said = tour.communicate(timeout=LONGEST)[0]
        assert said.splitlines() == ["On the way to ward a.", "The robot stands."]
        while (told := moves.get(timeout=LONGEST)) == "pose":
            pass
        assert "the tour" in told
        stands = robot.location()
        robot.wait(0.5)
        assert robot.location() == stands
