"""A robot that may drive slowly only: the dry run takes as long as it will."""

from contextlib import closing
from pathlib import Path

from nl2robot.cli.operator import Operator
from nl2robot.run.runlog import RunLog
from nl2robot.station.station import robot_station
from robot_api.drivers import emulated
from robot_api.robots.robot_file import Limits, RobotFile
from sim.world.loading import load_world


def test_the_dry_run_knows_how_fast_the_robot_file_lets_it_drive(tmp_path: Path) -> None:
    def seconds(limits: Limits) -> float:
        driver = emulated()
        driver.hold(RobotFile(limits=limits))
        with (
            closing(RunLog(tmp_path / "runs.sqlite")) as log,
            robot_station(driver, load_world("city-hospital"), log) as (station, _),
            station.connect() as robot,
        ):
            review = Operator(robot, "Nurse Kim").check('robot.goto("pharmacy")\n')
        assert review.dry_run is not None
        return review.dry_run.seconds

    assert seconds(Limits(speed=0.2)) > 2 * seconds(Limits())
