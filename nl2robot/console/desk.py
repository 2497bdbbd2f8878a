"""The operator's page: talk, review, approve, watch.

What is said goes to the `Dialogue` of this browser; whatever changes there is drawn anew here. The
run and the map are drawn by the page's own scripts, from the wire, for operators and observers
alike (`static/desk/`).
"""

from __future__ import annotations

import asyncio
import json
import re
import secrets
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import msgspec

from nl2robot.console.dialogues import Dialogues
from nl2robot.console.outlook import outlook
from nl2robot.console.part import Backstage, Part
from nl2robot.console.run_view import run_view
from nl2robot.console.visitor import texts
from nl2robot.paths import data_folder
from nl2robot.translation import Translation
from nl2robot.wire import service

if TYPE_CHECKING:
    from jinja2 import Environment
    from nicegui.events import GenericEventArguments

    from nl2robot.console.frame import Visit

EDITED_AFTER: Final = 0.35
"""Seconds without a key until an edited program is reviewed."""


def part(backstage: Backstage) -> Part:
    dialogues = Dialogues(backstage, data_folder() / "console" / "conversations")
    unsubscribe = backstage.subscribe(dialogues.on_event)

    def pages() -> None:
        from nicegui import ui

        from nl2robot.console.frame import frame

        @ui.page("/")
        def desk() -> None:
            with frame(backstage, "desk") as visit:
                _Desk(backstage, dialogues, visit)

    return Part(
        services={
            "desk.run": service(
                lambda p: run_view(backstage, p.get("language", "en")),
                "Tell how the present or last run stands, with its program and calls.",
                {"language": {"type": "string", "pattern": "^[a-z]{2}$"}},
                observes=True,
            )
        },
        pages=pages,
        close=unsubscribe,
    )


class _Desk:
    """The page in one browser window."""

    def __init__(self, backstage: Backstage, dialogues: Dialogues, visit: Visit) -> None:
        from nicegui import ui

        request = ui.context.client.request
        assert request is not None
        self.backstage = backstage
        self.visit = visit
        self.words = visit.words
        self.dialogue = dialogues.of(_name(request.cookies.get("desk", "")), visit.language)
        visit.hand_over(
            {
                "words": dict(visit.words),
                "microphone": dict(texts("microphone", visit.language)),
                "desk": self.dialogue.name,
                "history": [line.text for line in self.dialogue.lines if line.by == "you"],
            }
        )
        ui.add_head_html(
            '<link rel="stylesheet" href="/static/desk/desk.css">'
            '<script type="module" src="/static/desk/desk.js"></script>'
        )
        self._shown: str | None = None
        """The program in the editor, as it was last set here or typed there."""
        self._path: list[list[float]] | None = None
        self._build()
        if visit.role == "operator":
            for name, handler in self._handlers().items():
                ui.on(name, handler)
            program = request.query_params.get("program")
            if program:
                propose = self.dialogue.propose
                ui.timer(0, lambda: self._do(propose, program, visit.language), once=True)
            elif self.dialogue.draft and self.dialogue.draft.review is None:
                review = self.dialogue.review
                ui.timer(0, lambda: self._do(review, visit.language), once=True)
        self._follow()
        self._draw()

    def _follow(self) -> None:
        """Draw what changes in the dialogue, as long as the page is there."""
        from nicegui import core, ui

        loop = core.loop
        assert loop is not None

        def changed() -> None:
            if not loop.is_closed():
                loop.call_soon_threadsafe(self._draw)

        ui.context.client.on_delete(self.dialogue.watch(changed))

    # --- what is there

    def _build(self) -> None:
        from nicegui import ui

        with ui.element("div").classes(f"desk {self.visit.role}"):
            with (
                ui.element("section")
                .classes("desk-talk card")
                .props(f'aria-label="{self.words["conversation"]}"')
            ):
                self.conversation = ui.html("", sanitize=False).props(
                    'id="conversation" role="log" aria-live="polite" tabindex="0"'
                )
                ui.html(_page("composer.html", visit=self.visit), sanitize=False)
            with ui.element("div").classes("desk-program"):
                ui.html('<section id="run-panel" hidden></section>', sanitize=False)
                with (
                    ui.element("section")
                    .classes("desk-review card")
                    .props(f'aria-label="{self.words["review"]}"') as self.panel
                ):
                    self.head = ui.html("", sanitize=False).props('aria-live="polite"')
                    with ui.element("div").classes("desk-editor") as self.editor_box:
                        self.editor = ui.codemirror(
                            language="Python", line_wrapping=True, theme="basicLight"
                        )
                        self.editor.on_value_change(lambda event: self._edited(event.value or ""))
                    self.foot = ui.html("", sanitize=False)
            ui.html(
                '<section id="desk-map" class="floor-hugging"></section>', sanitize=False
            ).classes("desk-map")

    def _draw(self) -> None:
        """Show the dialogue as it stands now."""
        if self.conversation.is_deleted:
            return
        dialogue = self.dialogue
        self.conversation.set_content(
            _page("conversation.html", dialogue=dialogue, words=self.words, visit=self.visit)
        )
        draft = dialogue.draft
        review = draft.review if draft else None
        language, knowledge = self.visit.language, self.backstage.runner.knowledge
        seen = outlook(review, self.words, language, knowledge) if review else None
        about = {
            "draft": draft,
            "review": review,
            "outlook": seen,
            "words": self.words,
            "visit": self.visit,
        }
        self.head.set_content(_page("review_head.html", **about))
        self.foot.set_content(_page("review_foot.html", **about))
        self.editor_box.set_visibility(draft is not None)
        decorations = seen.decorations if seen else []
        if draft is None or draft.program != self._shown:
            self._shown = draft.program if draft else None
            self.editor.value = self._shown or ""
            self.editor.decorations = decorations
        elif draft.review is not None:
            # Not by the property: that sends the text with it, over what is typed meanwhile.
            self.editor.run_method("setDecorations", decorations)
        self._show_path([list(point) for point in seen.path] if seen else None)

    def _show_path(self, path: list[list[float]] | None) -> None:
        if path == self._path:
            return
        self._path = path
        detail = json.dumps(path)
        self.panel.client.run_javascript(
            f"document.dispatchEvent(new CustomEvent('dry-run', {{detail: {detail}}}))"
        )

    # --- what is done

    async def _do(self, act: Callable[..., None], *arguments: Any) -> None:
        """Do something that takes its time, in a thread of its own."""
        from nicegui import run

        await run.io_bound(act, *arguments)

    async def _edited(self, program: str) -> None:
        draft = self.dialogue.draft
        if draft is None or program == self._shown:
            return
        self._shown = program
        self.dialogue.touch(program)
        await asyncio.sleep(EDITED_AFTER)
        if self._shown == program:  # nobody typed on
            await self._do(self.dialogue.edit, program, self.visit.language)

    def _handlers(self) -> dict[str, Callable[[GenericEventArguments], Any]]:
        dialogue, language, who = self.dialogue, self.visit.language, self.visit.who

        async def say(event: GenericEventArguments) -> None:
            words = str(event.args["text"]).strip()
            if words:
                await self._do(dialogue.say, words, language, who, bool(event.args["harmless"]))

        async def hear(event: GenericEventArguments) -> None:
            words, harmless = str(event.args["text"]), bool(event.args["harmless"])
            translation = msgspec.convert(event.args["translation"], Translation)
            await self._do(dialogue.hear, words, translation, language, who, harmless)

        async def propose(event: GenericEventArguments) -> None:
            program, at_once = str(event.args["program"]), bool(event.args["at_once"])
            await self._do(dialogue.propose, program, language, who, at_once)

        async def approve(event: GenericEventArguments) -> None:
            await self._do(dialogue.approve, str(event.args["program"]), who, language)

        async def reject(event: GenericEventArguments) -> None:
            await self._do(dialogue.reject, language)

        def shade(event: GenericEventArguments) -> None:
            self.editor.theme = "githubDark" if event.args["dark"] else "githubLight"

        return {
            "desk-say": say,
            "desk-hear": hear,
            "desk-propose": propose,
            "desk-approve": approve,
            "desk-reject": reject,
            "desk-shade": shade,
        }


def _name(kept: str) -> str:
    """Of a browser's dialogue: the one that it keeps, or a new one."""
    return kept if re.fullmatch(r"[0-9a-f]{16}", kept) else secrets.token_hex(8)


@cache
def _templates() -> Environment:
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    folder = Path(__file__).parent / "templates"
    return Environment(
        loader=FileSystemLoader(folder),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )


def _page(template: str, **about: Any) -> str:
    return _templates().get_template(template).render(**about)
