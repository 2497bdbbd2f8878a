"""The dialogues of all browsers. They are kept in files, so that a server that is started anew goes
on with them: what was said, and the program that waited for a decision."""

from __future__ import annotations

import logging
import threading
from collections import OrderedDict
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any, Final

import msgspec

from nl2robot.console.desk.dialogue import Dialogue, Draft, Line
from nl2robot.run.archive import state_of
from nl2robot.run.state import GOING, Reviewing
from nl2robot.station.part import STOP, Backstage
from nl2robot.translate.outcome import Scheduled, Translation

IN_MEMORY: Final = 50
IN_FILES: Final = 200
THREADS: Final = 2 * IN_MEMORY
"""At most; in each, a sentence is understood or something is decided."""

_log = logging.getLogger(__name__)


class _Waiting(msgspec.Struct):
    """A draft, without its review, which is made anew."""

    program: str
    translation: Translation | None
    heard: str | None
    continues: int | None = None
    said: str | None = None
    proposed: str | None = None
    changed_by: str | None = None
    times: Scheduled | None = None

    @classmethod
    def of(cls, draft: Draft) -> _Waiting:
        return cls(*(getattr(draft, name) for name in cls.__struct_fields__))

    def draft(self) -> Draft:
        return Draft(**{name: getattr(self, name) for name in self.__struct_fields__})


class _Kept(msgspec.Struct):
    lines: list[Line]
    runs: list[int]
    draft: _Waiting | None


msgspec.json.Decoder(_Kept)  # learned before there are threads, see `robot_api.schema`


class Dialogues:
    """Those of all browsers; the one unused longest is forgotten first."""

    def __init__(self, backstage: Backstage, folder: Path) -> None:
        self._backstage = backstage
        self._folder = folder
        self._dialogues: OrderedDict[str, Dialogue] = OrderedDict()
        self._languages: dict[str, str] = {}
        self._written: dict[str, bytes] = {}
        self._writing = threading.Lock()
        # Not the page's own few threads: who waits for a language model must not keep others from
        # approving and editing.
        self.threads = ThreadPoolExecutor(THREADS, "desk")
        """For what takes its time."""
        self._forget_old_files()

    def of(self, name: str, language: str) -> Dialogue:
        """The one of this name, begun if there is none."""
        if name not in self._dialogues:
            dialogue = Dialogue(self._backstage, name)
            self._recall(dialogue, language)
            dialogue.watch(partial(self._keep, dialogue))
            dialogue.watch(partial(self._tell_review, dialogue))
            self._dialogues[name] = dialogue
        self._dialogues.move_to_end(name)
        self._languages[name] = language
        while len(self._dialogues) > IN_MEMORY:
            forgotten, _ = self._dialogues.popitem(last=False)
            self._languages.pop(forgotten, None)
            self._written.pop(forgotten, None)
        return self._dialogues[name]

    def on_event(self, kind: str, data: Mapping[str, Any]) -> None:
        """Tell whoever started a run that it is over. When the robot is stopped, nothing more is
        thought about, lest it moves on."""
        if kind == STOP:
            self._cancel_all()
        if kind != "program" or data["what"] != "state" or data["state"] in GOING:
            return
        for name, dialogue in tuple(self._dialogues.items()):
            language = self._languages.get(name, "en")
            dialogue.ended(data["run"], data["state"], data["message"], language)

    def later(self, act: Callable[..., None], *arguments: Any) -> None:
        """Do something that nobody waits for."""
        with suppress(RuntimeError):  # it was closed meanwhile
            self.threads.submit(act, *arguments)

    def close(self) -> None:
        """Nobody is left to whom anything could be told."""
        self._cancel_all()
        self.threads.shutdown(wait=False)

    def _cancel_all(self) -> None:
        for name, dialogue in tuple(self._dialogues.items()):
            if dialogue.thought is not None:  # who stops the robot does not wait for it
                self.later(dialogue.cancel, self._languages.get(name, "en"))

    def _tell_review(self, dialogue: Dialogue) -> None:
        """Whether a program lies before somebody is a part of how the robot stands."""
        lies = dialogue.draft is not None and dialogue.attended
        self._backstage.runner.present.happened(Reviewing(dialogue.name, lies))

    # --- files

    def _keep(self, dialogue: Dialogue) -> None:
        draft = dialogue.draft
        waiting = _Waiting.of(draft) if draft else None
        kept = msgspec.json.encode(_Kept(dialogue.lines, sorted(dialogue.runs), waiting))
        with self._writing:
            if self._written.get(dialogue.name) == kept:
                return
            file = self._file(dialogue.name)
            new = file.with_suffix(".new")
            try:
                self._folder.mkdir(parents=True, exist_ok=True)
                new.write_bytes(kept)
                new.replace(file)
            except OSError as error:  # it goes on without being kept
                _log.warning("A conversation could not be kept: %s", error)
            self._written[dialogue.name] = kept

    def _recall(self, dialogue: Dialogue, language: str) -> None:
        try:
            kept = msgspec.json.decode(self._file(dialogue.name).read_bytes(), type=_Kept)
        except FileNotFoundError:
            return
        except (OSError, msgspec.DecodeError) as error:  # such as one of another version
            _log.warning("A conversation could not be read: %s", error)
            return
        dialogue.lines = kept.lines
        if kept.draft:
            dialogue.draft = kept.draft.draft()
        dialogue.runs = set(kept.runs)
        for run in kept.runs:
            self._tell_end(dialogue, run, language)

    def _tell_end(self, dialogue: Dialogue, run: int, language: str) -> None:
        """Say how a run ended while its dialogue was not in memory."""
        logged = self._backstage.runner.log.run(run)
        if logged is None:
            dialogue.runs.discard(run)
            return
        state = state_of(logged.status, logged.process)
        if state != "running":
            dialogue.ended(run, state, logged.message, language)

    def _file(self, name: str) -> Path:
        return self._folder / f"{name}.json"

    def _forget_old_files(self) -> None:
        files = sorted(self._folder.glob("*.json"), key=lambda file: file.stat().st_mtime)
        for old in files[:-IN_FILES]:
            old.unlink(missing_ok=True)
