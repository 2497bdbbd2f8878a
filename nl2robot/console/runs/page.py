"""The log of past runs: the list (`/runs`) and the page of one run (`/runs/12`).

    /runs?words=tea&state=failed     search over sentences, programs, people; state and day
    /runs/export.csv, export.json    the same runs as a file
    /runs/12                         said, approved, run: program, calls, picture, to watch again
    /runs/12/run.json, program.py    all of it, and the program alone
    /runs/12/movement.json, floor.svg, picture.svg       what the page watches

The pages are made at the server (`view`), to be there at once; `static/past_runs.js`
keeps a run that goes on up to date, and lets its movement be watched. Nothing here moves a robot:
"run again" opens the review with the program.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, TypedDict

from starlette.requests import Request

from grammar.language import speech
from grammar.speech import fill, fitting
from nl2robot.console import slow_pages
from nl2robot.console.frame import frame
from nl2robot.console.runs import files as runs_files
from nl2robot.console.runs import view as runs_view
from nl2robot.console.runs.asked import PROPERTIES, Asked, BadDay, asked
from nl2robot.console.visitor import texts, visitor_of
from nl2robot.errors import UserError
from nl2robot.run.archive import Archive, State
from nl2robot.run.kept_record import Recorder
from nl2robot.station.part import Backstage, Part
from nl2robot.wire import service
from robot_api.driver import EVENTS_OF_METHODS
from robot_api.errors import NotPossible
from robot_api.methods import METHODS
from robot_api.server import Service

_HEAD = (
    '<link rel="stylesheet" href="/static/past_runs.css">'
    '<script type="module" src="/static/past_runs.js"></script>'
)
_FOR_SCRIPTS = (
    *("play", "pause", "says", "hears", "shows", "feels", "gestures"),
    *("replay_failed", "shortened", "stale"),
)


class Row(TypedDict):
    """`nl2robot.run.archive.Brief`, with its state."""

    id: int
    started: float
    finished: float | None
    heard: str | None
    utterance: str | None
    program: str
    approved_by: str
    proposed: str | None
    changed_by: str | None
    world: str | None
    robot: str | None
    status: str | None
    message: str | None
    process: int | None
    calls: int
    state: State


class Listed(TypedDict):
    """Some runs; `found`: how many there are in all, `more`: whether there are older ones."""

    runs: list[Row]
    found: int
    more: bool


def part(backstage: Backstage) -> Part:
    archive = Archive(backstage.runner.log.path)
    recorder = Recorder(backstage.runner.log)
    return Part(
        services=_services(backstage, archive),
        routes=runs_files.routes(backstage, archive),
        pages=partial(_pages, backstage, archive),
        close=backstage.subscribe(recorder.note),
    )


def _pages(backstage: Backstage, archive: Archive) -> None:
    from nicegui import ui

    def show(html: str) -> None:
        with frame(backstage, "runs") as visit:
            visit.hand_over({"words": _for_scripts(visit.language)})
            ui.add_head_html(_HEAD)
            ui.html(html, sanitize=False)

    @slow_pages.page("/runs", show)
    def runs(request: Request) -> str:
        return _list_page(backstage, archive, request)

    @slow_pages.page("/runs/{number:int}", show)
    def run(request: Request, number: int) -> str:
        return _run_page(backstage, archive, request, number)


def _for_scripts(language: str) -> dict[str, str]:
    """What a replay says, with what looks and gestures are called."""
    words, drive = texts("runs", language), texts("drive", language)
    called = {name: drive[name] for name in drive if name.startswith(("emotion_", "gesture_"))}
    return {**called, **_of_methods(language), **{name: words[name] for name in _FOR_SCRIPTS}}


def _of_methods(language: str) -> dict[str, str]:
    """How it is told what only the method table knows of: by the words for the call."""
    spoken, told = speech(language), {}
    for method in METHODS.values():
        kind, said = method.tells or "", spoken.methods[method.name]
        for name in EVENTS_OF_METHODS.get(kind, ())[:1]:
            pattern = fitting(said.do, {name}) or "{text}"
            told[kind] = spoken.joined_up(fill(pattern, {name: "{text}", "text": "{text}"}))
            called = said.choices.get(name, {})
            told |= {f"{kind}_{value}": called[value] for value in called}
    return told


def _list_page(backstage: Backstage, archive: Archive, request: Request) -> str:
    reader = runs_view.reader_of(request, backstage.runner.knowledge)
    try:
        wanted = asked(request.query_params)
        page = archive.page(wanted.wanted, wanted.before)
    except BadDay as error:
        trouble = reader.words["bad_day"].format(day=error.day)
    except UserError as error:
        trouble = str(error)
    else:
        return runs_view.list_page(wanted, page, None, reader)
    return runs_view.list_page(Asked(), None, trouble, reader)


def _run_page(backstage: Backstage, archive: Archive, request: Request, number: int) -> str:
    reader = runs_view.reader_of(request, backstage.runner.knowledge)
    log = backstage.runner.log
    try:
        run = log.run(number)
        if run is not None:
            seat = visitor_of(request).seat
            return runs_view.run_page(run, log, reader, seat, archive.neighbours(number))
    except UserError as error:
        return runs_view.list_page(Asked(), None, str(error), reader)
    trouble = reader.words["no_such_run"].format(number=number)
    return runs_view.list_page(Asked(), None, trouble, reader)


def _services(backstage: Backstage, archive: Archive) -> dict[str, Service]:
    log = backstage.runner.log

    def listed(p: Mapping[str, Any]) -> Any:
        wanted = asked(p)
        page = archive.page(wanted.wanted, wanted.before)
        return {
            "runs": [runs_files.row(run) for run in page.runs],
            "found": page.found,
            "more": page.more,
        }

    def shown(p: Mapping[str, Any]) -> Any:
        run = log.run(p["run"])
        if run is None:
            raise NotPossible(f"There is no run {p['run']}. runs.list tells those there are.")
        return log.whole(run)

    def looking(
        handler: Callable[[Mapping[str, Any]], Any],
        result: Any,
        doc: str,
        properties: Any,
        required: str = "",
    ) -> Service:
        return service(handler, doc, dict(properties), required, observes=True, result=result)

    return {
        "runs.list": looking(
            listed,
            Listed,
            "List past runs, newest first: those with all these words, in this state, of these"
            " days (2026-11-24), older than the run `before`.",
            PROPERTIES,
        ),
        "runs.show": looking(
            shown,
            dict[str, Any],
            "Everything that is logged of a run.",
            {"run": {"type": "integer", "minimum": 1}},
            "run",
        ),
    }
