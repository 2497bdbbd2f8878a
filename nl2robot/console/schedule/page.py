"""Schedule (`/schedule`): the week of the robot, and its appointments.

All of it is drawn by the page's scripts from the wire (`static/schedule/`): the methods
`schedule.*` are the station's own (`nl2robot.schedule.wire`).
"""

from __future__ import annotations

from html import escape
from typing import Final

from nl2robot.console.frame import frame
from nl2robot.station.part import Backstage, Part

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
                visit.hand_over({"words": dict(visit.words)})
                ui.add_head_html(_HEAD)
                title, intro = (escape(visit.words[key]) for key in ("title", "intro"))
                ui.html(
                    f'<header class="schedule-head"><h1>{title}</h1>'
                    f'<p class="muted">{intro}</p></header>'
                    '<div id="schedule" class="schedule"></div>',
                    sanitize=False,
                )

    return Part(pages=pages)
