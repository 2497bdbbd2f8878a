"""The benchmark measures what it says, and no number is where it would hurt."""

from __future__ import annotations

from sandbox.benchmark import measure


def test_measures() -> None:
    measured = measure(rounds=3)
    assert all(value > 0 for value in measured.values())
    # Ten times what the design aims for: these are to fail when something is broken, not busy.
    assert measured["stop_computing_worst_ms"] < 500
    assert measured["stop_paused_worst_ms"] < 500
    assert measured["call_us"] < 10_000
