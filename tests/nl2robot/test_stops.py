"""Which event of a stop is its first."""

from nl2robot.run.stops import Stops


def told(*kinds: str) -> list[bool]:
    stops = Stops()
    return [stops.begins(kind) for kind in kinds]


def test_a_stop_begins_once() -> None:
    assert told("stopping", "stopped", "stopping", "stop_not_confirmed") == [1, 0, 1, 0]


def test_what_a_slow_robot_confirms_does_not_stop_what_was_begun_since() -> None:
    assert told("stopping", "pose", "stopping", "stopped", "stop_not_confirmed") == [1, 0, 1, 0, 0]


def test_a_driver_that_only_ever_says_stopped_is_understood() -> None:
    assert told("stopped", "stopped", "pose") == [1, 1, 0]
