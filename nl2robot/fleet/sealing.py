"""Messages that nobody outside the fleet can write, change or play again.

Without I/O. Each message carries who sent it, in which session (one life of a process), its number
in that session, and a code (HMAC-SHA256) over all of it with the fleet's key. What is heard is

- refused if the code is wrong (`forged`), or its number was heard before (`replayed`);
- not believed before its session has proved that it lives now: it answers a challenge that nobody
  could know before. So what was recorded in an earlier session is worth nothing, also to a robot
  that has just been started and remembers no numbers.

No clock of anybody else is asked: robots whose clocks are minutes apart understand each other.
"""

from __future__ import annotations

import hashlib
import hmac
import secrets
from typing import Final, Literal

import msgspec

VERSION: Final = 1
WINDOW: Final = 1024
"""Numbers before the highest one that may still come, for the network may change their order."""
LARGEST: Final = 300_000
"""Bytes of a message; what is longer is none."""
ASKS_AGAIN: Final = 0.5
"""Seconds between two challenges of the same session."""

Trouble = Literal["garbled", "forged", "replayed", "unproven", "own", "other"]
"""Why a message is not believed; own: one's own, other: for another robot."""


class Sealed(msgspec.Struct, frozen=True, array_like=True):
    version: int
    sender: str
    session: str
    number: int
    to: str
    """Whom it is for; empty: all."""
    kind: str
    payload: bytes
    code: bytes = b""


class Opened(msgspec.Struct, frozen=True):
    """A message that may be believed."""

    sender: str
    session: str
    number: int
    kind: str
    payload: bytes


class NotBelieved(Exception):
    """Why, and from whom it claims to be, if its code is right."""

    def __init__(self, trouble: Trouble, sealed: Sealed | None = None) -> None:
        super().__init__(trouble)
        self.trouble: Trouble = trouble
        self.sealed = sealed


_encode = msgspec.msgpack.Encoder().encode
_decode = msgspec.msgpack.Decoder(Sealed).decode


def _code(key: bytes, sealed: Sealed) -> bytes:
    bare = msgspec.structs.replace(sealed, code=b"")
    return hmac.digest(key, b"nl2robot fleet message\0" + _encode(bare), hashlib.sha256)


class Sealer:
    """Seals what one process sends in its life."""

    def __init__(self, key: bytes, sender: str, session: str | None = None) -> None:
        self._key = key
        self.sender = sender
        self.session = session or secrets.token_hex(8)
        self.number = 0
        """Of the last message."""

    def seal(self, kind: str, payload: bytes, to: str = "") -> bytes:
        self.number += 1
        bare = Sealed(VERSION, self.sender, self.session, self.number, to, kind, payload)
        return _encode(msgspec.structs.replace(bare, code=_code(self._key, bare)))


class _Session:
    """The numbers that were heard of one."""

    def __init__(self, session: str) -> None:
        self.name = session
        self.highest = 0
        self._heard: set[int] = set()

    def fresh(self, number: int) -> bool:
        """Whether this number is heard for the first time; it is remembered."""
        if number <= self.highest - WINDOW or number in self._heard:
            return False
        self._heard.add(number)
        if number > self.highest:
            self.highest = number
            if len(self._heard) > 2 * WINDOW:
                self._heard = {each for each in self._heard if each > number - WINDOW}
        return True


class Opener:
    """Opens what one process hears."""

    def __init__(self, key: bytes, me: str) -> None:
        self._key = key
        self._me = me
        self._proven: dict[str, _Session] = {}
        self._asked: dict[tuple[str, str], tuple[bytes, float]] = {}
        """Challenges that are not answered, by sender and session, and when they were sent."""

    def open(self, raw: bytes) -> Opened:
        """Raises `NotBelieved`."""
        try:
            if len(raw) > LARGEST:
                raise ValueError
            sealed = _decode(raw)
        except (msgspec.MsgspecError, ValueError, RecursionError):
            raise NotBelieved("garbled") from None
        if sealed.version != VERSION or not hmac.compare_digest(
            sealed.code, _code(self._key, sealed)
        ):
            raise NotBelieved("forged")
        if sealed.sender == self._me:
            raise NotBelieved("own", sealed)
        if sealed.to not in ("", self._me):
            raise NotBelieved("other", sealed)
        session = self._proven.get(sealed.sender)
        if session is None or session.name != sealed.session:
            if not self._proves(sealed):
                raise NotBelieved("unproven", sealed)
            session = self._proven[sealed.sender] = _Session(sealed.session)
        if not session.fresh(sealed.number):
            raise NotBelieved("replayed", sealed)
        return Opened(sealed.sender, sealed.session, sealed.number, sealed.kind, sealed.payload)

    def challenge(self, sealed: Sealed, now: float) -> bytes | None:
        """What to ask a session that is not proven; None if it was asked just now."""
        who = (sealed.sender, sealed.session)
        nonce, at = self._asked.get(who, (b"", -ASKS_AGAIN))
        if now - at < ASKS_AGAIN:
            return None
        nonce = nonce or secrets.token_bytes(16)
        self._asked[who] = (nonce, now)
        return nonce

    def _proves(self, sealed: Sealed) -> bool:
        """Whether it answers the challenge of its session, which is used up by that."""
        nonce, _ = self._asked.get((sealed.sender, sealed.session), (b"", 0.0))
        if not nonce or sealed.kind != "proof" or not hmac.compare_digest(sealed.payload, nonce):
            return False
        for who in [who for who in self._asked if who[0] == sealed.sender]:
            del self._asked[who]
        return True
