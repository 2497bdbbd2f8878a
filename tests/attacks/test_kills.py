"""A server that is killed in mid-program has lost nothing that anybody was told of."""

from __future__ import annotations

import random
from pathlib import Path

from tests.attacks.kills import killed, trouble


def test_what_somebody_was_told_of_is_in_the_log_of_a_killed_server(tmp_path: Path) -> None:
    run, last = killed(tmp_path, random.Random(3))
    assert run == 1 and last > 0
    assert trouble(tmp_path, run, last) is None
    second, last = killed(tmp_path, random.Random(4))  # and the next one goes on with that log
    assert second == 2
    assert trouble(tmp_path, second, last) is None
