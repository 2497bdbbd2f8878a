"""Passwords: what is taken for one, and what is kept of it (Argon2id, in PHC's format)."""

from __future__ import annotations

import os
import unicodedata
from functools import cache
from typing import Final

from nl2robot.errors import UserError

SHORTEST: Final = 10
LONGEST: Final = 200
"""Characters."""

# As OWASP advises where there is little memory: 19 MiB, two passes.
PASSES: Final = 2
LANES: Final = 1
MEMORY: Final = 19 * 1024
"""KiB."""


def hashed(password: str) -> str:
    """What is kept of it. Raises `UserError` for one that is easily guessed."""
    from cryptography.hazmat.primitives.kdf.argon2 import Argon2id

    if not SHORTEST <= len(password) <= LONGEST:
        raise UserError(
            f"A password has {SHORTEST} to {LONGEST} characters: three words that do not belong"
            " together are a good one."
        )
    kdf = Argon2id(
        salt=os.urandom(16), length=32, iterations=PASSES, lanes=LANES, memory_cost=MEMORY
    )
    return kdf.derive_phc_encoded(_bytes(password))


def is_right(password: str, kept: str) -> bool:
    """Whether this is the password that `kept` was made from. Takes some 50 ms, on purpose."""
    from cryptography.exceptions import InvalidKey
    from cryptography.hazmat.primitives.kdf.argon2 import Argon2id

    try:
        Argon2id.verify_phc_encoded(_bytes(password[:LONGEST]), kept)
    except InvalidKey:
        return False
    return True


@cache
def of_nobody() -> str:
    """What would be kept of a password that nobody knows."""
    return hashed(os.urandom(16).hex())


def _bytes(password: str) -> bytes:
    """The same for what looks the same, on whichever keyboard it was typed."""
    return unicodedata.normalize("NFKC", password).encode(errors="replace")
