"""Where nl2robot keeps what it must remember: run log, pictures, speech models,
routines."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Final

from nl2robot.errors import UserError

PACKAGED: Final = Path(__file__).parent / "data"
"""What comes with the package: sentences, models' heads, lists."""


def data_folder() -> Path:
    """`$NL2ROBOT_HOME`, else the user's data folder of this system; made if missing. Raises
    `UserError`."""
    return made(_data_folder())


def data_file(name: str) -> Path:
    """A file in the data folder; neither need be there."""
    return _data_folder() / name


def authority_file() -> Path:
    """The certificate of the authority that a server on this machine is certified by
    (`nl2robot.station.certificates`); need not be there."""
    return data_file("certificates") / "authority.crt"


def pictures_folder() -> Path:
    """Where a picture of every run is kept; made if missing. Raises `UserError`."""
    return made(data_folder() / "pictures")


def cache_folder() -> Path:
    """For what can be made again at any time: in `$NL2ROBOT_HOME`, else the user's cache folder of
    this system; need not be there."""
    if os.environ.get("NL2ROBOT_HOME"):
        return _data_folder() / "cache"
    from platformdirs import user_cache_path

    return user_cache_path("nl2robot")


def _data_folder() -> Path:
    chosen = os.environ.get("NL2ROBOT_HOME")
    if chosen:
        return Path(chosen).expanduser()
    from platformdirs import user_data_path

    return user_data_path("nl2robot")


def made(folder: Path) -> Path:
    """The folder, made if missing. Raises `UserError`."""
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        folder.mkdir(mode=0o700, exist_ok=True)  # what is in it is nobody else's
    except OSError as error:
        raise UserError(
            f"The folder {folder} cannot be made ({error.strerror})."
            " Set $NL2ROBOT_HOME to a folder that you may write to."
        ) from error
    return folder
