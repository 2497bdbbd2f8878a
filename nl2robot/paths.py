"""Where nl2robot keeps what it must remember: run log, pictures, speech models."""

from __future__ import annotations

import os
from pathlib import Path

from nl2robot.errors import UserError


def data_folder() -> Path:
    """`$NL2ROBOT_HOME`, else the user's data folder of this system; made if missing. Raises
    `UserError`."""
    chosen = os.environ.get("NL2ROBOT_HOME")
    if chosen:
        folder = Path(chosen).expanduser()
    else:
        from platformdirs import user_data_path

        folder = user_data_path("nl2robot")
    return _made(folder)


def pictures_folder() -> Path:
    """Where a picture of every run is kept; made if missing. Raises `UserError`."""
    return _made(data_folder() / "pictures")


def _made(folder: Path) -> Path:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(
            f"The folder {folder} cannot be made ({error.strerror})."
            " Set $NL2ROBOT_HOME to a folder that you may write to."
        ) from error
    return folder
