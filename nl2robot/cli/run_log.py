"""The run log of whoever is logged in here."""

from __future__ import annotations

import logging
from logging.handlers import RotatingFileHandler

from nl2robot.paths import data_folder
from nl2robot.run.runlog import RunLog


def open_log(debug: bool = False) -> RunLog:
    """The run log in the user's data folder. What the server has to say about faults goes to a file
    beside it, with `debug` to standard error."""
    logging.raiseExceptions = debug  # a full disk is told of elsewhere
    if not debug:
        faults = RotatingFileHandler(
            data_folder() / "faults.log", maxBytes=1_000_000, backupCount=2, delay=True
        )
        for name in ("robot_api", "nl2robot"):
            logger = logging.getLogger(name)
            logger.handlers = [faults]
            logger.propagate = False
    return RunLog(data_folder() / "runs.sqlite")
