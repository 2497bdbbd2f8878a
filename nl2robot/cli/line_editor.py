"""Typing at the terminal: Tab completes, the arrow keys bring back earlier commands.

    editor = LineEditor(data_file("history"), lambda line: completions(line, sentences, names))
    editor.command("you: ")        # kept, in this session and those after it
    input("[a]pprove? ")           # not kept: an answer is no command

Python's readline is one for the whole process, so there is one editor at a time.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Final

MOST_KEPT: Final = 1000
"""Commands in the history file; the oldest are forgotten."""
_OURS_ALONE: Final = 0o600

Complete = Callable[[str], Sequence[str]]
"""The whole lines that a line may become."""


class LineEditor:
    """Reads commands. Without readline (Windows) it reads them, and no more."""

    def __init__(self, history: Path, complete: Complete) -> None:
        try:
            import readline
        except ImportError:
            self._readline = None
            return
        self._readline = readline
        self._history = history
        self._complete = complete
        self._matches: Sequence[str] = ()
        readline.set_auto_history(False)
        readline.set_completer_delims("")  # the names of places have blanks in them
        libedit = "libedit" in (readline.__doc__ or "")
        readline.parse_and_bind("bind ^I rl_complete" if libedit else "tab: complete")
        readline.clear_history()
        for line in self._kept():
            readline.add_history(line)

    def command(self, prompt: str) -> str:
        """The next command. Raises `EOFError`, as `input` does."""
        if self._readline is None:
            return input(prompt)
        self._readline.set_completer(self._match)
        try:
            line = input(prompt)
        finally:
            self._readline.set_completer(_nothing)
        self.remember(line)
        return line

    def remember(self, line: str) -> None:
        """Keep a command, for whoever presses the upward arrow; not twice in a row."""
        line = line.strip()
        if self._readline is None or not line or "\n" in line:
            return
        last = self._readline.get_current_history_length()
        if last and self._readline.get_history_item(last) == line:
            return
        self._readline.add_history(line)
        with contextlib.suppress(OSError):  # a full disk: it is known until the end of the session
            self._write([line], os.O_APPEND)

    def _kept(self) -> list[str]:
        try:
            lines = self._history.read_text(encoding="utf-8", errors="replace").splitlines()
        except OSError:  # there is none yet
            return []
        kept = [line for line in lines if line][-MOST_KEPT:]
        with contextlib.suppress(OSError):
            self._history.chmod(_OURS_ALONE)
            if len(lines) > MOST_KEPT:
                self._write(kept, os.O_TRUNC)
        return kept

    def _write(self, lines: Iterable[str], how: int) -> None:
        """What people told a robot may be about patients: nobody else reads it."""
        self._history.parent.mkdir(parents=True, exist_ok=True)
        handle = os.open(self._history, os.O_WRONLY | os.O_CREAT | how, _OURS_ALONE)
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.writelines(f"{line}\n" for line in lines)

    def _match(self, line: str, number: int) -> str | None:
        if number == 0:
            self._matches = self._complete(line)
        return self._matches[number] if number < len(self._matches) else None


def _nothing(line: str, number: int) -> None:
    """Answers are not completed, nor are the names of files, which is what readline would do."""
