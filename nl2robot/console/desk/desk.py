"""The desk itself, as one browser shows it: what is said, what lies before the operator."""

from __future__ import annotations

import asyncio
import json
import re
import secrets
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any, Final

import msgspec

from nl2robot.console.desk.dialogues import Dialogues
from nl2robot.console.desk.outlook import outlook
from nl2robot.console.desk.thought_view import ThoughtView
from nl2robot.console.rendering import rendered
from nl2robot.console.visitor import texts
from nl2robot.station.part import Backstage
from nl2robot.translate.outcome import Translation

if TYPE_CHECKING:
    from nicegui.events import GenericEventArguments

    from nl2robot.console.frame import Visit


EDITED_AFTER: Final = 0.35
"""Seconds without a key until an edited program is reviewed."""

GONE_AFTER: Final = 2.0
"""Seconds without a connection after which nothing more is thought about for a page."""


class Desk:
    """Talk, review, approve and watch, in one browser window.

    Without `talks` it is the review and the run alone, for a page of something else: of the same
    conversation, so that what waits on one page waits on the other.
    """

    def __init__(
        self, backstage: Backstage, dialogues: Dialogues, visit: Visit, *, talks: bool = True
    ) -> None:
        from nicegui import ui

        request = ui.context.client.request
        assert request is not None
        self.backstage = backstage
        self.visit = visit
        self.words = texts("desk", visit.language)
        self.talks = talks
        self.dialogues = dialogues
        self.dialogue = dialogues.of(_name(request.cookies.get("desk", "")), visit.language)
        visit.hand_over(
            {
                "words": dict(self.words),
                "microphone": dict(texts("microphone", visit.language)),
                "desk": self.dialogue.name,
                "who": visit.who,
                "times": dict(texts("schedule", visit.language)),
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
        self._dropped = self.dialogue.dropped
        self._read = len(self.dialogue.lines)
        """How many lines of the conversation were there when the page was opened."""
        self._ponders = False
        """Whether the microphone here has heard what was then thought about."""
        self._build()
        if visit.role == "operator":
            self._attend()
            for name, handler in self._handlers().items():
                ui.on(name, handler)
            backstage.talks.of(self.dialogue.name).who = visit.who
            program, routine = map(request.query_params.get, ("program", "routine"))
            if routine:
                said_in = request.query_params.get("in", visit.language)
                perform = self.dialogue.perform_routine
                act = partial(self._do, perform, routine, said_in, visit.language)
                ui.timer(0, act, once=True)
            elif (rest := request.query_params.get("go_on", "")[:9]).isdecimal():
                go_on = self.dialogue.go_on
                ui.timer(0, lambda: self._do(go_on, int(rest), visit.language), once=True)
            elif (number := request.query_params.get("proposal", "")[:9]).isdecimal():
                take_up = self.dialogue.take_up
                ui.timer(0, lambda: self._do(take_up, int(number), visit.language), once=True)
            elif program:
                # Whoever wrote a link elsewhere may want it approved unread.
                foreign = request.headers.get("sec-fetch-site", "same-origin") != "same-origin"
                note = visit.words["by_a_link"] if foreign else ""
                propose = partial(self.dialogue.propose, note=note)
                ui.timer(0, lambda: self._do(propose, program, visit.language), once=True)
            elif self.dialogue.draft and self.dialogue.draft.review is None:
                review = self.dialogue.review
                ui.timer(0, lambda: self._do(review, visit.language), once=True)
        self._follow()
        self._draw()

    def _follow(self) -> None:
        """Draw what changes in the dialogue, as long as the page is there."""
        from nicegui import ui

        client, loop = ui.context.client, _loop()

        def changed() -> None:
            if not loop.is_closed():
                loop.call_soon_threadsafe(self._draw)

        client.on_delete(self.dialogue.watch(changed))
        if self.talks:
            client.on_delete(self.dialogue.look_on(self.thought.grown))

    def _attend(self) -> None:
        """Be there for the dialogue as long as the browser is, and a little longer: a connection
        may break for a moment, and a page may be loaded anew."""
        from nicegui import ui

        client, loop = ui.context.client, _loop()
        there: list[Callable[[], None]] = []

        def came() -> None:
            there.append(self.dialogue.attend(self.visit.language))

        def went() -> None:
            if there:
                loop.call_later(GONE_AFTER, self.dialogues.later, there.pop())
            if self._ponders:  # nobody is left who would say what came of it
                self.dialogues.later(self.dialogue.give_up, self.visit.language)

        client.on_connect(came)
        client.on_disconnect(went)

    # --- what is there

    def _build(self) -> None:
        from nicegui import ui

        if not self.talks:
            with ui.element("div").classes("desk-program"):
                self.told = ui.html("", sanitize=False).props('role="status"')
                self._build_program()
            return
        with ui.element("div").classes(f"desk {self.visit.role}"):
            with (
                ui.element("section")
                .classes("desk-talk card")
                .props(f'aria-label="{self.words["conversation"]}"')
            ):
                with ui.element("div").props(
                    'id="conversation" role="log" aria-live="polite" tabindex="0"'
                ):
                    self.conversation = ui.html("", sanitize=False).classes("lines")
                    self.thought = ThoughtView(self.dialogue, self.words, _loop())
                    if self.visit.role == "operator":
                        ui.html('<div id="standing-in"></div>', sanitize=False)
                hands_free = texts("microphone", self.visit.language)["hands_free"]
                composer = rendered("composer.html", visit=self.visit, hands_free=hands_free)
                ui.html(composer, sanitize=False)
            with ui.element("div").classes("desk-program"):
                self._build_program()
            ui.html(
                '<section id="desk-map" class="floor-hugging"></section>', sanitize=False
            ).classes("desk-map")

    def _build_program(self) -> None:
        from nicegui import ui

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

    def _draw(self) -> None:
        """Show the dialogue as it stands now."""
        if self.panel.is_deleted:
            return
        if self.talks:
            self._draw_talk()
        else:
            self._draw_told()
        dialogue = self.dialogue
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
        self.head.set_content(rendered("review_head.html", **about))
        self.foot.set_content(rendered("review_foot.html", **about))
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

    def _draw_talk(self) -> None:
        dialogue = self.dialogue
        self.conversation.set_content(
            rendered("conversation.html", dialogue=dialogue, words=self.words, visit=self.visit)
        )
        self.thought.draw()
        if dialogue.dropped is not self._dropped:
            self._dropped = dialogue.dropped
            self._dispatch("thought-dropped", self._dropped and self._dropped.words)

    def _draw_told(self) -> None:
        """Where the conversation is not in view, what the robot said last since the page was
        opened."""
        lines = self.dialogue.lines
        last = lines[-1] if len(lines) > self._read else None
        said = last if last is not None and last.by == "robot" else None
        self.told.set_content(rendered("told.html", said=said))

    def _show_path(self, path: list[list[float]] | None) -> None:
        if path == self._path:
            return
        self._path = path
        self._dispatch("dry-run", path)

    def _dispatch(self, name: str, detail: Any) -> None:
        """Tell the page's scripts something."""
        about = json.dumps({"detail": detail})
        self.panel.client.run_javascript(
            f"document.dispatchEvent(new CustomEvent({json.dumps(name)}, {about}))"
        )

    # --- what is done

    async def _do(self, act: Callable[..., None], *arguments: Any) -> None:
        """Do something that takes its time, in a thread of its own."""
        await _loop().run_in_executor(self.dialogues.threads, partial(act, *arguments))

    async def _edited(self, program: str) -> None:
        draft = self.dialogue.draft
        if draft is None or program == self._shown:
            return
        self._shown = program
        self.dialogue.touch(program, self.visit.who)
        await asyncio.sleep(EDITED_AFTER)
        if self._shown == program:  # nobody typed on
            await self._do(self.dialogue.edit, program, self.visit.language, self.visit.who)

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

        def ponder(event: GenericEventArguments) -> None:  # here, so that they come in order
            words, program = str(event.args["text"]), str(event.args["program"])
            self._ponders = True
            dialogue.ponder(int(event.args["microphone"]), words, program, language)

        async def give_up(event: GenericEventArguments) -> None:
            await self._do(dialogue.give_up, language)

        async def cancel(event: GenericEventArguments) -> None:
            await self._do(dialogue.cancel, language)

        async def propose(event: GenericEventArguments) -> None:
            program, at_once = str(event.args["program"]), bool(event.args["at_once"])
            said, note = event.args.get("said"), str(event.args.get("note", ""))
            await self._do(dialogue.propose, program, language, who, at_once, said, note)

        async def go_on(event: GenericEventArguments) -> None:
            await self._do(dialogue.go_on, int(event.args["run"]), language)

        async def approve(event: GenericEventArguments) -> None:
            program, shown = str(event.args["program"]), str(event.args["sha256"])
            insists = bool(event.args["all_the_same"])
            await self._do(dialogue.approve, program, who, language, shown, insists)

        async def planned(event: GenericEventArguments) -> None:
            appointment, when = int(event.args["appointment"]), str(event.args["when"])
            await self._do(dialogue.planned, appointment, when, language)

        async def reject(event: GenericEventArguments) -> None:
            await self._do(dialogue.reject, language, who, str(event.args["reason"]))

        def shade(event: GenericEventArguments) -> None:
            self.editor.theme = "githubDark" if event.args["dark"] else "githubLight"

        return {
            "desk-say": say,
            "desk-hear": hear,
            "desk-ponder": ponder,
            "desk-given-up": give_up,
            "desk-cancel": cancel,
            "desk-propose": propose,
            "desk-go-on": go_on,
            "desk-approve": approve,
            "desk-planned": planned,
            "desk-reject": reject,
            "desk-shade": shade,
        }


def _loop() -> asyncio.AbstractEventLoop:
    """The one that the pages live in."""
    from nicegui import core

    assert core.loop is not None
    return core.loop


def _name(kept: str) -> str:
    """Of a browser's dialogue: the one that it keeps, or a new one."""
    return kept if re.fullmatch(r"[0-9a-f]{16}", kept) else secrets.token_hex(8)
