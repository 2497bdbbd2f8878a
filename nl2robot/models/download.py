"""Fetching a large file and unpacking it, so that nothing half-done is ever left in place.

`fetch` goes over HTTP and resumes; `npm_pack` and `pip_download` ask the user's own npm and pip;
`unpack` takes one folder out of a zip or tar archive. All of them raise `DownloadError`, whose text
is a half-sentence ("npm is not installed") that the caller puts into a sentence; what the disk
refuses stays an `OSError`.
Nothing here knows what a speech model is.
"""

from __future__ import annotations

import contextlib
import errno
import hashlib
import importlib.util
import os
import shutil
import subprocess
import sys
import tarfile
import threading
import time
import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path, PurePosixPath
from typing import IO, Any, Protocol
from urllib.parse import urlsplit

CONNECT_SECONDS = 3.0  # a publisher that cannot be reached must not keep anybody waiting
ANSWER_SECONDS = 8.0  # name lookup + connection + first answer together
STALL_SECONDS = 20.0  # no byte for so long counts as a broken connection
CHUNK = 1 << 16  # what is lost at most when a connection breaks
MEGABYTE = 1_000_000
MOST_UNPACKED = 4_000 * MEGABYTE  # no speech model is larger; an archive that claims so is broken


class DownloadError(Exception):
    """What went wrong, as a half-sentence; `unreachable` when asking again now is no use."""

    def __init__(self, reason: str, *, unreachable: bool = False) -> None:
        super().__init__(reason)
        self.unreachable = unreachable


class Progress(Protocol):
    """Where a long job reports to; all three are called from the thread that does the job."""

    def start(self, what: str, total: int | None) -> None:
        """A stage begins; `total` in bytes where it is known."""

    def at(self, done: int) -> None:
        """So many bytes of the present stage are done."""

    def note(self, sentence: str) -> None:
        """Something the user should read."""


class Silent:
    """A `Progress` that says nothing."""

    def start(self, what: str, total: int | None) -> None: ...

    def at(self, done: int) -> None: ...

    def note(self, sentence: str) -> None: ...


@contextlib.contextmanager
def shown(file: IO[str] | None = None) -> Iterator[Progress]:
    """A `Progress` for people, on standard error: a bar on a terminal, else a line every tenth."""
    out = file or sys.stderr
    if not out.isatty():
        yield _Lines(out)
        return
    from rich.console import Console
    from rich.progress import BarColumn, DownloadColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bars

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        DownloadColumn(),
        TimeRemainingColumn(),
    )
    with Bars(*columns, console=Console(file=out)) as bars:
        yield _Bar(bars)


class _Lines:
    def __init__(self, out: IO[str]) -> None:
        self.out = out
        self.what, self.total, self.next = "", 0, 0

    def start(self, what: str, total: int | None) -> None:
        self.what, self.total, self.next = what, total or 0, 10
        size = f" ({self.total / MEGABYTE:.0f} MB)" if total else ""
        self.note(f"{what}{size} ...")

    def at(self, done: int) -> None:
        percent = 100 * done // self.total if self.total else 0
        if percent >= self.next:
            self.next = percent // 10 * 10 + 10
            self.note(f"{self.what}: {percent} %")

    def note(self, sentence: str) -> None:
        print(sentence, file=self.out, flush=True)


class _Bar:
    def __init__(self, bars: Any) -> None:
        self.bars = bars
        self.task: Any = None

    def start(self, what: str, total: int | None) -> None:
        if self.task is not None:
            self.bars.remove_task(self.task)
        self.task = self.bars.add_task(what, total=total)

    def at(self, done: int) -> None:
        self.bars.update(self.task, completed=done)

    def note(self, sentence: str) -> None:
        self.bars.console.print(sentence, markup=False, highlight=False)


# ── over HTTP ────────────────────────────────────────────────────────────────────────────────


def is_private(url: str) -> bool:
    """Whether nobody on the way can change what comes from this address: https, or this machine."""
    parts = urlsplit(url)
    return parts.scheme == "https" or parts.hostname in {"127.0.0.1", "::1", "localhost"}


def fetch(url: str, part: Path, what: str, progress: Progress, *, attempts: int = 4) -> str:
    """Download `url` into the file `part`, going on where an earlier call stopped.

    `part` is complete when this returns; it returns the address the file came from in the end,
    redirects followed. When it raises, `part` holds what came so far and the next call resumes.
    """
    failures = 0
    while True:
        before = _size(part)
        try:
            return _fetch_on(url, part, what, progress)
        except _BrokenOff as error:
            # A connection that breaks but brings something each time gets there in the end.
            failures = 0 if _size(part) > before else failures + 1
            if failures >= attempts:
                raise DownloadError(
                    f"the connection to {_host(url)} broke off after "
                    f"{_size(part) / MEGABYTE:.1f} MB (the next try goes on from there)"
                ) from error


class _BrokenOff(Exception):
    """The connection was good and then was not."""


def _fetch_on(url: str, part: Path, what: str, progress: Progress) -> str:
    import requests

    have = _size(part)
    validator = part.with_name(part.name + ".version")
    headers = {"Accept-Encoding": "identity"}
    if have and validator.exists():
        # If-Range: the rest of the same file, or the whole of a newer one; never a mixture.
        headers |= {"Range": f"bytes={have}-", "If-Range": validator.read_text()}
    with contextlib.closing(_open(url, headers)) as answer:
        if answer.status_code == 416:  # nothing left to send: we have it all, or it has shrunk
            if answer.headers.get("Content-Range", "").endswith(f"/{have}"):
                return str(answer.url)
            part.unlink(missing_ok=True)
            raise _BrokenOff
        if answer.status_code not in (200, 206):
            raise DownloadError(
                f"{_host(url)} answered {answer.status_code} ({answer.reason}) for {url}"
            )
        start = have if answer.status_code == 206 else 0
        length = answer.headers.get("Content-Length")
        total = start + int(length) if length else None
        version = answer.headers.get("ETag") or answer.headers.get("Last-Modified")
        if version and not version.startswith("W/"):
            validator.write_text(version)
        else:
            validator.unlink(missing_ok=True)
        progress.start(what, total)
        with part.open("ab" if start else "wb") as file:
            done = start
            try:
                for block in answer.iter_content(CHUNK):
                    file.write(block)
                    done += len(block)
                    progress.at(done)
            except requests.RequestException as error:
                raise _BrokenOff from error
        if total is not None and done < total:
            raise _BrokenOff
        return str(answer.url)


def _open(url: str, headers: dict[str, str]) -> Any:
    """The response within ANSWER_SECONDS, a slow name server included, or DownloadError."""
    import requests

    result: list[Any] = []
    given_up = threading.Event()

    def ask() -> None:
        try:
            answer = requests.get(
                url, headers=headers, stream=True, timeout=(CONNECT_SECONDS, STALL_SECONDS)
            )
        except (requests.RequestException, OSError, ValueError) as error:
            result.append(error)
            return
        result.append(answer)
        if given_up.is_set():
            answer.close()

    # Looking up a name cannot be given a time limit, so it is done where it may be left behind.
    thread = threading.Thread(target=ask, daemon=True, name="download")
    thread.start()
    thread.join(ANSWER_SECONDS)
    given_up.set()
    if not result:
        raise DownloadError(f"{_host(url)} does not answer", unreachable=True)
    if isinstance(result[0], requests.exceptions.SSLError):
        raise DownloadError(
            f"the secure connection to {_host(url)} could not be verified", unreachable=True
        )
    if isinstance(result[0], Exception):
        raise DownloadError(f"{_host(url)} cannot be reached", unreachable=True)
    return result[0]


def _host(url: str) -> str:
    return urlsplit(url).hostname or url


def _size(path: Path) -> int:
    return path.stat().st_size if path.exists() else 0


# ── through the user's package managers ──────────────────────────────────────────────────────


def npm_pack(spec: str, folder: Path, size: int, what: str, progress: Progress) -> Path:
    """Let the user's npm fetch the package `spec` ("name@1.0.0") into `folder`; its tarball's path.

    npm asks whatever registry it is set up for. `size` is the tarball's expected size in bytes.
    """
    npm = shutil.which("npm")
    if npm is None:
        raise DownloadError("npm is not installed", unreachable=True)
    # npm shows no progress itself: in a cache of our own we see how much has come so far.
    cache = folder / "npm-cache"
    command = [npm, "pack", spec, "--pack-destination", str(folder), "--cache", str(cache)]
    command += ["--ignore-scripts", "--loglevel=error", "--fetch-retries=1"]
    command += ["--fetch-retry-mintimeout=1000", f"--fetch-timeout={int(STALL_SECONDS * 1000)}"]
    progress.start(what, size)
    failed, said = _run(command, folder, cache, size, progress)
    return _fetched(folder, "*.tgz", failed, said, _npm_reason(spec, said))


def pip_download(
    spec: str, platform: str, folder: Path, size: int, what: str, progress: Progress
) -> Path:
    """Let pip fetch the wheel of `spec` ("name==1.0.0") for any `platform` into `folder`; its path.

    pip asks whatever index it is set up for. Nothing of the wheel is installed or run, so that it
    may be one for another platform. `size` is its expected size in bytes.
    """
    if importlib.util.find_spec("pip") is None:  # as in an environment that uv made
        raise DownloadError("pip is not installed", unreachable=True)
    # An older pip shows no progress in a form for programs: in a temporary folder of our own we see
    # how much has come so far. A cache would keep a second copy for ever.
    unfinished = folder / "unfinished"
    unfinished.mkdir()
    command = [sys.executable, "-m", "pip", "download", spec, "--dest", str(folder)]
    command += ["--no-deps", "--only-binary=:all:", "--platform", platform]
    command += ["--implementation=py", "--abi=none", "--no-cache-dir", "--no-input"]
    command += ["--progress-bar=off", "--disable-pip-version-check"]
    command += ["--retries=1", f"--timeout={STALL_SECONDS:.0f}"]
    places = dict.fromkeys(("TMPDIR", "TEMP", "TMP"), str(unfinished))
    progress.start(what, size)
    failed, said = _run(command, folder, unfinished, size, progress, os.environ | places)
    return _fetched(folder, "*.whl", failed, said, _pip_reason(spec, said))


def _run(
    command: list[str],
    folder: Path,
    growing: Path,
    size: int,
    progress: Progress,
    environment: Mapping[str, str] | None = None,
) -> tuple[bool, str]:
    """Whether the command failed, and what it said; `growing` tells how far it is."""
    log = folder / "said.log"
    with log.open("wb") as output:
        process = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            cwd=folder,
            env=environment,
        )
        try:
            while True:
                with contextlib.suppress(subprocess.TimeoutExpired):
                    process.wait(0.2)
                    break
                progress.at(min(size, _bytes_below(growing)))
        finally:
            process.kill()
            process.wait()
    if not process.returncode:
        progress.at(size)
    return process.returncode != 0, log.read_text("utf-8", "replace")


def _fetched(folder: Path, pattern: str, failed: bool, said: str, reason: str) -> Path:
    archives = list(folder.glob(pattern))
    if archives and not failed:
        return archives[0]
    if "ENOSPC" in said or f"[Errno {errno.ENOSPC}]" in said:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    raise DownloadError(reason, unreachable=True)


def _bytes_below(folder: Path) -> int:
    total = 0
    for place, _, names in os.walk(folder):  # unlike rglob, it bears folders that vanish meanwhile
        for name in names:
            with contextlib.suppress(OSError):
                total += Path(place, name).stat().st_size
    return total


def _npm_reason(spec: str, said: str) -> str:
    if any(code in said for code in ("E404", "ETARGET", "E403")):
        return f"the npm registry that npm is set up for does not have {spec}"
    unreached = ("ENOTFOUND", "ECONNREFUSED", "ETIMEDOUT", "EAI_AGAIN", "ECONNRESET", "ENETUNREACH")
    if any(code in said for code in unreached):
        return "npm cannot reach its registry"
    return f"npm could not fetch {spec}" + _quoted(said, "npm error", "npm ERR!")


def _pip_reason(spec: str, said: str) -> str:
    # Asked first: pip goes on to say that an index which it did not reach has no such package.
    if "connection broken by" in said or "Max retries exceeded" in said:
        return "pip cannot reach its package index"
    if "No matching distribution found" in said:
        return f"the package index that pip is set up for does not have {spec}"
    return f"pip could not fetch {spec}" + _quoted(said, "ERROR:")


def _quoted(said: str, *marks: str) -> str:
    """The first line of those that a mark shows to be an error, in brackets."""
    for line in said.splitlines():
        for mark in marks:
            if line.startswith(mark) and (rest := line.removeprefix(mark).strip()):
                return f" (it said: {rest})"
    return ""


# ── unpacking ────────────────────────────────────────────────────────────────────────────────


@dataclass(frozen=True)
class Unpacked:
    """One file that came out of an archive."""

    size: int
    sha256: str


def sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def unpack(archive: Path, inside: str, target: Path, progress: Progress) -> dict[str, Unpacked]:
    """Take the regular files under the folder `inside` of a zip or tar archive into `target`.

    Returns path relative to `target` -> size and SHA-256. Links, devices and names that would leave
    `target` are an error: no honest archive of data holds any.
    """
    try:
        members = _zip if zipfile.is_zipfile(archive) else _tar
        return _copy_out(members, archive, PurePosixPath(inside), target, progress)
    except (zipfile.BadZipFile, tarfile.TarError, EOFError, NotImplementedError) as error:
        raise DownloadError("the downloaded archive is broken") from error
    except OSError as error:
        if error.errno is None:  # gzip's BadGzipFile
            raise DownloadError("the downloaded archive is broken") from error
        raise


Member = tuple[str, int, bool, Callable[[], IO[bytes] | None]]  # name, size, is it a file, open it


def _zip(archive: Path) -> Iterator[Member]:
    with zipfile.ZipFile(archive) as file:
        for info in file.infolist():
            if not info.is_dir():
                # The upper half of external_attr is the Unix mode; 0o120000 is a symbolic link.
                link = (info.external_attr >> 16) & 0o170000 == 0o120000
                yield info.filename, info.file_size, not link, partial(file.open, info)


def _tar(archive: Path) -> Iterator[Member]:
    with tarfile.open(archive, "r|*") as file:
        for info in file:
            if not info.isdir():
                yield info.name, info.size, info.isreg(), partial(file.extractfile, info)


def _copy_out(
    members: Callable[[Path], Iterator[Member]],
    archive: Path,
    inside: PurePosixPath,
    target: Path,
    progress: Progress,
) -> dict[str, Unpacked]:
    files: dict[str, Unpacked] = {}
    progress.start("Unpacking", None)
    done = 0
    for name, size, is_file, opened in members(archive):
        path = PurePosixPath(name)
        if not path.is_relative_to(inside):
            continue
        relative = path.relative_to(inside)
        if not is_file or ".." in relative.parts or relative.is_absolute() or "\\" in name:
            raise DownloadError(f"the downloaded archive holds something unsafe ({name})")
        done += size
        if done > MOST_UNPACKED:
            raise DownloadError("the downloaded archive is far too large")
        source = opened()
        assert source is not None  # only links and the like have no content
        with source:
            files[str(relative)] = _copy(source, target / relative)
        progress.at(done)
    if not files:
        raise DownloadError(f"the downloaded archive has no folder {inside}")
    return files


def join(folder: Path, joined: Mapping[str, Sequence[str]], files: dict[str, Unpacked]) -> None:
    """Make each file in `folder` out of its parts, which go; `files` is set right."""
    for whole, parts in joined.items():
        if not files.keys() >= {*parts}:
            raise DownloadError(f"the downloaded archives lack parts of {whole}")
        digest = hashlib.sha256()
        with (folder / whole).open("wb") as target:
            for part in parts:
                with (folder / part).open("rb") as source:
                    while block := source.read(CHUNK):
                        target.write(block)
                        digest.update(block)
                (folder / part).unlink()
                with contextlib.suppress(OSError):  # a folder that holds more stays
                    (folder / part).parent.rmdir()
        size = sum(files.pop(part).size for part in parts)
        files[whole] = Unpacked(size, digest.hexdigest())


def _copy(source: IO[bytes], target: Path) -> Unpacked:
    target.parent.mkdir(parents=True, exist_ok=True)
    digest, size = hashlib.sha256(), 0
    with target.open("wb") as file:
        while block := source.read(CHUNK):
            file.write(block)
            digest.update(block)
            size += len(block)
    return Unpacked(size, digest.hexdigest())


# ── one at a time ────────────────────────────────────────────────────────────────────────────


@contextlib.contextmanager
def locked(path: Path, progress: Progress) -> Iterator[None]:
    """Hold the lock file `path`; waits while another process has it, and says so.

    The operating system drops the lock when its holder ends, however it ends.
    """
    with path.open("a+b") as file:
        if not _try_lock(file):
            progress.note("Another nl2robot is fetching a model; waiting for it.")
            while not _try_lock(file):
                time.sleep(0.2)
        yield


def _try_lock(file: IO[bytes]) -> bool:
    try:
        if sys.platform == "win32":
            import msvcrt

            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True
