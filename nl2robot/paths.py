"""Where nl2robot keeps what it must remember: run log, pictures, speech models."""

from __future__ import annotations

import os
from pathlib import Path


def data_folder() -> Path:
    """`$NL2ROBOT_HOME`, else the user's data folder of this system; made if missing."""
    chosen = os.environ.get("NL2ROBOT_HOME")
    if chosen:
        folder = Path(chosen).expanduser()
    else:
        from platformdirs import user_data_path

        folder = user_data_path("nl2robot")
    folder.mkdir(parents=True, exist_ok=True)
    return folder
