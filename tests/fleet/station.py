"""A simulated robot of a fleet in a process of its own, without a console:

python -m tests.fleet.station FOLDER NAME LISTENS CONNECTS

"-" for nowhere. It says its address, and serves until its input ends.
"""

from __future__ import annotations

import sys
from pathlib import Path

from nl2robot.fleet.address import parse_fleet
from nl2robot.run.runlog import RunLog
from nl2robot.station.station import simulated_station
from sim.world.loading import load_world


def main(folder: str, name: str, listens: str, connects: str) -> None:
    address = parse_fleet(
        name if connects == "-" else f"{name}@{connects}", () if listens == "-" else (listens,)
    )
    log = RunLog(Path(folder) / "runs.sqlite")
    with simulated_station(load_world("ward"), log, speed=10.0, fleet=address) as station:
        print(station.address, flush=True)
        sys.stdin.read()
    log.close()


if __name__ == "__main__":
    main(*sys.argv[1:])
