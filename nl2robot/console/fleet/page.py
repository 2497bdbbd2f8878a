"""Fleet (`/fleet`): all robots of the fleet on one map, how each stands, and a stop for all.

Where this robot has joined none, there is no such page. All is drawn by the page's scripts from the
wire (`static/fleet/`): the methods `fleet.*` are the station's own (`nl2robot.fleet.wire`).
"""

from __future__ import annotations

from html import escape
from typing import Final

from nl2robot.console.frame import frame
from nl2robot.fleet.roll import UNKNOWN_AFTER
from nl2robot.station.part import Backstage, Part

_HEAD: Final = (
    '<link rel="stylesheet" href="/static/fleet/fleet.css">'
    '<script type="module" src="/static/fleet/fleet.js"></script>'
)


def part(backstage: Backstage) -> Part:
    if backstage.fleet is None:
        return Part()

    def pages() -> None:
        from nicegui import ui

        @ui.page("/fleet")
        def fleet() -> None:
            with frame(backstage, "fleet") as visit:
                visit.hand_over({"words": dict(visit.words), "unknownAfter": UNKNOWN_AFTER})
                ui.add_head_html(_HEAD)
                title, intro = (escape(visit.words[key]) for key in ("title", "intro"))
                ui.html(
                    f'<header class="fleet-head"><h1>{title}</h1>'
                    f'<p class="muted">{intro}</p></header>'
                    '<div id="fleet" class="fleet"></div>',
                    sanitize=False,
                )

    return Part(pages=pages)
