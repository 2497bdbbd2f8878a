"""The model's own process: what reaches it, and what does not."""

from __future__ import annotations

import io
import os
from pathlib import Path

import msgspec
import pytest

from grammar.planning.model.request import Piece, Request, TooLate
from nl2robot.language_model.client import Process
from nl2robot.language_model.install import install
from nl2robot.language_model.messages import Failed, Ready, Report, Write
from nl2robot.language_model.worker import Worker
from tests.language_model.tiny import Tiny


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("NL2ROBOT_HOME", str(tmp_path))
    Tiny().write(tmp_path / "tiny.gguf")
    install(tmp_path / "tiny.gguf", tmp_path)
    return tmp_path


def test_ctrl_c_at_the_terminal_does_not_reach_it(folder: Path) -> None:
    process = Process(folder)
    try:
        process.get_ready("say Bob")
        assert process._running is not None
        assert os.getpgid(process._running.pid) != os.getpgrp()
    finally:
        process.close()


def test_whose_time_is_over_before_there_is_a_program_is_told(folder: Path) -> None:
    process = Process(folder)
    try:
        with pytest.raises(TooLate):
            process.write(Request(prefix="say Bob", said=(Piece("go"),), seconds=0.0))
    finally:
        process.close()


def test_what_was_cancelled_before_it_was_begun_is_not_written(folder: Path) -> None:
    out = io.BytesIO()
    worker = Worker(folder, None, out)
    worker._cancel(1)
    worker.orders.put(Write(1, Request(prefix="say Bob", said=(Piece("go"),))))
    worker.orders.put(None)
    worker.work()
    reports = [msgspec.json.decode(line, type=Report) for line in out.getvalue().splitlines()]
    assert reports == [Ready(), Failed(1, cancelled=True)]
