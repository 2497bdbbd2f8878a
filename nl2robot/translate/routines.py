"""Routines on disk: commands that people gave a name, as the sentences they said or as programs.

One file for all, `routines.yaml` in the data folder, since a robot lives in one house; a routine
is known in the language it was said in. The sentence is understood anew whenever the routine is
used, so that it follows the world; a program that was kept stays as it was approved.

    routines:
      - {name: evening round, language: en, sentence: go to every ward and say good night,
         learned: 2026-11-21T19:30:00, by: Ana}
      - {name: tea round, language: en, program: 'robot.goto("lobby")', learned: ..., by: Ben}

What came from elsewhere (`imported`) is nobody's word here until somebody has looked at it: it
cannot be used before that (`reviewed`).

The file may be edited by hand: it is read again when it has changed.
"""

from __future__ import annotations

import os
import tempfile
import threading
from collections.abc import Callable, Iterable, Mapping
from datetime import datetime
from pathlib import Path
from typing import Any

import msgspec

from grammar.language import load_language
from nl2robot.errors import UserError
from nl2robot.paths import data_file, made
from robot_api.errors import cause


class Routine(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """A command with a name. Times are in ISO 8601, local."""

    name: str
    sentence: str = ""
    """What to do, as it was said; empty where a program says it."""
    language: str = "en"
    learned: str = ""
    """When it was learned."""
    program: str = ""
    """What to do, as a program that somebody kept; empty where a sentence says it."""
    by: str = ""
    """Who taught it."""
    changed: str = ""
    """When what it does was last changed."""
    changed_by: str = ""
    formerly: tuple[str, ...] = ()
    """Names that it had before."""
    imported: str = ""
    """The file that it came with, if it was not taught here."""
    reviewed: bool = True
    """Whether somebody here has looked at what it does; else it cannot be used."""
    reviewed_by: str = ""

    @property
    def body(self) -> str:
        """What says what it does."""
        return self.program or self.sentence

    def __post_init__(self) -> None:
        if bool(self.sentence.strip()) == bool(self.program.strip()):
            raise ValueError(f"“{self.name}” needs either a sentence or a program")


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
        self._watchers: list[Callable[[], None]] = []

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
        with self._lock:
            return self._known_as(name, language)

    def put(
        self, name: str, sentence: str, language: str, by: str = "", program: str = ""
    ) -> Routine:
        """Keep a routine, or let the one of this name do something else from now on."""
        now = _now()
        with self._lock:
            known = self._known_as(name, language)
            if known is None:
                new = Routine(name, sentence, language, now, program, by)
            else:
                new = msgspec.structs.replace(
                    known,
                    name=name,
                    sentence=sentence,
                    program=program,
                    changed=now,
                    changed_by=by,
                    # Whoever wrote it anew knows what it does.
                    reviewed=True,
                    reviewed_by="" if known.reviewed else by,
                )
            self._write((*self._others(name, language), new))
        return new

    def rename(self, name: str, new: str, language: str) -> None:
        """Call a routine otherwise; nothing if there is none of this name."""
        with self._lock:
            known = self._known_as(name, language)
            if known is not None:
                formerly = tuple(dict.fromkeys((*known.formerly, known.name)))
                renamed = msgspec.structs.replace(
                    known, name=new, formerly=tuple(n for n in formerly if n != new)
                )
                self._write((*self._others(name, language), renamed))

    def remove(self, name: str, language: str) -> Routine | None:
        """Forget a routine; returns what it was."""
        with self._lock:
            known = self._known_as(name, language)
            if known is not None:
                self._write(self._others(name, language))
        return known

    def take(self, chosen: Iterable[tuple[Routine, bool]]) -> list[Routine]:
        """Keep routines that come from elsewhere, all or none; each may replace the one of its name
        or not. Raises `UserError` if it may not, and there is one."""
        now = _now()
        with self._lock:
            kept = list(self._read())
            taken = []
            for routine, replace in chosen:
                there = next((each for each in kept if _same_name(each, routine)), None)
                if there is not None and not replace:
                    raise UserError(
                        f"There is a routine “{there.name}” already. Nothing was changed. Choose"
                        " another name, or have it replaced."
                    )
                new = msgspec.structs.replace(routine, learned=now)
                kept = [*(each for each in kept if each is not there), new]
                taken.append(new)
            self._write(kept)
        return taken

    def put_back(self, routine: Routine) -> None:
        """Keep a routine that was removed just as it was. Raises `UserError` if another one has
        its name meanwhile."""
        with self._lock:
            if self._known_as(routine.name, routine.language) is not None:
                raise UserError(
                    f"There is another routine “{routine.name}” by now. Rename that one first."
                )
            self._write((*self._read(), routine))

    def accept(self, name: str, language: str, body: str, by: str) -> Routine:
        """Somebody has looked at what an imported routine does: it may be used. Raises `UserError`
        if that is not what it does now."""
        with self._lock:
            known = self._known_as(name, language)
            if known is None or known.body != body:
                raise UserError(
                    f"The routine “{name}” has been changed or removed since you looked at it."
                    " Look at it again."
                )
            accepted = msgspec.structs.replace(known, reviewed=True, reviewed_by=by)
            self._write((*self._others(name, language), accepted))
        return accepted

    def watch(self, watcher: Callable[[], None]) -> Callable[[], None]:
        """Be told, from any thread, whenever something was changed here; returns what ends it."""
        self._watchers.append(watcher)
        return lambda: self._watchers.remove(watcher)

    # --- the file

    def _known_as(self, name: str, language: str) -> Routine | None:
        said = spelled(name, language)
        known = (r for r in self._read() if r.language == language)
        return next((r for r in known if spelled(r.name, language) == said), None)

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
        sorted_ = sorted(routines, key=lambda routine: (routine.language, routine.name.lower()))
        text = written({"routines": [as_data(routine) for routine in sorted_]})
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
        for watcher in tuple(self._watchers):
            watcher()


def open_routines() -> Routines:
    """The routines of this user, in the data folder."""
    return Routines(data_file("routines.yaml"))


def spelled(name: str, language: str) -> tuple[str, ...]:
    """A name as the grammar sees it: two names that are alike so are the same."""
    return load_language(language).tokens_of(name)


def as_data(routine: Routine) -> dict[str, Any]:
    """A routine as it stands in a file: what is not said is left out, but for its language."""
    data: dict[str, Any] = msgspec.to_builtins(routine)
    name = data.pop("name")
    body: dict[str, Any] = {
        part: data.pop(part) for part in ("sentence", "program") if part in data
    }
    return {"name": name, **body, **data, "language": routine.language}


def written(data: Mapping[str, Any]) -> str:
    """Data as YAML that people can read: programs stand line by line."""
    import yaml

    class Dumper(yaml.SafeDumper):
        pass

    def text(dumper: yaml.SafeDumper, value: str) -> yaml.ScalarNode:
        style = "|" if "\n" in value else None
        return dumper.represent_scalar("tag:yaml.org,2002:str", value, style)

    Dumper.add_representer(str, text)
    return yaml.dump(data, Dumper=Dumper, allow_unicode=True, sort_keys=False)


def _same_name(one: Routine, other: Routine) -> bool:
    return one.language == other.language and spelled(one.name, one.language) == spelled(
        other.name, other.language
    )


def _now() -> str:
    return datetime.now().isoformat(timespec="seconds")


def _parsed(text: str, file: Path) -> tuple[Routine, ...]:
    import yaml

    try:
        data = yaml.load(text, Loader=yaml.BaseLoader)  # names such as "on" stay what they are
        return msgspec.convert(data or {}, _File, strict=False).routines
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
