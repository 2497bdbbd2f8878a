"""What is to be done to its end is, whoever presses Ctrl-C."""

from __future__ import annotations

import signal

import pytest

from nl2robot.ctrl_c import ctrl_c_later


def test_ctrl_c_waits_for_what_has_to_be_whole() -> None:
    done = []
    with pytest.raises(KeyboardInterrupt), ctrl_c_later():
        signal.raise_signal(signal.SIGINT)
        signal.raise_signal(signal.SIGINT)
        done.append("to its end")
    assert done == ["to its end"]
