"""Models for speech and language: which there are, which are installed, fetching one and checking
it.

    list_models() -> list[Listed]     get("en", progress) -> Path     find("en") -> Path | None
    verify("en") -> list of problems, empty when nothing is wrong

A model is a folder `<models>/en` with a manifest of its files. It is put in place by one rename
once it is complete and checked, so a folder that is there is whole. A folder that somebody
unpacked there by hand (a hospital without internet) is used as it is. Where models come from is
data (`sources`).

A language has the model that its code names, and may have another beside it (`en-moonshine`),
which is fetched after it: where that one cannot be had, the language is heard less well, and that
is all. With some of these (`whisper`) a language can also be heard where its own cannot be had.

Every failure is a `ModelError`: what happened, and what to do next.
"""

from __future__ import annotations

import errno
import os
import shutil
import tempfile
import time
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any, ClassVar, Final
from urllib.parse import urlsplit

import msgspec

from nl2robot.errors import UserError
from nl2robot.models import download, single_file
from nl2robot.models.download import MEGABYTE, DownloadError, Progress, Silent, Unpacked
from nl2robot.models.sources import (
    NEEDED,
    Archive,
    Engine,
    File,
    Model,
    Npm,
    Parts,
    Registry,
    Single,
    Source,
    Split,
    Zip,
    load_registry,
)
from nl2robot.paths import data_folder

MANIFEST = "nl2robot-manifest.json"
PLANNER, LARGE = "planner", "planner-large"
"""The language models, the small one and the large one."""
REMEMBERED_SECONDS = 60.0  # how long a source that cannot be reached is left alone


class ModelError(UserError):
    """A model is missing, damaged or cannot be fetched."""


class Manifest(msgspec.Struct, frozen=True):
    """What lies beside an installed model: where it came from and what belongs to it."""

    source: str
    licence: str
    archive_sha256: str
    files: dict[str, tuple[int, str]]  # path in the model's folder -> size, SHA-256


_MANIFESTS: Final = msgspec.json.Decoder(Manifest)  # before there are threads, see `Registry`


@dataclass(frozen=True)
class Listed:
    """One line of `nl2robot models list`."""

    code: str  # "en"
    language: str  # "English"
    engine: Engine
    beside: tuple[str, ...]  # ("en",) if it is the second model of that language
    state: str  # "installed", "damaged" or "missing"
    path: Path  # where it is or would be
    source: str | None  # what it was made from, where that is known
    licence: str | None
    megabytes: float  # on the disk if installed, else of the download


def models_folder() -> Path:
    """`$NL2ROBOT_MODELS`, else the folder "models" in nl2robot's data folder; may not exist yet."""
    chosen = os.environ.get("NL2ROBOT_MODELS")
    return Path(chosen).expanduser() if chosen else data_folder() / "models"


# ── what is installed ────────────────────────────────────────────────────────────────────────


def find(code: str, registry: Registry | None = None) -> Path | None:
    """The folder of the installed model of this code, or None. Looks at sizes, not contents."""
    # Somebody may have put a vosk model there by hand for a language that has none here.
    model = (load_registry() if registry is None else registry).get(code)
    folder = models_folder() / code
    return folder if _state(folder, model.engine if model else "vosk") == "installed" else None


def need(code: str) -> Path:
    """The folder of the installed model, or of one beside it that hears the language alone; or a
    ModelError that says how to get it."""
    registry = load_registry()
    path = find(code, registry) or _alone(code, registry)
    if path is not None:
        return path
    model = _known(code, registry)
    if _state(models_folder() / code, model.engine) == "damaged":
        raise ModelError(f"The {model.name} is damaged. {_get(code)} again.")
    raise ModelError(f"The {model.name} is not installed. {_get(code)}.")


def _alone(code: str, registry: Registry) -> Path | None:
    """The model with which alone this language can be heard, if one is installed."""
    found = (
        find(other, registry) for other, model in _beside(code, registry) if code in model.alone
    )
    return next(filter(None, found), None)


def _get(code: str) -> str:
    return f"Run `nl2robot models get {code}` to fetch it"


def _get_again(code: str) -> str:
    return f"Run `nl2robot models get {code} --again` to fetch it again"


def list_models(registry: Registry | None = None) -> list[Listed]:
    """Every model of the registry, and how it stands."""
    return [
        _listed(code, model)
        for code, model in (load_registry() if registry is None else registry).items()
    ]


def _listed(code: str, model: Model) -> Listed:
    folder = models_folder() / code
    state = _state(folder, model.engine)
    manifest = _manifest(folder)
    if state == "missing":
        size = model.sources[0].megabytes
    else:
        size = sum(p.stat().st_size for p in folder.rglob("*") if p.is_file()) / MEGABYTE
    return Listed(
        code=code,
        language=model.language,
        engine=model.engine,
        beside=model.beside,
        state=state,
        path=folder,
        source=manifest.source if manifest else None,
        licence=manifest.licence if manifest else None,
        megabytes=size,
    )


def _state(folder: Path, engine: Engine) -> str:
    if not folder.is_dir():
        return "missing"
    if _lacking(folder, engine):
        return "damaged"
    manifest = _manifest(folder)
    whole = manifest is None or all(
        (folder / name).is_file() and (folder / name).stat().st_size == size
        for name, (size, _) in manifest.files.items()
    )
    return "installed" if whole else "damaged"


def _lacking(folder: Path, engine: Engine) -> list[str]:
    """The files without which no folder is a model."""
    lacking = [_empty(folder, files) for files in NEEDED[engine]]
    return [] if [] in lacking else lacking[-1]


def _empty(folder: Path, names: Iterable[str]) -> list[str]:
    paths = {name: folder / name for name in names}
    return [name for name, path in paths.items() if not (path.is_file() and path.stat().st_size)]


def _manifest(folder: Path) -> Manifest | None:
    try:
        return _MANIFESTS.decode((folder / MANIFEST).read_bytes())
    except (OSError, msgspec.DecodeError):
        return None


def verify(
    code: str, progress: Progress | None = None, registry: Registry | None = None
) -> list[str]:
    """Read every file of the installed model; a sentence for each thing that is wrong with it.

    Goes on to the models beside it. Raises ModelError if it is not installed at all.
    """
    progress = progress or Silent()
    registry = load_registry() if registry is None else registry
    model = _known(code, registry)
    if (models_folder() / code).is_dir():
        problems = _verify(code, model, progress)
    elif _alone(code, registry):
        problems = []
    else:
        raise ModelError(f"The {model.name} is not installed. {_get(code)}.")
    for other, second in _beside(code, registry):
        if (models_folder() / other).is_dir():
            problems += _verify(other, second, progress)
        else:
            progress.note(_unusable(other, second, "not installed"))
    return problems


def lacking_beside(code: str) -> list[str]:
    """A sentence for each model beside this one that cannot be used: what to do about it."""
    registry = load_registry()
    states = {
        other: _state(models_folder() / other, model.engine)
        for other, model in _beside(code, registry)
    }
    return [
        _unusable(other, registry[other], "damaged" if state == "damaged" else "not installed")
        for other, state in states.items()
        if state != "installed"
    ]


def _unusable(code: str, model: Model, state: str) -> str:
    return f"The {model.name} is {state}. {_without(model)} {_get(code)}."


def _verify(code: str, model: Model, progress: Progress) -> list[str]:
    folder = models_folder() / code
    manifest = _manifest(folder)
    if manifest is None:
        return [
            f"The {model.name} lacks {name}. {_get_again(code)}."
            for name in _lacking(folder, model.engine)
        ]
    problems = []
    progress.start(f"Checking {model.name}", sum(size for size, _ in manifest.files.values()))
    done = 0
    for name, (size, sha256) in manifest.files.items():
        path = folder / name
        if not path.is_file():
            problems.append(f"The {model.name} lacks the file {name}. {_get_again(code)}.")
        elif path.stat().st_size != size or download.sha256(path) != sha256:
            problems.append(f"The file {name} of the {model.name} is damaged. {_get_again(code)}.")
        done += size
        progress.at(done)
    return problems


def _known(code: str, registry: Registry) -> Model:
    if code not in registry:
        codes = ", ".join(code for code in registry if "-" not in code or code == LARGE)
        raise ModelError(f"There is no model called “{code}”. Choose one of: {codes}.")
    return registry[code]


def _beside(code: str, registry: Registry) -> list[tuple[str, Model]]:
    return [(other, model) for other, model in registry.items() if code in model.beside]


def _without(model: Model) -> str:
    are = "are" if len(model.beside) > 1 else "is"
    return f"{model.language} {are} heard less well without it."


# ── fetching one ─────────────────────────────────────────────────────────────────────────────


def get(
    code: str,
    progress: Progress | None = None,
    registry: Registry | None = None,
    *,
    again: bool = False,
) -> Path:
    """The folder of the model of this code, fetched if need be; at once when it is installed.

    Tries the sources in order, then those of the models beside it; that one of these cannot be had
    is only a note, and so is that the language's own cannot, where one beside it will do.
    `again` fetches even if it is installed. Safe to call from several processes at once, and to
    interrupt at any moment: the old model, or none, is then in place.
    """
    progress = progress or Silent()
    registry = load_registry() if registry is None else registry
    missing: ModelError | None = None
    try:
        path = _get_one(code, progress, registry, again)
    except ModelError as error:
        if not any(code in model.alone for _, model in _beside(code, registry)):
            raise
        missing = error
    for other, model in _beside(code, registry):
        try:
            _get_one(other, progress, registry, again)
        except ModelError as error:
            without = "" if find(other, registry) else f" {_without(model)}"
            progress.note(f"{error}{without}")
    if missing is None:
        return path
    instead = _alone(code, registry)
    if instead is None:
        raise missing
    progress.note(f"{missing} Until then the {_known(instead.name, registry).name} hears alone.")
    return instead


def _get_one(code: str, progress: Progress, registry: Registry, again: bool) -> Path:
    model = _known(code, registry)
    installed = None if again else find(code, registry)
    if installed is not None:
        return installed
    folder = models_folder()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with download.locked(folder / ".lock", progress):
            # Another process may have fetched it while this one waited.
            installed = None if again else find(code, registry)
            return installed or _Fetching(code, model, folder, progress).run()
    except OSError as error:
        if error.errno == errno.ENOSPC:
            raise ModelError(_full(model, folder)) from error
        raise ModelError(
            f"The folder for models {folder} cannot be written ({error.strerror}). "
            "Make it writable, or set NL2ROBOT_MODELS to another folder."
        ) from error


def _full(model: Model, folder: Path) -> str:
    return (
        f"The disk is full: there is no room for the {model.name} in {folder}. "
        "Free some space, or set NL2ROBOT_MODELS to a folder on another disk."
    )


class _Fetching:
    """One run through the sources of one model, with the lock held."""

    # Sources that could not be reached, why, and until when (time.monotonic) they are not asked
    # again: three languages in a row should not wait three times for the same publisher.
    unreachable: ClassVar[dict[str, tuple[str, float]]] = {}

    def __init__(self, code: str, model: Model, folder: Path, progress: Progress) -> None:
        self.code, self.model, self.folder, self.progress = code, model, folder, progress

    def run(self) -> Path:
        for stale in self.folder.glob(".new-*"):  # left by a process that was killed
            shutil.rmtree(stale, ignore_errors=True)
        reasons = []
        for source in self.model.sources:
            place = _asked(source)
            reason, until = self.unreachable.get(place, ("", 0.0))
            if time.monotonic() >= until:
                try:
                    return self.from_source(source)
                except DownloadError as error:
                    reason = str(error)
                    if error.unreachable:
                        self.unreachable[place] = reason, time.monotonic() + REMEMBERED_SECONDS
            reasons.append(reason)
            if source is not self.model.sources[-1]:
                self.progress.note(f"{source.name}: {reason}. Trying another source.")
        raise ModelError(self._no_source(reasons))

    def from_source(self, source: Source) -> Path:
        if isinstance(source, File | Split):
            return self.from_one_file(source)
        # Download, its unpacked files and npm's or pip's own copy lie side by side for a moment.
        room = int(source.megabytes * MEGABYTE * 4)
        if shutil.disk_usage(self.folder).free < room:
            raise ModelError(_full(self.model, self.folder))
        with tempfile.TemporaryDirectory(prefix=".new-", dir=self.folder) as name:
            model = Path(name) / "model"
            files: dict[str, Unpacked] = {}
            checksums = []
            for part in source.parts if isinstance(source, Parts) else [source]:
                checksum = self.part(part, Path(name), model, files)
                checksums.append(checksum)
            if isinstance(source, Parts):
                download.join(model, source.joined, files)
            self.install(source, ", ".join(checksums), files, model)
        return self.folder / self.code

    def from_one_file(self, source: Single) -> Path:
        # It, and what is made from it.
        if shutil.disk_usage(self.folder).free < int(source.megabytes * MEGABYTE * 2.5):
            raise ModelError(_full(self.model, self.folder))
        what = f"Fetching {self.model.name}"
        whole = single_file.fetched(source, self.folder, what, self.progress)
        with tempfile.TemporaryDirectory(prefix=".new-", dir=self.folder) as name:
            model = Path(name) / "model"
            model.mkdir()
            self.progress.start(f"Preparing {self.model.name}", None)
            self.prepare(whole, model)
            files = {
                path.name: Unpacked(path.stat().st_size, download.sha256(path))
                for path in model.iterdir()
            }
            self.install(source, source.sha256, files, model)
        single_file.forget(source, self.folder)
        return self.folder / self.code

    def prepare(self, whole: Path, folder: Path) -> None:
        """Make what the engine loads from the file that came."""
        from nl2robot.language_model.install import Unreadable, install

        try:
            install(whole, folder)
        except ImportError as error:
            raise ModelError(
                f"The {self.model.name} cannot be prepared, since {error.name} is not installed."
                " Run `pip install 'nl2robot[planner]'`, then fetch it again."
            ) from error
        except Unreadable as error:
            raise DownloadError(str(error)) from error

    def part(self, source: Archive, folder: Path, model: Path, files: dict[str, Unpacked]) -> str:
        """Unpack one archive into `model`, add its `files`; returns its checksum."""
        with tempfile.TemporaryDirectory(dir=folder) as name:
            archive, where = self.fetched(source, Path(name))
            try:
                checksum = download.sha256(archive)
                self.check(source, where, checksum)
                into = PurePosixPath("." if isinstance(source, Zip) else source.into)
                found = download.unpack(archive, source.folder, model / into, self.progress)
                files |= {str(into / path): file for path, file in found.items()}
            finally:
                # Whole and good, or not to be trusted: there is nothing left to resume.
                archive.unlink(missing_ok=True)
        if source.sha256 is None:
            self.record(where, checksum)
        return checksum

    def fetched(self, source: Archive, work: Path) -> tuple[Path, str]:
        """The downloaded archive, and where it came from."""
        if isinstance(source, Zip):
            return self.zip(source)
        size, what = int(source.megabytes * MEGABYTE), self.what(source)
        if isinstance(source, Npm):
            archive = download.npm_pack(source.name, work, size, what, self.progress)
        else:
            archive = download.pip_download(
                source.name, source.platform, work, size, what, self.progress
            )
        return archive, _asked(source)

    def zip(self, source: Zip) -> tuple[Path, str]:
        if source.sha256 is None and not download.is_private(source.url):
            raise DownloadError(f"{source.url} has no checksum and is not a secure address")
        part = self.folder / f".{source.name}.part"
        came_from = download.fetch(source.url, part, self.what(source), self.progress)
        if source.sha256 is None and not download.is_private(came_from):
            part.unlink()
            raise DownloadError(f"{source.url} led to an address that is not secure")
        return part, source.url

    def what(self, source: Archive) -> str:
        return f"Fetching {self.model.name} ({source.name})"

    def check(self, source: Archive, where: str, checksum: str) -> None:
        """The download is the file it should be: as pinned, or the same as the first time."""
        expected = source.sha256 or self.recorded().get(where)
        if expected is not None and checksum != expected:
            accept = (
                ""
                if source.sha256
                else f"; if its publisher has renewed it, delete {self.records} to accept that"
            )
            raise DownloadError(
                f"what came from {where} is not the expected file (its checksum differs{accept})"
            )
        if expected is None:
            self.progress.note(
                f"{where} has no checksum known to nl2robot and was trusted because it came over a "
                f"secure connection. Its SHA-256 is {checksum}; a different file will be refused."
            )

    def install(
        self, source: Source, checksum: str, files: dict[str, Unpacked], model: Path
    ) -> None:
        if _lacking(model, self.model.engine):
            raise DownloadError(f"{source.name} does not hold such a model")
        manifest = Manifest(
            source=source.name,
            licence=source.licence,
            archive_sha256=checksum,
            files={name: (file.size, file.sha256) for name, file in files.items()},
        )
        (model / MANIFEST).write_bytes(msgspec.json.format(msgspec.json.encode(manifest), indent=1))
        target = self.folder / self.code
        if target.exists():
            target.rename(model.with_name("old"))  # goes with the temporary folder
        model.rename(target)

    @property
    def records(self) -> Path:
        return self.folder / "trusted-checksums.json"

    def recorded(self) -> dict[str, str]:
        try:
            return msgspec.json.decode(self.records.read_bytes(), type=dict[str, str])
        except FileNotFoundError:
            return {}
        except msgspec.DecodeError as error:
            raise ModelError(
                f"The file {self.records} is damaged. Delete it to trust the publisher anew."
            ) from error

    def record(self, where: str, checksum: str) -> None:
        new = self.records.with_suffix(".new")
        new.write_bytes(msgspec.json.encode(self.recorded() | {where: checksum}))
        new.replace(self.records)

    def _no_source(self, reasons: list[str]) -> str:
        by_hand = ""
        publisher = next((s for s in self.model.sources if isinstance(s, Zip | File)), None)
        if isinstance(publisher, File):
            by_hand = (
                f" Or fetch {publisher.url} on another computer, put it into {self.folder},"
                " and run the command again."
            )
        elif publisher is not None:
            held = sorted({name.split("/")[0] for name in NEEDED[self.model.engine][-1]})
            by_hand = (
                f" Or fetch {publisher.url} on another computer and unpack it so that "
                f"{self.folder / self.code} holds its {', '.join(held[:-1])} and {held[-1]}."
            )
        return (
            f"The {self.model.name} could not be fetched: {'; '.join(reasons)}. "
            f"Connect to the internet{self._or_install(reasons)} and run "
            f"`nl2robot models get {self.code}` again.{by_hand}"
        )

    def _or_install(self, reasons: list[str]) -> str:
        lacking = [tool for tool in ("npm", "pip") if f"{tool} is not installed" in reasons]
        return f" or install {' and '.join(lacking)}" if lacking else ""


def _asked(source: Source) -> str:
    if isinstance(source, Zip | File):
        return urlsplit(source.url).netloc
    if isinstance(source, Split):
        return f"pypi:{source.name}"
    if isinstance(source, Parts):
        return _asked(source.parts[0])
    return f"{'npm' if isinstance(source, Npm) else 'pypi'}:{source.name}"


def as_json(listed: Listed) -> dict[str, Any]:
    """A `Listed` for `--json`."""
    return {**vars(listed), "path": str(listed.path)}
