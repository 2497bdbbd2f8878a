"""Who is killed in mid-program has lost nothing that anybody was told of, and the robot stands."""

from __future__ import annotations

import random
from pathlib import Path

from tests.attacks.kills import (
    ENDLESS,
    kill_clients,
    kill_command_line,
    kill_programs,
    killed,
    trouble,
)
from tests.attacks.outcome import Row


def test_what_somebody_was_told_of_is_in_the_log_of_a_killed_server(tmp_path: Path) -> None:
    home = tmp_path / "home"
    home.mkdir()
    row = Row("killed: server")
    run, last = killed(home, random.Random(3), row)
    assert run == 1 and last > 0
    assert trouble(home, run, last) is None
    second, last = killed(home, random.Random(4), row)  # and the next one goes on with that log
    assert second == 2
    assert trouble(home, second, last) is None
    assert not row.failures


def test_a_killed_program_leaves_the_robot_standing() -> None:
    row = Row("killed: program")
    kill_programs(random.Random(3), row, 1)
    assert not row.failures


def test_a_killed_client_leaves_the_robot_standing() -> None:
    row = Row("killed: client")
    kill_clients(random.Random(3), row, 1)
    assert not row.failures


def test_what_a_killed_command_line_told_of_is_in_its_log(tmp_path: Path) -> None:
    home, program = tmp_path / "home", tmp_path / "program.py"
    home.mkdir()
    program.write_text(ENDLESS, "utf-8")
    assert kill_command_line(home, program, random.Random(3), Row("killed: command line")) is None
