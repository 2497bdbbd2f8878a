"""What the robot did is kept small, whatever it was, and can be watched again."""

import pytest

from nl2robot.run import kept_record
from nl2robot.run.kept_record import (
    MOST_HAPPENINGS,
    MOST_POSES,
    Happening,
    Pose,
    Recorder,
    unpacked,
)
from nl2robot.run.runlog import RunLog


@pytest.fixture
def log(tmp_path):
    log = RunLog(tmp_path / "runs.sqlite")
    yield log
    log.close()


class Watched:
    """A robot whose events are recorded, and whose time passes as told."""

    def __init__(self, log) -> None:
        self.log = log
        self.now = 100.0
        self.recorder = Recorder(log, lambda: self.now)

    def begins(self, run: int) -> None:
        self.recorder.note("program", {"what": "state", "run": run, "state": "running"})

    def ends(self, run: int, state: str = "done"):
        self.recorder.note("program", {"what": "state", "run": run, "state": state})
        record = self.log.movement(run)
        return None if record is None else unpacked(record)

    def drives(self, steps: int, every: float = 0.1) -> None:
        for step in range(steps):
            self.now += every
            pose = {"x": step / 10, "y": 2.0, "theta": -90.0, "place": None, "speed": 1, "time": 0}
            self.recorder.note("pose", pose)


@pytest.fixture
def robot(log):
    return Watched(log)


def test_a_drive_is_kept_five_times_a_second(robot) -> None:
    robot.begins(1)
    robot.drives(50)
    robot.recorder.note("speech", {"text": "Here I am.", "language": "en"})
    robot.recorder.note("battery", {"percent": 9})
    robot.now += 10
    movement = robot.ends(1)
    assert len(movement.poses) == pytest.approx(25, abs=2)
    assert movement.poses[0] == Pose(0.1, 0.0, 2.0, 270.0)
    assert movement.poses[-1] == Pose(5.0, 4.9, 2.0, 270.0), "the last one of all"
    assert movement.happenings == (Happening(5.0, "speech", "Here I am."),)
    assert movement.seconds == 15.0


def test_where_it_stood_at_first_and_between_drives_is_known(robot) -> None:
    robot.drives(3)
    robot.now += 60
    robot.begins(1)
    robot.drives(8)  # the last of these is within the time of the one before
    robot.now += 30
    robot.drives(1)
    movement = robot.ends(1, "stopped")
    assert movement.poses[0] == Pose(0.0, 0.2, 2.0, 270.0)
    assert [pose.time for pose in movement.poses[-2:]] == [0.8, 30.9]


def test_a_run_of_a_whole_night_is_kept_coarsely(robot) -> None:
    robot.begins(1)
    robot.drives(60_000, 0.5)
    for number in range(2 * MOST_HAPPENINGS):
        robot.recorder.note("speech", {"text": f"{number}" * 1000})
    movement = robot.ends(1)
    assert MOST_POSES / 2 - 2 <= len(movement.poses) <= MOST_POSES + 1
    assert movement.poses[-1].time == 30_000
    assert (len(movement.happenings), movement.shortened) == (MOST_HAPPENINGS, True)
    assert len(robot.log.movement(1)) < 60_000


def test_only_the_newest_are_kept(robot, monkeypatch) -> None:
    monkeypatch.setattr(kept_record, "RECORDS_KEPT", 2)
    for run in (1, 2, 5, 9):
        robot.begins(run)
        robot.ends(run)
    assert [robot.log.movement(run) is not None for run in (1, 2, 5, 9)] == [
        False,
        False,
        True,
        True,
    ]


def test_pauses_do_not_begin_it_anew_and_nothing_is_kept_without_a_run(robot) -> None:
    assert robot.ends(7) is None
    robot.begins(1)
    robot.drives(5)
    robot.recorder.note("program", {"what": "state", "run": 1, "state": "paused"})
    robot.recorder.note("program", {"what": "line", "run": 1, "state": "running"})
    robot.begins(1)
    assert len(robot.ends(1).poses) == 3


def test_a_full_disk_takes_only_the_record(robot) -> None:
    robot.begins(1)
    robot.log.close()
    robot.recorder.note("program", {"what": "state", "run": 1, "state": "done"})


def test_what_is_no_record_is_none() -> None:
    assert unpacked(b"junk") is None
    assert unpacked(kept_record.zlib.compress(b'{"seconds": "x"}')) is None
