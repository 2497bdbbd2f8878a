"""How a page shows that a sentence is being thought about: a bubble in the conversation, with the
program as it is written and a button that ends it."""

from __future__ import annotations

from asyncio import AbstractEventLoop, TimerHandle
from collections.abc import Mapping
from typing import Final

from markupsafe import Markup

from nl2robot.console.desk.dialogue import Dialogue
from nl2robot.console.desk.highlight import highlighted

EVERY: Final = 0.1
"""Seconds between two looks at a growing program; a model may write faster than anybody reads."""


class ThoughtView:
    """The bubble of one page, built where it is made. For the loop of the pages only, but for
    `grown`."""

    def __init__(self, dialogue: Dialogue, words: Mapping[str, str], loop: AbstractEventLoop):
        from nicegui import ui

        self._dialogue = dialogue
        self._loop = loop
        self._due: TimerHandle | None = None
        self._drawn_at = 0.0
        with ui.element("div").classes("thought").props('id="thought"') as self._bubble:
            ui.html(
                Markup(
                    '<p class="thought-head"><span class="dots" aria-hidden="true"><i></i><i></i>'
                    '<i></i></span><span class="at-once">{}</span><span class="deep" role="status">'
                    '{}</span><button type="button" id="cancel" class="button small deep"'
                    ' aria-keyshortcuts="Escape" title="{}">{}</button></p>'
                ).format(
                    words["one_moment"], words["thinking"], words["cancel_hint"], words["cancel"]
                ),
                sanitize=False,
            )
            # Nobody wants to be read a program word by word.
            self._program = ui.html("", sanitize=False).props('aria-live="off"')
        self._bubble.set_visibility(False)

    def grown(self) -> None:
        """There is more to be seen; from any thread."""
        if not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._soon)

    def _soon(self) -> None:
        if self._due is None:
            wait = self._drawn_at + EVERY - self._loop.time()
            self._due = self._loop.call_later(max(0.0, wait), self.draw)

    def draw(self) -> None:
        """Show how far it is now."""
        if self._due is not None:
            self._due.cancel()
            self._due = None
        if self._bubble.is_deleted:
            return
        self._drawn_at = self._loop.time()
        thought = self._dialogue.thought
        self._bubble.set_visibility(thought is not None)
        deep = thought is not None and thought.deep
        self._bubble.classes(**({"add": "deep"} if deep else {"remove": "deep"}))
        self._program.set_content(_written(thought.program) if thought else "")


def _written(program: str) -> str:
    """A program as far as it is written, with a sign where it goes on."""
    if not program.strip():
        return ""
    lines = Markup("\n").join(highlighted(program))
    return Markup('<pre class="growing"><code>{}{}</code></pre>').format(
        lines, Markup('<span class="goes-on" aria-hidden="true"></span>')
    )
