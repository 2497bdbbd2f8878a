"""Schedule (`/schedule`): the week of the robot, its appointments, and the record of reminders.

    /schedule/reminders.csv    the record for a spreadsheet

All else is drawn by the page's scripts from the wire (`static/schedule/`): the methods
`schedule.*` are the station's own (`nl2robot.schedule.wire`).
"""

from __future__ import annotations

from datetime import datetime
from html import escape
from typing import Final

from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route

from nl2robot.console.frame import frame
from nl2robot.console.visitor import visitor_of
from nl2robot.errors import UserError
from nl2robot.schedule.reminders import as_csv, reminders
from nl2robot.sentences import in_language
from nl2robot.station.part import Backstage, Part
from robot_api.local_time import local_zone

_HEAD: Final = (
    '<link rel="stylesheet" href="/static/schedule/schedule.css">'
    '<script type="module" src="/static/schedule/schedule.js"></script>'
)


def part(backstage: Backstage) -> Part:
    def pages() -> None:
        from nicegui import ui

        @ui.page("/schedule")
        def schedule() -> None:
            with frame(backstage, "schedule") as visit:
                fleet = backstage.fleet is not None
                visit.hand_over({"words": dict(visit.words), "fleet": fleet})
                ui.add_head_html(_HEAD)
                title, intro = (escape(visit.words[key]) for key in ("title", "intro"))
                ui.html(
                    f'<header class="schedule-head"><h1>{title}</h1>'
                    f'<p class="muted">{intro}</p></header>'
                    '<div id="schedule" class="schedule"></div>',
                    sanitize=False,
                )

    def saved(request: Request) -> Response:
        """In a thread of its own."""
        if backstage.schedule is None:
            return PlainTextResponse("There are no appointments here.", 404)
        language = visitor_of(request).language
        try:
            found = reminders(backstage.schedule, backstage.runner.log, language=language)
        except UserError as error:
            sentence = in_language(str(error), language) or str(error)
            return PlainTextResponse(sentence, 503)
        name = f"reminders-{datetime.now():%Y-%m-%d}.csv"
        about = {
            "Content-Disposition": f'attachment; filename="{name}"',
            "Cache-Control": "no-store",
        }
        return Response(as_csv(found, local_zone()), 200, about, "text/csv")

    return Part(pages=pages, routes=[Route("/schedule/reminders.csv", saved)])
