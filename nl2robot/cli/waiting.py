"""What somebody at a terminal sees while a language model works, and their way out.

    with Waiting(language) as waiting:
        operator.translate(words, on_progress=waiting)

Where lines can be written again, the program is shown as it grows; else one line says what is going
on. It goes to standard error unless the terminal is written to anyway: what a command answers may
be read by another program.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

from grammar.planning.planner import Interrupted, Watch
from nl2robot.ctrl_c import ctrl_c_unheard
from nl2robot.errors import ExitStatus, UserError
from nl2robot.plain import visible
from nl2robot.translate.thinking import Progress, Thought
from nl2robot.words import words_in

if TYPE_CHECKING:
    from rich.console import Console
    from rich.live import Live

T = TypeVar("T")

FRAMES_A_SECOND = 10


class GivenUp(UserError):
    """Whoever asked a language model waits no longer."""

    def __init__(self, language: str) -> None:
        super().__init__(words_in(language)["given_up"], ExitStatus.INTERRUPTED)


class Waiting:
    """Shows how far a language model is, once one is asked; until then, nothing. Any thread may
    tell it."""

    def __init__(self, language: str, console: Console | None = None) -> None:
        """`console` is what the terminal is written to anyway."""
        self.begun = False
        """Whether a model was asked."""
        self._language = language
        self._console = console
        self._live: Live | None = None
        self._over = False
        self._lock = threading.Lock()

    def __enter__(self) -> Waiting:
        return self

    def __exit__(self, *_: object) -> None:
        with ctrl_c_unheard(), self._lock:
            self._over = True
            if self._live is not None:
                self._live.stop()

    def __call__(self, progress: Progress) -> None:
        with self._lock:
            if self._over:  # told late
                return
            if not self.begun:
                self.begun = True
                self._begin()
            if self._live is not None:
                self._live.update(self._picture(progress.text))

    def _begin(self) -> None:
        # Rich takes a moment to load, and most sentences need no model.
        from rich.console import Console
        from rich.live import Live

        console = self._console
        if console is None or not console.is_terminal:
            console = Console(stderr=True, highlight=False, emoji=False)
        if not console.is_terminal or console.is_dumb_terminal:
            console.print(words_in(self._language)["thinking"], markup=False)
            return
        self._live = Live(
            self._picture(""),
            console=console,
            refresh_per_second=FRAMES_A_SECOND,
            transient=True,
        )
        self._live.start(refresh=True)

    def _picture(self, program: str) -> Any:
        from rich.console import Group
        from rich.text import Text

        thinking = Text(words_in(self._language)["thinking"], style="dim")
        if not program:
            return thinking
        return Group(thinking, Text(_end(visible(program), self._room()), style="cyan"))

    def _room(self) -> int:
        """Lines that fit below the first."""
        return max(1, self._live.console.height - 2) if self._live is not None else 1


def _end(program: str, lines: int) -> str:
    """The last lines: what is being written."""
    return "\n".join(program.rstrip("\n").split("\n")[-lines:])


def thought_aloud(think: Callable[[Watch], T], language: str) -> T:
    """Think about something here, in view. Raises `GivenUp` after Ctrl-C."""
    with Waiting(language) as waiting:
        thought = Thought(think, waiting)
        try:
            return thought.result()
        except (KeyboardInterrupt, Interrupted) as error:
            with ctrl_c_unheard():
                thought.give_up()
            if not waiting.begun:
                raise
            raise GivenUp(language) from error
