"""A browser's recording (Opus in WebM) in another wrapping (Opus in Ogg), which libsndfile reads.

WebM is Matroska (RFC 9559), written in EBML (RFC 8794): elements of an identity, a length and a
content. A browser writes while it records and does not know the lengths of the outer ones. So the
file is read as one row: the outer elements are stepped into, whatever length they claim, all others
are read or stepped over. Each packet of sound is put on a page of Ogg (RFC 3533, 7845).
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Final

MAGIC: Final = b"\x1aE\xdf\xa3"
"""What every file in EBML begins with."""
OPUS_RATE: Final = 48_000
"""Samples a second by which Opus counts, whatever it was recorded with."""

_SEGMENT, _TRACK_ENTRY, _BLOCK = 0x18538067, 0xAE, 0xA1
_TRACK_NUMBER, _CODEC, _CODEC_PRIVATE, _SIMPLE_BLOCK = 0xD7, 0x86, 0x63A2, 0xA3
_TRACKS, _CLUSTER, _BLOCK_GROUP = 0x1654AE6B, 0x1F43B675, 0xA0
_OUTER: Final = {_SEGMENT, _TRACKS, _TRACK_ENTRY, _CLUSTER, _BLOCK_GROUP}
_LACING: Final = 0x06  # flags of a block that holds several packets

_FIRST, _LAST = 2, 4  # flags of a page
_BITS_REVERSED: Final = bytes(int(f"{byte:08b}"[::-1], 2) for byte in range(256))


class WebmError(Exception):
    """There is no Opus sound to be had from this file."""


class CutShort(WebmError):
    """It ends before it says that it ends."""


class NoSound(WebmError):
    """Nothing was recorded."""


@dataclass
class _Track:
    number: int = 0
    codec: bytes = b""
    head: bytes = b""  # an Ogg file begins with the very same
    packets: list[bytes] = field(default_factory=list)


def to_ogg(data: bytes) -> bytes:
    """The first Opus track of a WebM file as an Ogg file. Raises WebmError."""
    track = _opus_track(data)
    if not track.packets:
        raise NoSound
    pages = [
        _page(0, 0, _FIRST, track.head),
        _page(1, 0, 0, b"OpusTags" + struct.pack("<II", 0, 0)),
    ]
    position = 0
    for number, packet in enumerate(track.packets, 1):
        position += duration(packet)
        last = _LAST if number == len(track.packets) else 0
        pages.append(_page(number + 1, position, last, packet))
    return b"".join(pages)


def duration(packet: bytes) -> int:
    """Samples (at OPUS_RATE) in an Opus packet, by its first bytes (RFC 6716, 3.1)."""
    if not packet:
        return 0
    kind, code = packet[0] >> 3, packet[0] & 3
    if kind < 12:
        frame = (480, 960, 1920, 2880)[kind & 3]
    elif kind < 16:
        frame = (480, 960)[kind & 1]
    else:
        frame = 120 << (kind & 3)
    frames = (1, 2, 2)[code] if code < 3 else (packet[1] & 63 if len(packet) > 1 else 0)
    return frame * frames


def _opus_track(data: bytes) -> _Track:
    tracks: list[_Track] = []
    chosen: _Track | None = None
    for identity, content in _elements(data):
        if identity == _TRACK_ENTRY:
            tracks.append(_Track())
        elif identity in (_SIMPLE_BLOCK, _BLOCK):
            chosen = chosen or _first_opus(tracks)
            packet = _packet(content, chosen.number)
            if packet:
                chosen.packets.append(packet)
        elif tracks:
            if identity == _TRACK_NUMBER:
                tracks[-1].number = int.from_bytes(content, "big")
            elif identity == _CODEC:
                tracks[-1].codec = content.rstrip(b"\0")
            elif identity == _CODEC_PRIVATE:
                tracks[-1].head = content
    return chosen or _first_opus(tracks)


def _first_opus(tracks: list[_Track]) -> _Track:
    for track in tracks:
        if track.codec == b"A_OPUS" and track.head.startswith(b"OpusHead"):
            return track
    raise WebmError("no Opus track")


def _elements(data: bytes) -> Iterator[tuple[int, bytes]]:
    """Every element with its content, in the order of the file; of outer ones without."""
    at = 0
    while at < len(data):
        identity, at = _number(data, at, keep_marker=True)
        length, at = _number(data, at, keep_marker=False)
        if identity in _OUTER:
            if identity == _SEGMENT and length is not None and at + length > len(data):
                raise CutShort
            yield identity or 0, b""
            continue
        if identity is None or length is None:
            raise WebmError("not EBML")
        if at + length > len(data):
            raise CutShort
        yield identity, data[at : at + length]
        at += length


def _number(data: bytes, at: int, *, keep_marker: bool) -> tuple[int | None, int]:
    """A number of EBML, whose first bits say how long it is, and where it ends; None where all of
    its bits are set, which stands for "unknown"."""
    if at >= len(data):
        raise CutShort
    length = 9 - data[at].bit_length()
    if length > 8:
        raise WebmError("not EBML")
    if at + length > len(data):
        raise CutShort
    value = int.from_bytes(data[at : at + length], "big")
    unknown = (1 << 7 * length) - 1
    rest = value & unknown
    return (None if rest == unknown else value if keep_marker else rest), at + length


def _packet(block: bytes, track: int) -> bytes | None:
    """The packet in a block; None where it is another track's."""
    number, at = _number(block, 0, keep_marker=False)
    if number != track:
        return None
    if len(block) < at + 3:  # a time of two bytes, flags
        raise WebmError("a block without a head")
    if block[at + 2] & _LACING:  # allowed, but no browser does it
        raise WebmError("laced")
    return block[at + 3 :]


def _page(number: int, position: int, flags: int, packet: bytes) -> bytes:
    """One packet on a page. No packet of Opus is longer than 61,298 bytes; a page holds 65,024."""
    if len(packet) >= 255 * 255:
        raise WebmError("no packet of Opus")
    segments = bytes([255] * (len(packet) // 255) + [len(packet) % 255])
    head = struct.pack("<4sBBQIII", b"OggS", 0, flags, position, 1, number, 0)
    page = head + bytes([len(segments)]) + segments + packet
    return page[:22] + struct.pack("<I", _checksum(page)) + page[26:]


def _checksum(page: bytes) -> int:
    """Ogg's CRC-32: zlib's, but with the bits the other way round and nothing inverted."""
    other = zlib.crc32(page.translate(_BITS_REVERSED), 0xFFFF_FFFF) ^ 0xFFFF_FFFF
    return int(f"{other:032b}"[::-1], 2)
