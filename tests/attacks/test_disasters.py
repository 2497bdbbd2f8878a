"""What befalls the disk, the log and the clock: a short part of `make soak`."""

from __future__ import annotations

import random

import pytest

from tests.attacks.disasters import TAMPERINGS, clock_jumps, disk_full, tampered
from tests.attacks.outcome import Row


def test_a_full_disk_ends_the_run_and_nothing_else() -> None:
    row = Row("disk full")
    disk_full(random.Random(5), row)
    assert not row.failures
    assert row.tried == row.survived >= 2


@pytest.mark.parametrize("how", TAMPERINGS[-1:], ids=lambda how: how.__name__)
def test_a_log_that_is_taken_away_ends_the_run(how) -> None:
    row = Row("log tampered with")
    tampered(random.Random(5), row, how)
    assert not row.failures


def test_a_clock_that_jumps_keeps_nobody_from_stopping_the_robot() -> None:
    row = Row("clock jumps")
    clock_jumps(random.Random(5), row, 2)
    assert not row.failures
    assert row.stop is not None and row.stop < 1000
