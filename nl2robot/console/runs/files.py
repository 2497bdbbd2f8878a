"""The files behind the pages of past runs: exports, pictures, movements, parts of pages."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Iterable, Iterator
from datetime import datetime
from functools import lru_cache, partial
from itertools import islice
from pathlib import Path
from typing import Any, Final

import msgspec
from starlette.requests import Request
from starlette.responses import (
    FileResponse,
    HTMLResponse,
    JSONResponse,
    PlainTextResponse,
    Response,
    StreamingResponse,
)
from starlette.routing import Route

from nl2robot.console.runs import view as runs_view
from nl2robot.console.runs.asked import BadDay, asked
from nl2robot.console.visitor import LANGUAGES, texts, visitor_of
from nl2robot.errors import UserError
from nl2robot.run.archive import Archive, Brief
from nl2robot.run.kept_record import unpacked
from nl2robot.run.runlog import Run, RunLog
from nl2robot.station.part import Backstage
from sim.world.loading import load_world
from sim.world.model import WorldError

MOST_EXPORTED: Final = 100_000
"""Runs in a file."""
SAFE: Final = {
    # A picture shows texts of others: whatever one says, nothing in it is carried out.
    "Content-Security-Policy": "default-src 'none'; style-src 'unsafe-inline'; sandbox",
    "X-Content-Type-Options": "nosniff",
    "Cache-Control": "no-cache",
}


def routes(backstage: Backstage, archive: Archive) -> list[Route]:
    """Of these files; each handler runs in a thread of its own."""
    log = backstage.runner.log

    def reader(request: Request) -> runs_view.Reader:
        return runs_view.reader_of(request, backstage.runner.knowledge)

    def found(request: Request) -> Response:
        """The list anew, for a page that is open."""
        wanted = asked(request.query_params)
        page = archive.page(wanted.wanted, wanted.before)
        return HTMLResponse(runs_view.found(wanted, page, None, reader(request)), headers=SAFE)

    def exported(request: Request, kind: str) -> Response:
        wanted = asked(request.query_params).wanted
        archive.page(wanted, size=1)  # what fails, fails before the file begins
        runs = archive.all(wanted, MOST_EXPORTED)
        name = f"runs-{datetime.now():%Y-%m-%d}.{kind}"
        if kind == "csv":
            return _streamed(_csv(runs), "text/csv", name)
        return _streamed(_json(runs), "application/json", name)

    def parts(run: Run, request: Request) -> Response:
        return JSONResponse(runs_view.run_parts(run, log, reader(request)), headers=SAFE)

    def whole(run: Run, request: Request) -> Response:
        data = json.dumps(log.whole(run), ensure_ascii=False, indent=2)
        return Response(data, 200, _as_file(f"run-{run.id}.json"), "application/json")

    def program(run: Run, request: Request) -> Response:
        return Response(run.program, 200, _as_file(f"run-{run.id}.py"), "text/x-python")

    def movement(run: Run, request: Request) -> Response:
        data = movement_of(run, log)
        return _none(run) if data is None else JSONResponse(data, headers=SAFE)

    def picture(run: Run, request: Request) -> Response:
        file = Path(run.picture or "")
        if file.suffix != ".svg" or not file.is_file():
            return _none(run)
        return FileResponse(file, headers=SAFE, media_type="image/svg+xml")

    def floor(run: Run, request: Request) -> Response:
        drawn = _floor(run.world or "", visitor_of(request).language)
        return _none(run) if drawn is None else Response(drawn, 200, SAFE, "image/svg+xml")

    one = {
        "parts.json": parts,
        "run.json": whole,
        "program.py": program,
        "movement.json": movement,
        "picture.svg": picture,
        "floor.svg": floor,
    }
    return [
        Route("/runs/found", _told(found)),
        Route("/runs/export.csv", _told(partial(exported, kind="csv"))),
        Route("/runs/export.json", _told(partial(exported, kind="json"))),
        *(
            Route(f"/runs/{{number:int}}/{name}", _told(_of_run(handler, log)))
            for name, handler in one.items()
        ),
    ]


def row(run: Brief) -> dict[str, Any]:
    """A run of the list, as data."""
    return {**msgspec.to_builtins(run), "state": run.state}


def movement_of(run: Run, log: RunLog) -> dict[str, Any] | None:
    """What a page needs to watch a run again; None if it was not kept."""
    record = log.movement(run.id)
    movement = unpacked(record) if record is not None else None
    if movement is None:
        return None
    data: dict[str, Any] = msgspec.to_builtins(movement)
    if run.start is not None:  # a robot that has not moved yet has told nobody where it is
        start = json.loads(run.start)
        data["poses"] = [[0, start["x"], start["y"], start["theta"]], *data["poses"]]
    data["lines"] = [
        [round(call.started - run.started, 2), call.line] for call in log.calls(run.id)
    ]
    return data


_Handler = Callable[[Request], Response]


def _told(handler: _Handler) -> _Handler:
    """What a person did wrong, or is wrong with the log, is an answer."""

    def answer(request: Request) -> Response:
        try:
            return handler(request)
        except BadDay as error:
            words = texts("runs", visitor_of(request).language)
            return PlainTextResponse(words["bad_day"].format(day=error.day), 400, SAFE)
        except UserError as error:
            return PlainTextResponse(str(error), 503, SAFE)

    return answer


def _of_run(handler: Callable[[Run, Request], Response], log: RunLog) -> _Handler:
    def answer(request: Request) -> Response:
        number = request.path_params["number"]
        run = log.run(number)
        if run is None:
            return PlainTextResponse(f"There is no run {number}.\n", 404, SAFE)
        return handler(run, request)

    return answer


def _none(run: Run) -> Response:
    return PlainTextResponse(f"Of run {run.id}, that was not kept.\n", 404, SAFE)


def _as_file(name: str) -> dict[str, str]:
    return {**SAFE, "Content-Disposition": f'attachment; filename="{name}"'}


@lru_cache(maxsize=4 * len(LANGUAGES))
def _floor(world: str, language: str) -> str | None:
    """The floor of a world as it is now, with the names of a language; None if it is not to be
    found any more."""
    from sim.pictures.drawing import floor_svg

    try:
        loaded = load_world(world)
        return floor_svg(loaded, people=False, language=language) if loaded.has_geometry else None
    except WorldError:
        return None


# --- exports ------------------------------------------------------------------------------------

_COLUMNS: Final = (
    *("id", "started", "finished", "state", "utterance", "heard", "program", "approved_by"),
    *("proposed", "changed_by"),
    *("robot", "world", "message", "calls"),
)


def _streamed(pieces: Iterator[str], kind: str, name: str) -> Response:
    """A file of many small pieces, sent some at a time."""

    def together() -> Iterator[str]:
        while some := "".join(islice(pieces, 500)):
            yield some

    return StreamingResponse(together(), media_type=kind, headers=_as_file(name))


def _csv(runs: Iterable[Brief]) -> Iterator[str]:
    written = io.StringIO()
    table = csv.writer(written)
    table.writerow(_COLUMNS)
    yield "\ufeff" + _taken(written)  # with which spreadsheets know the letters
    for run in runs:
        data = row(run)
        for name in ("started", "finished"):
            data[name] = "" if data[name] is None else _iso(data[name])
        table.writerow([_cell(data[name]) for name in _COLUMNS])
        yield _taken(written)


def _taken(written: io.StringIO) -> str:
    text = written.getvalue()
    written.seek(0)
    written.truncate()
    return text


def _cell(value: Any) -> Any:
    """A text that a spreadsheet would compute stays a text."""
    return f"'{value}" if isinstance(value, str) and value[:1] in tuple("=+-@\t\r") else value


def _json(runs: Iterable[Brief]) -> Iterator[str]:
    yield "["
    between = "\n"
    for run in runs:
        yield between + json.dumps(row(run), ensure_ascii=False)
        between = ",\n"
    yield "\n]\n"


def _iso(seconds: float) -> str:
    return datetime.fromtimestamp(seconds).astimezone().isoformat(timespec="seconds")
