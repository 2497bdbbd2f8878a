"""The key that makes a fleet: whoever has it belongs to it.

It is in `fleet.key` of the data folder, which nobody else may read, or in the environment variable.
"""

from __future__ import annotations

import hashlib
import os
import secrets
from pathlib import Path
from typing import Final

from nl2robot.errors import UserError
from nl2robot.paths import data_file, made

VARIABLE: Final = "NL2ROBOT_FLEET_KEY"
SHORTEST: Final = 32
"""Letters and digits of a key."""
LONGEST: Final = 512


def key_file() -> Path:
    """Where it is kept; need not be there."""
    return data_file("fleet.key")


def fleet_key() -> bytes:
    """The key of this machine. Raises `UserError` if there is none, or others may read it."""
    given = os.environ.get(VARIABLE)
    if given is not None:
        return _checked(given, f"The environment variable {VARIABLE}")
    file = key_file()
    try:
        if os.name == "posix" and file.stat().st_mode & 0o077:
            raise UserError(
                f"The key of the fleet in {file} can be read by others. Take their right to it"
                f" away (chmod 600 {file}), or have a new key made."
            )
        return _checked(file.read_text(encoding="ascii"), f"The file {file}")
    except FileNotFoundError as error:
        raise UserError(
            "This robot has no key of a fleet. Make one by `nl2robot fleet key`, or copy the"
            f" fleet's own to {file}."
        ) from error
    except (OSError, ValueError) as error:
        raise UserError(
            f"The key of the fleet cannot be read from {file}. Check the file and its rights."
        ) from error


def make_key(file: Path | None = None) -> Path:
    """Make a key, if there is none yet; returns its file. Raises `UserError`."""
    file = file or key_file()
    made(file.parent)
    try:
        handle = os.open(file, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    except FileExistsError:
        return file
    except OSError as error:
        raise UserError(
            f"The key of the fleet cannot be written to {file} ({error.strerror})."
            " Check the folder and its rights."
        ) from error
    with os.fdopen(handle, "w", encoding="ascii") as opened:
        opened.write(secrets.token_urlsafe(32) + "\n")
    return file


def fingerprint(key: bytes) -> str:
    """By which people see that two robots have the same key; it does not give the key away."""
    return hashlib.sha256(b"nl2robot fleet\0" + key).hexdigest()[:16]


def _checked(text: str, where: str) -> bytes:
    text = text.strip()
    if not (SHORTEST <= len(text) <= LONGEST and text.isascii() and text.isprintable()):
        raise UserError(
            f"{where} holds no key of a fleet. It is {SHORTEST} letters and digits or more, in one"
            " line; `nl2robot fleet key` makes one."
        )
    return text.encode("ascii")
