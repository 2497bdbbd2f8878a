"""Routines on disk: commands that people gave a name, as the sentences they said.

One file for all, `routines.yaml` in the data folder, since a robot lives in one house; a routine
is known in the language it was said in. The sentence is understood anew whenever the routine is
used, so that it follows the world; what it does is therefore kept nowhere.

    routines:
      - {name: evening round, language: en, sentence: go to every ward and say good night,
         learned: 2026-11-21T19:30:00}

The file may be edited by hand: it is read again when it has changed.
"""

from __future__ import annotations

import os
import tempfile
import threading
from collections.abc import Iterable
from datetime import datetime
from pathlib import Path

import msgspec

from grammar.language import load_language
from nl2robot.errors import UserError
from nl2robot.paths import data_file, made
from robot_api.errors import cause


class Routine(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A command with a name."""

    name: str
    sentence: str
    """What to do, as it was said."""
    language: str = "en"
    learned: str = ""
    """When it was learned, in ISO 8601, local time."""


class _File(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    routines: tuple[Routine, ...] = ()


msgspec.json.Decoder(_File)  # learned before there are threads, see `robot_api.schema`


class Routines:
    """The routines of a file; every change is on disk when the method returns. Threads may share
    it. Raises `UserError` where the file cannot be used."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self._lock = threading.Lock()
        self._seen: tuple[int, int] | None = None
        """Time and size of the file that was read last."""
        self._known: tuple[Routine, ...] = ()

    def known(self, language: str | None = None) -> tuple[Routine, ...]:
        """All routines, or those of a language, by name."""
        with self._lock:
            return tuple(
                routine
                for routine in self._read()
                if language is None or routine.language == language
            )

    def get(self, name: str, language: str) -> Routine | None:
        """The routine of this name, however its name is spelled: "Evening  Round"."""
        said = spelled(name, language)
        return next((r for r in self.known(language) if spelled(r.name, language) == said), None)

    def put(self, name: str, sentence: str, language: str) -> Routine:
        """Keep a routine in the place of the one of this name, if there is one."""
        learned = datetime.now().isoformat(timespec="seconds")
        new = Routine(name, sentence, language, learned)
        with self._lock:
            self._write((*self._others(name, language), new))
        return new

    def rename(self, name: str, new: str, language: str) -> None:
        """Call a routine otherwise; nothing if there is none of this name."""
        known = self.get(name, language)
        if known is not None:
            with self._lock:
                renamed = msgspec.structs.replace(known, name=new)
                self._write((*self._others(name, language), renamed))

    def remove(self, name: str, language: str) -> None:
        with self._lock:
            self._write(self._others(name, language))

    # --- the file

    def _others(self, name: str, language: str) -> tuple[Routine, ...]:
        said = spelled(name, language)
        return tuple(
            routine
            for routine in self._read()
            if routine.language != language or spelled(routine.name, language) != said
        )

    def _read(self) -> tuple[Routine, ...]:
        try:
            status = self.file.stat()
            seen = (status.st_mtime_ns, status.st_size)
            if seen != self._seen:
                self._known = _parsed(self.file.read_text(encoding="utf-8"), self.file)
                self._seen = seen
        except FileNotFoundError:
            self._known, self._seen = (), None
        except (OSError, UnicodeDecodeError) as error:
            raise UserError(
                f"The file of the routines, {self.file}, cannot be read ({cause(error)})."
                " Mend it, or move it away to begin anew."
            ) from error
        return self._known

    def _write(self, routines: Iterable[Routine]) -> None:
        """All or nothing: whoever reads sees the old file or the new one."""
        import yaml

        sorted_ = sorted(routines, key=lambda routine: (routine.language, routine.name.lower()))
        text = yaml.safe_dump(
            msgspec.to_builtins(_File(tuple(sorted_))), allow_unicode=True, sort_keys=False
        )
        folder = made(self.file.parent)
        try:
            handle, new = tempfile.mkstemp(prefix=".routines-", dir=folder)
            try:
                with open(handle, "w", encoding="utf-8") as file:  # noqa: PTH123 - a descriptor
                    file.write(text)
                    file.flush()
                    os.fsync(file.fileno())
                Path(new).replace(self.file)
            except BaseException:
                Path(new).unlink(missing_ok=True)
                raise
        except OSError as error:
            raise UserError(
                f"The routines cannot be kept in {self.file} ({error.strerror})."
                " Check its place, its rights and the disk."
            ) from error


def open_routines() -> Routines:
    """The routines of this user, in the data folder."""
    return Routines(data_file("routines.yaml"))


def spelled(name: str, language: str) -> tuple[str, ...]:
    """A name as the grammar sees it: two names that are alike so are the same."""
    return load_language(language).tokens_of(name)


def _parsed(text: str, file: Path) -> tuple[Routine, ...]:
    import yaml

    try:
        data = yaml.load(text, Loader=yaml.BaseLoader)  # names such as "on" stay what they are
        return msgspec.convert(data or {}, _File).routines
    except yaml.MarkedYAMLError as error:
        line = f":{error.problem_mark.line + 1}" if error.problem_mark else ""
        raise _broken(f"{file}{line}", f"it is no YAML: {error.problem}") from error
    except (yaml.YAMLError, msgspec.ValidationError) as error:
        raise _broken(str(file), str(error)) from error


def _broken(where: str, why: str) -> UserError:
    return UserError(
        f"{where}: the file of the routines cannot be used ({why})."
        " Mend it, or move it away to begin anew."
    )
