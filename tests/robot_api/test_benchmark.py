"""The benchmark measures what it says; how fast is not for a test to judge."""

from robot_api.benchmark import measure


def test_every_figure_is_measured() -> None:
    figures = measure(calls=200, stops=3)
    assert set(figures) == {
        "calls_per_second",
        "calls_per_second_pipelined",
        "round_trip_ms",
        "round_trip_p99_ms",
        "stop_ms",
        "stop_p99_ms",
    }
    assert all(value > 0 for value in figures.values())
    assert figures["round_trip_ms"] <= figures["round_trip_p99_ms"]
