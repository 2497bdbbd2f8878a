"""Whose approval counts at a robot: each station of a fleet signs what it has others do.

The fleet's key says who belongs to it. Whoever has that key could still say "approved"; where a
robot has a list of the stations that it trusts (`fleet.trusted` in its data folder), it accepts
and begins only what one of them has signed (Ed25519) for this robot, for this one offer, as exactly
that program. What was approved at its own station needs no signature. Without such a list, the key
is enough.
"""

from __future__ import annotations

import base64
import binascii
import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Final

import msgspec

from nl2robot.errors import UserError
from nl2robot.fleet.messages import Order, packed
from nl2robot.paths import made
from robot_api.errors import cause

if TYPE_CHECKING:
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

KEY: Final = "fleet-station.key"
"""The file of a station's own key, for its user alone."""
TRUSTED: Final = "fleet.trusted"
"""The file of the stations that a robot trusts: in each line the key of one, and its name."""
SIGNED: Final = ("offer", "go")
"""The orders that somebody has to answer for; the others begin nothing."""
_PUBLIC: Final = re.compile(r"[A-Za-z0-9_-]{43}")


class Station:
    """Signs the orders of the station whose data are in `folder`, and knows whom it trusts."""

    def __init__(self, folder: Path | None) -> None:
        """None: a key for this process alone, and no list. Raises `UserError` if there is a key
        that cannot be used, or none can be made."""
        self._folder = folder
        self._key = _made(folder / KEY if folder is not None else None)
        self.public = _text(self._key.public_key().public_bytes_raw())
        """By which others name it."""

    def signed(self, sender: str, robot: str, order: Order) -> Order:
        """As the robot of this id takes it from `sender`."""
        if order.what not in SIGNED:
            return order
        bare = msgspec.structs.replace(order, station=self.public, signature=b"")
        signature = self._key.sign(_what(sender, robot, bare))
        return msgspec.structs.replace(bare, signature=signature)

    def doubts(self, sender: str, robot: str, order: Order) -> str | None:
        """Why this robot does nothing of what another station says; None if it may be done."""
        if order.what not in SIGNED or self._folder is None:
            return None
        try:
            known = trusted(self._folder)
        except UserError as error:
            return str(error)
        if known is None:
            return None
        if order.station not in known:
            return (
                "It does not trust the station where this was approved. There,"
                " `nl2robot fleet trust` tells its key; here, add it by `nl2robot fleet trust NAME"
                " --station KEY`."
            )
        return None if _holds(sender, robot, order) else "What it was sent is not what was signed."


def trusted(folder: Path) -> Mapping[str, str] | None:
    """The names of the stations that are trusted, by their keys; None if there is no list. Raises
    `UserError` if it cannot be read as one: then nobody is."""
    file = folder / TRUSTED
    try:
        lines = file.read_text(encoding="utf-8").splitlines()
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as error:
        raise UserError(
            f"The list of trusted stations in {file} cannot be read ({cause(error)})."
            " Check the file and its rights."
        ) from error
    found: dict[str, str] = {}
    for number, line in enumerate(lines, 1):
        if not line.strip():
            continue
        key, _, name = line.strip().partition(" ")
        if not _PUBLIC.fullmatch(key) or not name.strip():
            raise UserError(
                f"Line {number} of the list of trusted stations in {file} is not a key and a name."
                " Mend it, or take it out."
            )
        found[key] = name.strip()
    return found


def trust(folder: Path, name: str, key: str) -> None:
    """Trust a station of this name, instead of another of this name. Raises `UserError`."""
    if not _PUBLIC.fullmatch(key) or not name.strip() or not name.isprintable():
        raise UserError(
            "That is not the key of a station and a name for it. `nl2robot fleet trust` tells the"
            " key, where that station is."
        )
    others = {k: n for k, n in (trusted(folder) or {}).items() if n != name.strip()}
    _written(folder, {**others, key: name.strip()})


def distrust(folder: Path, name: str) -> None:
    """Do not trust the station of this name any more. Raises `UserError` if nobody did."""
    known = trusted(folder) or {}
    if name not in known.values():
        raise UserError(
            f"No station “{name}” is trusted here. `nl2robot fleet trust` lists those that are."
        )
    _written(folder, {key: each for key, each in known.items() if each != name})


def _written(folder: Path, known: Mapping[str, str]) -> None:
    """All of it or nothing: half a list would be another one."""
    file = folder / TRUSTED
    new = file.with_name(f"{TRUSTED}.new")
    try:
        made(folder)
        new.write_text("".join(f"{k} {n}\n" for k, n in known.items()), encoding="utf-8")
        new.replace(file)
    except OSError as error:
        raise UserError(
            f"The list of trusted stations cannot be written to {file} ({cause(error)})."
            " Check the folder and its rights."
        ) from error


def _what(sender: str, robot: str, bare: Order) -> bytes:
    return b"nl2robot fleet order\0" + msgspec.msgpack.encode((sender, robot, packed(bare)))


def _holds(sender: str, robot: str, order: Order) -> bool:
    from cryptography.exceptions import InvalidSignature
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey

    bare = msgspec.structs.replace(order, signature=b"")
    try:
        public = Ed25519PublicKey.from_public_bytes(base64.urlsafe_b64decode(order.station + "="))
        public.verify(order.signature, _what(sender, robot, bare))
    except (InvalidSignature, ValueError, binascii.Error):
        return False
    return True


def _generated() -> Ed25519PrivateKey:
    """One whose public key is no option where it is typed: it does not begin with "-"."""
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

    while True:
        key = Ed25519PrivateKey.generate()
        if not _text(key.public_key().public_bytes_raw()).startswith("-"):
            return key


def _text(raw: bytes) -> str:
    return base64.urlsafe_b64encode(raw).decode("ascii").rstrip("=")


def _made(file: Path | None) -> Ed25519PrivateKey:
    """The key in this file, which is made if it is not there."""
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

    if file is None:
        return _generated()
    try:
        made(file.parent)
        try:
            handle = os.open(file, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        except FileExistsError:
            if os.name == "posix" and file.stat().st_mode & 0o077:
                raise UserError(
                    f"The key of this station in {file} can be read by others. Take their right to"
                    f" it away (chmod 600 {file}), or remove it to have a new one made."
                ) from None
            return Ed25519PrivateKey.from_private_bytes(file.read_bytes())
        key = _generated()
        with os.fdopen(handle, "wb") as opened:
            opened.write(key.private_bytes_raw())
    except (OSError, ValueError) as error:
        raise UserError(
            f"The key of this station in {file} cannot be used ({cause(error)}). Check the file and"
            " its rights; without it, a new one is made, which others have to trust anew."
        ) from error
    return key
