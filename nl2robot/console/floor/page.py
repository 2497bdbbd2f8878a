"""The page `/map`: the live floor map over the whole width, and beside it, where there is one, the
review of where a click sends the robot, and the run."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nl2robot.console.desk.desk import Desk
from nl2robot.console.frame import frame
from nl2robot.station.part import Backstage

if TYPE_CHECKING:
    from nl2robot.console.desk.dialogues import Dialogues


def pages(backstage: Backstage, dialogues: Dialogues) -> None:
    """Register the page."""
    from nicegui import ui

    @ui.page("/map")
    def map_page() -> None:
        with frame(backstage, "map") as visit:
            ui.add_head_html(
                '<link rel="stylesheet" href="/static/floor/floor.css">'
                '<link rel="stylesheet" href="/static/floor/page.css">'
                '<script type="module" src="/static/floor/page.js"></script>'
            )
            with ui.element("div").classes(f"map-desk {visit.role}"):
                ui.html('<div id="map"></div>', sanitize=False).classes("map-page")
                Desk(backstage, dialogues, visit, talks=False)
