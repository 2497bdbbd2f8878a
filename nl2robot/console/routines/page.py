"""Routines (`/routines`): commands and programs that go by a name, as cards; they are named,
tested, changed, handed on and run from there.

    /routines/cards           the cards anew, for a page that is open
    /routines/export.yaml     all routines as a file, or ?name=tea%20round&in=en

They are those of the store (`nl2robot.translate.routines`), which what is said uses as well.
Nothing here moves a robot: to run one lays it before you at the desk.
"""

from __future__ import annotations

import itertools
from collections import OrderedDict
from collections.abc import Mapping
from datetime import datetime
from typing import Any, Final, NotRequired, TypedDict

from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import HTMLResponse, PlainTextResponse, Response
from starlette.routing import Route

from nl2robot.console import slow_pages
from nl2robot.console.desk.outlook import Outcome
from nl2robot.console.frame import frame
from nl2robot.console.rendering import rendered
from nl2robot.console.routines import view as routine_view
from nl2robot.console.routines.view import Body, Card, Shown, Viewer
from nl2robot.console.visitor import LANGUAGES, LONGEST_NAME, texts, visitor_of
from nl2robot.errors import UserError
from nl2robot.run.archive import Archive
from nl2robot.station.part import Backstage, Part
from nl2robot.translate import routine_files
from nl2robot.translate.routine_files import Choice
from nl2robot.translate.routines import Routine, Routines, spelled
from nl2robot.translate.teaching import Teacher, tidied
from nl2robot.wire import LANGUAGE, an_object, service
from robot_api.methods import MAX_TEXT
from robot_api.server import Service
from sandbox.limits import MAX_PROGRAM

REMOVED_KEPT: Final = 50
"""Routines that can be put back, until the server ends."""
_HEAD: Final = (
    '<link rel="stylesheet" href="/static/routines/routines.css">'
    '<script type="module" src="/static/routines/routines.js"></script>'
)
_NAME: Final = {"type": "string", "maxLength": 200}
_READER: Final = {"enum": list(LANGUAGES)}
_BY: Final = {"type": "string", "maxLength": LONGEST_NAME}
_BODY: Final = {
    "sentence": {"type": "string", "maxLength": MAX_TEXT},
    "program": {"type": "string", "maxLength": MAX_PROGRAM},
}


class Tried(TypedDict):
    """What a sentence or a program would do; `name`: why it can have no such name."""

    works: bool
    does: str
    steps: list[tuple[int, str]]
    written: str
    name: str | None


class Tested(Outcome):
    """A dry run; `picture` is an SVG of its way."""

    picture: str | None


class Renamed(TypedDict):
    """`used_by`: the names of the routines that need it, with commas between; maybe empty."""

    name: str
    used_by: str


class Removed(TypedDict):
    """`number`: with which it can be restored."""

    number: int
    used_by: str


class File(TypedDict):
    """A file to keep, by its name."""

    file: str
    text: str


class Found(TypedDict):
    """A routine of a file, and how it stands to those that are known."""

    name: str
    language: str
    sentence: str
    line: int
    state: routine_files.State
    why: str
    works: bool
    does: str
    steps: list[tuple[int, str]]
    written: str


class Kept(TypedDict):
    """A routine that was taken over."""

    name: str
    language: str


class Imported(TypedDict):
    """What is in a file, or what of it was taken over."""

    found: NotRequired[list[Found]]
    kept: NotRequired[list[Kept]]


def part(backstage: Backstage) -> Part:
    """The page, the services and the files of the routines."""
    shelf = Shelf(backstage)

    def pages() -> None:
        from nicegui import ui

        def show(html: str) -> None:
            with frame(backstage, "routines") as visit:
                visit.hand_over({"words": dict(visit.words), "languages": LANGUAGES})
                ui.add_head_html(_HEAD)
                ui.html(html, sanitize=False)

        # All sentences are understood, when nobody has looked before.
        @slow_pages.page("/routines", show)
        def routines(request: Request) -> str:
            visitor = visitor_of(request)
            return shelf.page(visitor.language, visitor.operates)

    async def cards(request: Request) -> Response:
        visitor = visitor_of(request)
        html = await run_in_threadpool(shelf.list_html, visitor.language, visitor.operates)
        return HTMLResponse(html, headers={"Cache-Control": "no-store"})

    async def export(request: Request) -> Response:
        name, language = request.query_params.get("name"), request.query_params.get("in", "en")
        which = [{"name": name, "language": language}] if name else None
        try:
            file = await run_in_threadpool(shelf.export, {"which": which} if which else {})
        except UserError as error:
            return PlainTextResponse(str(error), 404)
        about = {"Content-Disposition": f'attachment; filename="{file["file"]}"'}
        return Response(file["text"], 200, about, "application/yaml")

    return Part(
        services=shelf.services(),
        events={"routines": "nothing; whenever a routine was learned, changed or removed"},
        routes=[Route("/routines/cards", cards), Route("/routines/export.yaml", export)],
        pages=pages,
        close=shelf.close,
    )


class Shelf:
    """The routines of this server, for pages and for the wire."""

    def __init__(self, backstage: Backstage) -> None:
        self._knowledge = backstage.runner.knowledge
        assert self._knowledge.routines is not None
        self._routines: Routines = self._knowledge.routines
        self._viewer = Viewer(backstage, Archive(backstage.runner.log.path))
        self._removed: OrderedDict[int, Routine] = OrderedDict()
        self._numbers = itertools.count(1)
        self.close = self._routines.watch(lambda: backstage.publish("routines", {}))

    # --- the page

    def page(self, language: str, operates: bool) -> str:
        """All of it."""
        return rendered("routines.html", **self._about(language, operates))

    def list_html(self, language: str, operates: bool) -> str:
        """The cards alone."""
        return rendered("routine_cards.html", **self._about(language, operates))

    def _about(self, language: str, operates: bool) -> dict[str, Any]:
        words = texts("routines", language)
        cards: list[Card] = []
        trouble = ""
        try:
            cards = self._viewer.cards(language)
        except UserError as error:
            trouble = str(error)

        def day(moment: str) -> str:
            try:
                return datetime.fromisoformat(moment).strftime(words["day"])
            except ValueError:
                return moment

        return {
            "cards": cards,
            "trouble": trouble,
            "words": words,
            "operates": operates,
            "reader": language,
            "languages": LANGUAGES,
            "day": day,
        }

    # --- the wire

    def services(self) -> dict[str, Service]:
        one = {"name": _NAME, "language": LANGUAGE, "reader": _READER}
        which = an_object({"name": _NAME, "language": LANGUAGE}, "name language")
        number = {"type": "integer", "minimum": 0}
        choice = an_object(
            {"number": number, "name": _NAME, "replace": {"type": "boolean"}}, "number name"
        )
        return {
            "routines.list": service(
                lambda p: [routine_view.as_data(card) for card in self._viewer.cards(_reader(p))],
                "List the routines: what each does, who taught it, how often it was run.",
                {"reader": _READER},
                observes=True,
                result=list[Shown],
            ),
            "routines.show": service(
                lambda p: routine_view.as_data(self._viewer.card(self._known(p), _reader(p))),
                "Tell all about a routine.",
                one,
                "name language",
                observes=True,
                result=Shown,
            ),
            "routines.check": service(
                self.check,
                "Tell what a sentence or a program would do as a routine; keeps nothing.",
                {**one, **_BODY},
                "language",
                result=Tried,
            ),
            "routines.test": service(
                self.test,
                "Try a routine in a copy of the simulated world, with its picture; moves nothing.",
                {**one},
                "name language",
                result=Tested,
            ),
            "routines.keep": service(
                self.keep,
                "Keep a sentence or a program under a name that can be said.",
                {**one, **_BODY, "by": _BY},
                "name language",
                result=Shown,
            ),
            "routines.change": service(
                self.change,
                "Let a routine do something else from now on.",
                {**one, **_BODY, "by": _BY},
                "name language",
                result=Shown,
            ),
            "routines.rename": service(
                self.rename,
                "Call a routine otherwise.",
                {**one, "new": _NAME},
                "name language new",
                result=Renamed,
            ),
            "routines.accept": service(
                self.accept,
                "Let an imported routine be used, whose body with this SHA-256 was reviewed.",
                {**one, "sha256": {"type": "string", "pattern": "^[0-9a-f]{64}$"}, "by": _BY},
                "name language sha256",
                result=Shown,
            ),
            "routines.remove": service(
                self.remove,
                "Forget a routine; returns a number with which it can be restored.",
                {**one},
                "name language",
                result=Removed,
            ),
            "routines.restore": service(
                self.restore,
                "Undo a removal.",
                {"number": {"type": "integer", "minimum": 1}},
                "number",
                result=None,
            ),
            "routines.export": service(
                self.export,
                "Give routines as a file: those that are named, or all.",
                {"which": {"type": "array", "items": which, "maxItems": routine_files.MOST}},
                observes=True,
                result=File,
            ),
            "routines.import": service(
                self.take_over,
                "Look at a file of routines; with `keep`, take those over. What is taken over"
                " cannot be used before routines.accept.",
                {
                    "text": {"type": "string", "maxLength": routine_files.LONGEST_FILE},
                    "file": _NAME,
                    "reader": _READER,
                    "keep": {"type": "array", "items": choice, "maxItems": routine_files.MOST},
                },
                "text",
                result=Imported,
            ),
        }

    def check(self, p: Mapping[str, Any]) -> dict[str, Any]:
        name = tidied(p.get("name", "")) or "?"
        body = self._body(name, p)
        return {
            "works": body.works,
            "does": body.does,
            "steps": [list(step) for step in body.steps],
            "written": body.program,
            "name": self._trouble_with(name, p["language"]) if p.get("name", "").strip() else None,
        }

    def test(self, p: Mapping[str, Any]) -> dict[str, Any]:
        body = self._viewer.body(self._known(p), _reader(p))
        if not body.program:
            raise UserError(body.does)
        return self._viewer.tested(body, _reader(p))

    def keep(self, p: Mapping[str, Any]) -> dict[str, Any]:
        teacher = self._teacher(p)
        name = tidied(p["name"])
        trouble = self._trouble_with(name, p["language"])
        if trouble:
            raise UserError(trouble)
        self._require(name, p)
        kept = self._routines.put(
            name, _sentence(p), teacher.language, p.get("by", ""), p.get("program", "")
        )
        return routine_view.as_data(self._viewer.card(kept, _reader(p)))

    def change(self, p: Mapping[str, Any]) -> dict[str, Any]:
        known = self._known(p)
        self._require(known.name, p)
        kept = self._routines.put(
            known.name, _sentence(p), known.language, p.get("by", ""), p.get("program", "")
        )
        return routine_view.as_data(self._viewer.card(kept, _reader(p)))

    def rename(self, p: Mapping[str, Any]) -> dict[str, Any]:
        known, new = self._known(p), tidied(p["new"])
        # "Tea round" may become "tea round".
        if spelled(new, known.language) != spelled(known.name, known.language):
            trouble = self._trouble_with(new, known.language)
            if trouble:
                raise UserError(trouble)
        used_by = self._teacher(p).users(known)
        self._routines.rename(known.name, new, known.language)
        return {"name": new, "used_by": used_by}

    def accept(self, p: Mapping[str, Any]) -> dict[str, Any]:
        known = self._known(p)
        # The store refuses a body that is not the one that was looked at.
        seen = known.body if routine_view.digest(known) == p["sha256"] else ""
        kept = self._routines.accept(known.name, known.language, seen, p.get("by", ""))
        return routine_view.as_data(self._viewer.card(kept, _reader(p)))

    def remove(self, p: Mapping[str, Any]) -> dict[str, Any]:
        known = self._known(p)
        used_by = self._teacher(p).users(known)
        removed = self._routines.remove(known.name, known.language)
        number = next(self._numbers)
        self._removed[number] = removed or known
        while len(self._removed) > REMOVED_KEPT:
            self._removed.popitem(last=False)
        return {"number": number, "used_by": used_by}

    def restore(self, p: Mapping[str, Any]) -> None:
        removed = self._removed.get(p["number"])
        if removed is None:
            raise UserError("This cannot be undone any more. Teach the routine anew.")
        self._routines.put_back(removed)
        del self._removed[p["number"]]

    def export(self, p: Mapping[str, Any]) -> dict[str, str]:
        chosen = [self._known(each) for each in p["which"]] if "which" in p else None
        routines = self._routines.known() if chosen is None else chosen
        if not routines:
            raise UserError("There are no routines to export. Teach one first.")
        one = routines[0].name if len(routines) == 1 else "routines"
        safe = "".join(c if c.isascii() and c.isalnum() else "-" for c in one).strip("-")
        return {"file": f"{safe or 'routine'}.yaml", "text": routine_files.exported(routines)}

    def take_over(self, p: Mapping[str, Any]) -> dict[str, Any]:
        file = " ".join(p.get("file", "").split()) or "routines.yaml"
        found = routine_files.read(p["text"], file)
        if "keep" in p:
            choices = [
                Choice(each["number"], each["name"], each.get("replace", False))
                for each in p["keep"]
            ]
            kept = routine_files.take_over(found, choices, self._knowledge, file)
            return {"kept": [{"name": each.name, "language": each.language} for each in kept]}
        looked = []
        for each in found:
            state, why = routine_files.state_of(each.routine, self._knowledge)
            body = self._viewer.body(each.routine, _reader(p))
            looked.append(
                {
                    "name": each.routine.name,
                    "language": each.routine.language,
                    "sentence": each.routine.sentence,
                    "line": each.line,
                    "state": state,
                    "why": why,
                    "works": body.works,
                    "does": body.does,
                    "steps": [list(step) for step in body.steps],
                    "written": body.program,
                }
            )
        return {"found": looked}

    # --- inside

    def _teacher(self, p: Mapping[str, Any]) -> Teacher:
        return Teacher.of(self._knowledge, p["language"])

    def _known(self, p: Mapping[str, Any]) -> Routine:
        teacher = self._teacher(p)
        known = self._routines.get(p["name"], teacher.language)
        if known is None:
            raise UserError(teacher.pack.phrase("routine_unknown", name=p["name"]))
        return known

    def _trouble_with(self, name: str, language: str) -> str | None:
        """Why no new routine can have this name."""
        teacher = Teacher.of(self._knowledge, language)
        if self._routines.get(name, language) is not None:
            return teacher.pack.phrase("routine_name_used", name=name)
        return teacher.wrong_name(name)

    def _body(self, name: str, p: Mapping[str, Any]) -> Body:
        teacher = self._teacher(p)
        try:
            new = Routine(name, _sentence(p), teacher.language, program=p.get("program", ""))
        except ValueError:
            why = teacher.pack.phrase("routine_nothing", name=name)
            return Body(False, why)
        return self._viewer.body(new, _reader(p))

    def _require(self, name: str, p: Mapping[str, Any]) -> None:
        """Raise `UserError` if a routine cannot do this here."""
        body = self._body(name, p)
        if not body.works:
            raise UserError(body.does)


def _sentence(p: Mapping[str, Any]) -> str:
    return " ".join(p.get("sentence", "").split()) if not p.get("program", "").strip() else ""


def _reader(p: Mapping[str, Any]) -> str:
    """The language that whoever asks reads."""
    return str(p.get("reader") or p.get("language") or "en")
